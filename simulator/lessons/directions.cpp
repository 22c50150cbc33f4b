// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/directions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/joined.h"

namespace trephine::lessons {
namespace {

using texts::Language;
using texts::Wording;

// In the order of NamedPart::Name.
constexpr Wording more_of[] = {
    {{"more laterally", "weiter nach lateral"}},   {{"more medially", "weiter nach medial"}},
    {{"more anteriorly", "weiter nach anterior"}}, {{"more posteriorly", "weiter nach posterior"}},
    {{"more cranially", "weiter nach kranial"}},   {{"more caudally", "weiter nach kaudal"}}};
constexpr Wording place_of[] = {{{"lateral", "lateral"}},     {{"medial", "medial"}},   {{"anterior", "anterior"}},
                                {{"posterior", "posterior"}}, {{"cranial", "kranial"}}, {{"caudal", "kaudal"}}};
constexpr Wording and_word{{" and ", " und "}}, degrees_word{{"degrees", "Grad"}}, degree_word{{"degree", "Grad"}};

struct Axis {
  NamedPart::Name plus, minus;
  Vec3 way;
};
NamedPart part_along(const Axis& axis, Vec3 way) {
  const double size = dot(axis.way, way);
  return {size < 0 ? axis.minus : axis.plus, std::abs(size)};
}

std::vector<Axis> axes_of(const BodyAxes& b) {
  return {{NamedPart::lateral, NamedPart::medial, b.lateral},
          {NamedPart::anterior, NamedPart::posterior, b.anterior},
          {NamedPart::cranial, NamedPart::caudal, b.cranial}};
}

std::vector<NamedPart> largest(std::vector<NamedPart> parts, double least) {
  constexpr double min_share = 1.0 / 3;
  std::stable_sort(parts.begin(), parts.end(), [](const NamedPart& a, const NamedPart& b) { return a.size > b.size; });
  if (parts.size() > 2) parts.resize(2);
  const double most = parts.empty() ? 0 : parts.front().size;
  parts.erase(std::remove_if(parts.begin(), parts.end(),
                             [&](const NamedPart& p) { return p.size < least || p.size < min_share * most; }),
              parts.end());
  return parts;
}

template <class F>
std::string listed(const std::vector<NamedPart>& parts, Language language, F words) {
  return joined(parts, and_word.of(language), words);
}

}  // namespace

BodyAxes body_axes(bool treated_on_left, Vec3 left, Vec3 anterior) {
  left = normalized(left);
  anterior = normalized(anterior - left * dot(anterior, left));
  return {treated_on_left ? left : -left, anterior, cross(anterior, left)};
}

std::vector<NamedPart> parts_of(const BodyAxes& axes, Vec3 way, double least) {
  std::vector<NamedPart> parts;
  for (const Axis& a : axes_of(axes)) parts.push_back(part_along(a, way));
  return largest(parts, least);
}

std::vector<NamedPart> parts_across(const BodyAxes& axes, Vec3 line, Vec3 way, double least) {
  line = normalized(line);
  std::vector<Axis> across = axes_of(axes);
  std::stable_sort(across.begin(), across.end(), [&](const Axis& a, const Axis& b) {
    return std::abs(dot(a.way, line)) < std::abs(dot(b.way, line));
  });
  Axis first = across[0], second = across[1];
  first.way = normalized(first.way - line * dot(first.way, line));
  const Vec3 other = cross(line, first.way);
  second.way = dot(other, second.way) < 0 ? -other : other;
  return largest({part_along(first, way), part_along(second, way)}, least);
}

std::vector<NamedPart> opposite(std::vector<NamedPart> parts) {
  for (NamedPart& p : parts) p.name = NamedPart::Name(int(p.name) ^ 1);
  return parts;
}

std::vector<NamedPart> as_turns(std::vector<NamedPart> parts, double length_mm) {
  constexpr double min_deg = 1;
  for (NamedPart& p : parts) p.size = std::atan2(p.size, length_mm) * 180 / M_PI;
  parts.erase(std::remove_if(parts.begin(), parts.end(), [](const NamedPart& p) { return p.size < min_deg; }),
              parts.end());
  return parts;
}

std::string more_words(const std::vector<NamedPart>& parts, PartUnit unit, Language language) {
  return listed(parts, language, [&](const NamedPart& p) {
    const double size = std::max(1.0, std::round(p.size));
    const char* said = unit == PartUnit::mm ? "mm" : (size == 1 ? degree_word : degrees_word).of(language);
    return fmt::format("{:.0f} {} {}", size, said, more_of[p.name].of(language));
  });
}

std::string place_words(const std::vector<NamedPart>& parts, Language language) {
  return listed(parts, language, [&](const NamedPart& p) {
    return fmt::format("{:.0f} mm {}", std::max(1.0, std::round(p.size)), place_of[p.name].of(language));
  });
}

Advice advice_of(const std::string& row, const std::vector<NamedPart>& more, PartUnit unit,
                 const std::vector<NamedPart>& place_mm, const Wording& sentence) {
  Advice a{row, {}};
  for (const Language language : {Language::english, Language::german})
    a.in[std::size_t(language)] = fmt::format(fmt::runtime(sentence.of(language)), more_words(more, unit, language),
                                              place_words(place_mm, language));
  return a;
}

}  // namespace trephine::lessons
