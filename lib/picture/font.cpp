// SPDX-License-Identifier: GPL-3.0-or-later
// A stroke font, drawn for this program. A point is two digits, x then y (0 to 9, a to g); y runs down, and a capital
// is twelve units high. Lines are separated by '/'. A line that begins with '~' is a quadratic B-spline of its points,
// which is closed where it ends at its beginning.
#include <map>
#include <string>

#include "picture/stroke.h"

namespace trephine::picture::detail {
namespace {

constexpr double units = 12;

const std::map<char, const char*>& shapes() {
  static const std::map<char, const char*> table = {{'A', "0c 40 8c/19 79"},
                                                    {'B', "00 0c/~00 40 70 76 46 06/~06 46 86 8c 4c 0c"},
                                                    {'C', "~83 80 00 0c 8c 89"},
                                                    {'D', "00 0c/~00 40 80 8c 4c 0c"},
                                                    {'E', "70 00 0c 7c/06 56"},
                                                    {'F', "70 00 0c/06 56"},
                                                    {'G', "~83 80 00 0c 8c 87/87 57"},
                                                    {'H', "00 0c/80 8c/06 86"},
                                                    {'I', "00 40/20 2c/0c 4c"},
                                                    {'J', "~60 66 6c 0c 09"},
                                                    {'K', "00 0c/80 07/34 8c"},
                                                    {'L', "00 0c 7c"},
                                                    {'M', "0c 00 57 a0 ac"},
                                                    {'N', "0c 00 8c 80"},
                                                    {'O', "~40 80 8c 0c 00 40"},
                                                    {'P', "00 0c/~00 40 80 87 47 07"},
                                                    {'Q', "~40 80 8c 0c 00 40/59 8c"},
                                                    {'R', "00 0c/~00 40 80 87 47 07/47 8c"},
                                                    {'S', "~83 80 00 06 86 8c 0c 09"},
                                                    {'T', "00 80/40 4c"},
                                                    {'U', "~00 06 0c 8c 86 80"},
                                                    {'V', "00 4c 80"},
                                                    {'W', "00 3c 54 7c a0"},
                                                    {'X', "00 8c/80 0c"},
                                                    {'Y', "00 46 80/46 4c"},
                                                    {'Z', "00 80 0c 8c"},
                                                    {'0', "~40 70 7c 1c 10 40"},
                                                    {'1', "13 40 4c/1c 7c"},
                                                    {'2', "~13 10 80 85 1c/1c 8c"},
                                                    {'3', "~12 10 80 86 46/~46 86 8c 0c 0a"},
                                                    {'4', "6c 60 09 89"},
                                                    {'5', "70 20 15/~15 84 8c 0c 0a"},
                                                    {'6', "~71 00 0c 8c 86 06 09"},
                                                    {'7', "00 80 3c"},
                                                    {'8', "~40 70 76 16 10 40/~46 86 8c 0c 06 46"},
                                                    {'9', "~1b 8c 80 00 06 86 83"},
                                                    {'a', "74 7c/~44 74 7c 0c 04 44"},
                                                    {'b', "00 0c/~44 74 7c 0c 04 44"},
                                                    {'c', "~66 64 04 0c 6c 6a"},
                                                    {'d', "70 7c/~44 74 7c 0c 04 44"},
                                                    {'e', "08 78/~78 74 04 0c 7c 7a"},
                                                    {'f', "~50 20 23 2c/04 54"},
                                                    {'g', "~44 74 7c 0c 04 44/~74 7c 7g 0g 0e"},
                                                    {'h', "00 0c/~08 04 74 78 7c"},
                                                    {'i', "14 1c/11 11"},
                                                    {'j', "~24 2c 2g 0g/21 21"},
                                                    {'k', "00 0c/64 09/27 6c"},
                                                    {'l', "10 1c"},
                                                    {'m', "04 0c/~08 04 54 58 5c/~58 54 a4 a8 ac"},
                                                    {'n', "04 0c/~08 04 74 78 7c"},
                                                    {'o', "~44 74 7c 0c 04 44"},
                                                    {'p', "04 0g/~44 74 7c 0c 04 44"},
                                                    {'q', "74 7g/~44 74 7c 0c 04 44"},
                                                    {'r', "04 0c/~08 04 54"},
                                                    {'s', "~66 64 04 08 68 6c 0c 0a"},
                                                    {'t', "~20 29 2c 5c/04 54"},
                                                    {'u', "~04 08 0c 7c 78 74/74 7c"},
                                                    {'v', "04 3c 64"},
                                                    {'w', "04 2c 46 6c 84"},
                                                    {'x', "04 6c/64 0c"},
                                                    {'y', "04 3c/64 3c 1g"},
                                                    {'z', "04 64 0c 6c"},
                                                    {' ', ""},
                                                    {'.', "1c 1c"},
                                                    {',', "1c 0e"},
                                                    {':', "15 15/1b 1b"},
                                                    {';', "15 15/1b 0d"},
                                                    {'-', "07 57"},
                                                    {'+', "07 67/34 3a"},
                                                    {'=', "05 65/09 69"},
                                                    {'_', "0d 8d"},
                                                    {'/', "0d 60"},
                                                    {'(', "~30 03 0b 3e"},
                                                    {')', "~00 33 3b 0e"},
                                                    {'[', "30 00 0e 3e"},
                                                    {']', "00 30 3e 0e"},
                                                    {'<', "64 08 6c"},
                                                    {'>', "04 68 0c"},
                                                    {'|', "10 1e"},
                                                    {'\'', "10 13"},
                                                    {'"', "00 03/30 33"},
                                                    {'!', "10 18/1c 1c"},
                                                    {'?', "~02 00 70 76 36 39/3c 3c"},
                                                    {'%', "~20 40 44 04 00 20/~88 a8 ac 6c 68 88/a0 0c"},
                                                    {'#', "20 1c/70 6c/04 94/08 88"},
                                                    {'*', "34 3a/05 69/65 09"},
                                                    {'^', "04 30 64"},
                                                    {'~', "~07 05 49 87 85"}};
  return table;
}

double digit(char c) { return (c >= 'a' ? c - 'a' + 10 : c - '0') / units; }

using Points = std::vector<std::array<double, 2>>;

// Corner cutting after [Chaikin1974].
Points smoothed(Points p) {
  const bool closed = p.front() == p.back();
  if (closed) p.pop_back();
  for (int round = 0; round < 4; ++round) {
    Points q;
    const std::size_t n = p.size();
    if (!closed) q.push_back(p.front());
    for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
      const auto &a = p[i], &b = p[(i + 1) % n];
      const auto mix = [&](double t) {
        return std::array<double, 2>{a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t};
      };
      // The ends of an open line are kept, because cutting them would only shorten the line.
      if (closed || i > 0) q.push_back(mix(0.25));
      if (closed || i + 2 < n) q.push_back(mix(0.75));
    }
    if (!closed) q.push_back(p.back());
    p = std::move(q);
  }
  if (closed) p.push_back(p.front());
  return p;
}

Glyph make_glyph(const std::string& shape) {
  Glyph g;
  double width = 0;
  std::size_t at = 0;
  while (at < shape.size()) {
    const std::size_t end = std::min(shape.find('/', at), shape.size());
    std::size_t i = at;
    const bool smooth = shape[i] == '~';
    i += smooth;
    Points points;
    for (; i + 1 < end; i += 3) points.push_back({digit(shape[i]), digit(shape[i + 1])});
    for (const auto& p : points) width = std::max(width, p[0]);
    g.lines.push_back({smooth ? smoothed(points) : points});
    at = end + 1;
  }
  g.advance = shape.empty() ? 5 / units : width + 3.2 / units;
  return g;
}

}  // namespace

const Glyph& glyph_of(unsigned char c) {
  static const auto glyphs = [] {
    std::map<unsigned char, Glyph> made;
    for (const auto& [character, shape] : shapes()) made[static_cast<unsigned char>(character)] = make_glyph(shape);
    return made;
  }();
  static const Glyph box = make_glyph("00 80 8c 0c 00");
  const auto found = glyphs.find(c);
  return found == glyphs.end() ? box : found->second;
}

}  // namespace trephine::picture::detail
