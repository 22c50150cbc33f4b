// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/segment.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "segmentation/filters.h"
#include "segmentation/methods.h"
#include "segmentation/scan_edge.h"
#include "segmentation/surface_field.h"

namespace trephine {
namespace segmentation {

Grid<float> crop(const HuView& hu, const Box& box) {
  Grid<float> out(cropped(hu.lattice(), box));
  parallel_for(0, out.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < out.size[1]; ++j) {
        const std::size_t in = hu.lattice().index(box.begin[0], j + box.begin[1], k + box.begin[2]);
        float* o = &out.at(0, j, k);
        for (int i = 0; i < out.size[0]; ++i) o[i] = hu(in + i);
      }
  });
  return out;
}

Box region_of_interest(const Lattice& lattice, const SegmentParams& params) {
  const Vec3 lo{params.roi_min_mm[0], params.roi_min_mm[1], params.roi_min_mm[2]};
  const Vec3 hi{params.roi_max_mm[0], params.roi_max_mm[1], params.roi_max_mm[2]};
  for (int axis = 0; axis < 3; ++axis)
    if (lo[axis] > hi[axis])
      throw Error(ExitCode::usage, "", "roi_min_mm, roi_max_mm",
                  fmt::format("{} to {} mm along {}: the lower corner must not be beyond the upper", lo[axis], hi[axis],
                              "xyz"[axis]));
  // The box of indices around the eight corners: exact for volumes along the axes, the enclosing box for oblique ones.
  Box box = whole_box(lattice);
  for (int axis = 0; axis < 3; ++axis) {
    double least = 1e300, most = -1e300;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = lattice.to_index({corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z});
      least = std::min(least, p[axis]);
      most = std::max(most, p[axis]);
    }
    box.begin[axis] = int(std::clamp(std::ceil(least - 1e-6), 0.0, double(lattice.size[axis])));
    box.end[axis] = int(std::clamp(std::floor(most + 1e-6) + 1, 0.0, double(lattice.size[axis])));
  }
  if (box.empty())
    throw Error(ExitCode::quality, "", "roi_min_mm, roi_max_mm", "0 voxels of the volume lie between them");
  return box;
}

BitMask holes(const BitMask& shape, const FillRule& rule, const Progress& progress) {
  BitMask free = shape;
  free.invert();
  BitMask open = rule.close_mm > 0 ? closed(shape, rule.close_mm, progress) : shape;
  open.invert();
  const Components spaces = components(open);
  const double voxel_ml = shape.lattice().voxel_volume_mm3() / 1000;
  std::vector<char> outside(spaces.list.size());
  for (std::size_t c = 0; c < outside.size(); ++c) {
    const Component& space = spaces.list[c];
    outside[c] = space.faces > (rule.cut_open ? 1 : 0) || space.voxels * voxel_ml > rule.max_ml;
  }
  BitMask reached = select(spaces, outside);
  if (rule.close_mm > 0) reached = grown_within(reached, free, rule.close_mm, progress);
  return free.remove(reached);
}

void check_mask(const BitMask& mask, std::size_t volume_voxels, Report& report) {
  const std::size_t n = mask.count();
  if (n == 0) throw Error(ExitCode::quality, "", "", fmt::format("the mask is empty: 0 of {} voxels", volume_voxels));
  if (n == volume_voxels) throw Error(ExitCode::quality, "", "", fmt::format("the mask is full: all {} voxels", n));
  const Box b = mask.bounds();
  for (int axis = 0; axis < 3; ++axis)
    if (b.end[axis] - b.begin[axis] < 2)
      throw Error(ExitCode::quality, "", "", fmt::format("the mask lies in a single slice: {} voxels", n));
  report.add("voxels_count", n);
  report.add("volume_ml", double(n) * mask.lattice().voxel_volume_mm3() / 1000);
}

void check_varies(const HuVolume& volume) {
  std::visit(
      [](const auto& grid) {
        const auto& v = grid.voxels;
        if (std::adjacent_find(v.begin(), v.end(), std::not_equal_to<>()) == v.end())
          throw Error(ExitCode::quality, "", "volume",
                      fmt::format("every voxel is {} HU: there is nothing to be seen in it", v.empty() ? 0 : v[0]));
      },
      volume);
}

