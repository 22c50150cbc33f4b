// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <type_traits>
#include <vector>

#include "window/actions.h"

namespace trephine::window {

/// What is done with the player and the words.
template <class F>
std::function<Reply(Player&, Screen&, Words&)> does(F what) {
  return [what](Player& p, Screen&, Words& w) {
    if constexpr (std::is_void_v<decltype(what(p, w))>) {
      what(p, w);
      return Reply();
    } else {
      return Reply(what(p, w));
    }
  };
}
/// The entries of a group, and the one that is made.
class Entries {
 public:
  Entries(std::vector<Action>& all, Action::Group group) : all_(all), group_(group) {}
  void add(const char* name, const char* arguments, texts::Wording what, texts::Answer (*enabled)(const Player&) = {}) {
    Action& a = all_.emplace_back();
    a.name = name;
    a.arguments = arguments;
    a.what = what;
    a.enabled = enabled;
    a.group = group_;
  }
  Action* operator->() { return &all_.back(); }

 private:
  std::vector<Action>& all_;
  Action::Group group_;
};

/// Of the transfer function by which rays see a volume.
void transfer_actions(Entries e);

}  // namespace trephine::window
