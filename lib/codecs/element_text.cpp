// SPDX-License-Identifier: GPL-3.0-or-later
#include "codecs/element_text.h"

#include <charconv>
#include <cstdint>

#include "base/joined.h"

namespace trephine::codecs {

std::string decimal(double v) {
  if (v == 0) v = 0;  // no "-0"
  char text[64];
  for (int digits = 15; digits > 0; --digits) {
    const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, digits);
    if (end.ptr - text <= 16) return {text, end.ptr};
  }
  return "0";
}

std::string decimals(std::initializer_list<double> values) { return joined(values, "\\", decimal); }

std::string uid_of_hash(const std::string& hex) {
  std::uint8_t bytes[16];
  for (int i = 0; i < 16; ++i) std::from_chars(&hex[2 * i], &hex[2 * i] + 2, bytes[i], 16);
  bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0f) | 0x80);
  bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3f) | 0x80);
  std::string digits;
  bool zero = false;
  while (!zero) {  // long division by ten
    int rest = 0;
    zero = true;
    for (std::uint8_t& b : bytes) {
      rest = rest * 256 + b;
      b = static_cast<std::uint8_t>(rest / 10);
      rest %= 10;
      zero = zero && b == 0;
    }
    digits.insert(digits.begin(), static_cast<char>('0' + rest));
  }
  return "2.25." + digits;
}

}  // namespace trephine::codecs
