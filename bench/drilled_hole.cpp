// SPDX-License-Identifier: GPL-3.0-or-later
// bench_drilled_hole [--hole DRILLED_CASE] CASE RECORDING...: what a recorded session drilled, against the solid that
// its cutter swept, and against the boolean's hole. For each recording: the time, the removed volume against the part
// of the swept solid that was bone, bone that was swept and stands, how far the breach that was noticed lies from the
// inner table, the hole beside a cylinder that cut_volume takes out along the same axis (and beside that of a case of
// the same head whose hole was cut by the pipeline), and the bricks that followed beside a surface made anew and a
// contour.
//
// The swept solid is that of a ball of the tool's diameter about its recorded centres, on a lattice four times finer
// than the voxels. A part of it counts by the occupancy of the voxel in which it lies, as removal does.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "beside_boolean.h"
#include "session/felt_case.h"
#include "session/session.h"

using namespace trephine;

namespace {

constexpr int finer = 4;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

// The centres of the ball while it cut, no two neighbours nearer than a fifth of a fine step.
std::vector<Vec3> centres_of(const haptics::Recording& r, double radius_mm, double apart_mm) {
  std::vector<Vec3> out;
  for (const haptics::ServoFrame& f : r.frames) {
    if (!(f.buttons & haptics::Drilling::pedal) || (f.buttons & haptics::haptic_button::lifted) || f.faults != 0)
      continue;
    const Vec3 at = vec(f.tip_mm) + normalized(vec(f.axis)) * radius_mm;
    if (out.empty() || norm(at - out.back()) > apart_mm) out.push_back(at);
  }
  return out;
}

struct Volumes {
  double swept_mm3 = 0, standing_mm3 = 0;  // of the drillable shapes within the swept solid: before, and after
};

Volumes volumes(const voxel::HapticVolume& before, const voxel::HapticVolume& after, const drill::DrillShapes& shapes,
                const std::vector<Vec3>& centres, double radius_mm) {
  const grid::Lattice& l = before.voxels;
  grid::Box box{{l.size[0], l.size[1], l.size[2]}, {0, 0, 0}};
  for (const Vec3 c : centres)
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = l.to_index(c)[int(a)], reach = radius_mm / l.spacing_mm[int(a)] + 1;
      box.begin[a] = std::max(0, std::min(box.begin[a], int(std::floor(at - reach))));
      box.end[a] = std::min(l.size[a], std::max(box.end[a], int(std::ceil(at + reach)) + 1));
    }
  Volumes out;
  if (box.empty()) return out;
  // Fine cell (x, y, z) has its middle at voxel coordinate begin - 1/2 + (x + 1/2) / finer.
  std::array<int, 3> n{};
  for (std::size_t a = 0; a < 3; ++a) n[a] = finer * (box.end[a] - box.begin[a]);
  std::vector<bool> swept(std::size_t(n[0]) * std::size_t(n[1]) * std::size_t(n[2]), false);
  const auto index = [&](int x, int y, int z) {
    return (std::size_t(z) * std::size_t(n[1]) + std::size_t(y)) * std::size_t(n[0]) + std::size_t(x);
  };
  for (const Vec3 c : centres) {
    Vec3 fine, reach;  // in fine cells
    for (int a = 0; a < 3; ++a) {
      fine[a] = (l.to_index(c)[a] - box.begin[std::size_t(a)] + 0.5) * finer - 0.5;
      reach[a] = radius_mm / l.spacing_mm[a] * finer;
    }
    for (int z = std::max(0, int(std::ceil(fine.z - reach.z))); z <= std::min(n[2] - 1, int(fine.z + reach.z)); ++z)
      for (int y = std::max(0, int(std::ceil(fine.y - reach.y))); y <= std::min(n[1] - 1, int(fine.y + reach.y)); ++y) {
        const double across = std::pow((y - fine.y) / reach.y, 2) + std::pow((z - fine.z) / reach.z, 2);
        if (across >= 1) continue;
        const double half = reach.x * std::sqrt(1 - across);
        for (int x = std::max(0, int(std::ceil(fine.x - half))); x <= std::min(n[0] - 1, int(fine.x + half)); ++x)
          swept[index(x, y, z)] = true;
      }
  }
  const voxel::HapticDecoder was(before), is(after);
  const double share = l.voxel_volume_mm3() / (finer * finer * finer);
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        int cells = 0;
        for (int z = 0; z < finer; ++z)
          for (int y = 0; y < finer; ++y)
            for (int x = 0; x < finer; ++x)
              cells += swept[index(finer * (i - box.begin[0]) + x, finer * (j - box.begin[1]) + y,
                                   finer * (k - box.begin[2]) + z)];
        if (cells == 0) continue;
        double first = 0, last = 0;
        for (const voxel::HapticShape& s : before.shapes) {
          const drill::DrillShape& d = shapes[std::size_t(s.number)];
          if (!d.cuttable || !(d.energy_j_per_mm3 > 0)) continue;
          first += was.occupancy(s.number, i, j, k);
          last += is.occupancy(s.number, i, j, k);
        }
        out.swept_mm3 += first * cells * share;
        out.standing_mm3 += last * cells * share;
      }
  return out;
}

