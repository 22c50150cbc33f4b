// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "texts/language.h"
#include "texts/phrase.h"

namespace trephine::lessons {

/// What a lesson says, in that language: the phrase and each of its values are looked up by their English words, and
/// those that are no lesson's are said as they are.
std::string lesson_words(texts::Language language, const texts::Phrase& phrase);

/// A tool of a lesson, for a reader: screw_5.5x40 is "screw 5.5 x 40 mm", or "Schraube 5.5 x 40 mm"; burr_diamond_3 is
/// "burr diamond 3 mm".
texts::Phrase tool_phrase(const std::string& name);
std::string tool_title(texts::Language language, const std::string& name);

/// The name of a figure or limit without its unit, for a reader: kocher_off_mm is "kocher off", or "Abstand zu Kocher".
std::string figure_title(texts::Language language, const std::string& name);
/// Its unit, for a reader: "mm", "°"; empty for a ratio or a count.
std::string figure_unit(const std::string& name);

}  // namespace trephine::lessons
