// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace trephine::dicom {

/// What becomes of a series in whose slices an attribute has different values.
enum class AttributeRule {
  own,      ///< nothing: each slice has its own value, or it says nothing of what a pixel means and where it lies
  told,     ///< it is warned of
  applied,  ///< each slice is read by its own value, and it is warned of
  parted,   ///< slices of another value are left out or are a series of their own, which is told
  equal,    ///< the series is refused: the slices cannot be read alike
  fixed,    ///< each slice by itself is refused that says anything else than what is read
};

/// An attribute of DICOM part 3 that says what pixels mean, where they lie, or of whom and by what they were made.
struct Attribute {
  std::uint32_t tag;
  const char* keyword;
  const char* vr;
  const char* module;
  AttributeRule rule;
  const char* note;  ///< what happens beyond the rule; empty: nothing
};

/// All attributes of the modules CT Image (C.8.2.1), Image Pixel (C.7.6.3), General Image (C.7.6.1), Image Plane
/// (C.7.6.2) and Modality LUT (C.11.1) that a CT image can have, and those of General Series, General Equipment,
/// Frame of Reference and Patient Study on which the same depends. docs/reference/dicom.md holds this table (tested).
const std::vector<Attribute>& attributes();

/// The place in attributes(), or -1.
int find_attribute(std::uint32_t tag);

const char* to_text(AttributeRule rule);

/// A digest of a value that says whether two files say the same, in this process alone: it is salted anew in each. 0
/// stands for what is not said. Numbers are equal whose decimals mean the same; padding does not count.
std::uint64_t digest_of(std::string_view value, std::string_view vr);

/// The table as Markdown, as it stands in docs/reference/dicom.md.
std::string attributes_table();

}  // namespace trephine::dicom
