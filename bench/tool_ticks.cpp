// SPDX-License-Identifier: GPL-3.0-or-later
// CPU time of a haptic tick of every tool in holes of 3, 5 and 8 mm, voxels of 0.4 mm: pushed in, moved and turned
// about at random against the walls, drawn out. The clock's own reading is taken off.
//   bench_tool_ticks [SESSIONS [TOOL...]]     (of each tool in each hole, of about 500 ticks; 20 by default, all tools)
//   bench_tool_ticks plate [SESSIONS [TOOL...]]   (the same with a plate of 20,000 triangles on the bone, felt as a
//   mesh)
// The largest tick of a session is the median of all sessions; `felt` is a digest of every force and place, by which
// two versions of the program are compared bit for bit. Each session is run three times, and the shortest time of a
// tick counts: equal inputs give equal work, and what else the machine does only adds to it.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "touch_meshes.h"

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

// Bone below that plane, with a hole down to z = -8.
voxel::HapticVolume block(double hole_mm, double top_mm) {
  voxel::HapticVolume v = empty(70, {voxel_mm, voxel_mm, voxel_mm});
  fill_wide(v, 1,
            [&](Vec3 p) { return std::min(top_mm - p.z, std::max(std::hypot(p.x, p.y) - hole_mm / 2, -8 - p.z)); });
  return v;
}

// A round plate of 1 mm on the bone, 28 mm wide, with the same hole.
surface::TriMesh plate(double hole_mm) {
  constexpr int rings = 48, around = 102;
  surface::TriMesh m;
  const auto at = [&](int side, int r, int a) { return std::uint32_t((side * (rings + 1) + r) * around + a % around); };
  for (int side = 0; side < 2; ++side)
    for (int r = 0; r <= rings; ++r)
      for (int a = 0; a < around; ++a) {
        const double radius = hole_mm / 2 + (14 - hole_mm / 2) * r / rings, turn = 2 * M_PI * a / around;
        m.points_mm.push_back({radius * std::cos(turn), radius * std::sin(turn), top_mm + 0.01 + side});
      }
  const auto square = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (int a = 0; a < around; ++a) {
    for (int r = 0; r < rings; ++r) {
      square(at(1, r, a), at(1, r + 1, a), at(1, r + 1, a + 1), at(1, r, a + 1));
      square(at(0, r, a), at(0, r, a + 1), at(0, r + 1, a + 1), at(0, r + 1, a));
    }
    square(at(0, 0, a), at(1, 0, a), at(1, 0, a + 1), at(0, 0, a + 1));
    square(at(0, rings, a), at(0, rings, a + 1), at(1, rings, a + 1), at(1, rings, a));
  }
  return m;
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

std::vector<haptics::HapticInput> in_air(std::mt19937_64& rng) {
  std::vector<haptics::HapticInput> inputs;
  const auto place = [&] { return Vec3{between(rng, -9, 9), between(rng, -9, 9), top_mm + between(rng, 6, 12)}; };
  const auto lean = [&] { return normalized({between(rng, -0.5, 0.5), between(rng, -0.5, 0.5), 1}); };
  Vec3 tip = place(), axis = lean();
  for (int way = 0; way < 6; ++way) {
    const Vec3 from = tip, from_axis = axis;
    tip = place();
    axis = lean();
    for (int n = 1; n <= 100; ++n)
      inputs.push_back(pose(from + (tip - from) * (0.01 * n), from_axis + (axis - from_axis) * (0.01 * n)));
  }
  return inputs;
}

struct Times {
  std::vector<double> us;
  std::vector<double> most_us;       // of each session
  std::uint64_t felt = 1469598103u;  // a digest of every force, torque and place
  void feel(const haptics::HapticState& s) {
    for (const Vec3 v : {s.force_n, s.torque_n_mm, s.proxy_mm, s.axis})
      for (const double x : {v.x, v.y, v.z}) {
        std::uint64_t bits;
        std::memcpy(&bits, &x, sizeof bits);
        felt = (felt ^ bits) * 0x9e3779b97f4a7c15;
        felt ^= felt >> 29;
      }
  }
  double most_of_a_session() const { return most_us[most_us.size() / 2]; }  // the median
  double at(double share) const { return us[std::min(us.size() - 1, std::size_t(share * double(us.size())))]; }
};

enum class Plate { none, voxels, mesh, far };  // far: there is none, and the tool is in the open

Times times_of(const char* kind, double hole_mm, int sessions, Plate with = Plate::none) {
  voxel::HapticVolume volume = block(hole_mm, with == Plate::voxels ? top_mm + 1.01 : top_mm);
  const contact::ContactVolume contact(volume);
  std::optional<touch::MeshSurfaces> meshes;
  if (with == Plate::mesh)
    meshes.emplace(std::vector<touch::MeshSurfaces::Part>{{plate(hole_mm), touch::first_mesh_shape}},
                   0.00025 * voxel_mm);
  const touch::FeltSpace space(contact, {meshes ? &*meshes : nullptr, nullptr});
  haptics::Feels feels = one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3));
  feels[touch::first_mesh_shape] = feels[1];
  const double length = haptics::tool_kind(kind).length_mm;
  const haptics::Tool tool = length > 0
                                 ? haptics::make_tool(params_of(kind, 0.8 * hole_mm, std::max(length, 0.8 * hole_mm)))
                                 : haptics::Tool{};
  std::mt19937_64 rng(3);
  const double cost = clock_cost_us();
  Times out;
  for (int n = 0; n < sessions; ++n) {
    const std::vector<haptics::HapticInput> inputs = with == Plate::far ? in_air(rng) : session_of(rng);
    std::vector<double> least(inputs.size(), 1e9);
    for (int round = 0; round < rounds; ++round) {
      haptics::Proxy proxy(space, feels, {}, {}, tool);
      for (std::size_t i = 0; i < inputs.size(); ++i) {
        const double begin = cpu_us();
        proxy.update(inputs[i]);
        least[i] = std::min(least[i], std::max(0.0, cpu_us() - begin - cost));
        if (round == 0) out.feel(proxy.state());
      }
    }
    out.us.insert(out.us.end(), least.begin(), least.end());
    out.most_us.push_back(*std::max_element(least.begin(), least.end()));
  }
  std::sort(out.us.begin(), out.us.end());
  std::sort(out.most_us.begin(), out.most_us.end());
  return out;
}

