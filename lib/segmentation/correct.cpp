// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/correct.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "segmentation/label_raster.h"

namespace trephine::segmentation {
namespace {

using mask::BitMask;

constexpr int added = 1, removed = 2;
constexpr double reach_voxels = 2;  ///< around what changed, the field follows the new mask

void include(grid::Box& box, const grid::Box& other) {
  for (int a = 0; a < 3; ++a) {
    box.begin[a] = std::min(box.begin[a], other.begin[a]);
    box.end[a] = std::max(box.end[a], other.end[a]);
  }
}

/// The raster of `lattice` over a box of its indices, which may reach beyond it.
grid::Lattice over(const grid::Lattice& lattice, const grid::Box& box) {
  grid::Lattice out = lattice;
  out.origin_mm = lattice.to_world_mm({double(box.begin[0]), double(box.begin[1]), double(box.begin[2])});
  for (int a = 0; a < 3; ++a) out.size[a] = box.end[a] - box.begin[a];
  return out;
}

/// The box of `other`'s voxels in the indices of `lattice`, with which it shares a raster.
grid::Box box_in(const grid::Lattice& other, const grid::Lattice& lattice) {
  grid::Box box{{1 << 30, 1 << 30, 1 << 30}, {-(1 << 30), -(1 << 30), -(1 << 30)}};
  for (int c = 0; c < 8; ++c) {
    Vec3 at;
    for (int a = 0; a < 3; ++a) at[a] = c >> a & 1 ? other.size[std::size_t(a)] - 1.0 : 0;
    const Vec3 q = lattice.to_index(other.to_world_mm(at));
    for (int a = 0; a < 3; ++a) {
      box.begin[a] = std::min(box.begin[a], int(std::lround(q[a])));
      box.end[a] = std::max(box.end[a], int(std::lround(q[a])) + 1);
    }
  }
  return box;
}

CorrectionCounts counts_of(const BitMask& plus, const BitMask& minus) {
  const double ml = plus.lattice().voxel_volume_mm3() / 1000;
  const std::size_t more = plus.count(), less = minus.count();
  return {more, less, double(more) * ml, double(less) * ml};
}

/// What a correction says of the voxels of another lattice.
struct Wanted {
  BitMask plus, minus;
  bool resampled = false;
  std::size_t beyond = 0;  ///< voxels of the correction that lie beyond the lattice
};

Wanted wanted_on(const grid::Lattice& lattice, const grid::LabelFile& correction) {
  const auto picked = [&](const char* name) -> grid::Mask {
    for (const grid::LabelSegment& s : correction.segments)
      if (s.name == name) return grid::pick_label(correction, name).mask;
    throw Error(ExitCode::bad_input, "", "file", "is no correction: it has no segment '" + std::string(name) + "'");
  };
  const grid::Mask plus = picked("added"), minus = picked("removed");
  Wanted out;
  if (const auto aligned = raster_alignment(correction.lattice, lattice)) {
    out.plus = on_raster(plus, lattice, *aligned);
    out.minus = on_raster(minus, lattice, *aligned);
  } else {
    out.resampled = true;
    const auto nearest = [&](const grid::Mask& mask) {
      return mask::make_mask(lattice, [&](int j, int k, std::uint8_t* row) {
        for (int i = 0; i < lattice.size[0]; ++i) {
          const Vec3 q = mask.to_index(lattice.to_world_mm({double(i), double(j), double(k)}));
          if (!(std::abs(q.x) < 1e6 && std::abs(q.y) < 1e6 && std::abs(q.z) < 1e6)) continue;
          const int at[3] = {int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z))};
          row[i] = mask.contains(at[0], at[1], at[2]) && mask.at(at[0], at[1], at[2]);
        }
      });
    };
    out.plus = nearest(plus);
    out.minus = nearest(minus);
  }
  for (int k = 0; k < plus.size[2]; ++k)
    for (int j = 0; j < plus.size[1]; ++j)
      for (int i = 0; i < plus.size[0]; ++i) {
        if (!plus.at(i, j, k) && !minus.at(i, j, k)) continue;
        const Vec3 q = lattice.to_index(plus.to_world_mm({double(i), double(j), double(k)}));
        for (int a = 0; a < 3; ++a)
          if (!(q[a] >= -0.5 && q[a] < lattice.size[a] - 0.5)) {
            ++out.beyond;
            break;
          }
      }
  return out;
}

