// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/srgb.h"
#include "codecs/element_text.h"
#include "pacs/anatomy_codes.h"
#include "pacs/object.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

Elements reference_to(const SliceSet& slices, std::size_t slice) {
  return Elements()
      .text(t_referenced_class, "UI", slices.class_uid)
      .text(t_referenced_uid, "UI", slices.images[slice].instance_uid);
}

Elements segment_item(const Segment& segment, int number) {
  const AnatomyCode& code = code_of(segment.name);
  const std::array<int, 3> lab = lab_of(segment.colour_rgb);
  Elements e;
  e.code(t_segment_category, any_anatomy_category.code, "SCT", any_anatomy_category.meaning)
      .words(t_segment_number, {number})
      .text(t_segment_label, "LO", segment.name)
      .text(t_segment_algorithm, "CS", "AUTOMATIC")
      .text(t_algorithm_name, "LO", "trephine")
      .words(t_segment_lab, {lab[0], lab[1], lab[2]})
      .code(t_segment_type, code.code, "SCT", code.meaning);
  return e;
}

Elements frame_item(const SliceSet& slices, std::size_t slice, int segment) {
  Elements e;
  if (!slices.images.empty()) {
    Elements source = reference_to(slices, slice);
    if (slices.images[slice].frame > 0)
      source.text(t_referenced_frame, "IS", std::to_string(slices.images[slice].frame));
    source.text(t_locations_preserved, "CS", "YES")
        .code(t_purpose, "121322", "DCM", "Source image for image processing operation");
    e.item(t_derivation_image,
           Elements().code(t_derivation_code, "113076", "DCM", "Segmentation").item(t_source_image, std::move(source)));
  }
  e.item(t_frame_content, Elements().longs(t_dimension_values, {std::uint32_t(segment), std::uint32_t(slice + 1)}))
      .item(t_plane_position, Elements().text(t_position, "DS", place_text(slices.origins_mm[slice])))
      .item(t_segment_identification, Elements().words(t_referenced_segment, {segment}));
  return e;
}

Elements shared_item(const SliceSet& slices) {
  Elements measures;
  measures.text(t_thickness, "DS", codecs::decimal(slices.thickness_mm))
      .text(t_spacing, "DS", codecs::decimals({slices.dy_mm, slices.dx_mm}));
  if (const double step = slices.uniform_step_mm(); step > 0) measures.text(t_step, "DS", codecs::decimal(step));
  Elements e;
  e.item(t_plane_orientation, Elements().text(t_orientation, "DS", vector_text(slices)))
      .item(t_pixel_measures, std::move(measures));
  return e;
}

void describe_dimensions(Elements& e, const CaseIdentity& identity) {
  const std::string uid = uid_of({"dimensions", identity.study_uid});
  const auto index = [&](std::uint32_t pointer, std::uint32_t group, const char* label) {
    return Elements()
        .text(t_organization_uid, "UI", uid)
        .tag(t_dimension_pointer, pointer)
        .tag(t_group_pointer, group)
        .text(t_dimension_label, "LO", label);
  };
  e.item(t_organization, Elements().text(t_organization_uid, "UI", uid))
      .sequence(t_dimension_index, {index(t_referenced_segment, t_segment_identification, "Segment"),
                                    index(t_position, t_plane_position, "Slice")});
}

// Frames follow each other without padding, also within a byte.
void append_bits(std::string& out, std::size_t& bits, const std::string& frame, std::size_t count) {
  const std::size_t shift = bits % 8;
  out.resize((bits + count + 7) / 8);
  char* to = out.data() + bits / 8;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const unsigned v = unsigned(static_cast<unsigned char>(frame[i])) << shift;
    to[i] = static_cast<char>(to[i] | (v & 0xff));
    if (v >> 8) to[i + 1] = static_cast<char>(v >> 8);
  }
  bits += count;
}

