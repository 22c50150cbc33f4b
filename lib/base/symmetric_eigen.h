// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace trephine {

template <std::size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

/// An eigenvalue of a symmetric matrix with its unit eigenvector.
template <std::size_t N>
struct EigenPair {
  double value = 0;
  std::array<double, N> vector{};
};

/// All of them, the smallest value first, by Jacobi's rotations.
template <std::size_t N>
std::array<EigenPair<N>, N> symmetric_eigen(SquareMatrix<N> a) {
  SquareMatrix<N> v{};
  for (std::size_t n = 0; n < N; ++n) v[n][n] = 1;
  for (int sweep = 0; sweep < 60; ++sweep)
    for (std::size_t p = 0; p + 1 < N; ++p)
      for (std::size_t q = p + 1; q < N; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < N; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < N; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double kp = v[k][p], kq = v[k][q];
          v[k][p] = c * kp - s * kq;
          v[k][q] = s * kp + c * kq;
        }
      }
  std::array<EigenPair<N>, N> all;
  for (std::size_t n = 0; n < N; ++n) {
    all[n].value = a[n][n];
    for (std::size_t k = 0; k < N; ++k) all[n].vector[k] = v[k][n];
  }
  for (std::size_t n = 1; n < N; ++n)  // few: by insertion
    for (std::size_t k = n; k > 0 && all[k].value < all[k - 1].value; --k) std::swap(all[k], all[k - 1]);
  return all;
}

}  // namespace trephine
