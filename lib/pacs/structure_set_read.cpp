// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/object_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/memory_budget.h"
#include "pacs/contours.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

using dicom::Element;
using dicom::Level;

struct RawRoi {
  std::string name;
  std::vector<std::vector<Vec3>> contours;
};

std::vector<RawRoi> read_structure_set(dicom::ByteSource& source, const DataSet& set) {
  struct Contour {
    std::string type;
    std::vector<Vec3> points;
  };
  std::map<int, std::string> names;
  std::vector<std::pair<int, std::string>> named;           // of StructureSetROISequence, by item
  std::vector<std::pair<int, std::vector<Contour>>> drawn;  // of ROIContourSequence, by item
  const auto into = [](std::uint32_t tag) { return tag == t_rois || tag == t_roi_contours || tag == t_contours; };
  const auto number = [&](const Element& e) {
    const auto v = numbers_of(source, e);
    if (v.empty()) return 0;
    if (!(v[0] >= -2147483648.0 && v[0] <= 2147483647.0 && v[0] == std::floor(v[0])))
      refuse(e.tag == t_roi_number ? "ROINumber (3006,0022)" : "ReferencedROINumber (3006,0084)",
             "must be a whole number of 32 bits");
    return int(v[0]);
  };
  dicom::walk_elements(source, set.begin, source.size(), set.explicit_vr, into,
                       [&](const Element& e, const std::vector<Level>& levels) {
                         if (levels.empty()) return;
                         const std::size_t item = std::size_t(levels[0].item);
                         if (item >= 65535) refuse(dicom::tag_name(levels[0].tag), "has too many items");
                         if (levels[0].tag == t_rois && levels.size() == 1) {
                           if (item >= named.size()) named.resize(item + 1);
                           if (e.tag == t_roi_number) named[item].first = number(e);
                           if (e.tag == t_roi_name) named[item].second = text_of(source, e);
                         }
                         if (levels[0].tag != t_roi_contours) return;
                         if (item >= drawn.size()) drawn.resize(item + 1);
                         if (levels.size() == 1 && e.tag == t_referenced_roi) drawn[item].first = number(e);
                         if (levels.size() != 2 || levels[1].tag != t_contours) return;
                         auto& contours = drawn[item].second;
                         const std::size_t at = std::size_t(levels[1].item);
                         if (at >= 1000000) refuse(dicom::tag_name(t_contours), "has too many items");
                         if (at >= contours.size()) contours.resize(at + 1);
                         if (e.tag == t_contour_type) contours[at].type = text_of(source, e);
                         if (e.tag == t_contour_data) {
                           const auto v = numbers_of(source, e);
                           if (v.size() % 3) refuse(dicom::tag_name(e.tag), "is not triples of numbers");
                           for (std::size_t i = 0; i < v.size(); i += 3)
                             contours[at].points.push_back({v[i], v[i + 1], v[i + 2]});
                         }
                       });
  std::vector<RawRoi> rois;
  for (const auto& [own, contours] : drawn) {
    RawRoi roi;
    for (const auto& [n, name] : named)
      if (n == own) roi.name = name;
    for (const Contour& c : contours)
      if ((c.type == "CLOSED_PLANAR" || c.type == "CLOSEDPLANAR_XOR") && c.points.size() >= 3)
        roi.contours.push_back(c.points);
    if (!roi.contours.empty()) rois.push_back(std::move(roi));
  }
  if (rois.empty()) refuse(dicom::tag_name(t_roi_contours), "holds no closed contour");
  if (rois.size() > most_segments)
    refuse("ROIContourSequence (3006,0039)",
           fmt::format("has {} regions with contours, at most {} can be read", rois.size(), most_segments));
  return rois;
}

Vec3 normal_of(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) sum += cross(points[i] - points[0], points[i + 1] - points[0]);
  return sum;
}

