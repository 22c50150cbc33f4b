// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/landmarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/pi.h"
#include "base/refusal.h"
#include "craniometry/coronal_suture.h"
#include "craniometry/plausible.h"
#include "craniometry/symmetry.h"
#include "head/landmarks_parts.h"
#include "mask/filters.h"
#include "mask/hu_view.h"

namespace trephine::head {
namespace {

constexpr double tangent_mm = 5, middle_depth_mm = 70, tragi_to_nasion_deg = 20;
constexpr double min_lopsided_mm = 3.5, max_lopsided_mm = 10;  ///< distance of one tragus from the other's mirror image
constexpr double min_symmetry = 0.15;                          ///< below this the plane is not that of a head
constexpr double min_leap_mm = 2, max_leap_mm = 5;             ///< of the midline's skin between neighbouring points
constexpr double max_estimates_apart_mm = 10, of_an_estimate = 0.45;
constexpr double max_covered_ratio = 0.3;
constexpr double min_near_midline_ratio = 0.2, of_a_fused_suture = 0.45;

class Finder {
 public:
  Finder(const grid::HuVolume& volume, const LandmarkInputs& in, const LandmarkParams& params)
      : volume_(volume), lattice_(grid::lattice_of(volume)), in_(in), params_(params) {
    const auto check = [&](const grid::Field* f, const char* name) {
      if (f) with_field(name, [&] { grid::place_in(*f, lattice_); });
    };
    if (!in.skin) throw Error(ExitCode::usage, "", "skin", "is needed");
    if (!in.skull) throw Error(ExitCode::usage, "", "skull", "is needed");
    check(in.skin, "skin");
    check(in.skull, "skull");
    check(in.brain, "brain");
    check(in.ventricles, "ventricles");
    warnings_ = check_given(in.given, *in.skin, *in.skull, in.ventricles);
    mask::check_varies(volume);
    out_.landmarks = in.given;
  }

  Outcome<HeadLandmarks, LandmarksResult> run(const Progress& progress) {
    const craniometry::FieldView skin(*in_.skin, lattice_), skull(*in_.skull, lattice_);
    const bool by_points = plane_from_given();
    if (!by_points) plane_by_symmetry(skin, skull, progress.part(0, 0.7));
    progress.report(0.7);
    check_sides(in_.given, out_.midsagittal);
    head_ = frame_in(out_.midsagittal, skull);
    const auto nasion = find_nasion(skin, skull, head_);
    add_or_doubt("nasion", nasion, "no hollow between brow and nose");
    if (const Vec3* p = known("nasion", 0.5)) level_by_nasion(head_, *p);
    for (const int side : {1, -1}) {
      progress.check();
      add_or_doubt(side > 0 ? "tragus_left" : "tragus_right", find_tragus(skin, head_, side), "no ear with its concha");
    }
    doubt_lopsided_tragi();
    doubt_covered_tragi(skin);
    progress.report(0.8);
    level_frame();
    auto inion = find_inion(skin, skull, head_, inion_levels());
    if (inion && !levelled_) inion->confidence *= 0.5;
    add_or_doubt("inion", inion, "no protuberance of the bone there");
    auto vertex = find_vertex(skin, head_);
    if (const cases::CaseLandmark* l = out_.find("vertex")) doubt(*l, levelled_ ? vertex : std::nullopt);
    if (given("vertex")) vertex.reset();
    if (vertex && !levelled_) lower(*vertex, "vertex", 0.5, "the head could not be levelled");
    progress.report(0.85);
    set_arcs(skin);
    doubt_leaps(skin, skull, vertex);
    if (!out_.find("vertex")) add("vertex", vertex, "found", "the scan ends below it");
    find_bregma(skin, skull);
    find_kocher(skin, skull);
    if (in_.ventricles) {
      const auto monro = find_monro(craniometry::FieldView(*in_.ventricles, lattice_), volume_, head_);
      for (int s = 0; s < 2; ++s)
        add_or_doubt(s == 0 ? "monro_left" : "monro_right", monro[s],
                     "no third ventricle below the lateral ones, or no way between them");
    }
    judge_together(out_, given_names(), why_);
    const Progress last = progress.part(0.95, 1);
    hold_to_scan(out_, given_names(), in_.scan_figures ? in_.scan_figures(last) : mask::measure_scan(volume_, last),
                 why_);
    hold_to_motion(out_, given_names(), mask::find_motion(volume_, last), lattice_, why_);
    hold_to_bregma(out_, given_names(), why_);
    if (levelled_) hold_to_level(out_, given_names(), why_);
    const Warnings none = leave_out_what_is_none(out_, given_names(), why_);
    warnings_.insert(warnings_.end(), none.begin(), none.end());
    tell();
    return {std::move(out_), std::move(result_), std::move(warnings_)};
  }