namespace {

void check_finite(const HuVolume& volume) {
  const auto* grid = std::get_if<Grid<float>>(&volume);
  if (!grid) return;
  std::atomic<std::size_t> bad{0};
  parallel_for(0, std::int64_t(grid->voxels.size()), 1 << 20, [&](std::int64_t from, std::int64_t to) {
    std::size_t n = 0;
    for (std::int64_t v = from; v < to; ++v) n += !std::isfinite(grid->voxels[v]);
    bad += n;
  });
  if (bad > 0) throw Error(ExitCode::bad_input, "", "volume", fmt::format("{} voxels are NaN or infinite", bad.load()));
}

/// A fault of the shape found that names no parameter is the thresholds'.
template <class F>
auto of_thresholds(F&& f) {
  try {
    return f();
  } catch (Error& e) {
    if (e.field().empty()) e.in_field("lower_hu, upper_hu");
    throw;
  }
}

/// The field's surface moved by grow_mm, on a lattice with room for it.
Field moved(const Field& field, const Lattice& volume, double grow_mm, const Progress& progress) {
  Box box = place_in(field, volume);
  for (int axis = 0; axis < 3; ++axis) {
    const int margin = int(std::ceil(std::max(0.0, grow_mm) / volume.spacing_mm[axis])) + 1;
    box.begin[axis] = std::max(0, box.begin[axis] - margin);
    box.end[axis] = std::min(volume.size[axis], box.end[axis] + margin);
  }
  float lowest = -1;
  for (float f : field.voxels) lowest = std::min(lowest, f);
  Field out = signed_distance_mm(fit(field, cropped(volume, box), lowest), progress);
  for (float& d : out.voxels) {
    d += float(grow_mm);
    if (std::abs(d) < 1e-4f) d = d > 0 ? 1e-4f : -1e-4f;
  }
  return out;
}

/// Whether the surface is one of a body.
void check_scan_edge(const HuView& hu, const Field& field, const SegmentParams& params, Report& report) {
  const double ratio = scan_edge_ratio(hu, field);
  report.add("scan_edge_ratio", ratio);
  if (ratio > params.max_scan_edge_ratio)
    throw Error(ExitCode::quality, "", "max_scan_edge_ratio",
                fmt::format("{:.0f} % of its rim are the edge of the scanned field, at most {:.0f} %: leave it out of "
                            "the scene, or take a scan with a wider field of view",
                            100 * ratio, 100 * params.max_scan_edge_ratio));
}

/// The field cropped to its positive part and two voxels more.
Field trimmed(Field field) {
  const Box box = grown(positive(field, field).bounds(), 2, field);
  const Lattice target = cropped(field, box);
  if (target == field) return field;
  return crop(field, box);
}

}  // namespace
}  // namespace segmentation

Field segment(const HuVolume& volume, const SegmentMasks& masks, const SegmentParams& given, Report& report,
              const Progress& progress) {
  using namespace segmentation;
  SegmentParams params = given;  // with the method's own defaults
  const double lower_hu = given.lower_hu.of(given.method), upper_hu = given.upper_hu.of(given.method);
  params.lower_hu = lower_hu;
  params.upper_hu = upper_hu;
  params.edge = given.edge.of(given.method);
  const Lattice& lattice = lattice_of(volume);
  check_finite(volume);
  if (lower_hu > upper_hu)
    throw Error(ExitCode::usage, "", "lower_hu", fmt::format("{} is above upper_hu, {}", lower_hu, upper_hu));
  if (params.method != SegmentMethod::threshold) check_varies(volume);
  const HuView hu(volume);
  Field field = of_thresholds([&] {
    switch (params.method) {
      case SegmentMethod::brain:
        return segment_brain(hu, masks, params, report, progress);
      case SegmentMethod::ventricles:
        return segment_ventricles(hu, masks, params, report, progress);
      default:
        return segment_threshold(hu, masks, params, report, progress);
    }
  });
  if (params.grow_mm != 0) {
    field = moved(field, lattice, params.grow_mm, progress);
    report.add("grown_mm", params.grow_mm);
  }
  of_thresholds([&] { check_mask(positive(field, field), lattice.count(), report); });
  field = trimmed(std::move(field));
  if (params.max_scan_edge_ratio < 1) check_scan_edge(hu, field, params, report);
  progress.report(1);
  return field;
}

}  // namespace trephine
