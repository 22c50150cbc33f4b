// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/landmarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "head/landmarks_parts.h"
#include "head/symmetry.h"
#include "mask/hu_view.h"

namespace trephine {
namespace {

using namespace segmentation;

constexpr double tangent_mm = 5, middle_depth_mm = 70, tragi_to_nasion_deg = 20;
constexpr double least_lopsided_mm = 3.5,
                 most_lopsided_mm = 10;    ///< distance of one tragus from the other's mirror image
constexpr double least_confidence = 0.05;  ///< a landmark below this is left out
constexpr double least_symmetry = 0.15;    ///< below this the plane is not that of a head
const char* const how_to_give =
    "give nasion, inion, tragus_left and tragus_right (landmarks: {nasion: [x, y, z], ...}, mm, LPS; or a .mrk.json "
    "or .fcsv of 3D Slicer)";

class Finder {
 public:
  Finder(const HuVolume& volume, const LandmarkInputs& in, const LandmarkParams& params, Report& report)
      : lattice_(lattice_of(volume)), in_(in), params_(params), report_(report) {
    const auto check = [&](const Field* f, const char* name) {
      if (f) with_field(name, [&] { place_in(*f, lattice_); });
    };
    if (!in.skin) throw Error(ExitCode::usage, "", "skin", "is needed");
    if (!in.skull) throw Error(ExitCode::usage, "", "skull", "is needed");
    check(in.skin, "skin");
    check(in.skull, "skull");
    check(in.brain, "brain");
    check(in.ventricles, "ventricles");
    check_given(in.given, *in.skin, in.ventricles, report);
    check_varies(volume);
    out_.landmarks = in.given;
  }

  HeadLandmarks run(const Progress& progress) {
    const FieldView skin(*in_.skin, lattice_), skull(*in_.skull, lattice_);
    const bool by_points = plane_from_given();
    if (!by_points) plane_by_symmetry(skin, skull, progress.part(0, 0.7));
    progress.report(0.7);
    check_sides(in_.given, out_.midsagittal);
    set_frame(skull);
    const auto nasion = find_nasion(skin, skull, head_);
    if (const CaseLandmark* given = out_.find("nasion"))
      doubt_given(*given, nasion, report_);
    else
      add("nasion", nasion, "found", "no hollow between brow and nose");
    level_roughly();
    for (const int side : {1, -1}) {
      progress.check();
      const char* name = side > 0 ? "tragus_left" : "tragus_right";
      if (!out_.find(name)) add(name, find_tragus(skin, head_, side), "found", "no ear with its concha");
    }
    doubt_lopsided_tragi();
    progress.report(0.8);
    level_frame();
    if (!out_.find("vertex")) {
      auto vertex = find_vertex(skin, head_);
      if (vertex && !levelled_) vertex->confidence *= 0.5;
      add("vertex", vertex, "found", "the scan ends below it");
    }
    if (!out_.find("inion")) {
      auto inion = find_inion(skin, skull, head_, inion_levels());
      if (inion && !levelled_) inion->confidence *= 0.5;
      add("inion", inion, "found", "no protuberance of the bone there");
    }
    progress.report(0.85);
    measure_arcs(skin);
    if (in_.ventricles) {
      const auto monro = find_monro(FieldView(*in_.ventricles, lattice_), head_);
      for (int s = 0; s < 2; ++s) {
        const char* name = s == 0 ? "monro_left" : "monro_right";
        if (!out_.find(name))
          add(name, monro[s], "found", "no third ventricle below the lateral ones, or no way between them");
      }
    }
    tell();
    return std::move(out_);
  }

 private:
  const Vec3* given(const char* name) const {
    for (const CaseLandmark& l : in_.given)
      if (l.name == name) return &l.position_mm;
    return nullptr;
  }
  const Vec3* known(const char* name, double least = 0.3) const {
    const CaseLandmark* l = out_.find(name);
    return l && l->confidence >= least ? &l->position_mm : nullptr;
  }
  double confidence_of(const char* name) const {
    const CaseLandmark* l = out_.find(name);
    return l ? l->confidence : 0;
  }

