// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/object_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/memory_budget.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

using dicom::Element;
using dicom::Level;

struct FrameGroups {
  std::optional<Vec3> position, u, v;
  std::optional<std::array<double, 2>> spacing;  // x, y
  std::optional<double> thickness, step;
  int segment = 0;
};

struct RawSegmentation {
  std::string sop_class, type;
  int rows = 0, columns = 0, frames = 1, allocated = 0;
  struct Named {
    int number = 0;
    std::string label;
    std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  };
  std::vector<Named> segments;
  FrameGroups shared;
  std::vector<FrameGroups> each;
  Element pixels;
};

void take_group(dicom::ByteSource& source, const Element& e, FrameGroups& g) {
  switch (e.tag) {
    case t_position:
      g.position = vector_of(numbers_of(source, e), 0, e.tag);
      break;
    case t_orientation: {
      const auto v = numbers_of(source, e);
      g.u = vector_of(v, 0, e.tag);
      g.v = vector_of(v, 3, e.tag);
      break;
    }
    case t_spacing: {
      const auto v = numbers_of(source, e);
      const auto is_possible = [](double mm) { return mm >= 1e-3 && mm <= 1e3; };
      if (v.size() != 2 || !is_possible(v[0]) || !is_possible(v[1]))
        refuse("PixelSpacing (0028,0030)", "must be two numbers from 0.001 to 1000 mm");
      g.spacing = {v[1], v[0]};
      break;
    }
    case t_thickness:
      if (const auto v = numbers_of(source, e); !v.empty()) g.thickness = v[0];
      break;
    case t_step:
      if (const auto v = numbers_of(source, e); !v.empty()) g.step = v[0];
      break;
    case t_referenced_segment:
      g.segment = word_of(source, e);
      break;
    default:
      break;
  }
}

RawSegmentation read_segmentation(dicom::ByteSource& source, const DataSet& set) {
  RawSegmentation raw;
  const auto into = [](std::uint32_t tag) {
    return tag == t_segments || tag == t_shared_groups || tag == t_frame_groups || tag == t_plane_position ||
           tag == t_plane_orientation || tag == t_pixel_measures || tag == t_segment_identification;
  };
  raw.pixels = dicom::walk_elements(
      source, set.begin, source.size(), set.explicit_vr, into, [&](const Element& e, const std::vector<Level>& levels) {
        if (levels.empty()) {
          if (e.tag == t_sop_class) raw.sop_class = text_of(source, e);
          if (e.tag == t_segmentation_type) raw.type = text_of(source, e);
          if (e.tag == t_rows) raw.rows = word_of(source, e);
          if (e.tag == t_columns) raw.columns = word_of(source, e);
          if (e.tag == t_allocated) raw.allocated = word_of(source, e);
          if (e.tag == t_frames)
            if (const auto v = numbers_of(source, e); !v.empty() && v[0] >= 1 && v[0] <= 1e6) raw.frames = int(v[0]);
          return;
        }
        const std::size_t item = std::size_t(levels[0].item);
        if (levels[0].tag == t_segments && levels.size() == 1) {
          if (item >= most_segments)
            refuse("SegmentSequence (0062,0002)",
                   fmt::format("has more segments than can be read, at most {}", most_segments));
          if (item >= raw.segments.size()) raw.segments.resize(item + 1);
          if (e.tag == t_segment_number) raw.segments[item].number = word_of(source, e);
          if (e.tag == t_segment_label) raw.segments[item].label = text_of(source, e);
        }
        if (levels[0].tag == t_shared_groups && levels.size() == 2) take_group(source, e, raw.shared);
        if (levels[0].tag == t_frame_groups && levels.size() == 2) {
          if (item >= 1000000) refuse(dicom::tag_name(t_frame_groups), "has too many items");
          if (item >= raw.each.size()) raw.each.resize(item + 1);
          take_group(source, e, raw.each[item]);
        }
      });
  return raw;
}

void check_kind(const RawSegmentation& raw) {
  if (raw.type != "BINARY")
    refuse("SegmentationType (0062,0001)", "must be BINARY: save the segmentation as a binary one");
  if (raw.allocated != 1) refuse(dicom::tag_name(t_allocated), "must be 1");
  if (raw.rows < 1 || raw.columns < 1 || raw.frames < 1) refuse(dicom::tag_name(t_frames), "holds no frame");
  if (int(raw.each.size()) != raw.frames)
    refuse("(5200,9230)", fmt::format("{} items for {} frames", raw.each.size(), raw.frames));
  const std::uint64_t bits = std::uint64_t(raw.rows) * std::uint64_t(raw.columns) * std::uint64_t(raw.frames);
  if (raw.pixels.tag != t_pixels || raw.pixels.undefined_length || raw.pixels.length < (bits + 7) / 8)
    refuse(dicom::tag_name(t_pixels), "is missing or cut short");
}

// The bits of a frame, which may begin within a byte.
std::string frame_bits(dicom::ByteSource& source, const RawSegmentation& raw, std::size_t frame) {
  const std::uint64_t count = std::uint64_t(raw.rows) * std::uint64_t(raw.columns), first = frame * count;
  std::string bytes((first % 8 + count + 7) / 8, '\0');
  if (!source.read(raw.pixels.offset + first / 8, bytes.data(), bytes.size()))
    refuse(dicom::tag_name(t_pixels), "is cut short");
  std::string out((count + 7) / 8, '\0');
  const unsigned shift = unsigned(first % 8);
  for (std::size_t i = 0; i < out.size(); ++i) {
    unsigned v = static_cast<unsigned char>(bytes[i]) >> shift;
    if (shift && i + 1 < bytes.size()) v |= unsigned(static_cast<unsigned char>(bytes[i + 1])) << (8 - shift);
    out[i] = static_cast<char>(v & 0xff);
  }
  if (count % 8) out.back() = static_cast<char>(out.back() & ((1u << count % 8) - 1));
  return std::all_of(out.begin(), out.end(), [](char c) { return c == 0; }) ? std::string() : out;
}

