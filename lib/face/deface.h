// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "head/head_landmarks.h"

namespace trephine::face {

/// The region in which a head shows its face: in front of the plane through both tragi, and below the level of the
/// nasion (the slits of the eyes lie 2 to 12 mm under it), in the head's own axes, however it lies in the scanner.
/// `left` runs from tragus to tragus. Seen from the side, the line from the midpoint between the tragi to the nasion
/// ascends by 20 degrees relative to `front` (the Frankfurt plane is then level to about 10 degrees). `up` is
/// perpendicular to both. The plane through the tragi holds `left` and `up`.
struct FaceRegion {
  Vec3 nasion_mm, tragi_mm;  ///< tragi_mm: the midpoint between the two
  Vec3 left{1, 0, 0}, front{0, -1, 0}, up{0, 0, 1};

  double in_front_mm(Vec3 p) const { return dot(p - tragi_mm, front); }  ///< of the plane through the tragi
  double below_mm(Vec3 p) const { return dot(nasion_mm - p, up); }       ///< the level
  bool contains(Vec3 p) const { return in_front_mm(p) > 0 && below_mm(p) > 0; }
};

/// Throws Error 81 naming the landmark, and how to give it, where nasion, tragus_left or tragus_right is missing or its
/// confidence is below `min_confidence`, or where the three cannot be those of a head (left and right swapped,
/// distances of no head, upside down).
FaceRegion face_region(const head::HeadLandmarks& landmarks, double min_confidence = 0.5);

/// What stands in the place of a face that was removed.
constexpr double removed_hu = -1000;

/// The clearance that acceptance case P4 requires.
constexpr double face_clearance_mm = 5;

enum class FaceRemoval { deface, crop };

/// Which landmarks say where the face is, where given and found ones are more than 15 mm apart (face_belief.h).
enum class FaceBelief { both, given, found };

struct FaceBeliefParams {
  FaceBelief believe = FaceBelief::both;
  std::string believe_reason;

  template <class V>
  static void describe(V& v) {
    using P = FaceBeliefParams;
    v.choice(&P::believe, "believe",
             {{"both", FaceBelief::both}, {"given", FaceBelief::given}, {"found", FaceBelief::found}},
             "Which landmarks say where the face is. both: the face is what either says, and given ones that lie more "
             "than 15 mm from where they are found, or cannot be found, are refused. The others need a reason.");
    v.text(&P::believe_reason, "believe_reason",
           "Why the given, or the found, landmarks alone are right. The reason is recorded.");
  }
};

struct DefaceParams : FaceBeliefParams {
  FaceRemoval policy = FaceRemoval::deface;
  double depth_mm = 12, side_depth_mm = 7;
  double rounding_mm = 15;
  double above_mm = 6, behind_mm = 4;
  double cover_mm = 3;
  double crop_under_tragi_mm = 15;

  template <class V>
  static void describe(V& v) {
    using P = DefaceParams;
    v.template all_of<FaceBeliefParams>();
    v.choice(&P::policy, "policy", {{"deface", FaceRemoval::deface}, {"crop", FaceRemoval::crop}},
             "deface: removes what lies near the skin of the face; crop: removes that, and the face in its whole depth "
             "under the base of the skull.");
    v.number(&P::depth_mm, "depth_mm", Range{6, 40},
             "Depth under the skin that is removed, from 40 mm in front of the tragi on.");
    v.number(&P::side_depth_mm, "side_depth_mm", Range{6, 40},
             "Depth under the skin that is removed beside the tragi, where the skull is near; a little more where "
             "voxels are large.");
    v.number(&P::rounding_mm, "rounding_mm", Range{0, 30},
             "What is left has no bump narrower than twice this, so that nothing of nose, lips or chin can be "
             "reconstructed from it.");
    v.number(
        &P::above_mm, "above_mm", Range{2, 25},
        "How far above the nasion's level the removal begins, so that no eye stays where the nasion was found some "
        "mm too low.");
    v.number(&P::behind_mm, "behind_mm", Range{2, 25},
             "How far behind the plane through the tragi the removal begins.");
    v.number(&P::cover_mm, "cover_mm", Range{0, 10},
             "Bone and air that the cut would expose become soft tissue to this depth (not beside the tragi).");
    v.number(
        &P::crop_under_tragi_mm, "crop_under_tragi_mm", Range{0, 80},
        "crop: the cut runs from 10 mm under the nasion to this far under the tragi, below the base of the skull.");
  }
};

/// What is printed of it.
struct DefaceResult {
  FaceRemoval policy = FaceRemoval::deface;
  double removed_ml = 0;  ///< of the body
  std::size_t removed_voxels_count = 0;
  double depth_mm = -1;  ///< the least depth under the skin, within the region, of what is left; -1: nothing is left
  std::optional<std::int64_t> regions_count;
  template <class V>
  static void describe(V& v) {
    using P = DefaceResult;
    v.choice(&P::policy, "face_policy", {{"deface", FaceRemoval::deface}, {"crop", FaceRemoval::crop}},
             "How the face was removed.");
    v.number(&P::removed_ml, "face_removed_ml", Range{}, "What was removed of the body.");
    v.integer(&P::removed_voxels_count, "face_removed_voxels_count", Range{}, "Voxels that were changed.");
    v.number(&P::depth_mm, "face_depth_mm", Range{}, "Least depth under the skin of what is left; -1: nothing is.");
    v.integer(&P::regions_count, "face_regions_count", "Regions of which the face is the union.");
  }
};

/// Takes the face off a head, before anything is contoured: the result is the volume with air (removed_hu) in place of
/// the face. In the region grown by `above_mm` and `behind_mm`, everything that lies outside the skin, or less than the
/// depth under it, becomes air. What is left is rounded, ends in a ramp of a voxel and a half, so that a surface
/// through it is smooth, and is covered by soft tissue. Everything else keeps its values to the last bit: cranium,
/// brain, ears, and the field of an operation from `above_mm` over the nasion upwards.
///
/// `skin` is that of the original volume (positive inside, cavities filled), on its raster or a part of it. Warns where
/// the volume holds no face.
///
/// The shape of the bones underneath stays, except where `crop` removes them, and so do ears, forehead and the back of
/// the head. The result has the same bits whatever the thread count. Throws Error 65 where the skin is on another
/// raster or a voxel is not finite; 81 where a landmark of the region lies in the volume but more than 25 mm off the
/// skin (it cannot be right); Cancelled.
Outcome<grid::HuVolume, DefaceResult> deface(const grid::HuVolume& volume, const grid::Field& skin,
                                             const FaceRegion& region, const DefaceParams& params,
                                             const Progress& progress = {});

}  // namespace trephine::face
