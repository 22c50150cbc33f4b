// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/head_doubts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mask/bits.h"
#include "mask/filters.h"
#include "mask/scan_verdict.h"

namespace trephine::head {

const char* to_text(HeadClass c) {
  switch (c) {
    case HeadClass::normal:
      return "normal";
    case HeadClass::hydrocephalic:
      return "hydrocephalic";
    case HeadClass::shifted:
      return "shifted";
    case HeadClass::small:
      return "small";
    case HeadClass::uncertain:
      return "uncertain";
    case HeadClass::unknown:
      break;
  }
  return "unknown";
}

namespace {

constexpr double min_piece_ml = 0.1, slab_mm = 2, behind_horn_mm = 4, min_horn_length_mm = 6,
                 min_behind_ratio = 0.6;  ///< the third ventricle alone reaches 20 to 25 of 45 to 75 mm

/// The voxels of the ventricles told apart by side, those of the frontal horns by coronal slab too.
struct Sides {
  double ml[2] = {0, 0};              ///< left, right
  std::map<int, double> slab_mm2[2];  ///< of the frontal horn
  std::set<int> behind[2];            ///< slabs behind the foramina: body, trigone and occipital horn
  float horn_mm2(int side) const {
    std::vector<float> areas;
    for (const auto& s : slab_mm2[side]) areas.push_back(float(s.second));
    return mask::median(areas, 0);
  }
  double behind_mm(int side) const { return slab_mm * double(behind[side].size()); }
  double horn_length_mm(int side) const { return slab_mm * double(slab_mm2[side].size()); }
};

Sides sides_of(const grid::Field& f, const VentricleAxes& axes) {
  Sides s;
  const double voxel_mm3 = f.voxel_volume_mm3();
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        if (!(f.at(i, j, k) > 0)) continue;
        const Vec3 p = f.to_world_mm({double(i), double(j), double(k)}) - axes.origin_mm;
        const int side = dot(p, axes.left) >= axes.middle_mm ? 0 : 1;
        const double ahead_mm = axes.monro_mm - dot(p, axes.back);
        s.ml[side] += voxel_mm3 / 1000;
        if (ahead_mm < 0) s.behind[side].insert(int(-ahead_mm / slab_mm));
        if (ahead_mm > behind_horn_mm) s.slab_mm2[side][int(ahead_mm / slab_mm)] += voxel_mm3 / slab_mm;
      }
  return s;
}

int pieces_of(const grid::Field& f) {
  int pieces = 0;
  for (const mask::Component& c : mask::components(mask::positive(f, f)).list)
    pieces += double(c.voxels) * f.voxel_volume_mm3() / 1000 >= min_piece_ml;
  return pieces;
}

}  // namespace

VentricleDoubts ventricle_doubts(const grid::Field& ventricles, const VentricleAxes& axes,
                                 const HeadLandmarks* landmarks, const HeadFigures& figures,
                                 const HeadClassParams& params) {
  VentricleDoubts out;
  const auto outside = [&](const char* id, const std::string& what, const std::optional<double>& v, double low,
                           double high, const std::string& digits) {
    if (!v || (*v >= low && *v <= high)) return;
    out.doubts.push_back(
        {id,
         what + " is {value:." + digits + "f}, {low:." + digits + "f} to {high:." + digits + "f} are plausible",
         {{"value", *v}, {"low", low}, {"high", high}}});
  };
  out.pieces_count = pieces_of(ventricles);
  if (out.pieces_count > params.most_pieces_count)
    out.doubts.push_back(
        {"many_pieces",
         "the ventricles are in {pieces_count} pieces, at most {most_count:.0f} are plausible",
         {{"pieces_count", std::int64_t{out.pieces_count}}, {"most_count", params.most_pieces_count}}});
  const Sides sides = sides_of(ventricles, axes);
  const double larger = std::max(sides.ml[0], sides.ml[1]), smaller = std::min(sides.ml[0], sides.ml[1]);
  const auto name_of = [](int side) { return side == 0 ? "left" : "right"; };
  out.sides_ratio = larger > 0 ? smaller / larger : 1;
  if (out.sides_ratio < params.least_sides_ratio)
    out.doubts.push_back(
        {"unequal_sides",
         "the {side} half of the ventricles holds {smaller_ml:.1f} ml, the other one {larger_ml:.1f}",
         {{"side", name_of(sides.ml[0] < sides.ml[1] ? 0 : 1)}, {"smaller_ml", smaller}, {"larger_ml", larger}}});
  for (int side = 0; side < 2; ++side) {
    const double area = sides.horn_mm2(side), length = sides.horn_length_mm(side);
    out.horn_mm2[side] = area;
    const bool missing = length < min_horn_length_mm;
    const double min_mm2 = std::max(params.least_horn_mm2, params.least_horns_ratio * sides.horn_mm2(1 - side));
    if (!missing && area >= min_mm2) continue;
    out.horns_whole = false;
    if (missing)
      out.doubts.push_back({"no_frontal_horn", "the {side} frontal horn is missing", {{"side", name_of(side)}}});
    else
      out.doubts.push_back(
          {"thin_frontal_horn",
           "the {side} frontal horn is a thread of {area_mm2:.0f} mm2, at least {least_mm2:.0f} are plausible",
           {{"side", name_of(side)}, {"area_mm2", area}, {"least_mm2", min_mm2}}});
  }
  for (int side = 0; side < 2; ++side)
    if (sides.behind_mm(side) < min_behind_ratio * sides.behind_mm(1 - side))
      out.doubts.push_back(
          {"short_ventricle",
           "the {side} lateral ventricle ends {mm:.0f} mm behind the foramina, the other one {other_mm:.0f} mm",
           {{"side", name_of(side)}, {"mm", sides.behind_mm(side)}, {"other_mm", sides.behind_mm(1 - side)}}});
  bool looked_for = false, seen = false;
  if (landmarks)
    for (const cases::CaseLandmark& l : landmarks->landmarks) {
      looked_for = looked_for || l.source == "found";
      seen = seen || (l.name.rfind("monro", 0) == 0 && l.confidence >= 0.5);
    }
  if (looked_for && !seen)
    out.doubts.push_back({"no_foramen",
                          "no foramen of Monro was found: the third ventricle may be missing, or give monro_left and "
                          "monro_right where they are seen",
                          {}});
  outside("implausible_ventricles_volume", "the ventricles' volume (ml)", figures.ventricles_ml,
          params.least_ventricles_ml, params.most_ventricles_ml, "1");
  outside("implausible_evans_index", "Evans' index", figures.evans_index_ratio, params.least_evans_ratio,
          params.most_evans_ratio, "2");
  outside("implausible_shift", "the midline shift (mm)", figures.midline_shift_mm, -params.most_shift_mm,
          params.most_shift_mm, "1");
  return out;
}

