// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/header_frame.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace trephine::dicom {
namespace {

void fault(std::vector<TagFault>& faults, std::uint32_t tag, const std::string& what) { faults.push_back({tag, what}); }

std::optional<std::vector<double>> decimals(std::vector<TagFault>& faults, std::uint32_t tag,
                                            const std::optional<std::string>& raw, std::size_t count) {
  if (!raw) {
    fault(faults, tag, "missing");
    return std::nullopt;
  }
  auto v = parse_decimals(*raw);
  if (!v) {
    fault(faults, tag, trimmed(*raw).empty() ? "empty" : "not a number");
    return std::nullopt;
  }
  if (v->size() != count) {
    fault(faults, tag, fmt::format("{} values, must be {}", v->size(), count));
    return std::nullopt;
  }
  return v;
}

std::optional<std::array<Vec3, 2>> orthonormal(const std::vector<double>& v, std::vector<TagFault>& faults) {
  constexpr double tolerance = 2e-3;  // three decimals in the file
  Vec3 a{v[0], v[1], v[2]}, b{v[3], v[4], v[5]};
  if (!(std::abs(norm(a) - 1) <= tolerance && std::abs(norm(b) - 1) <= tolerance)) {
    fault(faults, t_orientation, "its directions are not of unit length");
    return std::nullopt;
  }
  a = normalized(a);
  b = normalized(b);
  const double c = dot(a, b);
  if (!(std::abs(c) <= tolerance)) {
    fault(faults, t_orientation, "its directions are not orthogonal");
    return std::nullopt;
  }
  // Both axes share the deviation from the right angle. The last step removes the remaining error of second order.
  const Vec3 u = normalized(a - b * (c / 2));
  b = b - a * (c / 2);
  const Vec3 w = normalized(b - u * dot(u, b));
  const auto positive_zero = [](Vec3 d) { return Vec3{d.x + 0.0, d.y + 0.0, d.z + 0.0}; };
  return std::array<Vec3, 2>{positive_zero(u), positive_zero(w)};
}

}  // namespace

Frame frame_of(const RawFrame& raw, bool ct, std::vector<TagFault>& faults) {
  Frame f;
  if (const auto v = decimals(faults, t_orientation, raw.orientation, 6)) f.orientation = orthonormal(*v, faults);
  if (const auto v = decimals(faults, t_position, raw.position, 3)) {
    f.position_mm = Vec3{(*v)[0], (*v)[1], (*v)[2]};
    for (double c : *v)
      if (!(std::abs(c) <= 1e5)) fault(faults, t_position, "beyond 100 m");
  }
  if (const auto v = decimals(faults, t_spacing, raw.spacing, 2)) {
    f.spacing_mm = {(*v)[1], (*v)[0]};  // the tag gives the step between rows first
    for (double s : *v)
      if (!(s >= 0.005 && s <= 50)) {
        fault(faults, t_spacing, fmt::format("{}, must be 0.005 to 50 mm", s));
        break;
      }
  }
  if (ct || raw.slope) {
    if (const auto v = decimals(faults, t_slope, raw.slope, 1)) {
      f.slope = v->front();
      if (!(std::abs(*f.slope) >= 1e-6 && std::abs(*f.slope) <= 1e4))
        fault(faults, t_slope, fmt::format("{}, must be 1e-6 to 1e4 in size", *f.slope));
    }
  }
  if (ct || raw.intercept) {
    if (const auto v = decimals(faults, t_intercept, raw.intercept, 1)) {
      f.intercept = v->front();
      if (!(std::abs(*f.intercept) <= 1e6))
        fault(faults, t_intercept, fmt::format("{}, must be within +-1e6", *f.intercept));
    }
  }
  if (raw.thickness)
    if (const auto v = parse_decimals(*raw.thickness); v && v->size() == 1 && v->front() > 0)
      f.thickness_mm = v->front();
  return f;
}

}  // namespace trephine::dicom
