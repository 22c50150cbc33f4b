// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "texts/language.h"

namespace trephine::group {

/// A note of the results' folder ("NAME: the recording is gone; ..."), as a reader of that language reads it. What
/// stands in no table, such as the words of an error, stays as it is.
std::string note_words(texts::Language language, const std::string& english);

/// The words of a plot's caption, or of the texts within an SVG, in that language. Names of levels stay.
std::string caption_words(texts::Language language, const std::string& english);
std::string plot_words(texts::Language language, const std::string& svg);

}  // namespace trephine::group