 private:
  const Vec3* given(const char* name) const {
    for (const cases::CaseLandmark& l : in_.given)
      if (l.name == name) return &l.position_mm;
    return nullptr;
  }
  std::set<std::string> given_names() const {
    std::set<std::string> names;
    for (const cases::CaseLandmark& l : in_.given) names.insert(l.name);
    return names;
  }
  const Vec3* known(const char* name, double least = 0.3) const {
    const cases::CaseLandmark* l = out_.find(name);
    return l && l->confidence >= least ? &l->position_mm : nullptr;
  }
  double confidence_of(const char* name) const {
    const cases::CaseLandmark* l = out_.find(name);
    return l ? l->confidence : 0;
  }

  void add(const char* name, std::optional<FoundPoint> found, const char* source, const char* otherwise) {
    if (found) found->confidence *= out_.midsagittal.confidence;
    if (found && found->confidence >= min_confidence && lies_in_scan(found->position_mm))
      out_.landmarks.push_back({name, found->position_mm, found->confidence, source});
    else
      not_found(name, !found                   ? otherwise
                      : !why_.of(name).empty() ? why_.of(name)
                                               : "too near the scan's edge, or doubtful");
  }
  /// What a person gave stays, and where it is found elsewhere that is told.
  void add_or_doubt(const char* name, const std::optional<FoundPoint>& found, const char* otherwise) {
    if (const cases::CaseLandmark* l = out_.find(name))
      doubt(*l, found);
    else
      add(name, found, "found", otherwise);
  }
  void doubt(const cases::CaseLandmark& given, std::optional<FoundPoint> found) {
    if (found) found->confidence *= out_.midsagittal.confidence;
    if (const auto warning = doubt_given(given, found)) warnings_.push_back(*warning);
  }
  void not_found(const std::string& name, const std::string& why) {
    warnings_.push_back(
        {"landmark_not_found", "{landmark} not found: {reason}", {{"landmark", name}, {"reason", why}}});
  }
  bool lies_in_scan(Vec3 p) const { return craniometry::FieldView(*in_.skin, lattice_).depth_in_scan_mm(p) >= 0; }

  bool plane_from_given() {
    const auto plane = plane_of_given(in_.given);
    if (plane) out_.midsagittal = *plane;
    if (plane) result_.midsagittal_from = "given landmarks";
    return plane.has_value();
  }

  void plane_by_symmetry(const craniometry::FieldView& skin, const craniometry::FieldView& skull,
                         const Progress& progress) {
    const craniometry::MirrorPlane plane = craniometry::find_mirror_plane(skin, skull, progress);
    result_.midsagittal_from = "symmetry";
    result_.symmetry = SymmetryFigures{plane.residual_mm, plane.midline_mm, plane.matched, plane.rise_mm};
    if (plane.confidence < min_symmetry)
      throw refusal("midsagittal",
                    fmt::format("no symmetric skull was found (residual {:.1f} mm of at most 4, {:.0f} % match of at "
                                "least 50, sharpness {:.2f} mm of at least 0.1)",
                                plane.residual_mm, 100 * plane.matched, plane.rise_mm),
                    {how_to_give_landmarks});
    out_.midsagittal = {plane.point_mm, plane.normal, plane.confidence};
  }