/// The median of what the field has beside its surface within the box: how much it changes from voxel to voxel there.
float scale_beside_surface(const grid::Field& f, const grid::Box& box) {
  std::vector<float> beside;
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        const float v = f.at(i, j, k);
        const int at[3] = {i, j, k};
        bool is = false;
        for (int a = 0; a < 3; ++a)
          for (const int step : {-1, 1}) {
            int to[3] = {at[0], at[1], at[2]};
            to[a] += step;
            is = is || (f.contains(to[0], to[1], to[2]) && (f.at(to[0], to[1], to[2]) > 0) != (v > 0));
          }
        if (is) beside.push_back(std::abs(v));
      }
  return mask::median(beside, 0);
}

/// The field over a lattice of its raster that covers it; what is new is outside.
grid::Field spread(const grid::Field& field, const grid::Lattice& lattice) {
  grid::Field out(lattice, std::min(-1.f, *std::min_element(field.voxels.begin(), field.voxels.end())));
  const grid::Box box = box_in(field, lattice);
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      std::copy_n(&field.voxels[field.index(0, j, k)], field.size[0],
                  &out.voxels[out.index(box.begin[0], box.begin[1] + j, box.begin[2] + k)]);
  return out;
}

/// The field's lattice grown to the box (of the volume's indices) and the box around it that is looked at.
grid::Field grown_to(const grid::Field& field, const grid::Lattice& volume, const grid::Box& changed, int margin) {
  grid::Box all = box_in(field, volume), wanted = grid::grown(changed, margin, volume);
  include(all, wanted);
  return spread(field, over(volume, all));
}

}  // namespace

Outcome<grid::LabelFile, CorrectionCounts> correction_between(const grid::LabelFile& before,
                                                              const grid::LabelFile& after, const std::string& label,
                                                              const std::string& painted_label) {
  const grid::Mask was = with_field("before", [&] { return grid::pick_label(before, label).mask; });
  const grid::Mask is = with_field("after", [&] { return grid::pick_label(after, painted_label).mask; });
  if (!raster_alignment(is, was))
    throw Error(ExitCode::bad_input, "", "after",
                "its voxels do not lie on those of before: save it on the voxels that it was opened on");
  grid::Box all = grid::whole_box(was);
  include(all, box_in(is, was));
  const grid::Lattice lattice = over(was, all);
  if (lattice.count() > std::size_t{1} << 33) throw Error(ExitCode::bad_input, "", "after", "lies too far from before");
  const BitMask old_bits = on_raster(was, lattice, *raster_alignment(was, lattice)),
                new_bits = on_raster(is, lattice, *raster_alignment(is, lattice));
  const BitMask plus = mask::without(new_bits, old_bits), minus = mask::without(old_bits, new_bits);
  grid::Box changed = plus.any() ? plus.bounds() : minus.bounds();
  if (minus.any()) include(changed, minus.bounds());
  if (!plus.any() && !minus.any()) throw Error(ExitCode::bad_input, "", "after", "nothing of the label is different");
  grid::Mask change(over(lattice, changed));
  for (int k = 0; k < change.size[2]; ++k)
    for (int j = 0; j < change.size[1]; ++j)
      for (int i = 0; i < change.size[0]; ++i) {
        const int at[3] = {i + changed.begin[0], j + changed.begin[1], k + changed.begin[2]};
        change.at(i, j, k) = std::uint8_t(plus.get(at[0], at[1], at[2])    ? added
                                          : minus.get(at[0], at[1], at[2]) ? removed
                                                                           : 0);
      }
  return {correction_of(std::move(change)), counts_of(plus, minus), {}};
}