void look_at(const char* folder, const char* file, const std::string& drilled_case) {
  const haptics::Recording r = haptics::read_recording(file);
  const haptics::RecordingHeader& h = r.header;
  session::FeltCase felt = session::felt_again(folder, file, h);
  voxel::HapticVolume before;
  before.encoding = felt.loaded.haptic.encoding;
  before.voxels = felt.loaded.haptic.voxels;
  before.shapes = felt.loaded.haptic.shapes;
  contact::ContactVolume contact(felt.loaded.haptic, h.contact), uncut(before);
  const drill::DrillShapes shapes = haptics::drill_shapes_of(felt.loaded.manifest.haptic);
  drill::DirtyBricks marks(before.voxels);
  session::Rerun rerun(felt, contact, file, h, &marks);
  std::vector<std::pair<int, std::unique_ptr<drill::LiveSurface>>> surfaces;
  for (const voxel::HapticShape& s : before.shapes)
    if (bits_of(shapes) >> s.number & 1)
      surfaces.emplace_back(s.number, std::make_unique<drill::LiveSurface>(felt.loaded.haptic, s.number));
  std::vector<std::size_t> marked;
  rerun.run(r.frames);
  marks.take(marked);
  for (const auto& [number, surface] : surfaces) surface->update(marked);
  if (!rerun.drilling()) throw std::runtime_error("the tool of this recording does not cut");
  const double radius_mm = 0.5 * haptics::own_tool(h.tool).tool_diameter_mm;
  const Volumes v = volumes(before, felt.loaded.haptic, shapes, centres_of(r, radius_mm, 0.02), radius_mm);
  const haptics::DrillingOutcome& o = rerun.drilling()->outcome();
  double removed = 0;
  for (const voxel::HapticShape& s : before.shapes)
    if (shapes[std::size_t(s.number)].energy_j_per_mm3 > 0)
      removed += double(o.units[std::size_t(s.number)]) / voxel::haptic_full * before.voxels.voxel_volume_mm3();
  std::printf(
      "%s: %.1f s, drilled %.1f s, stalled %.1f s; removed %.1f mm3, swept bone %.1f mm3: %+.2f %%; of it %.1f "
      "mm3 stand\n",
      file, r.frames.back().time_s, o.drilled_s, o.stalled_s, removed, v.swept_mm3, 100 * (removed / v.swept_mm3 - 1),
      v.standing_mm3);
  beside_boolean(before, felt.loaded.haptic, shapes, r, radius_mm, drilled_case);
  for (const auto& [number, surface] : surfaces) beside_contour(felt.loaded.haptic, number, *surface);
  if (!o.breached) {
    std::printf("  no breach\n");
    return;
  }
  // The inner table along the tool's axis, either way from where the breach was noticed.
  contact::TouchableFaces inner{0, 0};
  for (std::size_t n = 1; n < shapes.size(); ++n)
    if (shapes[n].cuttable && shapes[n].energy_j_per_mm3 > 0) inner.back |= std::uint64_t{1} << n;
  const contact::TouchableFaces both{inner.back, inner.back};
  const auto at = std::find_if(r.frames.begin(), r.frames.end(),
                               [&](const haptics::ServoFrame& f) { return f.time_s >= o.breach_time_s - 1e-9; });
  const Vec3 axis = at == r.frames.end() ? Vec3{0, 0, 1} : normalized(vec(at->axis));
  double nearest = 5;
  for (const double sign : {1.0, -1.0})
    if (const contact::Contact c = uncut.intersect(o.breach_mm, o.breach_mm + axis * (sign * 5), both); c.hit)
      nearest = std::min(nearest, norm(c.point_mm - o.breach_mm));
  std::printf("  breach after %.2f s, %.3f mm from the inner table\n", o.breach_time_s, nearest);
}

}  // namespace

int main(int argc, char** argv) {
  const bool hole = argc > 2 && std::string(argv[1]) == "--hole";
  const int first = hole ? 3 : 1;
  if (argc < first + 2) {
    std::fprintf(stderr, "bench_drilled_hole [--hole DRILLED_CASE] CASE RECORDING...\n");
    return 64;
  }
  try {
    for (int n = first + 1; n < argc; ++n) look_at(argv[first], argv[n], hole ? argv[2] : "");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 70;
  }
}
