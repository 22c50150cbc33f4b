// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/bubbles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "base/text.h"
#include "mask/box_about.h"
#include "mask/filters.h"
#include "surface/bounds.h"

namespace trephine::segmentation {
namespace {

std::vector<std::string> split(std::string_view s, char by) {
  std::vector<std::string> parts = split_at(s, by);
  for (std::string& part : parts) {
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
  }
  return parts;
}

std::string described(const Bubble& b) {
  return fmt::format("{},{},{},{}", trephine::to_text(b.centre_mm.x), trephine::to_text(b.centre_mm.y),
                     trephine::to_text(b.centre_mm.z), trephine::to_text(b.radius_mm));
}

/// "x -80 to 75, y -100 to 90, z 0 to 120 mm": where the lattice's voxels lie.
std::string reach_of(const grid::Lattice& l) {
  const auto [low, high] = surface::bounds_of(l);
  return fmt::format("x {:.0f} to {:.0f}, y {:.0f} to {:.0f}, z {:.0f} to {:.0f} mm", low.x, high.x, low.y, high.y,
                     low.z, high.z);
}

/// Calls f(voxel, distance from the centre in mm) for the voxels of the ball's box, where it meets the lattice.
template <class F>
void for_ball(const Bubble& b, const grid::Lattice& l, double margin_mm, F&& f) {
  mask::for_box_about(l, b.centre_mm, b.radius_mm + margin_mm, [&](int i, int j, int k, double mm) {
    f(l.index(i, j, k), mm);
    return false;
  });
}

/// Means over blocks of voxels, so that no side is below 1 mm.
grid::Grid<float> coarsened(const grid::Field& speed) {
  int step[3];
  grid::Lattice l = speed;
  Vec3 shift;
  for (int a = 0; a < 3; ++a) {
    step[a] = std::clamp(int(std::lround(1 / l.spacing_mm[a])), 1, std::max(1, l.size[a]));
    l.size[a] = (l.size[a] + step[a] - 1) / step[a];
    l.spacing_mm[a] *= step[a];
    shift[a] = 0.5 * (step[a] - 1);
  }
  l.origin_mm = speed.to_world_mm(shift);
  grid::Grid<float> sum(l), count(l);
  for (int k = 0; k < speed.size[2]; ++k)
    for (int j = 0; j < speed.size[1]; ++j)
      for (int i = 0; i < speed.size[0]; ++i) {
        const std::size_t v = l.index(i / step[0], j / step[1], k / step[2]);
        sum.voxels[v] += speed.at(i, j, k);
        count.voxels[v] += 1;
      }
  for (std::size_t v = 0; v < l.count(); ++v) sum.voxels[v] /= count.voxels[v];
  return sum;
}

}  // namespace

std::vector<Bubble> parse_bubbles(const std::string& text) {
  std::vector<Bubble> bubbles;
  for (const std::string_view part : split(text, ';')) {
    const auto items = split(part, ',');
    double v[4];
    bool good = items.size() == 4;
    for (std::size_t i = 0; good && i < 4; ++i) {
      const auto number = parse_number(items[i]);
      good = number && std::abs(*number) <= 1e6;
      if (good) v[i] = *number;
    }
    if (!good || !(v[3] > 0))
      throw Error(ExitCode::usage, "", "bubbles",
                  "\"" + printable(part) + "\", must be x,y,z,radius in mm with a radius above 0, several parted by ;");
    bubbles.push_back({{v[0], v[1], v[2]}, v[3]});
  }
  return bubbles;
}

std::vector<Bubble> place_bubbles(const grid::Field& speed, int count, double min_radius_mm, const Progress& progress) {
  constexpr double share = 0.9;  // of the ball that fits
  const grid::Grid<float> coarse = coarsened(speed);
  const mask::BitMask held = mask::make_mask(coarse, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < coarse.size[0]; ++i) row[i] = !(coarse.at(i, j, k) > 0);
  });
  const grid::Grid<float> free = mask::distance_mm(held, progress);

  struct Place {
    float radius;
    std::uint32_t voxel;
  };
  std::vector<Place> places;
  float largest = 0;
  for (int k = 0; k < coarse.size[2]; ++k)
    for (int j = 0; j < coarse.size[1]; ++j)
      for (int i = 0; i < coarse.size[0]; ++i) {
        double room = free.at(i, j, k);
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; ++a)
          room = std::min(room, (0.5 + std::min(at[a], coarse.size[a] - 1 - at[a])) * coarse.spacing_mm[a]);
        const float radius = float(share * room);
        largest = std::max(largest, radius);
        if (radius >= min_radius_mm) places.push_back({radius, std::uint32_t(coarse.index(i, j, k))});
      }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return a.radius != b.radius ? a.radius > b.radius : a.voxel < b.voxel;
  });
  std::vector<Bubble> bubbles;
  for (const Place& p : places) {
    if (int(bubbles.size()) >= count) break;
    const int i = int(p.voxel % std::uint32_t(coarse.size[0])),
              j = int(p.voxel / std::uint32_t(coarse.size[0]) % std::uint32_t(coarse.size[1])),
              k = int(p.voxel / (std::uint32_t(coarse.size[0]) * std::uint32_t(coarse.size[1])));
    const Bubble b{coarse.to_world_mm({double(i), double(j), double(k)}), p.radius};
    bool apart = true;
    for (const Bubble& o : bubbles) apart = apart && norm(o.centre_mm - b.centre_mm) > o.radius_mm;
    if (apart) bubbles.push_back(b);
  }
  if (bubbles.empty())
    throw refusal("bubble_min_radius_mm",
                  fmt::format("no ball of {} mm fits where the speed is positive, the largest has {:.2g} mm",
                              trephine::to_text(min_radius_mm), largest),
                  {"check what `presegment` made, or lower `bubble_min_radius_mm`"});
  return bubbles;
}

