// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cases/load_case.h"
#include "scene/camera.h"

namespace trephine::scene {

/// A vertex of a surface: mm from the scene's centre, and a unit normal of 1/127.
struct SceneVertex {
  float position_mm[3];
  std::int8_t normal[4];
};

/// One anatomy as it is drawn.
struct SceneSurface {
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB
  double opacity = 1;                               ///< the case's
  int shape = 0;                                    ///< its shape in the haptic volume; 0: none
  bool live = false;  ///< drawn from the haptic volume (LiveSurface), so that it can be drilled; then no vertices
  /// Only an incision cuts it: drawn from its file, without what lies within the incisions.
  bool incised = false;
  bool skin = false;  ///< drapes lie on it, and it is dry; also where nothing can cut it
  std::vector<SceneVertex> vertices;
  std::vector<std::uint32_t> indices;
};

/// What is drawn of a case, as plain data: outermost surfaces first, by the volume of their boxes.
struct SceneData {
  Vec3 centre_mm;
  surface::Bounds bounds;  ///< world, of all that is drawn
  std::vector<SceneSurface> surfaces;
  int find(const std::string& name) const;  ///< -1 where there is none
};

SceneData scene_of(const cases::LoadedCase& loaded);

/// A place of the case at which a procedure begins, and the unit direction into the patient there: of the burr hole or
/// landmark of that name. A landmark's direction leads to the target of the same side where there is one (the target
/// whose name ends alike, else the nearest), else to the scene's centre. None where the case has no such place.
struct Approach {
  Vec3 site_mm, direction;
};
std::optional<Approach> approach_of(const cases::CaseManifest& manifest, const SceneData& scene,
                                    const std::string& site);

/// Removes everything where dot(normal, p - point) > 0.
struct CutPlane {
  Vec3 point_mm, normal{0, 0, 1};
};
struct CutBall {
  Vec3 centre_mm;
  double radius_mm = 0;
};
struct Marker {
  Vec3 position_mm;
  double radius_mm = 1.5;
  std::array<float, 3> colour_rgb{1, 0.8f, 0.1f};
};
/// A slice of the CT as a plane in the scene: axis 0 sagittal, 1 coronal, 2 axial, through the point.
struct CtPlane {
  int axis = 2;
  Vec3 point_mm;
};

/// A field of operation: a lamp over it, drapes around it, and what is wet or bleeds looks so.
struct TheatreField {
  Vec3 centre_mm;
  double open_mm = 0;    ///< radius of the drape's opening; 0: nothing is draped yet
  double lamp_mm = 130;  ///< radius of the lamp's light
};

class BoneDust;
struct Room;

/// What changes from picture to picture.
struct SceneState {
  std::vector<double> opacity;  ///< by surface; 0: not drawn
  std::optional<CutPlane> cut;
  std::optional<surface::Bounds> cast_box;  ///< nothing of a volume that is cast is seen beyond it; world
  bool cut_shows_ct = true;  ///< where the case has a CT; else, and where false, the cut has the surface's colour
  bool tool_shown = false;
  Vec3 tip_mm, axis{0, 0, 1};  ///< of the tool: the proxy's
  bool second_shown = false;
  Vec3 second_tip_mm, second_axis{0, 0, 1};  ///< of the other hand's tool
  std::optional<Vec3> device_mm;             ///< where the hand is, if that is to be shown too
  std::optional<Vec3> contact_mm;            ///< lit up
  double contact_strength = 0;               ///< 0 to 1
  std::vector<Marker> markers;               ///< landmarks, targets
  std::vector<Marker> moving;                ///< a target that a hand follows, and where it began
  std::vector<Vec3> ghost_mm;                ///< the way that somebody else went
  bool insets = false;                       ///< three slices of the CT through the tip, in a corner
  std::vector<Vec3> trace_mm;                ///< a line
  std::vector<Vec3> ink_mm;                  ///< what a marker drew, as dots that touch
  std::optional<TheatreField> theatre;
  std::shared_ptr<const Room> room;      ///< stands about the patient in a theatre, but for where it is cut; null: none
  std::vector<Marker> drops;             ///< of a fluid that comes out of the tool
  std::shared_ptr<const BoneDust> dust;  ///< null: none is shown
  std::vector<CtPlane> ct_planes;
  double ct_low_hu = -160, ct_high_hu = 240;
};

}  // namespace trephine::scene
