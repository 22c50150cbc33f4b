// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/head_doubts.h"

#include <fmt/format.h>

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

std::vector<std::string> ventricle_doubts(const grid::Field& ventricles, const VentricleAxes& axes,
                                          const HeadLandmarks* landmarks, const HeadFigures& figures,
                                          const HeadClassParams& params, Report& report, bool& horns_whole) {
  std::vector<std::string> out;
  const auto outside = [&](const char* what, const std::optional<double>& v, double low, double high, int digits) {
    if (v && !(*v >= low && *v <= high))
      out.push_back(
          fmt::format("{} is {:.{}f}, {:.{}f} to {:.{}f} are plausible", what, *v, digits, low, digits, high, digits));
  };
  const int pieces = pieces_of(ventricles);
  report.add("ventricle_pieces_count", pieces);
  if (pieces > params.most_pieces_count)
    out.push_back(
        fmt::format("the ventricles are in {} pieces, at most {:.0f} are plausible", pieces, params.most_pieces_count));
  const Sides sides = sides_of(ventricles, axes);
  const double larger = std::max(sides.ml[0], sides.ml[1]);
  const double ratio = larger > 0 ? std::min(sides.ml[0], sides.ml[1]) / larger : 1;
  report.add("ventricle_sides_ratio", ratio);
  if (ratio < params.least_sides_ratio)
    out.push_back(fmt::format("the {} half of the ventricles holds {:.1f} ml, the other one {:.1f}",
                              sides.ml[0] < sides.ml[1] ? "left" : "right", std::min(sides.ml[0], sides.ml[1]),
                              larger));
  horns_whole = true;
  for (int side = 0; side < 2; ++side) {
    const char* name = side == 0 ? "left" : "right";
    const double area = sides.horn_mm2(side), length = sides.horn_length_mm(side);
    report.add(side == 0 ? "horn_left_mm2" : "horn_right_mm2", area);
    const bool missing = length < min_horn_length_mm;
    const double min_mm2 = std::max(params.least_horn_mm2, params.least_horns_ratio * sides.horn_mm2(1 - side));
    if (!missing && area >= min_mm2) continue;
    horns_whole = false;
    out.push_back(missing ? fmt::format("the {} frontal horn is missing", name)
                          : fmt::format("the {} frontal horn is a thread of {:.0f} mm2, at least {:.0f} are plausible",
                                        name, area, min_mm2));
  }
  for (int side = 0; side < 2; ++side)
    if (sides.behind_mm(side) < min_behind_ratio * sides.behind_mm(1 - side))
      out.push_back(fmt::format("the {} lateral ventricle ends {:.0f} mm behind the foramina, the other one {:.0f} mm",
                                side == 0 ? "left" : "right", sides.behind_mm(side), sides.behind_mm(1 - side)));
  bool looked_for = false, seen = false;
  if (landmarks)
    for (const cases::CaseLandmark& l : landmarks->landmarks) {
      looked_for = looked_for || l.source == "found";
      seen = seen || (l.name.rfind("monro", 0) == 0 && l.confidence >= 0.5);
    }
  if (looked_for && !seen) out.push_back("no foramen of Monro was found: the third ventricle may be missing");
  outside("the ventricles' volume (ml)", figures.ventricles_ml, params.least_ventricles_ml, params.most_ventricles_ml,
          1);
  outside("Evans' index", figures.evans_index_ratio, params.least_evans_ratio, params.most_evans_ratio, 2);
  outside("the midline shift (mm)", figures.midline_shift_mm, -params.most_shift_mm, params.most_shift_mm, 1);
  return out;
}

std::string scan_doubt(const mask::ScanFigures& scan, const HeadClassParams& params) {
  if (!scan.known()) return "";
  if (scan.cube_noise_hu < params.least_cube_noise_hu)
    return fmt::format(
        "the scan's noise in a cube of 2 mm is {:.1f} HU, below {:.1f} it was denoised so strongly that narrow horns "
        "may "
        "be gone",
        scan.cube_noise_hu, params.least_cube_noise_hu);
  if (scan.cube_noise_hu > params.most_cube_noise_hu || scan.noise_hu > params.most_noise_hu)
    return fmt::format(
        "the scan's noise is {:.0f} HU a voxel and {:.0f} HU in a cube of 2 mm, above {:.0f} or {:.0f} narrow horns "
        "cannot be seen",
        scan.noise_hu, scan.cube_noise_hu, params.most_noise_hu, params.most_cube_noise_hu);
  return "";
}

std::string close_call(const HeadFigures& f, const mask::ScanFigures& scan, const HeadClassParams& p) {
  const mask::ScanVerdict verdict = mask::judge_scan(scan, {});
  if (verdict.ventricles != mask::Suitability::doubtful && verdict.ventricles != mask::Suitability::unsuited) return "";
  std::string why;
  for (const std::string& reason : verdict.reasons)
    if (why.empty() && reason.find("ventricles") != std::string::npos) why = reason.substr(0, reason.find(';'));
  if (verdict.ventricles == mask::Suitability::unsuited) return "the scan is " + why;
  std::string near;
  if (f.midline_shift_mm && std::abs(std::abs(*f.midline_shift_mm) - p.shifted_mm) < p.doubtful_shift_mm)
    near =
        fmt::format("a midline shift of {:.1f} mm is near to the limit of {:.1f}", *f.midline_shift_mm, p.shifted_mm);
  else if (f.midline_shift_mm && std::abs(*f.midline_shift_mm) > p.shifted_mm)
    return "";
  else if (f.evans_index_ratio && std::abs(*f.evans_index_ratio - p.hydrocephalic_evans_ratio) < p.doubtful_evans_ratio)
    near = fmt::format("Evans' index of {:.2f} is near to the limit of {:.2f}", *f.evans_index_ratio,
                       p.hydrocephalic_evans_ratio);
  else if (f.evans_index_ratio && *f.evans_index_ratio <= p.small_evans_ratio + p.doubtful_evans_ratio && f.brain_ml &&
           f.ventricles_ml) {
    const double limit_ml = p.small_ventricles_ratio * *f.brain_ml;
    if (std::abs(*f.ventricles_ml - limit_ml) < p.doubtful_share_ratio * limit_ml)
      near = fmt::format("ventricles of {:.1f} ml are near to the limit of {:.1f}", *f.ventricles_ml, limit_ml);
  }
  return near.empty() ? "" : near + ", and the scan is " + why;
}

}  // namespace trephine::head
