// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged copies of a DICOM file, the same for the same number on every machine.
#pragma once
#include <cstdint>
#include <string>

#include "base/splitmix64.h"
#include "dicom_synthetic.h"

namespace synthetic {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * trephine::splitmix64_step + 1) {}
  /// 0 to below - 1.
  std::size_t roll(std::size_t below) {
    return static_cast<std::size_t>(trephine::splitmix64_mixed(state_ += trephine::splitmix64_step) % below);
  }

 private:
  std::uint64_t state_;
};

/// One to three changes of: bits, bytes, lengths, tags, decimal strings, pieces cut, doubled or moved, the end. Most
/// hit the header (what lies before `pixels_at`).
inline std::string mutant_of(const std::string& seed, std::size_t pixels_at, std::uint64_t number) {
  static const char* const texts[] = {"0",
                                      "nan",
                                      "inf",
                                      "-1",
                                      "abc",
                                      "1e10",
                                      "1e-9",
                                      "-0",
                                      "",
                                      "1\\",
                                      "0\\0",
                                      "1,5",
                                      "CT",
                                      "MR",
                                      "1\\0\\0\\0\\1\\0",
                                      "0\\0\\0\\0\\0\\0",
                                      "65536",
                                      "-2147483648",
                                      "1.2.3"};
  Dice dice(number);
  std::string b = seed;
  for (std::size_t hits = 1 + dice.roll(2) * dice.roll(3); hits > 0 && b.size() > 200; --hits) {
    const std::size_t head = std::min(pixels_at + 16, b.size());
    const std::size_t at = dice.roll(8) == 0 ? dice.roll(b.size()) : 128 + dice.roll(head - 128);
    switch (dice.roll(12)) {
      case 0:
      case 1:
        b[at] = static_cast<char>(b[at] ^ (1 << dice.roll(8)));
        break;
      case 2:
        b[at] = static_cast<char>(dice.roll(256));
        break;
      case 3:
        b[at] = dice.roll(2) ? '\xff' : '\0';
        break;
      case 4:  // numbers of 2 and 4 bytes at their limits
        for (std::size_t i = 0, n = dice.roll(2) ? 4 : 2, v = dice.roll(3); i < n && at + i < b.size(); ++i)
          b[at + i] = v == 0 ? '\xff' : v == 1 ? '\0' : i + 1 == n ? '\x7f' : '\xff';
        break;
      case 5:
      case 6:
      case 7: {  // a text value, its element's length kept: the next decimal digit begins it
        std::size_t p = b.find_first_of("0123456789", at);
        if (p == std::string::npos || p >= head) break;
        const std::string text = texts[dice.roll(std::size(texts))];
        const std::size_t room = b.find_first_not_of("0123456789.+-eE\\ ", p);
        if (room == std::string::npos) break;
        for (std::size_t i = p; i < room; ++i) b[i] = i - p < text.size() ? text[i - p] : ' ';
        break;
      }
      case 8: {  // a digit for another: a value that is as good as the old one
        std::size_t p = b.find_first_of("0123456789", at);
        if (p != std::string::npos && p < head) b[p] = static_cast<char>('0' + dice.roll(10));
        break;
      }
      case 9: {  // a piece cut out, doubled, or moved
        const std::size_t n = std::min<std::size_t>(1 + dice.roll(64), b.size() - at), how = dice.roll(3);
        const std::string piece = b.substr(at, n);
        if (how != 1) b.erase(at, n);
        if (how == 1) b.insert(at, piece);
        if (how == 2) b.insert(128 + dice.roll(b.size() - 128), piece);
        break;
      }
      case 10:
        b.resize(dice.roll(4) == 0 ? dice.roll(b.size())
                                   : b.size() - 1 - dice.roll(std::min<std::size_t>(64, b.size() - 1)));
        break;
      default: {  // one tag made another that may matter
        static const std::uint32_t tags[] = {
            tag(0x28, 0x1052),   tag(0x28, 0x1053),   tag(0x28, 0x30),  tag(0x20, 0x32),  tag(0x20, 0x37),
            tag(0x28, 0x120),    tag(0x28, 0x8),      tag(0x28, 0x10),  tag(0x28, 0x103), tag(0xfffe, 0xe000),
            tag(0xfffe, 0xe00d), tag(0xfffe, 0xe0dd), tag(0x7fe0, 0x10)};
        const std::uint32_t t = tags[dice.roll(std::size(tags))];
        // At an element: group and element of a tag in the file, found by its group's low byte.
        const std::size_t p = b.find(std::string(1, "\x08\x18\x20\x28"[dice.roll(4)]) + '\0', at);
        if (p == std::string::npos || p + 4 > b.size()) break;
        b.replace(p, 4, little(t >> 16, 2) + little(t & 0xffff, 2));
      }
    }
  }
  return b;
}

}  // namespace synthetic
