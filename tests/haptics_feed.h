// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A hand that presses a running drill into a block with a constant force, and how deep it comes.
#include "device/simulated_hand.h"
#include "haptics/drilling.h"
#include "haptics_tools.h"

namespace trephine::tools {

struct FeedRun {
  const char* kind = "ball";
  double diameter_mm = 5, voxel_mm = 0.5, force_n = 1, tilt_deg = 0, tremor_mm = 0;
  double seconds = 4, max_depth_mm = 8;  ///< it ends where one of them is reached
  double rate_hz = 1000;
  haptics::DrillingParams drilling;
  drill::DrillParams law;
};

struct Feed {
  double depth_mm = 0;       ///< of the tool's tip below the block's surface, along its axis
  double feed_mm_per_s = 0;  ///< of the last half of the way
  double stalled_s = 0;      ///< that the drill reported
  double late_mm = 0;        ///< depth of the last quarter of the time less that before: 0 where it has stopped
  double max_step_n = 0;     ///< largest change of the force from tick to tick while it cuts
  double removed_mm3 = 0;
  double depth_after_mm[4] = {};  ///< after each of feed_times_s; after its end as at its end
};
constexpr double feed_times_s[4] = {0.25, 0.5, 1, 2};

inline haptics::DrillingParams drills(haptics::DrillingParams params) {
  params.drill = true;
  return params;
}

/// What a run leaves: the volume, and where the hole begins and goes.
struct Drilled {
  voxel::HapticVolume volume;
  Vec3 entry_mm, axis;
};

/// Bone fills the half space below the plane through the origin whose normal is no axis of the lattice.
inline Feed feed_of(FeedRun run, Drilled* left = nullptr) {
  const Vec3 normal = normalized({0.05, -0.03, 1});
  const double side = std::max(3.2 * run.diameter_mm, run.diameter_mm + 10.0);
  const int n = int(std::ceil(side / run.voxel_mm));
  voxel::HapticVolume volume = empty(n, {run.voxel_mm, run.voxel_mm, run.voxel_mm});
  const double top = 0.5 * side - 0.6 * run.diameter_mm - 1;
  fill_wide(volume, 1, [&](Vec3 p) { return top - dot(p, normal); });
  contact::ContactVolume contact(volume);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.1};
  const haptics::DrillingParams params = drills(run.drilling);
  const haptics::ToolParams tool = haptics::own_tool(params_of(run.kind, run.diameter_mm));
  haptics::Drilling drilling(volume, contact, shapes, params, run.law, haptics::cutter_of(params, tool));
  haptics::ForceParams limits;  // of a device that can do more
  limits.max_force_n = 20;
  limits.ramp_s = 0;
  limits.max_force_rate_n_per_s = 1e5;
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3, 0, 0.0003), face(1, 0.35, 0.3, 0, 0.0003)), limits, {},
                       haptics::make_tool(tool));

  // The hand's way goes in at a tilt, and its tool lies along its way.
  const double tilt = run.tilt_deg * M_PI / 180;
  const Vec3 across = normalized(cross(normal, Vec3{0.3, 1, 0}));
  const Vec3 axis = normal * std::cos(tilt) + across * std::sin(tilt), in = -axis;
  const Vec3 entry = normal * top - across * (0.25 * run.diameter_mm * std::sin(tilt));
  device::HandParams hand;
  hand.arm_damping_n_s_per_mm = 0.006;
  hand.tremor_mm = run.tremor_mm;
  device::HandBody body;
  body.position_mm = entry + axis * 0.3;
  const double dt = 1 / run.rate_hz;
  Feed out;
  std::vector<double> depth;
  Vec3 last;
  for (int tick = 0; tick < int(run.seconds * run.rate_hz) && out.depth_mm < run.max_depth_mm; ++tick) {
    for (double left = dt; left > 1e-9; left -= 0.001) {
      Vec3 to = entry + in * (dot(body.position_mm - entry, in) + run.force_n / hand.arm_stiffness_n_per_mm);
      device::add_tremor(hand, tick * dt, to);
      body.pull(hand, {}, to, std::min(left, 0.001));
    }
    haptics::HapticInput given = pose(body.position_mm, axis);
    given.buttons = haptics::Drilling::pedal;
    given.dt_s = dt;
    drilling.prepare(given);
    const haptics::HapticState& is = proxy.update(given);
    body.feel(is.force_n);
    drilling.tick(given, is);
    out.depth_mm = dot(entry - is.proxy_mm, axis);
    if (tick > int(0.3 * run.rate_hz)) out.max_step_n = std::max(out.max_step_n, norm(is.force_n - last));
    last = is.force_n;
    depth.push_back(out.depth_mm);
  }
  const std::size_t ticks = depth.size();
  for (int n = 0; n < 4; ++n)
    out.depth_after_mm[n] = depth[std::min(ticks, std::size_t(feed_times_s[n] * run.rate_hz)) - 1];
  std::size_t half = 0;
  while (half + 1 < ticks && depth[half] < 0.5 * out.depth_mm) ++half;
  out.feed_mm_per_s = (out.depth_mm - depth[half]) / (double(ticks - half) * dt);
  out.late_mm = out.depth_mm - depth[ticks - 1 - ticks / 4];
  out.stalled_s = drilling.outcome().stalled_s;
  out.removed_mm3 = double(drilling.outcome().units[1]) / voxel::haptic_full * volume.voxels.voxel_volume_mm3();
  if (left) *left = {std::move(volume), entry, axis};
  return out;
}

}  // namespace trephine::tools
