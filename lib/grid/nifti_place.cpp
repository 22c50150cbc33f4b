// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/nifti_place.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/text.h"

namespace trephine::grid::detail {
namespace {

constexpr std::string_view mark = "trephine-place ";
constexpr std::size_t before_text = 12;  ///< whether there are extensions, size, code
constexpr std::int32_t comment_code = 6;

}  // namespace

double meant(float stored) {
  char text[40];
  const auto digits_of = [&text](auto r) {
    return std::count_if(text, r.ptr, [](char c) { return c >= '0' && c <= '9'; });
  };
  const double exact = stored;
  if (!std::isfinite(exact) || digits_of(std::to_chars(text, text + sizeof text, exact)) <= 12) return exact;
  double decimal = exact;
  std::from_chars(text, std::to_chars(text, text + sizeof text, stored).ptr, decimal);
  return decimal;
}

std::array<std::array<float, 4>, 3> sform_of(const Lattice& l) {
  std::array<std::array<float, 4>, 3> rows{};
  for (int row = 0; row < 3; ++row) {
    const auto r = static_cast<std::size_t>(row);
    const auto ras = [&](double v) { return row < 2 ? 0 - v : v; };
    for (std::size_t a = 0; a < 3; ++a)
      rows[r][a] = float(ras(l.direction.column[a][row]) * l.spacing_mm[static_cast<int>(a)]);
    rows[r][3] = float(ras(l.origin_mm[row]));
  }
  return rows;
}

std::string place_extension(const Lattice& l) {
  std::string text(mark);
  const auto add = [&](Vec3 v) {
    for (int a = 0; a < 3; ++a) text += to_text(v[a]) + " ";
  };
  add(l.spacing_mm);
  add(l.origin_mm);
  for (const Vec3& c : l.direction.column) add(c);
  // The size counts itself and the code, and is a multiple of 16.
  const std::size_t size = (8 + text.size() + 15) / 16 * 16;
  std::string bytes(4 + size, '\0');
  bytes[0] = 1;
  const auto stated = static_cast<std::int32_t>(size);
  std::memcpy(bytes.data() + 4, &stated, 4);
  std::memcpy(bytes.data() + 8, &comment_code, 4);
  std::memcpy(bytes.data() + before_text, text.data(), text.size());
  return bytes;
}

void take_place_extension(std::string_view bytes, const std::array<std::array<float, 4>, 3>& sform, Lattice& lattice) {
  if (bytes.size() < before_text + mark.size() || bytes[0] == 0 || bytes.substr(before_text, mark.size()) != mark)
    return;
  std::vector<double> numbers;
  const std::string_view text = bytes.substr(before_text + mark.size());
  for (const std::string& word : split_at(text.substr(0, text.find('\0')), ' '))
    if (const auto number = parse_number(word)) numbers.push_back(*number);
  if (numbers.size() != 15) return;
  Lattice said = lattice;
  for (int a = 0; a < 3; ++a) {
    said.spacing_mm[a] = numbers[static_cast<std::size_t>(a)];
    said.origin_mm[a] = numbers[static_cast<std::size_t>(3 + a)];
    for (int b = 0; b < 3; ++b) said.direction.column[a][b] = numbers[static_cast<std::size_t>(6 + 3 * a + b)];
    if (!(said.spacing_mm[a] > 0) || !(std::fabs(norm(said.direction.column[a]) - 1) < 1e-9)) return;
  }
  if (sform_of(said) == sform) lattice = said;
}

}  // namespace trephine::grid::detail
