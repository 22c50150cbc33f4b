// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <set>
#include <vector>

#include "window/actions.h"
#include "window/glfw_window.h"

namespace trephine::window {

/// Mouse and keyboard: the actions whose keys they are.
class Controls {
 public:
  /// `panel_has_mouse`, `panel_has_keys`: what is pressed now is for a panel of the window.
  void apply(const std::vector<InputEvent>& events, Player& player, Screen& screen, bool panel_has_mouse,
             bool panel_has_keys);
  /// What keys do for as long as they are down. `wall_s`: since the last call.
  void hold(double wall_s, Player& player, Screen& screen);

 private:
  void press(int key, Player& player, Screen& screen);
  bool acts(const KeyUse& use);  ///< with what is held beside its key
  void release(int key, Player& player, Screen& screen);
  void drag(int part, double x, double y, Player& player, const Screen& screen);
  std::set<int> down_;  // keys, and parts of the mouse
  std::map<int, double> down_since_s_;
  std::map<int, KeyUse::With> down_with_;  // as it was pressed: Shift may be released first
  bool cursor_known_ = false;
  double held_s_ = 0, again_s_ = 0;
  std::map<const Action*, double> asked_s_;  // when a key that must be pressed twice was
};

}  // namespace trephine::window
