// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/stage.h"
#include "session/moving_target.h"
#include "session/session.h"
#include "texts/note.h"

namespace trephine::window {

/// Where the cursor is, and how large the picture, in pixels from the upper left corner.
struct Cursor {
  double x = 0, y = 0;
  int width = 0, height = 0;
};

/// A patient on stage and the camera before it: what is shown, what is under the cursor, and what is measured at the
/// tool. It knows neither who moves the tool nor whether that is now. In the thread of the OpenGL context.
class CaseView {
 public:
  /// Makes the scene in the current context; throws as Stage does.
  CaseView(std::shared_ptr<session::Patient> patient, const scene::ViewParams& params);

  texts::Answer set_view(const std::string& preset);
  /// Panels leave that part of the picture free, from the left edge on. In a lesson whose surgeon stands before a back
  /// or a chest, what is looked at lies in its middle and fits into it.
  void set_room(double from_px, double to_px, int width, int height);
  texts::Answer set_opacity(const std::string& anatomy, double opacity);
  texts::Answer cut(const std::string& how);  ///< none, tool, axial, coronal, sagittal: at the tip
  void move_cut(double mm);
  /// Cuts along a tool at that place, and looks at the cut from where the camera stood, or from beside it: the tool is
  /// seen in its whole length, its tail above.
  void cut_along(Vec3 tip_mm, Vec3 axis);
  void show_places(bool shown);
  void show_slices(bool shown);
  void trace(bool on);
  bool traces() const { return traces_; }

  /// A target that a hand follows from now on; null: none.
  /// The surgeon of a session with a target stands over where it sets off.
  void show_target(std::shared_ptr<const session::MovingTarget> target);
  /// How far the tip is behind it along its path, mm; none where it does not run.
  std::optional<double> behind_mm() const;
  /// Tool, hand and contact as they are in that frame, and the other hand (Stage::show_frame).
  void look_at(const haptics::ServoFrame& frame, const haptics::RecordedSecondHand* held = nullptr,
               const haptics::ServoFrame* second = nullptr);
  /// Makes the scene follow what was cut, and measures at the tool.
  void follow();
  const haptics::ServoFrame& frame() const { return frame_; }

  scene::EyeView eye(const Cursor& cursor) const {
    return camera.eye(cursor.width, cursor.height, stage_.scene().bounds);
  }
  contact::Contact seen(const Cursor& cursor) const;
  std::string under(const Cursor& cursor) const;  ///< "skull, 12.3 ...", or an empty text

  scene::OrbitCamera camera;
  std::optional<Vec3> open_field_mm;  ///< the middle of a lesson's field that is open: there its surgeon stands
  std::optional<Vec3> stands_from;    ///< from where a lesson's surgeon sees the patient; none: as case or field say
  Vec3 middle_mm() const { return (stage_.scene().bounds.min_mm + stage_.scene().bounds.max_mm) / 2; }
  render::Stage& stage() { return stage_; }
  const render::Stage& stage() const { return stage_; }
  const session::Patient& patient() const { return *patient_; }
  const cases::CaseManifest& manifest() const { return patient_->felt.loaded.manifest; }
  const std::string& shape_name(int number) const;
  const cases::CaseTarget* nearest_target(Vec3 to_mm) const;  ///< null where the case has none
  double depth_mm() const { return depth_mm_; }    ///< of the tip behind the first surface along the tool; 0 in air
  double target_mm() const { return target_mm_; }  ///< to the nearest target; negative where there is none
  double trace_mm() const { return trace_mm_; }
  const std::deque<float>& forces() const { return forces_; }  ///< N, one a picture

 private:
  contact::TouchableFaces visible_faces() const;

  std::shared_ptr<session::Patient> patient_;
  render::Stage stage_;
  std::map<int, std::string> shapes_;
  std::shared_ptr<const session::MovingTarget> target_;
  haptics::ServoFrame frame_{};
  std::deque<float> forces_;
  double depth_mm_ = 0, target_mm_ = -1, trace_mm_ = 0, trace_apart_mm_ = 1;
  double fit_ = 1;  ///< by which factor the eye stands back for the room
  bool traces_ = false;
  Vec3 last_trace_mm_;
};

}  // namespace trephine::window
