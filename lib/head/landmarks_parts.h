// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How find_landmarks finds each kind of landmark; for the sources of this room only.
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/warning.h"
#include "craniometry/near_distance.h"
#include "craniometry/skin_arc.h"
#include "head/head_landmarks.h"
#include "mask/hu_view.h"
#include "mask/motion.h"
#include "mask/scan_figures.h"

namespace trephine::head {

/// The head's own axes: the origin lies in the midsagittal plane, inside the skull.
struct HeadFrame {
  Vec3 origin_mm, left{1, 0, 0}, back{0, 1, 0}, up{0, 0, 1};
};

/// Axes in the plane, the superior one nearest to the scan's; the origin is the centre of the skull's bones. Throws
/// Error 80 where there are none.
HeadFrame frame_in(const MidsagittalPlane& plane, const craniometry::FieldView& skull);
/// The ears are searched for with the nasion level with the skull's centre, or up to 20 degrees above it (the centre is
/// too low where the vertex was not scanned). In a head that is tilted further forwards, the hollow of the cheek looks
/// like a concha.
void level_by_nasion(HeadFrame& head, Vec3 nasion_mm);
extern const char* const how_to_give_landmarks;

/// A point and its confidence from 0 to 1.
struct FoundPoint {
  Vec3 position_mm;
  double confidence = 0;
};

/// Throws Error 65, with the landmark's name as field, where one is not finite, occurs twice, or lies further outside
/// of the skin than a landmark marked on a cut-off part can. Warns where a name is not searched for (with the nearest
/// one that is), where a landmark lies off its tissue: of the skin below it, the bregma off the bone, a foramen far
/// from the ventricles (null: not known).
Warnings check_given(const std::vector<cases::CaseLandmark>& given, const grid::Field& skin, const grid::Field& skull,
                     const grid::Field* ventricles);
/// As place_burr_hole defines it: through nasion and inion (or vertex), perpendicular to the line between the tragi;
/// none where too few are given. Throws Error 65 where they span no head.
std::optional<MidsagittalPlane> plane_of_given(const std::vector<cases::CaseLandmark>& given);
/// Throws Error 65 where a left landmark lies to the right of the plane, or the reverse.
void check_sides(const std::vector<cases::CaseLandmark>& given, const MidsagittalPlane& plane);
/// Warns where the given landmark is far from where it would be found, farther than such a landmark is found apart by
/// two people.
std::optional<Warning> doubt_given(const cases::CaseLandmark& given, const std::optional<FoundPoint>& found);

constexpr double min_confidence = 0.05;      ///< a landmark below this is left out
constexpr double doubtful_confidence = 0.5;  ///< each landmark below this is told of

/// Why landmarks are doubtful, by name: of each the reason that lowered its confidence most.
struct Reason {
  double factor = 1;
  std::string text;
};
class Reasons {
 public:
  void note(const std::string& name, double factor, const std::string& text) {
    Reason& kept = all_[name];
    if (factor < kept.factor) kept = {factor, text};
  }
  const std::string& of(const std::string& name) const {  ///< empty: there is none
    static const std::string none;
    const auto kept = all_.find(name);
    return kept == all_.end() ? none : kept->second.text;
  }

