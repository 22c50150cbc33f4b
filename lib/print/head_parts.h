// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The parts of a printed head, as solids. Made one after the other, each beside those before it.
#include <optional>
#include <string>
#include <vector>

#include "print/print_frame.h"
#include "print/print_params.h"
#include "print/print_record.h"
#include "print/solid.h"

namespace trephine::print {

/// A part before it has a surface.
struct PartSolid {
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  Solid solid;
};

/// The solid with walls of `plan`, in one piece. Throws Error 80 where more than a crumb of it would hang on nothing.
struct HeadPlan;
constexpr double most_crumbs_ml = 0.3;
Solid one_piece(const HeadPlan& plan, const Solid& solid, const std::string& part, const Progress& progress = {});

/// What the parts of a head share.
struct HeadPlan {
  const cases::LoadedCase& loaded;
  const PrintParams& params;
  PrintFrame frame;
  /// Balls of this radius fill every part: half of the least wall, and a little for what surface and raster lose.
  double ball_mm = 1;
  Solid bone;          ///< in distances, thin walls made thick, its largest piece; from below the cut
  Vec3 middle_mm;      ///< of the head, in the frame of the parts
  grid::Lattice flat;  ///< one slice of bone's lattice
  /// Of each column: the largest of bone over the heights that the base's rim reaches; and 1 within the ring of bone.
  Solid rim_bone;
  mask::BitMask ring_inside, ring_filled;
  double dropped_ml = 0;  ///< of bone in other pieces

  /// What is so thick keeps its balls, wherever the raster lies.
  double thick_mm() const { return 2 * ball_mm + 1.2 * params.voxel_mm; }
  double rim_mm() const { return 2 * thick_mm(); }                    ///< height of the base's rim
  double plate_mm() const { return 2 * thick_mm() + params.gap_mm; }  ///< thickness of the base
};

/// Throws Error 65 where the case lacks what a head needs, 80 where its bone makes no ring at the cut.
HeadPlan plan_head(const cases::LoadedCase& loaded, const PrintParams& params, const Progress& progress = {});

/// Where the bone's outside lies over the head's middle in that direction, and its unit normal, the mean of its
/// surroundings. Nothing where no bone lies there.
struct OuterPlace {
  Vec3 at_mm, out;
};
std::optional<OuterPlace> outer_place(const HeadPlan& plan, Vec3 way);

/// A replaceable piece of bone: a cylinder with a rim that rests on the outside of the bone.
struct InsertPlan {
  std::string name;
  OuterPlace place;
  double radius_mm = 18;
  double off_axis_mm(Vec3 p) const { return norm(cross(p - place.at_mm, place.out)); }
  double along_mm(Vec3 p) const { return dot(p - place.at_mm, place.out); }
};
/// Throws Error 65 where the case has no Kocher's point or no bone there, 80 where two inserts would touch.
std::vector<InsertPlan> plan_inserts(const HeadPlan& plan);
PartSolid insert_part(const HeadPlan& plan, const InsertPlan& insert, const Progress& progress = {});

/// Spheres on posts, spread over the skull, away from the inserts. Throws Error 80 where too few have room.
std::vector<PrintMark> plan_marks(const HeadPlan& plan, const std::vector<InsertPlan>& inserts);
/// Everything above the cut: bone with holes for the inserts, and the marks.
PartSolid skull_part(const HeadPlan& plan, const std::vector<InsertPlan>& inserts, const std::vector<PrintMark>& marks,
                     const Progress& progress = {});

/// The ventricles on a stem that stands in the base.
struct VentriclesPart {
  PartSolid part;
  Vec3 stem_mm;  ///< its foot's middle, at z = 0
  double stem_radius_mm = 4, collar_radius_mm = 8;
  int bridges = 0;  ///< rods between pieces that do not hang together
};
/// Throws Error 65 where the case has no ventricles, 80 where no stem reaches them.
VentriclesPart ventricles_part(const HeadPlan& plan, const Progress& progress = {});

/// The plate that closes the skull from below, with a rim that fits into it, and the lid of its pouring hole. `token`
/// is engraved into the base from below. Throws Error 80 where the ring of bone has no room for the hole.
struct BaseParts {
  PartSolid base, lid;
  double letters_to_mm = 0;  ///< height up to which the letters reach into the base
};
BaseParts base_parts(const HeadPlan& plan, const VentriclesPart* ventricles, const std::string& token,
                     const Progress& progress = {});

}  // namespace trephine::print