  void add(const char* name, std::optional<FoundPoint> found, const char* source, const char* otherwise) {
    if (found) found->confidence *= out_.midsagittal.confidence;
    if (found && found->confidence >= least_confidence && lies_in_scan(found->position_mm))
      out_.landmarks.push_back({name, found->position_mm, found->confidence, source});
    else
      report_.warn(fmt::format("{} not found: {}", name, found ? "too near the scan's edge, or doubtful" : otherwise));
  }
  bool lies_in_scan(Vec3 p) const { return FieldView(*in_.skin, lattice_).depth_in_scan_mm(p) >= 0; }

  /// As place_burr_hole defines it: through nasion and inion (or vertex), perpendicular to the line between the tragi.
  bool plane_from_given() {
    const Vec3 *nasion = given("nasion"), *inion = given("inion"), *vertex = given("vertex");
    const Vec3 *left = given("tragus_left"), *right = given("tragus_right");
    const Vec3* other = inion ? inion : vertex;
    if (!nasion || !other) return false;
    const Vec3 along = normalized(*other - *nasion);
    Vec3 across;
    if (left && right)
      across = *left - *right;
    else if (inion && vertex)
      across = cross(along, *vertex - *nasion);
    else
      return false;
    const double before = norm(across);
    if (left && right && before < 60)
      throw Error(ExitCode::bad_input, "", "tragus_left, tragus_right",
                  fmt::format("are {:.0f} mm apart, of a head at least 60", before));
    across = across - along * dot(across, along);
    if (!(norm(*other - *nasion) > 50) || !(norm(across) > 0.1 * before) || !(before > 0.02))
      throw Error(ExitCode::bad_input, "", "landmarks", "nasion, inion and tragi as given span no head");
    across = normalized(across);
    if (across.x < 0)
      throw Error(ExitCode::bad_input, "", "tragus_left",
                  "lies to the right of tragus_right (x runs to the patient's left): are they exchanged?");
    out_.midsagittal = {(*nasion + *other) * 0.5, across, 1};
    report_.add("midsagittal_from", "given landmarks");
    return true;
  }

  void plane_by_symmetry(const FieldView& skin, const FieldView& skull, const Progress& progress) {
    const MirrorPlane plane = find_mirror_plane(skin, skull, progress);
    report_.add("midsagittal_from", "symmetry");
    report_.add("symmetry_residual_mm", plane.residual_mm);
    report_.add("symmetry_midline_residual_mm", plane.midline_mm);
    report_.add("symmetry_matched_ratio", plane.matched);
    report_.add("symmetry_sharpness_mm", plane.rise_mm);
    if (plane.confidence < least_symmetry)
      throw Error(
          ExitCode::quality, "", "midsagittal",
          fmt::format("no symmetric skull was found (residual {:.1f} mm of at most 4, {:.0f} % match of at least "
                      "50, sharpness {:.2f} mm of at least 0.1): {}",
                      plane.residual_mm, 100 * plane.matched, plane.rise_mm, how_to_give));
    out_.midsagittal = {plane.point_mm, plane.normal, plane.confidence};
  }

  /// Axes in the plane, the superior one nearest to the scan's; the origin is the centre of the skull's bones.
  void set_frame(const FieldView& skull) {
    const MidsagittalPlane& p = out_.midsagittal;
    head_.left = p.normal;
    head_.back = normalized(Vec3{0, 1, 0} - p.normal * p.normal.y);
    head_.up = cross(head_.left, head_.back);
    Vec3 sum;
    std::size_t count = 0;
    const Field& f = skull.field();
    for (int k = 0; k < f.size[2]; k += 3)
      for (int j = 0; j < f.size[1]; j += 4)
        for (int i = 0; i < f.size[0]; i += 4)
          if (f.at(i, j, k) > 0) sum += f.to_world_mm({double(i), double(j), double(k)}), ++count;
    if (!count) throw Error(ExitCode::quality, "", "skull", std::string("is empty: ") + how_to_give);
    const Vec3 middle = sum / double(count);
    head_.origin_mm = middle - head_.left * dot(middle - p.point_mm, head_.left);
  }