struct Placed {
  double along = 0;
  std::size_t frame = 0;
};

// The slices of the sorted frames, and for each of these the index of its slice. Slices on which nothing lies are often
// left out; where their step is known they are known to be empty.
std::vector<std::size_t> place_slices(const std::vector<Placed>& placed, const std::vector<Vec3>& positions,
                                      double step, SliceSet& s) {
  std::vector<std::size_t> slice_of;
  double last = -1e300;
  for (const Placed& p : placed) {
    if (p.along - last > 0.01) {
      const double gap = p.along - last, parts = step > 0 && !s.origins_mm.empty() ? std::round(gap / step) : 1;
      const bool is_filled = parts > 1 && parts < 1000 && std::abs(gap - parts * step) < 0.01 * step;
      if (s.origins_mm.size() + (is_filled ? std::size_t(parts) : 1) > most_planes)
        refuse("ImagePositionPatient (0020,0032)",
               fmt::format("has more slices than can be read, at most {}", most_planes));
      if (is_filled) {
        const Vec3 from = s.origins_mm.back(), whole = positions[p.frame] - from;
        for (int k = 1; k < int(parts); ++k) s.origins_mm.push_back(from + whole * (k / parts));
      }
      s.origins_mm.push_back(positions[p.frame]);
      last = p.along;
    } else if (const Vec3 apart = positions[p.frame] - s.origins_mm.back(), n = s.normal();
               norm(apart - n * dot(apart, n)) > 0.01) {
      refuse(
          "ImagePositionPatient (0020,0032)",
          fmt::format("frames lie beside each other, {:.3f} mm apart, on one plane: save each place's segments as an "
                      "object of its own",
                      norm(apart)));
    }
    slice_of.push_back(s.origins_mm.size() - 1);
  }
  return slice_of;
}

}  // namespace

LabelObject segmentation_of(dicom::ByteSource& source, const DataSet& set) {
  const RawSegmentation raw = read_segmentation(source, set);
  check_kind(raw);
  LabelObject out;
  out.format = "DICOM SEG";
  SliceSet& s = out.slices;
  s.columns = raw.columns;
  s.rows = raw.rows;
  std::map<int, std::size_t> by_number;
  for (const auto& named : raw.segments) {
    by_number[named.number] = out.segments.size();
    out.segments.push_back({named.label, named.colour_rgb, {}});
  }
  std::vector<Placed> placed;
  std::vector<Vec3> positions;
  for (std::size_t f = 0; f < raw.each.size(); ++f) {
    const FrameGroups& g = raw.each[f];
    const auto position = g.position ? g.position : raw.shared.position;
    const auto u = g.u ? g.u : raw.shared.u, v = g.v ? g.v : raw.shared.v;
    const auto spacing = g.spacing ? g.spacing : raw.shared.spacing;
    if (!position) refuse(dicom::tag_name(t_position), "missing in a frame");
    if (!(norm(*position) < farthest_mm)) refuse(dicom::tag_name(t_position), "lies kilometres away");
    if (!u || !v || !(std::abs(norm(*u) - 1) < 1e-3 && std::abs(norm(*v) - 1) < 1e-3 && std::abs(dot(*u, *v)) < 1e-3))
      refuse(dicom::tag_name(t_orientation), "missing, or not orthonormal");
    if (!spacing) refuse(dicom::tag_name(t_spacing), "missing");
    if (f == 0) {
      s.u = normalized(*u);
      s.v = normalized(*v - s.u * dot(*v, s.u));
      s.dx_mm = (*spacing)[0];
      s.dy_mm = (*spacing)[1];
      const auto thickness = g.thickness ? g.thickness : raw.shared.thickness;
      s.thickness_mm = thickness && *thickness > 0 ? *thickness : 1;
    } else if (norm(*u - s.u) > 1e-3 || norm(*v - s.v) > 1e-3 || std::abs((*spacing)[0] - s.dx_mm) > 1e-4 ||
               std::abs((*spacing)[1] - s.dy_mm) > 1e-4) {
      refuse(dicom::tag_name(t_orientation), "the frames are not parallel, or of different pixels");
    }
    placed.push_back({dot(*position, s.normal()), f});
    positions.push_back(*position);
  }
  std::stable_sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) { return a.along < b.along; });
  const double step = raw.shared.step.value_or(0);
  const std::vector<std::size_t> slice_of = place_slices(placed, positions, step, s);
  require_memory(
      out.segments.size() * s.origins_mm.size() * sizeof(std::string) + raw.each.size() * ((s.pixels() + 7) / 8),
      "a segmentation");
  for (Segment& segment : out.segments) segment.bits.resize(s.origins_mm.size());
  for (std::size_t n = 0; n < placed.size(); ++n) {
    const Placed& p = placed[n];
    const int number = raw.each[p.frame].segment ? raw.each[p.frame].segment : raw.shared.segment;
    const auto known = by_number.find(number);
    if (known == by_number.end()) refuse("(0062,000B)", fmt::format("{}: there is no segment of that number", number));
    std::string& bits = out.segments[known->second].bits[slice_of[n]];
    std::string frame = frame_bits(source, raw, p.frame);
    for (std::size_t i = 0; i < bits.size() && i < frame.size(); ++i) frame[i] = static_cast<char>(frame[i] | bits[i]);
    if (!frame.empty()) bits = std::move(frame);
  }
  return out;
}

}  // namespace trephine::pacs