 private:
  std::map<std::string, Reason> all_;
};
/// Multiplies the confidence, and notes the reason.
void lower_confidence(cases::CaseLandmark& landmark, double factor, const std::string& reason, Reasons& reasons);
/// An ear is recognized by its shape alone, and a fold of a mask or the edge of the scan can look like one: a tragus
/// whose other one was not found, or is doubtful, becomes doubtful too. What was given stays, and confirms the other.
void judge_tragi(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons);
/// A foramen of Monro is confirmed by the other one: where that is missing or doubtful, it is less sure.
void judge_foramina(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons);
/// What cannot belong to one head together becomes doubtful (craniometry/plausible.h), and with the nasion all that is
/// measured from it; the tragi are judged as a pair. What was given stays.
void judge_together(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons);
/// Removes found landmarks below min_confidence; given ones stay. Warns of each that is removed, with the reason, and
/// of each doubtful one, with the reason and how to give it.
Warnings leave_out_what_is_none(HeadLandmarks& all, const std::set<std::string>& given, const Reasons& reasons);

/// How sure a landmark that is looked for in a scan of such slices and noise can be at most: the share of 1 that is
/// left where half of the slices' distance is an error beside the 5 mm within which readers agree, and noise one beside
/// the contrast by which the landmark is seen (skin 500 HU, a suture 250, fluid of a ventricle 20 in a cube of 2 mm).
double allowed_by_scan(const std::string& name, const mask::ScanFigures& scan);
/// Multiplies the confidence of each landmark that was found in the scan by allowed_by_scan().
void hold_to_scan(HeadLandmarks& all, const std::set<std::string>& given, const mask::ScanFigures& scan,
                  Reasons& reasons);
/// Where the head moved between the slices of the nasion and those of a Kocher's point, which is measured from it, or
/// within 5 mm of either, the motion is an error beside those 5 mm.
void hold_to_motion(HeadLandmarks& all, const std::set<std::string>& given, const std::optional<mask::Motion>& motion,
                    const grid::Lattice& slices, Reasons& reasons);
/// Kocher's points are where they are because the coronal suture lies behind them: none is surer than the bregma.
void hold_to_bregma(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons);
/// Inion and vertex are what stands out most, or highest, in a head that is levelled by nasion and tragi: they are half
/// as sure where the nasion or both tragi are doubtful, as they are where those are not known.
void hold_to_level(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons);
/// How far the scan goes on below the point, at most so far.
double scanned_below_mm(const craniometry::FieldView& skin, Vec3 point_mm, Vec3 up, double most_mm);
/// Share of the skin within 12 mm of the point on which something lies within 9 mm (a mask, a pad, a cushion) that was
/// taken off the scan.
double covered_ratio(const grid::HuVolume& as_read, const grid::HuVolume& cleaned, const craniometry::FieldView& skin,
                     Vec3 point_mm, Vec3 outwards);

/// The skin of the midline from the vertex down over the face, or over the back of the head: smoothed points every 0.5
/// mm.
std::vector<Vec3> midline_profile(const craniometry::FieldView& view, const HeadFrame& head, bool front,
                                  double sigma_mm);

std::optional<FoundPoint> find_nasion(const craniometry::FieldView& skin, const craniometry::FieldView& skull,
                                      const HeadFrame& head);
/// `level_mm`: from where to where it is searched for, along `up` from the origin.
std::optional<FoundPoint> find_inion(const craniometry::FieldView& skin, const craniometry::FieldView& skull,
                                     const HeadFrame& head, std::array<double, 2> level_mm);
/// side: 1 left, -1 right.
std::optional<FoundPoint> find_tragus(const craniometry::FieldView& skin, const HeadFrame& head, int side);
std::optional<FoundPoint> find_vertex(const craniometry::FieldView& skin, const HeadFrame& head);
/// Of two estimates of the vertex that lie apart: one at least is off by half of that.
constexpr double of_contradicted_vertices = 0.45;
double confidence_of_vertices_apart(double apart_mm);

/// The skin of the midline from the nasion backwards, swept about a centre between nasion and inion, as in
/// place_burr_hole; without an inion it lies in the bones.
struct MidlineArc {
  craniometry::Outline skin;
  Vec3 centre_mm, front, onwards;
  double nasion_gap_mm = 0;  ///< from the arc's start to the nasion
};
MidlineArc midline_arc(const craniometry::FieldView& skin, const HeadFrame& head, Vec3 nasion_mm, const Vec3* inion_mm);
/// The widest step between neighbouring points of the arc, within that length from its start.
double widest_leap_mm(const craniometry::Outline& arc, double length_mm);
/// Whether a point between the curve's start and `end_mm` lies where the scan cut the head.
bool runs_over_edge(const craniometry::FieldView& skin, const craniometry::Outline& curve, Vec3 end_mm);
/// From the arc's start to the place nearest to the point, measured as point_along does.
double arc_length_to_mm(const craniometry::Outline& arc, Vec3 point_mm);
/// From a point of the skin inwards (unit) to the bone; 40 where there is none.
double soft_tissue_mm(const craniometry::FieldView& skull, Vec3 on_skin_mm, Vec3 inwards);
/// How plausible that is of a scalp: 1 from 1.5 to 13 mm, 0 below 0.3 and from 22 on. Means are 3 to 7 mm
/// [Stephan2008].
double scalp_ratio(double soft_mm);

/// The foramina of Monro, left and right: the middle between the narrowest place of the ventricles there, and the
/// brightest place of the darkest way from the third to the lateral one in the smoothed scan, where it shows one.
std::array<std::optional<FoundPoint>, 2> find_monro(const craniometry::FieldView& ventricles,
                                                    const grid::HuVolume& volume, const HeadFrame& head);

}  // namespace trephine::head