bool is_unused(const std::vector<Segment>& segments, std::size_t slice) {
  return std::all_of(segments.begin(), segments.end(), [&](const Segment& s) { return s.bits[slice].empty(); });
}

// From the first slice that any segment uses to behind the last. Unused ones between them get a frame without pixels,
// so that who reads the object knows that nothing lies there, whatever the distances of slices.
std::pair<std::size_t, std::size_t> used_slices(const std::vector<Segment>& segments) {
  std::size_t first = 0, end = segments.empty() ? 0 : segments.front().bits.size();
  while (first < end && is_unused(segments, first)) ++first;
  while (end > first && is_unused(segments, end - 1)) --end;
  return {first, end};
}

}  // namespace

ObjectFile encode_segmentation(const CaseIdentity& identity, const SliceSet& slices,
                               const std::vector<Segment>& segments) {
  Elements e = described(identity, "SEG", 2, "Anatomies of the case");
  std::vector<Elements> segment_items, frames, references;
  std::string pixels;
  std::size_t bits = 0;
  const auto [first, end] = used_slices(segments);
  for (std::size_t n = 0; n < segments.size(); ++n) {
    const int number = int(n) + 1;
    segment_items.push_back(segment_item(segments[n], number));
    for (std::size_t k = first; k < end; ++k) {
      const bool holds_place = n == 0 && is_unused(segments, k);
      if (segments[n].bits[k].empty() && !holds_place) continue;
      frames.push_back(frame_item(slices, k, number));
      append_bits(pixels, bits, segments[n].bits[k], slices.pixels());
    }
  }
  if (frames.empty()) throw Error(ExitCode::internal, "", "dicom-seg", "no segment has a pixel on any slice");
  std::string last;
  for (std::size_t k = 0; k < slices.images.size(); ++k)
    if (slices.images[k].instance_uid != std::exchange(last, slices.images[k].instance_uid))
      references.push_back(reference_to(slices, k));
  e.text(t_image_type, "CS", "DERIVED\\PRIMARY")
      .text(t_content_date, "DA", content_date)
      .text(t_content_time, "TM", content_time)
      .text(t_instance_number, "IS", "1")
      .words(t_samples, {1})
      .text(t_photometric, "CS", "MONOCHROME2")
      .text(t_frames, "IS", std::to_string(frames.size()))
      .words(t_rows, {slices.rows})
      .words(t_columns, {slices.columns})
      .words(t_allocated, {1})
      .words(t_stored, {1})
      .words(t_high_bit, {0})
      .words(t_representation, {0})
      .text(t_lossy, "CS", "00")
      .text(t_segmentation_type, "CS", "BINARY")
      .sequence(t_segments, std::move(segment_items))
      .text(t_content_label, "CS", "SEGMENTATION")
      .text(t_content_description, "LO", "Anatomies of the case")
      .text(t_content_creator, "PN")
      .item(t_shared_groups, shared_item(slices))
      .sequence(t_frame_groups, std::move(frames))
      .bytes(t_pixels, "OB", std::move(pixels));
  describe_dimensions(e, identity);
  if (!references.empty())
    e.item(t_referenced_series,
           Elements().text(t_series, "UI", slices.series_uid).sequence(t_referenced_instance, std::move(references)));
  return encode_object(std::move(e), class_seg);
}

std::array<int, 3> lab_of(std::array<double, 3> rgb) {
  for (double& c : rgb) c = linear_of_srgb(c);
  const double x = (0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2]) / 0.95047,
               y = 0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2],
               z = (0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2]) / 1.08883;
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double l = 116 * f(y) - 16, a = 500 * (f(x) - f(y)), b = 200 * (f(y) - f(z));
  const auto scaled = [](double v, double low, double range) {
    return int(std::lround(std::clamp((v - low) / range, 0.0, 1.0) * 65535));
  };
  return {scaled(l, 0, 100), scaled(a, -128, 255), scaled(b, -128, 255)};
}

}  // namespace trephine::pacs