  /// The ears are searched for with the nasion level with the skull's centre, or up to 20 degrees above it (the centre
  /// is too low where the vertex was not scanned). In a head that is tilted further forwards, the hollow of the cheek
  /// looks like a concha.
  void level_roughly() {
    const Vec3* nasion = known("nasion", 0.5);
    if (!nasion) return;
    const Vec3 way = *nasion - head_.origin_mm;
    const double degree = std::acos(-1.0) / 180, angle = std::atan2(dot(way, head_.up), -dot(way, head_.back));
    const double turn = angle - std::clamp(angle, 0.0, 20 * degree);
    if (std::abs(turn) > 40 * degree) return;
    head_.back = head_.back * std::cos(turn) - head_.up * std::sin(turn);
    head_.up = cross(head_.left, head_.back);
  }

  /// The ears of a head differ less than a wrong rim is off, but which of the two is wrong is not known.
  void doubt_lopsided_tragi() {
    CaseLandmark* tragi[2] = {nullptr, nullptr};
    for (CaseLandmark& l : out_.landmarks)
      if (l.name == "tragus_left" || l.name == "tragus_right") tragi[l.name == "tragus_left" ? 0 : 1] = &l;
    if (!tragi[0] || !tragi[1]) return;
    const MidsagittalPlane& p = out_.midsagittal;
    const Vec3 left = tragi[0]->position_mm;
    const double apart_mm = norm(left - p.normal * (2 * dot(left - p.point_mm, p.normal)) - tragi[1]->position_mm);
    report_.add("tragi_asymmetry_mm", apart_mm);
    for (CaseLandmark* l : tragi)
      if (!given(l->name.c_str())) l->confidence *= ramp(apart_mm, most_lopsided_mm, least_lopsided_mm);
  }

  /// Turns the axes so that the line from the tragi to the nasion rises by 20 degrees towards the front, as it does
  /// where the Frankfurt plane is level.
  void level_frame() {
    const Vec3 *nasion = known("nasion"), *left = known("tragus_left"), *right = known("tragus_right");
    if (!nasion || (!left && !right)) return;
    Vec3 ears = left && right ? (*left + *right) * 0.5 : left ? *left : *right;
    ears = ears - head_.left * dot(ears - head_.origin_mm, head_.left);
    const Vec3 way = normalized(*nasion - ears - head_.left * dot(*nasion - ears, head_.left));
    const double angle = tragi_to_nasion_deg * std::acos(-1.0) / 180;
    // `way` is front * cos + up * sin.
    const Vec3 upwards = cross(way, head_.left);
    const Vec3 front = way * std::cos(angle) - upwards * std::sin(angle);
    if (dot(upwards, head_.up) < 0.7) return;
    head_.back = -front;
    head_.up = cross(head_.left, head_.back);
    ears_level_mm_ = dot(ears - head_.origin_mm, head_.up);
    levelled_ = true;
  }

  std::array<double, 2> inion_levels() const {
    if (levelled_) return {ears_level_mm_ - 22, ears_level_mm_ + 32};
    return {-75, 5};
  }

