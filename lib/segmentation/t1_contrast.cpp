// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/t1_contrast.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rank.h"
#include "base/refusal.h"
#include "mask/hu_view.h"
#include "segmentation/tissue_mixture.h"

namespace trephine::segmentation {
namespace {

using mask::BitMask;
using mask::HuView;

constexpr double csf_hu = 8, tissue_hu = 30, max_hu = 40;
constexpr double cell_mm = 3, rim_mm = 2, near_mm = 1.5;  ///< of the samples; from bone; their neighbours
constexpr int rounds = 40;
constexpr std::size_t min_samples = 2000, min_pure = 50;
constexpr double min_grey_to_csf = 1.3, min_white_to_grey = 1.05, min_share = 0.02, max_outside = 0.02;
constexpr double outlier_density = 0.02;  ///< of vessels, dura and other things, per unit of the logarithm

enum Class { csf, grey, white, classes };

/// The polynomial in space.
class Bias {
 public:
  Bias(const grid::Lattice& lattice, const grid::Box& box, int degree) : degree_(degree) {
    for (int a = 0; a < 3; ++a) {
      middle_[a] = 0.5 * (box.begin[a] + box.end[a] - 1);
      half_[a] = std::max(1.0, 0.5 * (box.end[a] - box.begin[a]));
    }
    (void)lattice;
    for (int total = 1; total <= degree; ++total)
      for (int x = total; x >= 0; --x)
        for (int y = total - x; y >= 0; --y) powers_.push_back({x, y, total - x - y});
    weights.assign(powers_.size(), 0);
  }
  std::size_t terms() const { return powers_.size(); }
  /// The terms at a voxel. There is no constant one: that is the classes' level.
  void terms_at(double i, double j, double k, double* out) const {
    const double at[3] = {(i - middle_[0]) / half_[0], (j - middle_[1]) / half_[1], (k - middle_[2]) / half_[2]};
    double power[3][5];
    for (int a = 0; a < 3; ++a) {
      power[a][0] = 1;
      for (int n = 1; n <= degree_; ++n) power[a][n] = power[a][n - 1] * at[a];
    }
    for (std::size_t t = 0; t < powers_.size(); ++t)
      out[t] = power[0][powers_[t][0]] * power[1][powers_[t][1]] * power[2][powers_[t][2]];
  }
  double at(double i, double j, double k) const {
    double terms[40], sum = 0;
    terms_at(i, j, k, terms);
    for (std::size_t t = 0; t < weights.size(); ++t) sum += weights[t] * terms[t];
    return sum;
  }
  std::vector<double> weights;

 private:
  int degree_;
  double middle_[3], half_[3];
  std::vector<std::array<int, 3>> powers_;
};

struct Samples {
  std::vector<std::array<int, 3>> at;
  std::vector<double> log;  ///< of the MR
};

/// One voxel of each cell that lies in the cavity and not at its rim.
Samples samples_of(const HuView& mr, const BitMask& inner) {
  Samples s;
  const grid::Lattice& l = mr.lattice();
  const auto step = [&](double spacing) { return std::max(1, static_cast<int>(std::lround(cell_mm / spacing))); };
  const int di = step(l.spacing_mm.x), dj = step(l.spacing_mm.y), dk = step(l.spacing_mm.z);
  for (int k = 0; k < l.size[2]; k += dk)
    for (int j = 0; j < l.size[1]; j += dj)
      for (int i = 0; i < l.size[0]; i += di)
        if (inner.get(i, j, k) && mr(i, j, k) > 0) {
          s.at.push_back({i, j, k});
          s.log.push_back(std::log(double(mr(i, j, k))));
        }
  return s;
}

/// Solves the symmetric positive definite system by Cholesky's method; leaves x as it is where it has no solution.
void solve(std::vector<double> a, std::vector<double> b, std::vector<double>& x) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      if (i == j) {
        if (!(sum > 0)) return;
        a[i * n + i] = std::sqrt(sum);
      } else {
        a[i * n + j] = sum / a[j * n + j];
      }
    }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
  x = b;
}

struct Model {
  std::array<double, classes> mean{}, sigma{}, weight{};
  /// How likely the value is of each class; what none explains goes to none of them.
  std::array<double, classes> share(double value) const {
    std::array<double, classes> p{};
    double sum = outlier_density;
    for (int c = 0; c < classes; ++c) {
      const double z = (value - mean[c]) / sigma[c];
      sum += p[c] = weight[c] / sigma[c] * std::exp(-0.5 * z * z) / std::sqrt(2 * M_PI);
    }
    for (double& q : p) q /= sum;
    return p;
  }
  int likeliest(double value) const {
    const auto p = share(value);
    return static_cast<int>(std::max_element(p.begin(), p.end()) - p.begin());
  }
};

