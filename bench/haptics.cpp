// SPDX-License-Identifier: GPL-3.0-or-later
// CPU time of a haptic tick (proxy and force), this thread's own, the clock's reading taken off from all but `in a
// row`, which is the mean of ticks without a clock between them:
//   bench_haptics [--tools | --shape NAME] [CASE...]
// --tools: only by the points of the tool; --shape: only that shape of the cases, without tools. Over synthetic volumes
// by number of shapes, size, speed and contact method, then over the surfaces of cases. Run it with other programs
// idle: their cache misses count, their time does not.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "cases/load_case.h"
#include "device/hand_path.h"
#include "haptics/proxy.h"

using namespace trephine;

namespace {

double cpu_ns() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * double(t.tv_sec) + double(t.tv_nsec);
}

double clock_cost_ns() {
  std::vector<double> v(20001);
  for (double& d : v) {
    const double begin = cpu_ns();
    d = cpu_ns() - begin;
  }
  std::nth_element(v.begin(), v.begin() + 10000, v.end());
  return v[10000];
}

struct Times {
  double in_a_row, mean, p50, p99, p999, max, touching;
};

// How a tool lies on its way: about that axis, and how far and fast it sways.
struct Sway {
  Vec3 axis{0, 0, 1};
  double rad = 0;
};

// The device goes along the path at that speed, `ticks` times.
std::vector<haptics::HapticInput> inputs_of(const std::vector<Vec3>& path, double mm_a_frame, int ticks,
                                            const Sway& sway) {
  std::vector<haptics::HapticInput> inputs;
  std::size_t next = 0;
  Vec3 x = path[0];
  for (int n = 0; n < ticks; ++n) {
    double left = mm_a_frame;
    while (left > 0) {
      const Vec3 d = path[next] - x;
      const double length = norm(d);
      if (length > left) {
        x += d * (left / length);
        break;
      }
      x = path[next];
      left -= length;
      next = next + 1 < path.size() ? next + 1 : 1;
    }
    haptics::HapticInput in;
    in.tip_mm = x;
    // At 1 Hz about both axes across: up to 6 times its angle in rad/s.
    const double a = 2 * M_PI * n / 1000;
    in.axis = normalized(sway.axis + Vec3{std::sin(a), std::cos(a), std::sin(1.3 * a)} * sway.rad);
    inputs.push_back(in);
  }
  return inputs;
}

Times measure(haptics::Proxy& proxy, const std::vector<Vec3>& path, double mm_a_frame, int ticks,
              const Sway& sway = {}) {
  constexpr std::size_t unmeasured = 2000;
  const std::vector<haptics::HapticInput> inputs = inputs_of(path, mm_a_frame, ticks + int(unmeasured), sway);
  proxy.reset();
  double row = 0;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (n == unmeasured) row = cpu_ns();
    proxy.update(inputs[n]);
  }
  row = (cpu_ns() - row) / ticks;

  const double cost = clock_cost_ns();
  std::vector<double> ns;
  ns.reserve(inputs.size());
  int touching = 0;
  proxy.reset();
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const double begin = cpu_ns();
    proxy.update(inputs[n]);
    const double t = cpu_ns() - begin - cost;
    if (n < unmeasured) continue;
    ns.push_back(std::max(0.0, t));
    touching += proxy.state().touched != 0;
  }
  std::sort(ns.begin(), ns.end());
  double sum = 0;
  for (const double t : ns) sum += t;
  const auto at = [&](double share) {
    return ns[std::min(ns.size() - 1, std::size_t(share * double(ns.size())))] / 1e3;
  };
  return {row / 1e3,       sum / double(ns.size()) / 1e3,       at(0.5), at(0.99), at(0.999),
          ns.back() / 1e3, 100.0 * touching / double(ns.size())};
}

void print(const std::string& what, const Times& t) {
  std::printf("| %-58s | %6.2f | %6.2f | %6.2f | %6.2f | %6.2f | %7.2f | %5.1f |\n", what.c_str(), t.in_a_row, t.mean,
              t.p50, t.p99, t.p999, t.max, t.touching);
}
void head(const char* what) {
  std::printf(
      "\n| %-58s | in a row | mean | p50    | p99    | p99.9  | max us  | in contact %% "
      "|\n|---|---|---|---|---|---|---|---|\n",
      what);
}

