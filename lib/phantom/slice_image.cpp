// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/slice_image.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "phantom/random.h"

namespace trephine::phantom {
namespace {

std::vector<float> gaussian_taps(double sigma_px) {
  const int reach = std::max(1, static_cast<int>(std::ceil(4 * sigma_px)));
  std::vector<float> taps(2 * reach + 1);
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (sigma_px * sigma_px));
  for (int i = -reach; i <= reach; ++i)
    taps[i + reach] = static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px)) / sum);
  return taps;
}

/// Rows, then columns; the source is larger than the result by the taps' reach on each side.
void convolve(const std::vector<float>& source, int columns, int rows, const std::vector<float>& taps,
              std::vector<float>& out) {
  const int reach = static_cast<int>(taps.size()) / 2, wide = columns + 2 * reach, high = rows + 2 * reach;
  std::vector<float> passed(std::size_t(columns) * high, 0.0f);
  for (int j = 0; j < high; ++j) {
    float* to = &passed[std::size_t(j) * columns];
    for (std::size_t t = 0; t < taps.size(); ++t) {
      const float* from = &source[std::size_t(j) * wide + t];
      for (int i = 0; i < columns; ++i) to[i] += taps[t] * from[i];
    }
  }
  out.assign(std::size_t(columns) * rows, 0.0f);
  for (int j = 0; j < rows; ++j) {
    float* to = &out[std::size_t(j) * columns];
    for (std::size_t t = 0; t < taps.size(); ++t) {
      const float* from = &passed[(j + t) * columns];
      for (int i = 0; i < columns; ++i) to[i] += taps[t] * from[i];
    }
  }
}

}  // namespace

void blur(SliceImage& image, double sigma_px) {
  if (sigma_px < 0.05) return;
  const std::vector<float> taps = gaussian_taps(sigma_px);
  const int reach = static_cast<int>(taps.size()) / 2, wide = image.columns + 2 * reach, high = image.rows + 2 * reach;
  std::vector<float> padded(std::size_t(wide) * high);
  for (int j = 0; j < high; ++j)
    for (int i = 0; i < wide; ++i)
      padded[std::size_t(j) * wide + i] =
          image.at(std::clamp(i - reach, 0, image.columns - 1), std::clamp(j - reach, 0, image.rows - 1));
  convolve(padded, image.columns, image.rows, taps, image.hu);
}

void add_cupping(SliceImage& image, const SlicePose& pose, double pixel_mm, double depth_hu) {
  for (int j = 0; j < image.rows; ++j)
    for (int i = 0; i < image.columns; ++i) {
      const Vec3 p = pose.origin_mm + pose.row * (i * pixel_mm) + pose.column * (j * pixel_mm);
      const double x = p.x / 75, y = (p.y + 3) / 95, r = x * x + y * y;
      if (r >= 1) continue;
      const double density = std::clamp((image.at(i, j) + 1000) / 1000.0, 0.0, 1.0);
      image.at(i, j) -= static_cast<float>(depth_hu * (1 - r) * density);
    }
}

void add_streaks(SliceImage& image, const SlicePose& pose, double pixel_mm, Vec3 metal, double height_hu,
                 std::uint64_t seed) {
  const Vec3 d = metal - pose.origin_mm, normal = cross(pose.row, pose.column);
  const double depth = dot(d, normal);
  if (std::fabs(depth) > 5) return;
  const double strength = height_hu * std::exp(-depth * depth / 8);
  const double ci = dot(d, pose.row), cj = dot(d, pose.column);
  constexpr int rays = 11;
  double angle[rays], width[rays], sign[rays];
  for (int r = 0; r < rays; ++r) {
    angle[r] = pi * uniform(seed, 20, r);
    width[r] = 0.035 + 0.02 * uniform(seed, 21, r);
    sign[r] = r % 2 ? -1 : 1;
  }
  for (int j = 0; j < image.rows; ++j)
    for (int i = 0; i < image.columns; ++i) {
      const double x = i * pixel_mm - ci, y = j * pixel_mm - cj, r = std::sqrt(x * x + y * y);
      if (r < 2) continue;
      double sum = 0;
      for (int k = 0; k < rays; ++k) {
        const double off = (x * std::sin(angle[k]) - y * std::cos(angle[k])) / r / width[k];
        if (std::fabs(off) < 4) sum += sign[k] * std::exp(-0.5 * off * off);
      }
      image.at(i, j) += static_cast<float>(strength * sum / (1 + r / 25));
    }
}