  /// The ears of a head differ less than a wrong rim is off, but which of the two is wrong is not known.
  void doubt_lopsided_tragi() {
    cases::CaseLandmark* tragi[2] = {nullptr, nullptr};
    for (cases::CaseLandmark& l : out_.landmarks)
      if (l.name == "tragus_left" || l.name == "tragus_right") tragi[l.name == "tragus_left" ? 0 : 1] = &l;
    if (!tragi[0] || !tragi[1]) return;
    const MidsagittalPlane& p = out_.midsagittal;
    const Vec3 left = tragi[0]->position_mm;
    const double apart_mm = norm(left - p.normal * (2 * dot(left - p.point_mm, p.normal)) - tragi[1]->position_mm);
    result_.tragi_asymmetry_mm = apart_mm;
    for (cases::CaseLandmark* l : tragi)
      lower(*l, mask::ramp(apart_mm, max_lopsided_mm, min_lopsided_mm),
            fmt::format("{:.0f} mm from the mirror image of the other tragus", apart_mm));
  }

  /// Under a sheet or a pad an ear is pressed flat, and what was taken off with it may be a part of the ear.
  void doubt_covered_tragi(const craniometry::FieldView& skin) {
    if (!in_.as_read) return;
    for (cases::CaseLandmark& l : out_.landmarks) {
      if (l.name != "tragus_left" && l.name != "tragus_right") continue;
      const double side = l.name == "tragus_left" ? 1 : -1;
      const double covered = covered_ratio(*in_.as_read, volume_, skin, l.position_mm, head_.left * side);
      result_.covered_ratio.emplace_back(l.name, covered);
      lower(l, mask::ramp(covered, 1.2 * max_covered_ratio, 0.5 * max_covered_ratio),
            fmt::format("something that was taken off lies on {:.0f} % of the skin about it", 100 * covered));
    }
  }