// Nested bumpy shells, the outermost always the same: what lies inside must not matter.
voxel::HapticVolume shells(int n, int shapes) {
  voxel::HapticVolume v;
  grid::Lattice l;
  l.size = {n, n, n};
  const double side = 160.0 / n;
  l.spacing_mm = {side, side, side};
  l.origin_mm = Vec3{1, 1, 1} * (-0.5 * side * (n - 1));
  v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  for (int s = 1; s <= shapes; ++s) v.shapes.push_back(voxel::occupancy_shape("shape_" + std::to_string(s), s));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const double depth = (70 + std::sin(p.x / 7) + std::cos(p.y / 9) - norm(p)) / side;
        const int o = int(std::lround(255 * std::clamp(0.5 + depth, 0.0, 1.0)));
        if (o == 0) continue;
        const int shape = 1 + std::min(shapes - 1, std::max(0, int(depth * side / 4)));
        v.voxels.at(i, j, k) = std::int16_t(1000 * shape + o + (o < 255 ? 300 : 0));
      }
  return v;
}

cases::CaseFace bone() {
  cases::CaseFace f;
  f.stiffness_n_per_mm = 1;
  f.damping_n_s_per_mm = 0.0003;
  f.static_friction_ratio = 0.35;
  f.dynamic_friction_ratio = 0.3;
  return f;
}

struct Method {
  const char* name;
  contact::ContactParams params;
};
const Method methods[] = {
    {"exact, subvoxel", {}},
    {"exact, nearest", {contact::ContactParams::Walk::exact, contact::ContactParams::Surface::nearest, 1}},
    {"stepped, subvoxel", {contact::ContactParams::Walk::stepped, contact::ContactParams::Surface::subvoxel, 0.5}},
    {"stepped, nearest", {contact::ContactParams::Walk::stepped, contact::ContactParams::Surface::nearest, 0.5}}};

// Over the surface at 1 mm of depth for what a hand does; for what it does not, to and fro through everything.
std::vector<Vec3> path_for(const contact::ContactVolume& contact, const contact::TouchableFaces& faces,
                           double mm_a_frame) {
  device::HandPathParams task;
  task.radius_mm = 20;
  std::vector<Vec3> path = device::path_over(contact, faces, task).points_mm;
  if (mm_a_frame < 1) return path;
  const grid::Lattice& l = contact.volume().voxels;
  std::mt19937_64 rng(1);
  const auto uniform = [&] { return double(rng() >> 11) * 0x1p-53; };
  path.clear();
  for (int n = 0; n < 4000; ++n)
    path.push_back(l.to_world_mm({uniform() * l.size[0], uniform() * l.size[1], uniform() * l.size[2]}));
  return path;
}

// A ball's outside, even.
haptics::Tool ball(int points) {
  haptics::Tool t;
  const double r = 2.5;
  t.points_mm.push_back({});
  for (int n = 1; n < points; ++n) {
    const double z = 1 - 2 * (n + 0.5) / points, a = M_PI * (3 - std::sqrt(5)) * n, w = std::sqrt(1 - z * z);
    t.points_mm.push_back(Vec3{w * std::cos(a), w * std::sin(a), 1 - z} * r);
  }
  t.length_mm = 2 * r;
  return t;
}

// A rod, its points 1 mm apart.
haptics::Tool rod(int points) {
  haptics::Tool t;
  for (int n = 0; n < points; ++n) t.points_mm.push_back({0, 0, double(n)});
  t.length_mm = points - 1;
  return t;
}

// Over the surface at 1 mm of depth and 20 mm/s, swaying: what a tick costs by the points of the tool.
void tools_over(const contact::ContactVolume& contact, const haptics::Feels& feels) {
  const std::vector<Vec3> path = path_for(contact, haptics::touchable_of(feels), 0.02);
  const auto run = [&](const std::string& what, const haptics::Tool& tool, const Sway& sway) {
    haptics::Proxy proxy(contact, feels, haptics::ForceParams{}, {}, tool);
    print(what, measure(proxy, path, 0.02, 40000, sway));
  };
  for (const int n : {1, 16, 64, 256}) {
    run("ball of " + std::to_string(n) + (n == 1 ? " point" : " points"), ball(n), {});
    run("ball of " + std::to_string(n) + ", swaying", ball(n), {{0, 0, 1}, 0.2});
    run("rod of " + std::to_string(n) + ", flat, swaying", rod(n), {{1, 0, 0}, 0.2});
  }
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
    if (!(kind.length_mm > 0)) continue;
    haptics::ToolParams p;
    p.tool = kind.name;
    const haptics::Tool tool = haptics::make_tool(p);
    run(p.tool + (", " + std::to_string(tool.points_mm.size()) + " points, swaying"), tool, {{0, 0, 1}, 0.2});
  }
}

