// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "window/actions.h"

namespace trephine::window {

/// What actions of actions.cpp do that is more than a call; of the remote's words. They throw as Words does.
Reply command(Player& p, Words& w);
Reply move_arm(Player& p, Words& w);
Reply pause(Player& p, Words& w);
Reply opacity(Player& p, Words& w);
Reply zoom(Player& p, Words& w);
Reply cast_volume(Player& p, Words& w);
/// What of the case can be cast, as words of the action; empty where nothing is.
std::vector<std::string> cast_choices(const Player& p);
/// Those that show HU, by a transfer function.
std::vector<std::string> hu_choices(const Player& p);
Reply notes(Player& p, Screen& s, Words& w);

}  // namespace trephine::window