  /// Turns the axes so that the line from the tragi to the nasion rises by 20 degrees towards the front, as it does
  /// where the Frankfurt plane is level.
  void level_frame() {
    const Vec3 *nasion = known("nasion"), *left = known("tragus_left"), *right = known("tragus_right");
    if (!nasion || (!left && !right)) return;
    Vec3 ears = left && right ? (*left + *right) * 0.5 : left ? *left : *right;
    ears = ears - head_.left * dot(ears - head_.origin_mm, head_.left);
    const Vec3 way = normalized(*nasion - ears - head_.left * dot(*nasion - ears, head_.left));
    const double angle = tragi_to_nasion_deg * pi / 180;
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

  void set_arcs(const craniometry::FieldView& skin) {
    if (const Vec3* nasion = known("nasion", min_confidence))
      arc_ = midline_arc(skin, head_, *nasion, known("inion", min_confidence));
  }

  /// A sheet that lies on the skin (a radiotherapy mask, a dressing) ends or is perforated somewhere: what is measured
  /// over it is not measured over skin. Nor is what lies far from any bone.
  void doubt_leaps(const craniometry::FieldView& skin, const craniometry::FieldView& skull,
                   std::optional<FoundPoint>& vertex) {
    if (vertex) {
      const double soft_mm =
          soft_tissue_mm(skull, vertex->position_mm, normalized(head_.origin_mm - vertex->position_mm));
      lower(*vertex, "vertex", std::max(0.3, scalp_ratio(soft_mm)), fmt::format("bone lies {:.0f} mm below", soft_mm));
    }
    if (!arc_) return;
    if (vertex) doubt_vertex(skin, *vertex);
    leap_mm_ = widest_leap_mm(arc_->skin, params_.along_mm + tangent_mm);
    result_.midline_leap_mm = leap_mm_;
    const double factor = std::max(0.3, mask::ramp(leap_mm_, max_leap_mm, min_leap_mm));
    const std::string why = fmt::format("the midline's skin leaps by {:.1f} mm", leap_mm_);
    if (vertex) lower(*vertex, "vertex", factor, why);
    for (cases::CaseLandmark& l : out_.landmarks)
      if (l.name == "nasion") lower(l, factor, why);
  }

  /// The highest point moves by 2 mm with each degree by which the head is levelled otherwise. The highest point as the
  /// patient lay, and half of the way from nasion to inion over the skin, are other estimates.
  void doubt_vertex(const craniometry::FieldView& skin, FoundPoint& vertex) {
    HeadFrame lying = head_;
    lying.back = normalized(Vec3{0, 1, 0} - head_.left * head_.left.y);
    lying.up = cross(lying.left, lying.back);
    const auto highest = find_vertex(skin, lying);
    const double lying_mm = highest ? norm(highest->position_mm - vertex.position_mm) : 0;
    result_.vertex_to_highest_mm = lying_mm;
    lower(vertex, "vertex", confidence_of_vertices_apart(lying_mm),
          fmt::format("the highest point, as the patient lay, is {:.0f} mm off", lying_mm));
    const Vec3* inion = known("inion", min_confidence);
    if (!inion) return;
    const double all = arc_length_to_mm(arc_->skin, *inion);
    const auto half = surface::point_along(arc_->skin, 0.5 * all);
    if (!half || skin.depth_in_scan_mm(*half) < 0.5) return;
    const double apart_mm = norm(*half - vertex.position_mm);
    result_.vertex_to_half_way_mm = apart_mm;
    lower(vertex, "vertex", confidence_of_vertices_apart(apart_mm),
          fmt::format("half of the way from nasion to inion lies {:.0f} mm off", apart_mm));
  }

  /// The suture is looked for in the bone. Where it is not clear, it has to agree with the usual distance; where it
  /// does not, that distance is all that is left, and no reason to trust it.
  void find_bregma(const craniometry::FieldView& skin, const craniometry::FieldView& skull) {
    if (out_.find("bregma")) return;
    if (!arc_) {
      warnings_.push_back({"nasion_not_known", "bregma and Kocher's points not measured: the nasion is not known", {}});
      return;
    }
    const Vec3* nasion = known("nasion", min_confidence);
    const auto suture = craniometry::find_coronal_suture(
        volume_, {arc_->centre_mm, arc_->front, arc_->onwards, head_.left, *nasion},
        [&](Vec3 from, Vec3 direction, double length_mm) { return skull.enter(from, direction, length_mm, 1.2); });
    std::optional<Vec3> usual = surface::point_along(arc_->skin, params_.bregma_mm);
    if (usual && runs_over_edge(skin, arc_->skin, *usual)) usual.reset();
    if (usual) {
      const Vec3 inwards = normalized(arc_->centre_mm - *usual);
      usual = skull.enter(*usual - inwards, inwards, 40, 0.4);
    }
    std::optional<FoundPoint> seen, estimated;
    if (suture) {
      result_.suture =
          SutureFigures{suture->visible_ratio, suture->distinct_ratio, suture->halves_apart_mm, suture->arc_mm};
      seen = FoundPoint{suture->bregma_mm, suture->confidence};
      const bool agree = usual && norm(*usual - suture->bregma_mm) <= max_estimates_apart_mm;
      if (seen->confidence < 0.5 && agree && seen->confidence > 0.2) seen->confidence = 0.5;
    }
    if (usual) estimated = FoundPoint{*usual, of_an_estimate * mask::ramp(arc_->nasion_gap_mm, 10, 4)};
    if (seen && seen->confidence >= 0.5) {
      result_.suture_near_midline_ratio = suture->near_midline_ratio;
      if (suture->near_midline_ratio < min_near_midline_ratio)
        lower(*seen, "bregma", of_a_fused_suture / seen->confidence,
              "the coronal suture has grown together at the midline, and is seen beside it alone");
      return add("bregma", seen, "found", "");
    }
    why_.note("bregma", 0, "the coronal suture is not seen; the usual distance from the nasion is an estimate");
    if (estimated) estimated->confidence *= confidence_of("nasion");
    add("bregma", estimated, "estimated", "the skin ends before, at the scan's edge");
  }

  void find_kocher(const craniometry::FieldView& skin, const craniometry::FieldView& skull) {
    if (!arc_) return;
    const double base = confidence_of("nasion") * mask::ramp(arc_->nasion_gap_mm, 10, 4);
    const craniometry::Outline midline = surface::without_ridges(arc_->skin, arc_->centre_mm, surface::brow_mm);
    const auto top = surface::point_along(midline, params_.along_mm),
               behind = surface::point_along(midline, params_.along_mm + tangent_mm),
               ahead = surface::point_along(midline, std::max(0.0, params_.along_mm - tangent_mm));
    if (!top || !behind || !ahead || runs_over_edge(skin, arc_->skin, *top)) {
      not_found("kocher_left and kocher_right", "the midline's skin ends before, at the scan's edge");
      return;
    }
    const Vec3 outwards = cross(head_.left, normalized(*behind - *ahead));
    std::optional<Vec3> suture_mm;  // a copy: what is found here joins the same list
    if (const cases::CaseLandmark* bregma = out_.find("bregma");
        bregma && bregma->source != "estimated" && bregma->confidence >= seen_bregma_confidence)
      suture_mm = bregma->position_mm;
    for (const int side : {1, -1}) {
      const Vec3 sideways = head_.left * side, middle = *top - outwards * middle_depth_mm;
      const craniometry::Outline lateral =
          surface::without_ridges(craniometry::outline(skin, {middle, outwards, sideways, 5, 120}), middle, 0);
      const std::string name = side > 0 ? "kocher_left" : "kocher_right";
      if (out_.find(name)) continue;
      const auto p = surface::point_along(lateral, params_.lateral_mm);
      if (!p || runs_over_edge(skin, lateral, *p) || base < min_confidence) {
        not_found(name, "the skin ends before, at the scan's edge, or the nasion is doubtful");
        continue;
      }
      // The confidence includes the plane's already, through the nasion's.
      FoundPoint found{*p, 0.95 * base};
      if (base < doubtful_confidence) why_.note(name, base, "it is measured from the nasion, which is doubtful");
      const double soft_mm = soft_tissue_mm(skull, *p, normalized(middle - *p));
      lower(found, name, std::max(0.3, scalp_ratio(soft_mm)), fmt::format("bone lies {:.0f} mm below", soft_mm));
      if (suture_mm) {
        const double before_mm =
            craniometry::before_suture_mm(*p, *suture_mm, arc_->centre_mm, *known("nasion", min_confidence));
        result_.before_suture_mm.emplace_back(name, before_mm);
        if (before_mm < craniometry::min_before_suture_mm || before_mm > craniometry::max_before_suture_mm)
          lower(found, name, 0.45,
                fmt::format("{:.0f} mm before the coronal suture, {:.0f} to {:.0f} are right", before_mm,
                            craniometry::min_before_suture_mm, craniometry::max_before_suture_mm));
      }
      out_.landmarks.push_back({name, found.position_mm, found.confidence, "found"});
    }
  }

  void lower(FoundPoint& p, const std::string& name, double factor, const std::string& why) {
    why_.note(name, factor, why);
    p.confidence *= factor;
  }
  void lower(cases::CaseLandmark& l, double factor, const std::string& why) {
    if (!given(l.name.c_str())) lower_confidence(l, factor, why, why_);
  }

  void tell() {
    result_.midsagittal_confidence = out_.midsagittal.confidence;
    for (const cases::CaseLandmark& l : out_.landmarks)
      result_.landmarks.emplace_back(l.name, LandmarkFigures{fmt::format("[{:.1f}, {:.1f}, {:.1f}]", l.position_mm.x,
                                                                         l.position_mm.y, l.position_mm.z),
                                                             l.confidence});
  }

  const grid::HuVolume& volume_;
  const grid::Lattice& lattice_;
  const LandmarkInputs& in_;
  const LandmarkParams& params_;
  HeadLandmarks out_;
  LandmarksResult result_;
  Warnings warnings_;
  HeadFrame head_;
  std::optional<MidlineArc> arc_;  ///< none without a nasion
  Reasons why_;
  double ears_level_mm_ = 0, leap_mm_ = 0;
  bool levelled_ = false;
};

}  // namespace

Outcome<HeadLandmarks, LandmarksResult> find_landmarks(const grid::HuVolume& volume, const LandmarkInputs& inputs,
                                                       const LandmarkParams& params, const Progress& progress) {
  auto found = Finder(volume, inputs, params).run(progress);
  progress.report(1);
  return found;
}

}  // namespace trephine::head
