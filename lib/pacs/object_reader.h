// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Reading of elements, for the sources of this room that read objects.
#include <string>
#include <vector>

#include "dicom/elements.h"
#include "pacs/label_objects.h"

namespace trephine::pacs {

/// No place of a patient lies farther from the frame's origin.
constexpr double farthest_mm = 1e6;
/// A label has one byte.
constexpr std::size_t most_segments = 255;
constexpr std::size_t most_planes = 10000;

/// Throws Error 65.
[[noreturn]] void refuse(const std::string& field, const std::string& what);

/// The value of an element of at most 64 MB, and what it says. They throw Error 65 naming the tag.
std::string text_of(dicom::ByteSource& source, const dicom::Element& e);
std::vector<double> numbers_of(dicom::ByteSource& source, const dicom::Element& e);
int word_of(dicom::ByteSource& source, const dicom::Element& e);
Vec3 vector_of(const std::vector<double>& v, std::size_t at, std::uint32_t tag);

/// What follows the file meta information.
struct DataSet {
  std::uint64_t begin = 0;
  bool explicit_vr = true;
};
DataSet data_set_of(dicom::ByteSource& source);

/// A shape between two slices that both have pixels, at parts of the distance from the lower to the upper one: the
/// linear interpolation of their signed distances [Raya1990]. Empty where nothing of it is left.
std::vector<std::string> bits_between(const std::string& lower, const std::string& upper,
                                      const std::vector<double>& parts, const SliceSet& slices);

LabelObject segmentation_of(dicom::ByteSource& source, const DataSet& set);
LabelObject structure_set_of(dicom::ByteSource& source, const DataSet& set);

}  // namespace trephine::pacs