void add_dark_band(SliceImage& image, const SlicePose& pose, double pixel_mm, Vec3 from_mm, Vec3 to_mm,
                   double depth_hu) {
  const Vec3 normal = normalized(cross(pose.row, pose.column)), way = to_mm - from_mm, u = normalized(way);
  const double length = norm(way);
  for (int j = 0; j < image.rows; ++j)
    for (int i = 0; i < image.columns; ++i) {
      const Vec3 d = pose.origin_mm + pose.row * (i * pixel_mm) + pose.column * (j * pixel_mm) - from_mm;
      const double along = dot(d, u);
      const Vec3 across = d - u * along;
      const double depth = dot(across, normal), aside = norm(across - normal * depth);
      const double beyond = std::max({0.0, -along, along - length});
      if (std::fabs(depth) > 6 || aside > 18 || beyond > 120) continue;
      image.at(i, j) -= static_cast<float>(depth_hu * std::exp(-depth * depth / 12 - aside * aside / 40 - beyond / 35));
    }
}

void add_noise(SliceImage& image, double sigma_px, double noise_hu, std::uint64_t seed, std::uint64_t slice) {
  if (noise_hu <= 0) return;
  const bool correlated = sigma_px >= 0.05;
  const std::vector<float> taps = correlated ? gaussian_taps(sigma_px) : std::vector<float>{0, 1, 0};
  const int reach = static_cast<int>(taps.size()) / 2;
  const std::size_t count = std::size_t(image.columns + 2 * reach) * (image.rows + 2 * reach);
  std::vector<float> white(count + 1), noise;
  for (std::size_t i = 0; i < count; i += 2) normal_pair(seed, 1000 + slice, i, white[i], white[i + 1]);
  convolve(white, image.columns, image.rows, taps, noise);
  double power = 0;
  for (float t : taps) power += static_cast<double>(t) * t;
  const float scale = static_cast<float>(noise_hu / power);
  for (std::size_t i = 0; i < noise.size(); ++i) image.hu[i] += scale * noise[i];
}

void sharpen(SliceImage& image, double sigma_px, double ratio) {
  if (ratio <= 0) return;
  SliceImage wide = image;
  blur(wide, std::sqrt(3.0) * std::max(sigma_px, 0.3));  // together with the blur by sigma_px, twice as wide
  for (std::size_t i = 0; i < image.hu.size(); ++i)
    image.hu[i] += static_cast<float>(ratio) * (image.hu[i] - wide.hu[i]);
}

void add_shared_noise(SliceImage& image, double first_sigma_px, double sigma_px, double ratio, double noise_hu,
                      double slices_in_one, std::uint64_t seed, int slice) {
  if (noise_hu <= 0) return;
  double power = 1;  // of the first kernel's taps along one axis
  if (first_sigma_px >= 0.05) {
    power = 0;
    for (float t : gaussian_taps(first_sigma_px)) power += static_cast<double>(t) * t;
  }
  const double reach = 0.5 * std::max(1.0, slices_in_one) - 0.5;
  const int steps = static_cast<int>(std::ceil(reach - 1e-9));
  std::vector<double> share;
  double sum = 0;
  for (int s = -steps; s <= steps; ++s) {
    share.push_back(std::clamp(reach + 1 - std::abs(s), 0.0, 1.0));
    sum += share.back() * share.back();
  }
  SliceImage noise(image.columns, image.rows, 0);
  std::vector<float> white(noise.hu.size() + 1);
  for (int s = -steps; s <= steps; ++s) {
    const auto weight = static_cast<float>(noise_hu / power * share[s + steps] / std::sqrt(sum));
    const auto stream = static_cast<std::uint64_t>(1000000 + slice + s);
    for (std::size_t i = 0; i < noise.hu.size(); i += 2) normal_pair(seed, stream, i, white[i], white[i + 1]);
    for (std::size_t i = 0; i < noise.hu.size(); ++i) noise.hu[i] += weight * white[i];
  }
  blur(noise, sigma_px);
  sharpen(noise, sigma_px, ratio);
  for (std::size_t i = 0; i < noise.hu.size(); ++i) image.hu[i] += noise.hu[i];
}

void quantize(const SliceImage& image, bool round_field, std::int16_t* out) {
  const double ci = 0.5 * (image.columns - 1), cj = 0.5 * (image.rows - 1),
               radius = 0.5 * std::min(image.columns, image.rows);
  for (int j = 0; j < image.rows; ++j)
    for (int i = 0; i < image.columns; ++i) {
      const std::size_t n = std::size_t(j) * image.columns + i;
      const bool outside = (i - ci) * (i - ci) + (j - cj) * (j - cj) > radius * radius;
      out[n] = round_field && outside
                   ? padding_hu
                   : static_cast<std::int16_t>(std::lround(std::clamp(image.hu[n], -1024.0f, 3071.0f)));
    }
}

}  // namespace trephine::phantom
