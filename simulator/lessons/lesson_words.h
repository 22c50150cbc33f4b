// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "texts/language.h"

namespace trephine::lessons {

/// Words of any lesson in that language, looked up by their English ones; those that are no lesson's are returned as
/// they are. A text of a lesson may have places {}: "{} of five errors" says "2 of five errors", and what stands in a
/// place is looked up too.
std::string lesson_words(texts::Language language, const std::string& english);

/// A tool of a lesson, for a reader: screw_5.5x40 is "screw 5.5 x 40 mm", or "Schraube 5.5 x 40 mm".
std::string tool_title(texts::Language language, const std::string& name);

/// The name of a figure or limit without its unit, for a reader: kocher_off_mm is "kocher off", or "Abstand zu Kocher".
std::string figure_title(texts::Language language, const std::string& name);
/// Its unit, for a reader: "mm", "°"; empty for a ratio or a count.
std::string figure_unit(const std::string& name);

}  // namespace trephine::lessons
