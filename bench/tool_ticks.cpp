// SPDX-License-Identifier: GPL-3.0-or-later
// CPU time of a haptic tick of every tool in holes of 3, 5 and 8 mm, voxels of 0.4 mm: pushed in, moved and turned
// about at random against the walls, drawn out. The clock's own reading is taken off.
//   bench_tool_ticks [SESSIONS [TOOL...]]     (of each tool in each hole, of about 500 ticks; 20 by default, all tools)
// Each session is run three times, and the shortest time of a tick counts: equal inputs give equal work, and what else
// the machine does only adds to it.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

constexpr double top_mm = 4, voxel_mm = 0.4;
constexpr int rounds = 3;

double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * double(t.tv_sec) + 1e-3 * double(t.tv_nsec);
}

double clock_cost_us() {
  double least = 1e9;
  for (int n = 0; n < 10000; ++n) {
    const double begin = cpu_us();
    least = std::min(least, cpu_us() - begin);
  }
  return least;
}

double between(std::mt19937_64& rng, double from, double to) {
  return from + (to - from) * double(rng() >> 11) * 0x1p-53;
}

// Bone below the plane z = 4, with a hole down to z = -8.
voxel::HapticVolume block(double hole_mm) {
  voxel::HapticVolume v = empty(70, {voxel_mm, voxel_mm, voxel_mm});
  fill_wide(v, 1,
            [&](Vec3 p) { return std::min(top_mm - p.z, std::max(std::hypot(p.x, p.y) - hole_mm / 2, -8 - p.z)); });
  return v;
}

std::vector<haptics::HapticInput> session_of(std::mt19937_64& rng) {
  std::vector<haptics::HapticInput> inputs;
  Vec3 tip{0, 0, top_mm + 6}, axis{0, 0, 1};
  const auto move = [&](Vec3 to, Vec3 to_axis, int ticks) {
    const Vec3 from = tip, from_axis = axis;
    for (int n = 1; n <= ticks; ++n) {
      tip = from + (to - from) * (double(n) / ticks);
      axis = normalized(from_axis + (to_axis - from_axis) * (double(n) / ticks));
      inputs.push_back(pose(tip, axis));
    }
  };
  move({0, 0, between(rng, -6, 0)}, {0, 0, 1}, 100);
  for (int n = 0; n < 6; ++n)
    move({between(rng, -4, 4), between(rng, -4, 4), between(rng, -7, 3)},
         normalized({between(rng, -0.9, 0.9), between(rng, -0.9, 0.9), 1}), int(between(rng, 20, 100)));
  move(tip + axis * ((top_mm + 13 - tip.z) / std::max(0.3, axis.z)), axis, 60);
  return inputs;
}

struct Times {
  std::vector<double> us;
  double at(double share) const { return us[std::min(us.size() - 1, std::size_t(share * double(us.size())))]; }
};

Times times_of(const char* kind, double hole_mm, int sessions) {
  voxel::HapticVolume volume = block(hole_mm);
  const contact::ContactVolume contact(volume);
  const double length = haptics::tool_kind(kind).length_mm;
  const haptics::Tool tool = haptics::make_tool(params_of(kind, 0.8 * hole_mm, std::max(length, 0.8 * hole_mm)));
  std::mt19937_64 rng(3);
  const double cost = clock_cost_us();
  Times out;
  for (int n = 0; n < sessions; ++n) {
    const std::vector<haptics::HapticInput> inputs = session_of(rng);
    std::vector<double> least(inputs.size(), 1e9);
    for (int round = 0; round < rounds; ++round) {
      haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), {}, {}, tool);
      for (std::size_t i = 0; i < inputs.size(); ++i) {
        const double begin = cpu_us();
        proxy.update(inputs[i]);
        least[i] = std::min(least[i], std::max(0.0, cpu_us() - begin - cost));
      }
    }
    out.us.insert(out.us.end(), least.begin(), least.end());
  }
  std::sort(out.us.begin(), out.us.end());
  return out;
}

}  // namespace

int main(int count, char** words) {
  const int sessions = count > 1 ? std::max(1, std::atoi(words[1])) : 20;
  std::printf(
      "| tool | points | hole, mm | ticks | p50 | p99 | p99.9 | most, us |\n|---|---|---|---|---|---|---|---|\n");
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
    if (!(kind.length_mm > 0) || kind.from_file) continue;
    if (count > 2 && std::find(words + 2, words + count, std::string(kind.name)) == words + count) continue;
    for (const double hole_mm : {3.0, 5.0, 8.0}) {
      const Times t = times_of(kind.name, hole_mm, sessions);
      const std::size_t points =
          haptics::make_tool(params_of(kind.name, 0.8 * hole_mm, kind.length_mm)).points_mm.size();
      std::printf("| `%s` | %zu | %.0f | %zu | %.0f | %.0f | %.0f | %.0f |\n", kind.name, points, hole_mm, t.us.size(),
                  t.at(0.5), t.at(0.99), t.at(0.999), t.us.back());
      std::fflush(stdout);
    }
  }
}