grid::LabelFile correction_of(grid::Mask voxels) {
  grid::LabelFile out;
  out.lattice = voxels;
  out.samples = std::move(voxels);
  out.format = "seg.nrrd";
  for (const auto& [name, value] : {std::make_pair("added", added), {"removed", removed}}) {
    grid::LabelSegment segment;
    segment.id = segment.name = name;
    segment.value = value;
    out.segments.push_back(segment);
  }
  return out;
}

Outcome<grid::Field, CorrectedResult> corrected(const grid::Field& field, const grid::Lattice& volume,
                                                const grid::LabelFile& correction, const Progress& progress) {
  for (const float v : field.voxels)
    if (!std::isfinite(v)) throw Error(ExitCode::bad_input, "", "field", "holds a voxel that is not finite");
  with_field("field", [&] { grid::place_in(field, volume); });
  const Wanted wanted = wanted_on(volume, correction);
  BitMask touched = wanted.plus;
  touched |= wanted.minus;
  if (!touched.any()) throw Error(ExitCode::bad_input, "", "file", "no voxel of the correction lies in the scan");
  const double mean = std::cbrt(volume.voxel_volume_mm3());
  const double smallest = std::min({volume.spacing_mm.x, volume.spacing_mm.y, volume.spacing_mm.z});
  const double reach_mm = reach_voxels * mean;
  const int margin = int(std::ceil((reach_mm + 3 * mean) / smallest)) + 2;
  grid::Field out = grown_to(field, volume, touched.bounds(), margin);
  const BitMask plus = mask::placed(wanted.plus, out), minus = mask::placed(wanted.minus, out);

  BitMask mask = mask::positive(out, out);
  const BitMask really_plus = mask::without(plus, mask);
  BitMask really_minus = minus;
  really_minus &= mask;
  mask |= plus;
  mask.remove(minus);
  BitMask changed = really_plus;
  changed |= really_minus;
  const double asked = double(plus.count() + minus.count()), already = 1 - double(changed.count()) / asked;
  const CorrectedResult result{counts_of(really_plus, really_minus), already, wanted.resampled};
  Warnings warnings;
  if (wanted.resampled)
    warnings.push_back(
        {"correction_resampled",
         "the correction was made on other voxels than these: each takes what the nearest one of it says",
         {}});
  if (wanted.beyond > 0)
    warnings.push_back({"correction_beyond_scan",
                        "{voxels_count} voxels of the correction lie beyond the scan",
                        {{"voxels_count", static_cast<std::int64_t>(wanted.beyond)}}});
  if (already > 0.5)
    warnings.push_back({"correction_held_already",
                        "{already_percent} % of the correction held without it: the segmentation has changed since, or "
                        "it is of another scan",
                        {{"already_percent", to_text(std::round(already * 100))}}});
  if (!changed.any()) return {field, result, std::move(warnings)};
  progress.report(0.3);

  const BitMask near = mask::dilated(changed, reach_mm, progress.part(0.3, 0.6));
  const grid::Box work = grid::grown(near.bounds(), margin, out);
  const BitMask part = mask::crop(mask, work);
  grid::Field smooth(part.lattice(), -1.f);
  mask::place_surface(smooth, part, mean, 1, progress.part(0.6, 0.9));
  float scale = scale_beside_surface(out, work);
  if (!(scale > 0)) scale = scale_beside_surface(out, grid::whole_box(out));
  if (!(scale > 0)) scale = 1;
  // The smoothed mask is about a third beside its surface: half a voxel off, at a sigma of one.
  const float factor = scale / std::max(0.05f, scale_beside_surface(smooth, grid::whole_box(smooth)));
  for (int k = work.begin[2]; k < work.end[2]; ++k)
    for (int j = work.begin[1]; j < work.end[1]; ++j)
      for (int i = work.begin[0]; i < work.end[0]; ++i)
        if (near.get(i, j, k)) {
          const float v = factor * smooth.at(i - work.begin[0], j - work.begin[1], k - work.begin[2]);
          out.at(i, j, k) = std::abs(v) < 1e-6f * scale ? (mask.get(i, j, k) ? 1e-6f : -1e-6f) * scale : v;
        }
  progress.report(1);
  return {std::move(out), result, std::move(warnings)};
}

}  // namespace trephine::segmentation
