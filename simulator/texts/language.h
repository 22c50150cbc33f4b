// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

namespace trephine::texts {

/// The languages in which the simulator speaks to its user. A further one is a further column of each Wording.
enum class Language { english, german };
constexpr int language_count = 2;

/// What is said, in each language.
struct Wording {
  const char* in[language_count] = {};
  constexpr const char* of(Language language) const { return in[std::size_t(language)]; }
};

}  // namespace trephine::texts