Model first_guess(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  Histogram h;
  const double low = sorted[sorted.size() / 200], high = sorted[sorted.size() - 1 - sorted.size() / 200];
  if (!(high > low)) throw refusal("", "the MR has one value in the whole head", {"look at the picture of `register`"});
  h.width = (high - low) / 256;
  h.first = low;
  h.counts.assign(257, 0);
  for (const double v : values)
    if (v >= low && v <= high) ++h.counts[static_cast<std::size_t>((v - low) / h.width)];
  const auto mixture = fit_mixture(h, classes);
  Model m;
  for (int c = 0; c < classes; ++c) {
    m.mean[c] = mixture.classes[c].mean;
    m.sigma[c] = std::max(0.02, mixture.classes[c].sigma);
    m.weight[c] = mixture.classes[c].weight;
  }
  return m;
}

/// Classes and bias in turns.
Model fit(const Samples& s, Bias& bias, const Progress& progress) {
  Model m = first_guess(s.log);
  const std::size_t n = s.log.size(), terms = bias.terms();
  std::vector<double> basis(n * terms), field(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) bias.terms_at(s.at[i][0], s.at[i][1], s.at[i][2], basis.data() + i * terms);
  for (int round = 0; round < rounds; ++round) {
    progress.report(double(round) / rounds);
    std::array<double, classes> sum{}, first{}, second{};
    std::vector<double> a(terms * terms, 0.0), b(terms, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const double y = s.log[i] - field[i];
      const auto p = m.share(y);
      double weight = 0, expected = 0;
      for (int c = 0; c < classes; ++c) {
        sum[c] += p[c];
        first[c] += p[c] * y;
        second[c] += p[c] * y * y;
        if (c == csf) continue;  // the liquor's level is that of partial volume as well
        weight += p[c] / (m.sigma[c] * m.sigma[c]);
        expected += p[c] / (m.sigma[c] * m.sigma[c]) * m.mean[c];
      }
      if (!(weight > 0)) continue;
      const double residual = weight * s.log[i] - expected;
      const double* row = basis.data() + i * terms;
      for (std::size_t t = 0; t < terms; ++t) {
        b[t] += residual * row[t];
        for (std::size_t u = 0; u <= t; ++u) a[t * terms + u] += weight * row[t] * row[u];
      }
    }
    double all = 0;
    for (const double w : sum) all += w;
    for (int c = 0; c < classes; ++c) {
      if (!(sum[c] > 0)) continue;
      m.mean[c] = first[c] / sum[c];
      m.sigma[c] = std::sqrt(std::max(4e-4, second[c] / sum[c] - m.mean[c] * m.mean[c]));
      m.weight[c] = sum[c] / all;
    }
    if (terms == 0) continue;
    for (std::size_t t = 0; t < terms; ++t) a[t * terms + t] += 1e-9 * (1 + a[t * terms + t]);
    solve(a, b, bias.weights);
    for (std::size_t i = 0; i < n; ++i) {
      field[i] = 0;
      for (std::size_t t = 0; t < terms; ++t) field[i] += bias.weights[t] * basis[i * terms + t];
    }
  }
  return m;
}

/// The level of each class where nothing else is near.
std::array<double, classes> pure_levels(const HuView& mr, const Samples& s, const Model& m, const Bias& bias) {
  std::array<std::vector<double>, classes> pure;
  const grid::Lattice& l = mr.lattice();
  const auto step = [&](double spacing) { return std::max(1, static_cast<int>(std::lround(near_mm / spacing))); };
  const int d[3] = {step(l.spacing_mm.x), step(l.spacing_mm.y), step(l.spacing_mm.z)};
  for (std::size_t n = 0; n < s.at.size(); ++n) {
    const auto [i, j, k] = s.at[n];
    const double field = bias.at(i, j, k);
    const int c = m.likeliest(s.log[n] - field);
    bool alone = true;
    for (int a = 0; a < 3 && alone; ++a)
      for (const int way : {-1, 1}) {
        int q[3] = {i, j, k};
        q[a] += way * d[a];
        alone = alone && l.contains(q[0], q[1], q[2]) && mr(q[0], q[1], q[2]) > 0 &&
                m.likeliest(std::log(double(mr(q[0], q[1], q[2]))) - field) == c;
      }
    if (alone) pure[static_cast<std::size_t>(c)].push_back(std::exp(s.log[n] - field));
  }
  std::array<double, classes> level{};
  for (int c = 0; c < classes; ++c) {
    auto& all = pure[static_cast<std::size_t>(c)];
    level[c] = std::exp(m.mean[c]);
    if (all.size() >= min_pure) level[c] = median_of(all);
  }
  return level;
}