std::optional<Warning> scan_doubt(const mask::ScanFigures& scan, const HeadClassParams& params) {
  if (!scan.known()) return {};
  if (scan.cube_noise_hu < params.least_cube_noise_hu)
    return Warning{"denoised_horns",
                   "the scan's noise in a cube of 2 mm is {noise_hu:.1f} HU, below {limit_hu:.1f} it was denoised so "
                   "strongly that narrow horns may be gone",
                   {{"noise_hu", scan.cube_noise_hu}, {"limit_hu", params.least_cube_noise_hu}}};
  if (scan.cube_noise_hu > params.most_cube_noise_hu || scan.noise_hu > params.most_noise_hu)
    return Warning{"noisy",
                   "the scan's noise is {noise_hu:.0f} HU a voxel and {cube_noise_hu:.0f} HU in a cube of 2 mm, above "
                   "{limit_hu:.0f} or {cube_limit_hu:.0f} narrow horns cannot be seen",
                   {{"noise_hu", scan.noise_hu},
                    {"cube_noise_hu", scan.cube_noise_hu},
                    {"limit_hu", params.most_noise_hu},
                    {"cube_limit_hu", params.most_cube_noise_hu}}};
  return {};
}

std::optional<Warning> close_call(const HeadFigures& f, const mask::ScanFigures& scan, const HeadClassParams& p) {
  const mask::ScanVerdict verdict = mask::judge_scan(scan, {});
  if (verdict.ventricles != mask::Suitability::doubtful && verdict.ventricles != mask::Suitability::unsuited) return {};
  const auto reason = std::find_if(verdict.reasons.begin(), verdict.reasons.end(),
                                   [](const mask::ScanReason& r) { return r.concerns("ventricles"); });
  const std::string why = reason == verdict.reasons.end() ? "" : reason->verdict();
  if (verdict.ventricles == mask::Suitability::unsuited)
    return Warning{"unsuited_scan", "the scan is {why}", {{"why", why}}};
  const auto near = [&](const char* id, const char* form, double value, double limit) {
    return Warning{
        id, std::string(form) + ", and the scan is {why}", {{"value", value}, {"limit", limit}, {"why", why}}};
  };
  if (f.midline_shift_mm && std::abs(std::abs(*f.midline_shift_mm) - p.shifted_mm) < p.doubtful_shift_mm)
    return near("shift_near_limit", "a midline shift of {value:.1f} mm is near to the limit of {limit:.1f}",
                *f.midline_shift_mm, p.shifted_mm);
  if (f.midline_shift_mm && std::abs(*f.midline_shift_mm) > p.shifted_mm) return {};
  if (f.evans_index_ratio && std::abs(*f.evans_index_ratio - p.hydrocephalic_evans_ratio) < p.doubtful_evans_ratio)
    return near("evans_near_limit", "Evans' index of {value:.2f} is near to the limit of {limit:.2f}",
                *f.evans_index_ratio, p.hydrocephalic_evans_ratio);
  if (f.evans_index_ratio && *f.evans_index_ratio <= p.small_evans_ratio + p.doubtful_evans_ratio && f.brain_ml &&
      f.ventricles_ml) {
    const double limit_ml = p.small_ventricles_ratio * *f.brain_ml;
    if (std::abs(*f.ventricles_ml - limit_ml) < p.doubtful_share_ratio * limit_ml)
      return near("volume_near_limit", "ventricles of {value:.1f} ml are near to the limit of {limit:.1f}",
                  *f.ventricles_ml, limit_ml);
  }
  return {};
}

}  // namespace trephine::head