  void measure_arcs(const FieldView& skin) {
    const Vec3* nasion = known("nasion", least_confidence);
    if (!nasion) {
      report_.warn("bregma and Kocher's points not measured: the nasion is not known");
      return;
    }
    // The sweep's centre lies between nasion and inion, as in place_burr_hole; without an inion it lies in the bones.
    const Vec3* inion = known("inion", least_confidence);
    Vec3 centre = inion ? (*nasion + *inion) * 0.5 : head_.origin_mm;
    centre = centre - head_.left * dot(centre - out_.midsagittal.point_mm, head_.left);
    Vec3 front = *nasion - centre;
    front = normalized(front - head_.left * dot(front, head_.left));
    const Vec3 onwards = cross(front, head_.left);
    const Outline midline = outline(skin, {centre, front, onwards});
    const double base = confidence_of("nasion") * ramp(start_gap(midline, *nasion), 10, 4);
    if (!out_.find("bregma")) arc_point("bregma", skin, midline, params_.bregma_mm, 0.6 * base, "estimated");
    const auto top = point_along(midline, params_.along_mm);
    const auto behind = point_along(midline, params_.along_mm + tangent_mm);
    const auto ahead = point_along(midline, std::max(0.0, params_.along_mm - tangent_mm));
    if (!top || !behind || !ahead || runs_over_edge(skin, midline, *top)) {
      report_.warn("kocher_left and kocher_right not found: the midline's skin ends before, at the scan's edge");
      return;
    }
    const Vec3 outwards = cross(head_.left, normalized(*behind - *ahead));
    for (const int side : {1, -1}) {
      const Vec3 sideways = head_.left * side;
      const Outline lateral = outline(skin, {*top - outwards * middle_depth_mm, outwards, sideways, 5, 120});
      const char* name = side > 0 ? "kocher_left" : "kocher_right";
      if (!out_.find(name)) arc_point(name, skin, lateral, params_.lateral_mm, 0.95 * base, "found");
    }
  }

  static double start_gap(const Outline& curve, Vec3 nasion) {
    return curve.start < curve.points_mm.size() ? norm(curve.points_mm[curve.start] - nasion) : 1e9;
  }
  /// Whether a point between the curve's start and `end` lies where the scan cut the head.
  static bool runs_over_edge(const FieldView& skin, const Outline& curve, Vec3 end) {
    const Vec3 start = curve.points_mm[curve.start];
    const double reach = norm(end - start);
    for (std::size_t i = curve.start; i < curve.points_mm.size(); ++i) {
      if (norm(curve.points_mm[i] - start) > reach + 0.5) break;
      if (skin.depth_in_scan_mm(curve.points_mm[i]) < 0.3) return true;
    }
    return false;
  }
  void arc_point(const char* name, const FieldView& skin, const Outline& curve, double length, double confidence,
                 const char* source) {
    const auto p = point_along(curve, length);
    if (!p || runs_over_edge(skin, curve, *p) || confidence < least_confidence) {
      report_.warn(
          fmt::format("{} not found: the skin ends before, at the scan's edge, or the nasion is doubtful", name));
      return;
    }
    // The confidence includes the plane's already, through the nasion's.
    out_.landmarks.push_back({name, *p, confidence, source});
  }

  void tell() {
    report_.add("midsagittal_confidence", out_.midsagittal.confidence);
    for (const CaseLandmark& l : out_.landmarks) {
      report_.add(l.name + "_mm",
                  fmt::format("[{:.1f}, {:.1f}, {:.1f}]", l.position_mm.x, l.position_mm.y, l.position_mm.z));
      report_.add(l.name + "_confidence", l.confidence);
    }
  }

  const Lattice& lattice_;
  const LandmarkInputs& in_;
  const LandmarkParams& params_;
  Report& report_;
  HeadLandmarks out_;
  HeadFrame head_;
  double ears_level_mm_ = 0;
  bool levelled_ = false;
};

}  // namespace

HeadLandmarks find_landmarks(const HuVolume& volume, const LandmarkInputs& inputs, const LandmarkParams& params,
                             Report& report, const Progress& progress) {
  HeadLandmarks found = Finder(volume, inputs, params, report).run(progress);
  progress.report(1);
  return found;
}

HeadLandmarks merged(const HeadLandmarks& found, const std::vector<CaseLandmark>& given) {
  HeadLandmarks out = found;
  for (const CaseLandmark& g : given) {
    const auto same = std::find_if(out.landmarks.begin(), out.landmarks.end(),
                                   [&](const CaseLandmark& l) { return l.name == g.name; });
    if (same != out.landmarks.end())
      *same = g;
    else
      out.landmarks.push_back(g);
  }
  return out;
}

}  // namespace trephine