[[noreturn]] void refuse(const std::string& what) {
  throw refusal(
      "", what,
      {"read a T1-weighted scan without contrast agent, or take `t1_contrast` out of the recipe: then brain and "
       "ventricles are those of the CT"});
}

/// In T1 the dark class lies around the brain; in T2 and FLAIR the bright one does, or none.
void require_t1(const Samples& s, const Model& m, const Bias& bias, const BitMask& deep) {
  double dark[2] = {0, 0}, all[2] = {0, 0};
  for (std::size_t n = 0; n < s.at.size(); ++n) {
    const auto [i, j, k] = s.at[n];
    const int where = deep.get(i, j, k);
    dark[where] += m.share(s.log[n] - bias.at(i, j, k))[csf];
    all[where] += 1;
  }
  if (!(all[0] > 0 && all[1] > 0)) refuse("the cranial cavity is too small to be judged");
  if (!(dark[0] / all[0] > 1.3 * dark[1] / all[1]))
    refuse(
        fmt::format("the contrast is not that of T1: what is dark is no commoner near the skull ({:.2f}) than deep in "
                    "the brain ({:.2f})",
                    dark[0] / all[0], dark[1] / all[1]));
}

void require_in_scan(const HuView& mr, const BitMask& cavity) {
  std::size_t all = 0, out = 0;
  const grid::Lattice& l = mr.lattice();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (cavity.get(i, j, k)) ++all, out += !(mr(i, j, k) > 0);
  if (all == 0 || double(out) > max_outside * double(all))
    refuse(fmt::format("{:.1f} % of the cranial cavity lies outside of the MR", 100.0 * double(out) / double(all)));
}

}  // namespace

Outcome<grid::HuVolume, T1ContrastResult> t1_contrast(const grid::HuVolume& mr, const grid::HuVolume& ct,
                                                      const BitMask& cavity, const T1ContrastParams& params,
                                                      const Progress& progress) {
  if (grid::lattice_of(mr) != grid::lattice_of(ct) || cavity.lattice() != grid::lattice_of(ct))
    throw Error(ExitCode::bad_input, "", "volume", "must lie on the CT's voxels, as `register` gives it");
  mask::check_finite(mr);
  mask::check_finite(ct);
  const HuView view(mr), bone(ct);
  require_in_scan(view, cavity);
  const Samples samples = samples_of(view, mask::eroded(cavity, rim_mm));
  if (samples.log.size() < min_samples) refuse("the cranial cavity is too small to be judged");
  Bias bias(view.lattice(), cavity.bounds(), params.bias_degree_count);
  const Model model = fit(samples, bias, progress.part(0, 0.6));
  require_t1(samples, model, bias, mask::eroded(cavity, 12));
  const auto level = pure_levels(view, samples, model, bias);
  double low = 1e9, high = -1e9;
  for (const auto& at : samples.at) {
    const double b = bias.at(at[0], at[1], at[2]);
    low = std::min(low, b);
    high = std::max(high, b);
  }
  T1ContrastResult result;
  result.csf_share_ratio = model.weight[csf];
  result.grey_share_ratio = model.weight[grey];
  result.white_share_ratio = model.weight[white];
  result.csf_to_grey_ratio = level[csf] / level[grey];
  result.grey_to_white_ratio = level[grey] / level[white];
  result.bias_ratio = std::tanh(0.5 * (high - low));
  if (!(level[grey] > min_grey_to_csf * level[csf]) || !(level[white] > min_white_to_grey * level[grey]))
    refuse(fmt::format("the contrast is not that of T1: CSF, grey and white matter lie at {:.0f}, {:.0f} and {:.0f}",
                       level[csf], level[grey], level[white]));
  for (const double w : model.weight)
    if (!(w > min_share)) refuse("the contrast is not that of T1: one of three tissues is not there");

  const double top = level[params.bright == T1Bright::grey ? grey : white];
  grid::Grid<float> out(view.lattice());
  parallel_for(0, out.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k) {
      progress.part(0.6, 1).report(double(k) / out.size[2]);
      for (int j = 0; j < out.size[1]; ++j)
        for (int i = 0; i < out.size[0]; ++i) {
          const std::size_t n = out.index(i, j, k);
          if (!cavity.get(i, j, k) || !(view(n) > 0)) {
            out.voxels[n] = bone(n);
            continue;
          }
          const double value = double(view(n)) * std::exp(-bias.at(i, j, k));
          const double hu = csf_hu + (tissue_hu - csf_hu) * (value - level[csf]) / (top - level[csf]);
          const double most = params.bright == T1Bright::grey ? tissue_hu : max_hu;
          out.voxels[n] = static_cast<float>(std::clamp(hu, csf_hu - 10, most));
        }
    }
  });
  return {std::move(out), std::move(result), {}};
}

}  // namespace trephine::segmentation
