// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "texts/language.h"

namespace trephine::lessons {

/// What a lesson says, in each language of texts/language.h, English first. Steps, why and sign, labels and values are
/// looked up by their English words (lesson_words); words that the window knows for every lesson ("Passes") stand
/// there. So are the rows' titles and reasons, critical errors, and what outcome() and headline() say.
struct LessonText {
  std::string in[texts::language_count];
  const std::string& of(texts::Language language) const { return in[std::size_t(language)]; }
};

}  // namespace trephine::lessons
