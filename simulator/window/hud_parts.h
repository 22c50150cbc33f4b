// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <imgui.h>

#include <string>

#include "window/player.h"

/// What the window's panels share.
namespace trephine::hud {

// Of the colours that are told apart with any kind of colour vision (Okabe and Ito).
inline const ImVec4 sky{0.34f, 0.71f, 0.91f, 1}, orange{0.90f, 0.62f, 0.00f, 1}, vermilion{0.84f, 0.37f, 0.00f, 1},
    grey{0.65f, 0.68f, 0.72f, 1};

/// A line of a panel: what it is, and its value.
void line(const char* what, const std::string& value, const ImVec4& colour = {1, 1, 1, 1});
/// A low button, with room for all of the letters. Returns whether it was pressed.
bool button(const char* label);
/// The same for what has a name (translated_name).
bool name_button(Language language, const std::string& name);
/// The next button follows on the line where its label has room there.
void flow_on(const std::string& label);
/// The tools that may be taken, so many a line.
void tool_buttons(Language language, Player& player, int a_line);

}  // namespace trephine::hud
