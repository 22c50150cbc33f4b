// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/cut.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "voxel/cut_solid.h"
#include "voxel/raw_voxel.h"
#include "voxel/shape_field.h"
#include "voxel/shape_occupancy.h"

namespace trephine::voxel {
namespace {

using detail::RawVoxel;
using detail::SolidOnLattice;

constexpr int volume_unit = 2 * haptic_full;  // what a full voxel counts in sums of volume

// By the shape's number, 1 to 32; [0] is unused.
using Sums = std::array<std::int64_t, haptic_max_shapes + 1>;

int counted(int share) { return std::clamp(haptic_full + 2 * (2 * share - haptic_full), 0, volume_unit); }

// In units of 1 / volume_unit of a voxel.
Sums filled_by_shape(const HapticVolume& volume, const grid::Grid<std::int16_t>& voxels) {
  std::vector<Sums> by_slice(std::size_t(std::max(0, voxels.size[2])), Sums{});
  parallel_for(0, voxels.size[2], 1, [&](std::int64_t from, std::int64_t) {
    const int k = int(from);
    Sums& sums = by_slice[std::size_t(k)];
    for (int j = 0; j < voxels.size[1]; ++j)
      for (int i = 0; i < voxels.size[0]; ++i) {
        const std::int16_t raw = detail::load_voxel(voxels.voxels[voxels.index(i, j, k)]);
        if (volume.encoding == HapticEncoding::hu) {
          for (const HapticShape& s : volume.shapes)
            if (raw >= s.window_low && raw <= s.window_high) sums[std::size_t(s.number)] += volume_unit;
          continue;
        }
        const RawVoxel v = detail::split(raw);
        if (v.number == 0) continue;
        sums[std::size_t(v.number)] += counted(v.share);
        if (v.bare || counted(haptic_full - v.share) == 0) continue;
        sums[std::size_t(detail::other_shape(voxels, v.number, i, j, k))] += counted(haptic_full - v.share);
      }
  });
  Sums total{};
  for (const Sums& s : by_slice)
    for (std::size_t n = 1; n < s.size(); ++n) total[n] += s[n];
  return total;
}

// Which shapes are cut, by number.
std::array<bool, haptic_max_shapes + 1> cut_shapes(const HapticVolume& volume, const std::vector<int>& numbers) {
  std::array<bool, haptic_max_shapes + 1> cut{};
  if (numbers.empty())
    for (const HapticShape& s : volume.shapes) cut[std::size_t(s.number)] = true;
  for (const int n : numbers) {
    const auto has = [&](const HapticShape& s) { return s.number == n; };
    if (std::none_of(volume.shapes.begin(), volume.shapes.end(), has))
      throw Error(ExitCode::bad_input, "", "shape " + std::to_string(n), "the haptic volume has none of that number");
    cut[std::size_t(n)] = true;
  }
  return cut;
}

// One region of the volume before the cut, and the volume that is written to.
struct Cut {
  HapticVolume& volume;
  const SolidOnLattice& solid;
  grid::Box box;     ///< of the volume's voxels that may change
  grid::Box around;  ///< what `before` holds: box and two voxels more
  const grid::Grid<std::int16_t>& before;
  std::array<bool, haptic_max_shapes + 1> cut;
  bool all = false;
};

template <class Each>
void for_each_voxel(const grid::Box& box, const Progress& progress, const Each& each) {
  parallel_for(box.begin[2], box.end[2], 1, [&](std::int64_t from, std::int64_t) {
    progress.check();
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) each(i, j, int(from));
  });
}

// The voxel's new value where the solid leaves `left` of 255 of the shapes that are cut.
std::int16_t lowered(const RawVoxel& v, int other, const std::array<bool, haptic_max_shapes + 1>& cut, int left) {
  const int rest = other > 0 ? haptic_full - v.share : 0;
  const int own = cut[std::size_t(v.number)] ? std::min(v.share, left) : v.share;
  const int others = other > 0 && cut[std::size_t(other)] ? std::min(rest, left) : rest;
  if (own == v.share && others == rest) return detail::join(v.number, v.share, v.bare);
  if (std::max(own, others) == 0) return haptic_empty;
  return own >= others ? detail::join(v.number, own, true) : detail::join(other, others, true);
}

void cut_occupancy(const Cut& c, const Progress& progress) {
  const auto& b = c.around.begin;
  for_each_voxel(c.box, progress, [&](int i, int j, int k) {
    const int x = i - b[0], y = j - b[1], z = k - b[2];
    const RawVoxel v = detail::split(c.before.at(x, y, z));
    if (v.number == 0) return;
    const bool shared = !v.bare && v.share < haptic_full;
    const int other = shared ? detail::other_shape(c.before, v.number, x, y, z) : 0;
    if (!c.cut[std::size_t(v.number)] && !c.cut[std::size_t(other)]) return;
    const int left = c.solid.at(i, j, k).left;
    detail::change_voxel(c.volume.voxels.at(i, j, k), [&](std::int16_t raw) {
      // A voxel that a drill cuts meanwhile becomes bare, and may then belong to its other shape.
      const RawVoxel is = detail::split(raw);
      return is.number == 0 ? raw : lowered(is, is.bare || is.share == haptic_full ? 0 : other, c.cut, left);
    });
  });
  // The neighbours decide to which shape the rest of a voxel belongs. Where that has changed, the rest becomes EMPTY.
  const grid::Box beside = grid::grown(c.box, 1, c.volume.voxels);
  for_each_voxel(beside, progress, [&](int i, int j, int k) {
    std::int16_t& raw = c.volume.voxels.at(i, j, k);
    const RawVoxel v = detail::split(detail::load_voxel(raw));
    if (v.number == 0 || v.bare || v.share == haptic_full) return;
    const int was = detail::other_shape(c.before, v.number, i - b[0], j - b[1], k - b[2]);
    if (detail::other_shape(c.volume.voxels, v.number, i, j, k) == was) return;
    detail::change_voxel(raw, [](std::int16_t is) {
      const RawVoxel now = detail::split(is);
      return now.number == 0 ? is : detail::join(now.number, now.share, true);
    });
  });
}

const HapticShape* window_at(const HapticVolume& volume, int hu) {
  for (const HapticShape& s : volume.shapes)
    if (hu >= s.window_low && hu <= s.window_high) return &s;
  return nullptr;
}

bool beside_another_window(const Cut& c, const HapticShape* own, int i, int j, int k) {
  for (int z = std::max(0, k - 1); z <= std::min(c.before.size[2] - 1, k + 1); ++z)
    for (int y = std::max(0, j - 1); y <= std::min(c.before.size[1] - 1, j + 1); ++y)
      for (int x = std::max(0, i - 1); x <= std::min(c.before.size[0] - 1, i + 1); ++x) {
        const HapticShape* s = window_at(c.volume, c.before.at(x, y, z));
        if (s && s != own) return true;
      }
  return false;
}

void cut_hu_windows(const Cut& c, const Progress& progress) {
  const auto& b = c.around.begin;
  const HapticShape* lowest = nullptr;
  for (const HapticShape& s : c.volume.shapes)
    if (!lowest || s.window_low < lowest->window_low) lowest = &s;
  if (!lowest) return;
  for_each_voxel(c.box, progress, [&](int i, int j, int k) {
    const int x = i - b[0], y = j - b[1], z = k - b[2], hu = c.before.at(x, y, z);
    const HapticShape* own = window_at(c.volume, hu);
    if (own ? !c.cut[std::size_t(own->number)] : !c.all) return;
    const auto s = c.solid.at(i, j, k);
    if (s.left == haptic_full) return;
    int value = s.distance_mm < 0 ? std::min(hu, haptic_beyond_hu) : hu;
    const bool air = hu < lowest->window_low;
    if (s.left > 0 && (own || air) && !beside_another_window(c, own ? own : lowest, x, y, z)) {
      // The solid's distance in HU about the window's low end. Within the solid it must fall below every window.
      const int low = (own ? own : lowest)->window_low;
      const double wanted = low + std::max(1, low - haptic_beyond_hu) * s.distance_mm / s.ramp_mm;
      const int level = int(std::floor(wanted + 0.5));
      if (s.distance_mm >= 0)
        value = air ? hu : std::min(hu, std::max(low, level));
      else
        value = std::min({hu, std::max(level, haptic_beyond_hu), lowest->window_low - 1});
    }
    detail::change_voxel(c.volume.voxels.at(i, j, k),
                         [&](std::int16_t raw) { return std::min(raw, std::int16_t(value)); });
  });
}

}  // namespace

