// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "cases/case.h"
#include "config/said.h"
#include "face/deface.h"
#include "stages/voxelize.h"

namespace trephine::config {

/// The declarations of scene files (configs/scenes/*.yaml) and of the file of materials (configs/materials.yaml).

/// The limits that a scene sets for one anatomy's surface.
struct SceneAnatomyParams {
  double max_deviation_mm = 0;
  std::int64_t max_triangles = 0;
  bool may_be_missing = false;
  std::string stand_in, touched_as;
  template <class V>
  static void describe(V& v) {
    using P = SceneAnatomyParams;
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0.01, 100},
             "How far the surface may lie from the unreduced one; smoothing and decimation share this deviation.")
        .none_at_zero();
    v.integer(&P::max_triangles, "max_triangles", Range{4, 1e8}, "How many triangles the surface may have.")
        .none_at_zero();
    v.flag(&P::may_be_missing, "may_be_missing",
           "Where the anatomy is refused (80), the case is made without it, and says so; otherwise there is no case.");
    v.text(&P::stand_in, "stand_in",
           "The anatomy of the recipe that stands for this one where it is refused (80), under this one's name; the "
           "case says so. Should that be refused too, may_be_missing counts.")
        .names("anatomy");
    v.text(&P::touched_as, "touched_as",
           "The material of a surface that is touched as a mesh beside the haptic volume, such as an implant, on both "
           "of its sides as its `front` says. No tool cuts it.");
  }
};

enum class FacePolicy { keep, crop, deface };

struct FacePolicyParams : face::FaceBeliefParams {
  FacePolicy policy = FacePolicy::keep;
  std::string reason;
  template <class V>
  static void describe(V& v) {
    using P = FacePolicyParams;
    v.choice(&P::policy, "policy",
             {{"crop", FacePolicy::crop}, {"deface", FacePolicy::deface}, {"keep", FacePolicy::keep}},
             "What is done about the patient's face: crop removes it with everything in front of it, deface removes "
             "what is near the skin, keep leaves it.")
        .is_required();
    v.text(&P::reason, "reason", "With policy keep: why the case may show the face. The reason is recorded.");
    v.template all_of<face::FaceBeliefParams>();
  }
  std::string fault() const;
};

/// A shape of the haptic volume: how it is made, what it feels like, and whether a tool may remove it.
struct SceneShapeParams : stages::HapticShapeParams, cases::ShapeParams {
  std::string material, transfer_file;
  template <class V>
  static void describe(V& v) {
    using P = SceneShapeParams;
    v.text(&P::material, "material", "The material that says how the shape feels, from the scene's file of materials.")
        .names("material")
        .is_required();
    v.template all_of<cases::ShapeParams>();
    v.text(&P::transfer_file, "transfer_file",
           "A file with `transfer`'s keys, in place of it, such as the editor of `trephine-sim play` writes.")
        .names("transfer_file");
    v.template all_of<stages::HapticShapeParams>();
  }
};

struct SceneHapticParams : stages::HapticVolumeParams {
  Named<SceneShapeParams> shapes;
  template <class V>
  static void describe(V& v) {
    using P = SceneHapticParams;
    v.template all_of<stages::HapticVolumeParams>();
    v.map(&P::shapes, "shapes",
          "The shapes by name, in order of precedence: a part that one shape fills does not belong to later ones.")
        .names("shape")
        .at_most(voxel::haptic_max_shapes)
        .is_required();
  }
  std::string fault() const;
};

/// The CT of a case, for its page and for fluoroscopy.
struct SceneCtParams {
  double margin_mm = 5;
  template <class V>
  static void describe(V& v) {
    v.number(&SceneCtParams::margin_mm, "margin_mm", Range{0, 1000},
             "How far the CT reaches beyond the surfaces and the haptic volume; it ends where the scan ends.");
  }
};

struct SceneFileParams : VersionParams {
  Named<SceneAnatomyParams> anatomies;
  bool strict = false;
  double triangles_ratio = 1;
  Named<SaidConfidence> landmarks;
  Named<stages::DrillParams> burr_holes;
  std::string materials;
  std::optional<SceneHapticParams> haptic;
  std::optional<SceneCtParams> ct;
  std::optional<FacePolicyParams> face;

  template <class V>
  static void describe(V& v) {
    using P = SceneFileParams;
    v.template all_of<VersionParams>();
    v.map(&P::anatomies, "anatomies",
          "The anatomies that are shown. Anatomies that no scene requires are not computed.")
        .names("anatomy")
        .is_required();
    v.flag(&P::strict, "strict",
           "There is no case (80) where an anatomy is refused, whatever may_be_missing and stand_in say of it.");
    v.number(&P::triangles_ratio, "triangles_ratio", Range{0.01, 100},
             "Factor on the triangles that the scene allows for each anatomy, for a machine that shows more of them or "
             "fewer.");
    v.map(&P::landmarks, "landmarks", "Landmarks that the scene requires, each with its least confidence.")
        .names("landmark");
    v.map(&P::burr_holes, "burr_holes", "The anatomies from which the case's burr holes are cut.").names("anatomy");
    // Before haptic, whose shapes name materials.
    v.text(&P::materials, "materials", "The file of materials that the haptic shapes name.").names("materials");
    v.group(&P::haptic, "haptic", "The haptic volume, which is what the hand feels.");
    v.group(&P::ct, "ct",
            "The CT itself, which the case then holds: cropped to what is shown and felt, after the face policy. "
            "Without it the case's page shows slices of the haptic volume.");
    v.group(&P::face, "face", "What is done about the patient's face.");
  }
};

struct MaterialsFileParams : VersionParams {
  Named<cases::MaterialParams> materials;
  template <class V>
  static void describe(V& v) {
    using P = MaterialsFileParams;
    v.template all_of<VersionParams>();
    v.map(&P::materials, "materials", "The materials by name.").names("name").is_required();
  }
};

}  // namespace trephine::config
