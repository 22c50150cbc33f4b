// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace trephine::texts {

/// The languages in which the simulator speaks to its user. A further one is a further column of each Wording.
enum class Language { english, german };
constexpr int language_count = 2;

/// By the names that `--language` takes.
const std::vector<std::pair<std::string, Language>>& languages();

/// What is said, in each language.
struct Wording {
  const char* in[language_count] = {};
  constexpr const char* of(Language language) const { return in[std::size_t(language)]; }
};

}  // namespace trephine::texts
