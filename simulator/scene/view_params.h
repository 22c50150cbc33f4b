// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/params.h"
#include "scene/scene.h"
#include "session/moving_target.h"

namespace trephine::scene {

/// How a case is looked at: the declared settings of a window and of pictures.
struct ViewParams {
  enum class Stereo { none, side_by_side, top_bottom, anaglyph, quad_buffer };
  enum class Cut { none, axial, coronal, sagittal };
  enum class Cast { none, ct, haptic };
  enum class SurfaceBy { measured, processor, graphics };
  ViewPreset view = ViewPreset::surgeon;
  std::string view_site = "kocher_right", opacity;
  double field_of_view_deg = 25;
  Stereo stereo = Stereo::none;
  double eye_distance_mm = 30, convergence_mm = 0;
  Cut cut = Cut::none;
  double cut_mm = 0;
  bool cut_ct = true, places = true, insets = false;
  double ct_low_hu = -160, ct_high_hu = 240;
  int samples = 0;
  bool occlusion = true, shadow = true, grain = true, dust = true;
  Cast cast = Cast::none;
  std::string transfer;
  std::array<double, 3> box_low_mm{-1000, -1000, -1000}, box_high_mm{1000, 1000, 1000};
  SurfaceBy surface_by = SurfaceBy::measured;
  double occlusion_mm = 20, coarse_mm = 0, graphics_budget_mb = 2048;
  template <class V>
  static void describe(V& v) {
    using P = ViewParams;
    v.choice(&P::view, "view", view_presets(),
             "From where the patient is seen. surgeon: at the site, along the way to the target.");
    v.text(&P::view_site, "view_site",
           "Landmark or burr hole of the surgeon's view; where the case has none of that name, the view is oblique.");
    v.text(&P::opacity, "opacity", "Opacities of anatomies from 0 (hidden) to 1, such as skin=0.3,brain=0.");
    v.number(&P::field_of_view_deg, "field_of_view_deg", Range{5, 90}, "Angle of view of the picture's shorter side.");
    v.choice(&P::stereo, "stereo",
             {{"none", Stereo::none},
              {"side_by_side", Stereo::side_by_side},
              {"top_bottom", Stereo::top_bottom},
              {"anaglyph", Stereo::anaglyph},
              {"quad_buffer", Stereo::quad_buffer}},
             "Two eyes: side by side, one above the other (left on top), red for the left and cyan for the right, or a "
             "buffer of the window for each, where the driver has them (else side by side).");
    v.number(&P::eye_distance_mm, "eye_distance_mm", Range{0, 200}, "Distance between the two eyes, in the scene.");
    v.number(&P::convergence_mm, "convergence_mm", Range{0, 5000},
             "Distance of the plane that both eyes see at the same place; 0: that of what is looked at.");
    v.choice(&P::cut, "cut",
             {{"none", Cut::none}, {"axial", Cut::axial}, {"coronal", Cut::coronal}, {"sagittal", Cut::sagittal}},
             "A plane before which everything is cut away: above, before, or to the patient's left of it.");
    v.number(&P::cut_mm, "cut_mm", Range{-1000, 1000}, "Where that plane lies, mm from the scene's middle.");
    v.flag(&P::cut_ct, "cut_ct", "Show the CT on the cut, where the case has one.");
    v.flag(&P::insets, "insets", "Show three slices of the CT through the tip in a corner, where the case has one.");
    v.flag(&P::places, "places", "Show landmarks and targets.");
    v.number(&P::ct_low_hu, "ct_low_hu", Range{-1024, 3000}, "HU shown as black.");
    v.number(&P::ct_high_hu, "ct_high_hu", Range{-1023, 4000}, "HU shown as white.");
    v.integer(&P::samples, "samples", Range{0, 16},
              "Samples a pixel for smooth edges; 0: 4, or 1 where the processor draws.");
    v.flag(&P::occlusion, "occlusion", "Darken creases and what lies close behind something.");
    v.number(&P::occlusion_mm, "occlusion_mm", Range{0.1, 100}, "Within that distance.");
    v.flag(&P::shadow, "shadow", "The tool casts its shadow: where it meets the tool, the tool touches.");
    v.choice(
        &P::surface_by, "surface_by",
        {{"measured", SurfaceBy::measured}, {"processor", SurfaceBy::processor}, {"graphics", SurfaceBy::graphics}},
        "Who makes the triangles of bone that is cut. measured: the faster one, measured at the start; the processor "
        "where it draws as well.");
    v.number(&P::graphics_budget_mb, "graphics_budget_mb", Range{16, 1e6},
             "Graphics memory that surfaces, CT and pictures may take, counted by the program. Where it is too little "
             "smooth edges, whole triangles, and the CT's resolution are left out, and it says so; 0: any.")
        .none_at_zero();
    v.number(
        &P::coarse_mm, "coarse_mm", Range{0, 20},
        "Where pictures take too long or the graphics memory does not suffice, surfaces are drawn with triangles of "
        "about that size, and the program says by how much they are off; 0: 0.5, 1, 1.5 or 2.5 mm, the finest that "
        "does.");
    v.choice(
        &P::cast, "cast", {{"none", Cast::none}, {"ct", Cast::ct}, {"haptic", Cast::haptic}},
        "Cast rays through a volume: the CT or a haptic volume of raw HU, as a transfer function shows it, or the "
        "shapes "
        "of another haptic volume, each where it is felt. Of the anatomies, only those are drawn then that `opacity` "
        "names; of a shape it says how opaque a layer of 1 mm is.");
    v.text(
        &P::transfer, "transfer",
        "What the rays see of HU: bone, skin or vessels, or points HU:OPACITY:RRGGBB with commas between them, such as "
        "150:0:e0c8a8,300:0.9:f0e8d0, or a file that the window's editor wrote, which ends in .yaml. Empty: what the "
        "case says of its haptic volume, and bone for the CT.");
    v.numbers(&P::box_low_mm, "box_low_mm", Range{-1000, 1000},
              "Of the volume, nothing is seen below these places along LPS, mm from the scene's middle.");
    v.numbers(&P::box_high_mm, "box_high_mm", Range{-1000, 1000}, "Nor above these.");
    v.flag(&P::dust, "dust", "Bone dust where a drill works, blood, and the saline that wets and washes them away.");
    v.flag(&P::grain, "grain", "A fine texture on what only an incision cuts.");
  }
  std::string fault() const {
    for (std::size_t a = 0; a < 3; ++a)
      if (!(box_low_mm[a] < box_high_mm[a])) return "box_high_mm: must be above box_low_mm along each axis";
    return ct_high_hu > ct_low_hu ? "" : "ct_high_hu: must be above ct_low_hu";
  }
};

/// One opacity for each surface: the case's own, and over them those of the text. Throws Error 64 where the text names
/// no anatomy of the scene, or a number is missing.
std::vector<double> opacities_of(const SceneData& scene, const std::string& text);
/// The same beside rays: what is not named is not drawn; where rays show shapes, each of these is opaque.
std::vector<double> opacities_beside_rays(const SceneData& scene, const std::string& text, bool of_shapes);
/// The box of the parameters; none where it holds all.
std::optional<surface::Bounds> cast_box_of(const ViewParams& params, const SceneData& scene);
/// The plane of the parameters; none where they want none.
std::optional<CutPlane> cut_of(const ViewParams& params, const SceneData& scene);
/// Landmarks (amber), burr holes (green) and targets (blue).
std::vector<Marker> places_of(const cases::CaseManifest& manifest);
/// A target that a hand follows (red), as it is at that time, and where it began (green); of none nothing.
std::vector<Marker> moving_of(const session::MovingTarget* target, double time_s);
OrbitCamera camera_of(const ViewParams& params, const cases::CaseManifest& manifest, const SceneData& scene);

}  // namespace trephine::scene
