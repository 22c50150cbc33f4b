// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace trephine {

/// A PNG of 8 bits a channel, sRGB, without time, text or any chunk beyond what the pixels need. It is made from the
/// top, a few rows at a time, and never held whole. The same bytes for the same pixels.
class PngRows {
 public:
  /// `channels`: 4 (red, green, blue, alpha), 3 or 1 (grey). Throws Error 70, as add and take do, where the picture
  /// cannot be encoded.
  PngRows(int width, int height, int channels);
  ~PngRows();
  /// The next rows, row by row from the top, `channels` bytes a pixel.
  void add(const std::vector<std::uint8_t>& rows);
  /// The PNG; all its rows were added.
  std::string take();

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

/// The same of a whole picture.
std::string png_of(int width, int height, int channels, const std::vector<std::uint8_t>& rows);

}  // namespace trephine
