// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <vector>

#include "window/glfw_window.h"
#include "window/player.h"

namespace trephine {

/// Mouse and keyboard: what they do is listed in texts.cpp (keys_help) and docs/play.md.
class Controls {
 public:
  explicit Controls(const ScreenHandParams& params) : params_(params) {}
  /// `panel_has_mouse`, `panel_has_keys`: what is pressed now is for a panel of the window.
  void apply(const std::vector<InputEvent>& events, Player& player, int width, int height, bool panel_has_mouse,
             bool panel_has_keys);
  /// What keys do for as long as they are down.
  void hold(double wall_s, Player& player, int width, int height);

  bool panels_shown = true;
  double cursor_x = 0, cursor_y = 0;
  std::string said;  ///< the answer to the last key that could not do what it should

 private:
  void press(int key, int mods, Player& player, int width, int height);
  void move(double x, double y, Player& player, int width, int height);
  ScreenHandParams params_;
  std::set<int> keys_, buttons_;
  bool cursor_known_ = false;
  double finish_asked_s_ = -1, held_s_ = 0, arm_again_s_ = 0;
};

}  // namespace trephine
