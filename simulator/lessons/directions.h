// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/vec3.h"
#include "texts/language.h"

namespace trephine::lessons {

/// What a participant should do otherwise next time, as a sentence in each language of texts/language.h.
struct Advice {
  std::string row;  ///< the row of the score that it explains
  std::string in[texts::language_count];
  const std::string& of(texts::Language language) const { return in[std::size_t(language)]; }
};

/// Directions as a surgeon says them. Unit vectors in LPS, at right angles; `lateral` points away from the midline on
/// the side that is treated.
struct BodyAxes {
  Vec3 lateral, anterior, cranial;
};
/// Of a body whose left and front are given; neither needs to be exact, `left` is kept. They must not be parallel.
BodyAxes body_axes(bool treated_on_left, Vec3 left, Vec3 anterior);

/// A part of a way along one axis of the body, in the way's unit.
struct NamedPart {
  enum Name { lateral, medial, anterior, posterior, cranial, caudal };
  Name name = lateral;
  double size = 0;
};
/// The two largest parts of a way, the larger first. A part of less than a third of the larger one, or below `least`,
/// is left out.
std::vector<NamedPart> parts_of(const BodyAxes& axes, Vec3 way, double least = 1);
/// The same across a line, by the two axes that lie most across it: the parts are of the plane at right angles to it.
std::vector<NamedPart> parts_across(const BodyAxes& axes, Vec3 line, Vec3 way, double least = 1);
/// The same parts the other way.
std::vector<NamedPart> opposite(std::vector<NamedPart> parts);
/// By how many degrees a line must be turned to meet what it passes by these mm after that length. Turns of less than
/// a degree are left out.
std::vector<NamedPart> as_turns(std::vector<NamedPart> parts_mm, double length_mm);

/// "4 degrees more medially and 2 degrees more anteriorly", "4 Grad weiter nach medial ..."; `unit` is mm or degrees.
enum class PartUnit { mm, degrees };
std::string more_words(const std::vector<NamedPart>& parts, PartUnit unit, texts::Language language);
/// "9 mm lateral and 3 mm posterior", "9 mm lateral und 3 mm posterior".
std::string place_words(const std::vector<NamedPart>& parts_mm, texts::Language language);

/// An advice whose sentences have {} where `more` and then `place` are said.
Advice advice_of(const std::string& row, const std::vector<NamedPart>& more, PartUnit unit,
                 const std::vector<NamedPart>& place_mm, const texts::Wording& sentence);

}  // namespace trephine::lessons
