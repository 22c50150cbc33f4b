// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "haptics/frame.h"
#include "scene/bone_dust.h"
#include "scene/fluid.h"
#include "window/case_view.h"
#include "window/lesson_controller.h"

namespace trephine::window {

/// How a lesson is seen: the tool in hand, in green where it succeeded and in red where it failed, with what is in it;
/// the room with the tools that are not in the hand; the field in the light of a theatre; and what flows.
class Theatre {
 public:
  /// The lesson must outlive it.
  explicit Theatre(const LessonController& lesson) : lesson_(lesson) {}
  /// All of it.
  void show(CaseView& view);
  /// After these frames: what changed.
  void follow(const std::vector<haptics::ServoFrame>& frames, CaseView& view);
  /// What bleeds in the open since a critical error.
  std::vector<scene::Bleeding> bleedings() const;

 private:
  struct ToolLook {
    std::string tool;
    int verdict = 0;
    std::optional<std::array<float, 3>> inside_rgb;
    bool operator==(const ToolLook& o) const {
      return tool == o.tool && verdict == o.verdict && inside_rgb == o.inside_rgb;
    }
  };
  ToolLook look() const;
  void show_tool(CaseView& view);
  void show_room(CaseView& view) const;
  void show_field(CaseView& view);

  const LessonController& lesson_;
  ToolLook shown_;
  double tail_mm_ = 0;  // of the tool that is shown, from its tip
  scene::CsfDrain drain_;
  double run_ml_ = 0;  // what came out of the tool since an error
};

}  // namespace trephine::window