std::array<double, haptic_max_shapes + 1> shape_volumes_mm3(const HapticVolume& volume) {
  const Sums filled = filled_by_shape(volume, volume.voxels);
  std::array<double, haptic_max_shapes + 1> mm3{};
  for (std::size_t n = 1; n < mm3.size(); ++n)
    mm3[n] = double(filled[n]) / volume_unit * volume.voxels.voxel_volume_mm3();
  return mm3;
}

double shape_volume_mm3(const HapticVolume& volume, int number) {
  return number < 1 || number > haptic_max_shapes ? 0 : shape_volumes_mm3(volume)[std::size_t(number)];
}

Outcome<std::monostate, CutVolumeResult> cut_volume(HapticVolume& volume, const surface::DistanceFunction& solid,
                                                    const surface::Bounds& solid_bounds_mm,
                                                    const std::vector<int>& shape_numbers, const Progress& progress) {
  const auto cut = cut_shapes(volume, shape_numbers);
  Vec3 margin;
  for (int a = 0; a < 3; ++a)
    margin[a] = 0.5 * (1 + detail::largest_ramp_mm(volume.voxels) / volume.voxels.spacing_mm[a]) + 1e-6;
  const grid::Box box = detail::box_of(volume.voxels, solid_bounds_mm, margin);
  const auto is_cut = [&](const HapticShape& s) { return cut[std::size_t(s.number)]; };
  Sums removed{};
  std::size_t changed = 0;
  if (!box.empty()) {
    const grid::Box around = grid::grown(box, 2, volume.voxels);
    const grid::Grid<std::int16_t> before = detail::copy_voxels(volume.voxels, around);
    const SolidOnLattice on_lattice(volume.voxels, solid);
    const Cut c{
        volume, on_lattice, box, around, before, cut, std::all_of(volume.shapes.begin(), volume.shapes.end(), is_cut)};
    if (volume.encoding == HapticEncoding::occupancy)
      cut_occupancy(c, progress);
    else
      cut_hu_windows(c, progress);
    const grid::Grid<std::int16_t> after = detail::copy_voxels(volume.voxels, around);
    const Sums had = filled_by_shape(volume, before), has = filled_by_shape(volume, after);
    for (std::size_t n = 1; n < had.size(); ++n) removed[n] = had[n] - has[n];
    for (std::size_t i = 0; i < after.voxels.size(); ++i) changed += after.voxels[i] != before.voxels[i];
  }
  Outcome<std::monostate, CutVolumeResult> out;
  bool any = false;
  std::string names;
  for (const HapticShape& s : volume.shapes) {
    if (!is_cut(s)) continue;
    any = any || removed[std::size_t(s.number)] != 0;
    names += (names.empty() ? "" : ", ") + s.name;
    const double removed_mm3 = double(removed[std::size_t(s.number)]) / volume_unit * volume.voxels.voxel_volume_mm3();
    out.result.shapes.emplace_back(s.name, Removed{removed_mm3});
  }
  out.result.voxels_count = changed;
  if (!any)
    out.warnings.push_back(
        {"removes_nothing", "removes nothing of {shapes}", {{"shapes", names.empty() ? "the haptic volume" : names}}});
  progress.report(1);
  return out;
}

}  // namespace trephine::voxel