void synthetic(bool tools_only) {
  haptics::Feels feels;
  for (haptics::ShapeFeel& f : feels) f.front = f.back = bone();
  const haptics::ForceParams force;
  const auto run = [&](voxel::HapticVolume& v, const Method& m, double speed, const std::string& what) {
    const contact::ContactVolume contact(v, m.params);
    haptics::Proxy proxy(contact, feels, force);
    print(what,
          measure(proxy, path_for(contact, haptics::touchable_of(feels), speed), speed, speed < 1 ? 100000 : 20000));
  };
  voxel::HapticVolume v = shells(256, 8);
  head("points of the tool (256^3, 8 shapes, 0.02 mm a frame, exact, subvoxel)");
  tools_over(contact::ContactVolume(v), feels);
  if (tools_only) return;
  head("shapes (256^3, 0.02 mm a frame, exact, subvoxel)");
  for (const int shapes : {1, 2, 4, 8}) {
    voxel::HapticVolume v = shells(256, shapes);
    run(v, methods[0], 0.02, std::to_string(shapes) + (shapes == 1 ? " shape" : " shapes"));
  }
  head("size (8 shapes, 0.02 mm a frame, exact, subvoxel)");
  for (const int n : {128, 256, 512}) {
    voxel::HapticVolume v = shells(n, 8);
    run(v, methods[0], 0.02, std::to_string(n) + "^3");
  }
  head("speed and method (256^3, 8 shapes)");
  for (const Method& m : methods)
    for (const double speed : {0.02, 0.2, 2.0, 100.0}) {
      char what[100];
      std::snprintf(what, sizeof what, "%s, %g mm a frame", m.name, speed);
      run(v, m, speed, what);
    }
}

void of_case(const std::string& folder, bool tools_only, const std::string& only) {
  cases::LoadedCase c = cases::load_case(folder);
  const haptics::Feels all = haptics::feels_of(c.manifest.haptic);
  if (only.empty()) {
    head((folder + ": points of the tool, all shapes felt (0.02 mm a frame, exact, subvoxel)").c_str());
    tools_over(contact::ContactVolume(c.haptic), all);
  }
  if (tools_only) return;
  head((folder + ": shape felt, method, speed").c_str());
  for (const voxel::HapticShape& s : c.haptic.shapes) {
    if (!only.empty() && s.name != only) continue;
    haptics::Feels feels = all;
    for (const voxel::HapticShape& o : c.haptic.shapes)
      if (o.number != s.number)
        feels[std::size_t(o.number)].front.touchable = feels[std::size_t(o.number)].back.touchable = false;
    for (const Method& m : methods)
      for (const double speed : {0.02, 100.0}) {
        const contact::ContactVolume contact(c.haptic, m.params);
        haptics::Proxy proxy(contact, feels, haptics::ForceParams{});
        char what[120];
        std::snprintf(what, sizeof what, "%s, %s, %g mm a frame", s.name.c_str(), m.name, speed);
        print(what, measure(proxy, path_for(contact, haptics::touchable_of(feels), speed), speed,
                            speed < 1 ? 100000 : 20000));
      }
  }
}

}  // namespace

int main(int argc, char** argv) try {
  std::printf("CPU time of a tick, us; reading the clock costs %.0f ns, taken off\n", clock_cost_ns());
  const bool tools_only = argc > 1 && std::string(argv[1]) == "--tools";
  const bool shape = argc > 2 && std::string(argv[1]) == "--shape";
  const int first = 1 + tools_only + 2 * shape;
  if (argc == first) synthetic(tools_only);
  for (int n = first; n < argc; ++n) of_case(argv[n], tools_only, shape ? argv[2] : "");
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_haptics").c_str());
  return static_cast<int>(e.code());
}
