// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

#include "texts/language.h"
#include "texts/phrase.h"

namespace trephine::group {

/// A word or pattern of the page; what stands in no table stays as it is (and must then end in a zero).
const char* group_word(texts::Language language, std::string_view english);
/// A note of the results' folder, or a word of a plot, as a reader of that language reads it. What stands in no table,
/// such as the words of an error or the name of a group, stays as it is.
std::string group_words(texts::Language language, const texts::Phrase& phrase);

}  // namespace trephine::group