// The plane of the contour with the largest area, with its normal towards the head, the back or the left.
void choose_axes(const std::vector<RawRoi>& rois, SliceSet& s) {
  Vec3 n;
  for (const RawRoi& roi : rois)
    for (const auto& points : roi.contours)
      if (const Vec3 own = normal_of(points); norm(own) > norm(n)) n = own;
  if (!(norm(n) > 1e-6)) refuse(dicom::tag_name(t_contour_data), "no contour encloses anything");
  n = normalized(n);
  int most = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(n[a]) > std::abs(n[most])) most = a;
  if (n[most] < 0) n = -n;
  const Vec3 along = most == 0 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  s.u = normalized(along - n * dot(along, n));
  s.v = cross(n, s.u);
}

// How far a contour may lie off its plane.
constexpr double planar_mm = 0.1;

// Heights that differ by no more than contours may lie off their plane are one plane: the lowest of each.
std::vector<double> planes_of(std::vector<double> heights) {
  std::sort(heights.begin(), heights.end());
  std::vector<double> levels;
  double last = -1e300;
  for (const double h : heights) {
    if (h - last > 1.1 * planar_mm)
      levels.push_back(h);
    else if (h - levels.back() > 1.05 * planar_mm)
      refuse("ContourData (3006,0050)",
             fmt::format("planes from {:.3f} to {:.3f} mm lie within {} mm of each other, so that they cannot be "
                         "distinguished from one plane: save contours on planes farther apart",
                         levels.back(), h, planar_mm));
    last = h;
  }
  return levels;
}

std::size_t plane_at(const std::vector<double>& levels, double height) {
  return std::size_t(std::upper_bound(levels.begin(), levels.end(), height) - levels.begin()) - 1;
}

// The planes on which a region has contours, ascending.
std::vector<std::size_t> own_planes(const RawRoi& roi, const std::vector<double>& levels, const Vec3& normal) {
  std::vector<std::size_t> own;
  for (const auto& points : roi.contours) own.push_back(plane_at(levels, dot(points[0], normal)));
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());
  return own;
}

// What lies between a region's plane and its next one. Another region's planes there mean nothing for this one, unless
// the step is more than three times its steps beside it: then these are separate pieces.
struct Gap {
  std::size_t lower = 0, upper = 0;
  double below_mm = 0, above_mm = 0;  ///< its steps beside it; either where it has one alone, 0 where it has none
  bool is_one_piece = true;
};
std::vector<Gap> gaps_of(const std::vector<std::size_t>& own, const std::vector<double>& levels) {
  std::vector<Gap> gaps;
  const auto step = [&](std::size_t i) { return levels[own[i + 1]] - levels[own[i]]; };
  for (std::size_t i = 0; i + 1 < own.size(); ++i) {
    Gap g{own[i], own[i + 1]};
    if (i > 0) g.below_mm = g.above_mm = step(i - 1);
    if (i + 2 < own.size()) g.above_mm = step(i + 1);
    if (i == 0) g.below_mm = g.above_mm;
    const double most = std::max(g.below_mm, g.above_mm);
    g.is_one_piece = !(most > 0) || step(i) <= 3 * most;
    gaps.push_back(g);
  }
  return gaps;
}

// Separate pieces with no plane between them get an empty one beside either.
void part_pieces(const std::vector<RawRoi>& rois, const Vec3& normal, std::vector<double>& levels) {
  for (const RawRoi& roi : rois) {
    std::vector<double> empty;
    for (const Gap& g : gaps_of(own_planes(roi, levels, normal), levels))
      if (!g.is_one_piece && g.upper == g.lower + 1) {
        empty.push_back(levels[g.lower] + g.below_mm);
        empty.push_back(levels[g.upper] - g.above_mm);
      }
    levels.insert(levels.end(), empty.begin(), empty.end());
    std::sort(levels.begin(), levels.end());
  }
}

