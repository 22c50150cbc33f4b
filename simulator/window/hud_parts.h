// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <imgui.h>

#include <string>

#include "window/actions.h"

/// What the window's panels share.
namespace trephine::window::hud {

// Of the colours that are told apart with any kind of colour vision (Okabe and Ito).
inline const ImVec4 sky{0.34f, 0.71f, 0.91f, 1}, orange{0.90f, 0.62f, 0.00f, 1}, vermilion{0.84f, 0.37f, 0.00f, 1},
    grey{0.65f, 0.68f, 0.72f, 1}, white{1, 1, 1, 1};

/// A line of a panel: what it is, and its value.
void line(const char* what, const std::string& value, const ImVec4& colour = white);
/// A low button, with room for all of the letters. Returns whether it was pressed.
bool button(const char* label);
/// The next button follows on the line where its label has room there.
void flow_on(const std::string& label);
/// A button for an action, with its keys; one for each of its choices, of which one may be held.
void action_button(const char* name, Player& player, Screen& screen, bool flows);
void choice_buttons(const char* name, Player& player, Screen& screen, const std::string& held = "");
/// The same as a box that is ticked while it is on.
void action_box(const char* name, bool on, Player& player, Screen& screen);

}  // namespace trephine::window::hud
