// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <string>

#include "config/said.h"
#include "stages/stage.h"

namespace trephine::config {

/// The declaration of everything in a recipe (pipelines/*.yaml). Its steps come from the registry of stages.

/// One step as a recipe writes it: the stage's own parameters, and for each port the output that it reads, as
/// "anatomy.stage", and the scan. These are the objects that `Steps` of a recipe hold.
struct RecipeStepParams {
  AnyParams params;
  std::map<std::string, std::string> ports;
  std::string scan;  ///< empty: the CT
};

/// The steps that a recipe may name at that place, each with its parameters and the ports whose source a recipe names.
std::vector<StepChoice> recipe_steps(stages::StagePlace place);

struct RecipeAnatomyParams {
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity_ratio = 1;
  bool shows_face = false;
  template <class V>
  static void describe(V& v) {
    using P = RecipeAnatomyParams;
    v.numbers(&P::colour_rgb, "colour_rgb", Range{0, 1}, "Colour of the anatomy, sRGB.");
    v.number(&P::opacity_ratio, "opacity_ratio", Range{0.05, 1}, "Opacity of the anatomy in pictures and in the GLB.");
    // This key has no default: a recipe that forgets it must not publish a face.
    v.flag(&P::shows_face, "shows_face",
           "Whether the anatomy shows the patient's face. If so, it is published only under a face policy.")
        .is_required();
  }
};

struct RecipeAnatomyFileParams : RecipeAnatomyParams {
  Steps stages;
  template <class V>
  static void describe(V& v) {
    v.template all_of<RecipeAnatomyParams>();
    v.steps(&RecipeAnatomyFileParams::stages, "stages", recipe_steps(stages::StagePlace::anatomy),
            "The stages that make the anatomy; each works on what the one before it gives.")
        .is_required();
  }
};

/// The roles of anatomies in what a scene does to a case.
struct BurrHoleRoles {
  std::string bone, over;
  template <class V>
  static void describe(V& v) {
    using P = BurrHoleRoles;
    v.text(&P::bone, "bone", "The bone that burr holes are placed on and must go through.")
        .names("anatomy")
        .is_required();
    v.text(&P::over, "over", "The skin over which Kocher's point is measured; empty: over the bone.").names("anatomy");
  }
};

struct RecipeRoles {
  BurrHoleRoles burr_holes;
  Named<SaidAnatomy> targets;
  std::string class_of;
  template <class V>
  static void describe(V& v) {
    using P = RecipeRoles;
    v.group(&P::burr_holes, "burr_holes", "Which anatomies burr holes concern.");
    v.map(&P::targets, "targets",
          "Landmarks that lie in an anatomy and are what an exercise aims at, such as {monro_right: ventricles}. That "
          "anatomy is computed where one of them is wanted, and they are targets where it is shown.")
        .names("target");
    v.text(&P::class_of, "class_of",
           "The anatomy by which a case is classed as normal, hydrocephalic, shifted, small or uncertain.")
        .names("anatomy");
  }
};

struct RecipeFileParams : VersionParams, RecipeRoles {
  Named<RecipeAnatomyFileParams> anatomies;
  Steps scan_steps;
  template <class V>
  static void describe(V& v) {
    using P = RecipeFileParams;
    v.template all_of<VersionParams>();
    v.map(&P::anatomies, "anatomies", "The anatomies by name, and how each is made.").names("name").is_required();
    v.template all_of<RecipeRoles>();
    for (const StepChoice& step : recipe_steps(stages::StagePlace::scan)) v.group(&P::scan_steps, step);
  }
};

}  // namespace trephine::config