void compare_plate(int sessions, const std::vector<std::string>& tools) {
  std::printf(
      "| tool | bone alone: p50 | p99 | most, us | plate of voxels: p50 | p99 | most, us | plate as a mesh: p50 | p99 "
      "| "
      "most, us |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
    if (kind.from_file || (!(kind.length_mm > 0) && std::string(kind.name) != "point")) continue;
    if (!tools.empty() && std::find(tools.begin(), tools.end(), kind.name) == tools.end()) continue;
    std::printf("| `%s` |", kind.name);
    for (const Plate with : {Plate::none, Plate::voxels, Plate::mesh}) {
      const Times t = times_of(kind.name, 5, sessions, with);
      std::printf(" %.1f | %.1f | %.1f (%.1f, %016llx) |", t.at(0.5), t.at(0.99), t.us.back(), t.most_of_a_session(),
                  static_cast<unsigned long long>(t.felt));
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** words) {
  if (count > 1 && std::string(words[1]) == "air") {
    std::printf("| tool | p50 | p99 | most, us |\n|---|---|---|---|\n");
    for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
      if (kind.from_file || (!(kind.length_mm > 0) && std::string(kind.name) != "point")) continue;
      const Times t = times_of(kind.name, 5, 5, Plate::far);
      std::printf("| `%s` | %.1f | %.1f | %.1f |\n", kind.name, t.at(0.5), t.at(0.99), t.us.back());
    }
    return 0;
  }
  if (count > 1 && std::string(words[1]) == "plate") {
    compare_plate(count > 2 ? std::max(1, std::atoi(words[2])) : 6, {words + std::min(count, 3), words + count});
    return 0;
  }
  const int sessions = count > 1 ? std::max(1, std::atoi(words[1])) : 20;
  std::printf(
      "| tool | points | hole, mm | ticks | p50 | p99 | p99.9 | most of a session | most, us | felt |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
    if (!(kind.length_mm > 0) || kind.from_file) continue;
    if (count > 2 && std::find(words + 2, words + count, std::string(kind.name)) == words + count) continue;
    for (const double hole_mm : {3.0, 5.0, 8.0}) {
      const Times t = times_of(kind.name, hole_mm, sessions);
      const std::size_t points =
          haptics::make_tool(params_of(kind.name, 0.8 * hole_mm, kind.length_mm)).points_mm.size();
      std::printf("| `%s` | %zu | %.0f | %zu | %.0f | %.0f | %.0f | %.0f | %.0f | %016llx |\n", kind.name, points,
                  hole_mm, t.us.size(), t.at(0.5), t.at(0.99), t.at(0.999), t.most_of_a_session(), t.us.back(),
                  static_cast<unsigned long long>(t.felt));
      std::fflush(stdout);
    }
  }
}