std::string to_text(const std::vector<Bubble>& bubbles) {
  std::string all;
  for (const Bubble& b : bubbles)
    all += fmt::format("{}{:.1f},{:.1f},{:.1f},{:.1f}", all.empty() ? "" : "; ", b.centre_mm.x, b.centre_mm.y,
                       b.centre_mm.z, b.radius_mm);
  return all;
}

grid::Field bubble_field(const std::vector<Bubble>& bubbles, const grid::Lattice& lattice) {
  const double margin = 3 * std::max({lattice.spacing_mm.x, lattice.spacing_mm.y, lattice.spacing_mm.z});
  grid::Field field(lattice, float(-margin));
  for (std::size_t n = 0; n < bubbles.size(); ++n) {
    bool any = false;
    for_ball(bubbles[n], lattice, margin, [&](std::size_t v, double distance) {
      const double depth = bubbles[n].radius_mm - distance;
      any = any || depth > 0;
      field.voxels[v] = std::max(field.voxels[v], float(depth));
    });
    if (!any)
      throw refusal(
          "bubbles",
          fmt::format("ball {} ({}) holds 0 voxels of the speed image ({}), which presegment makes of its region "
                      "and `within` alone: it lies outside, or between voxels",
                      n + 1, described(bubbles[n]), reach_of(lattice)),
          {"move or enlarge it in `bubbles`, or widen `roi_min_mm` and `roi_max_mm` of `presegment`"});
  }
  return field;
}

void check_bubbles(const std::vector<Bubble>& bubbles, const grid::Field& speed) {
  for (std::size_t n = 0; n < bubbles.size(); ++n) {
    bool any = false;
    for_ball(bubbles[n], speed, 0, [&](std::size_t v, double distance) {
      any = any || (distance < bubbles[n].radius_mm && speed.voxels[v] > 0);
    });
    if (!any)
      throw refusal("bubbles",
                    fmt::format("ball {} ({}) lies wholly outside the structure: the speed is positive nowhere in it",
                                n + 1, described(bubbles[n])),
                    {"move it in `bubbles`, or check what `presegment` made"});
  }
}

}  // namespace trephine::segmentation