void fill_gaps(const std::vector<Gap>& gaps, const std::vector<double>& levels, const SliceSet& s, SliceBits& bits) {
  for (const Gap& g : gaps) {
    if (!g.is_one_piece || g.upper == g.lower + 1 || bits[g.lower].empty() || bits[g.upper].empty()) continue;
    std::vector<double> parts;
    for (std::size_t k = g.lower + 1; k < g.upper; ++k)
      parts.push_back((levels[k] - levels[g.lower]) / (levels[g.upper] - levels[g.lower]));
    auto between = bits_between(bits[g.lower], bits[g.upper], parts, s);
    std::move(between.begin(), between.end(), bits.begin() + std::ptrdiff_t(g.lower) + 1);
  }
}

}  // namespace

LabelObject structure_set_of(dicom::ByteSource& source, const DataSet& set) {
  constexpr double pixel_mm = 0.5;
  constexpr int most_pixels = 2048, margin = 2;
  const std::vector<RawRoi> rois = read_structure_set(source, set);
  LabelObject out;
  out.format = "RT structure set";
  SliceSet& s = out.slices;
  choose_axes(rois, s);
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  std::vector<double> heights;
  for (const RawRoi& roi : rois)
    for (const auto& points : roi.contours) {
      const double at = dot(points[0], s.normal());
      heights.push_back(at);
      for (const Vec3& p : points) {
        if (!(norm(p) < farthest_mm)) refuse(dicom::tag_name(t_contour_data), "lies kilometres away");
        if (!(std::abs(dot(p, s.normal()) - at) <= planar_mm))
          refuse(dicom::tag_name(t_contour_data), "a contour is not planar, or not parallel to the others");
        const double q[2] = {dot(p, s.u), dot(p, s.v)};
        for (int a = 0; a < 2; ++a) {
          low[a] = std::min(low[a], q[a]);
          high[a] = std::max(high[a], q[a]);
        }
      }
    }
  s.dx_mm = s.dy_mm = std::max({pixel_mm, (high[0] - low[0]) / most_pixels, (high[1] - low[1]) / most_pixels});
  s.columns = int((high[0] - low[0]) / s.dx_mm) + 2 * margin + 1;
  s.rows = int((high[1] - low[1]) / s.dy_mm) + 2 * margin + 1;
  const double first[2] = {low[0] - margin * s.dx_mm, low[1] - margin * s.dy_mm};
  std::vector<double> levels = planes_of(std::move(heights));
  part_pieces(rois, s.normal(), levels);
  if (levels.size() > most_planes)
    refuse(dicom::tag_name(t_contour_data),
           fmt::format("{} planes, at most {} make sense", levels.size(), most_planes));
  require_memory(rois.size() * levels.size() * (sizeof(std::string) + (s.pixels() + 7) / 8), "contours on pixels");
  for (const double h : levels) s.origins_mm.push_back(s.u * first[0] + s.v * first[1] + s.normal() * h);
  s.thickness_mm = levels.size() > 1 ? (levels.back() - levels.front()) / double(levels.size() - 1) : 1;
  for (const RawRoi& roi : rois) {
    std::vector<std::vector<PlaneLine>> lines(levels.size());
    for (const auto& points : roi.contours) {
      const double at = dot(points[0], s.normal());
      PlaneLine line;
      for (const Vec3& p : points) line.push_back({dot(p, s.u) - first[0], dot(p, s.v) - first[1]});
      lines[plane_at(levels, at)].push_back(std::move(line));
    }
    Segment segment{roi.name, {}, SliceBits(levels.size())};
    const std::vector<std::size_t> own = own_planes(roi, levels, s.normal());
    for (const std::size_t k : own) {
      const auto pixels = filled(lines[k], s.columns, s.rows, s.dx_mm, s.dy_mm);
      if (std::none_of(pixels.begin(), pixels.end(), [](std::uint8_t v) { return v != 0; })) continue;
      segment.bits[k] = packed(pixels);
    }
    fill_gaps(gaps_of(own, levels), levels, s, segment.bits);
    out.segments.push_back(std::move(segment));
  }
  return out;
}

}  // namespace trephine::pacs
