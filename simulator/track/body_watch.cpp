// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/body_watch.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace trephine::track {
namespace {

constexpr double rotation_off = 1e-3;  // of numbers in float32, and of trackers that round them
constexpr double same_stamp_s = 1e-4;
constexpr double clock_drift = 2e-4;  // of one clock to the other
constexpr std::size_t most_strangers = 8;
constexpr double most_mm = 1e5;

}  // namespace

std::vector<std::pair<std::string, std::uint64_t>> listed(const WatchCounts& c) {
  return {
      {"poses", c.poses},           {"broken", c.broken}, {"not_rigid", c.not_rigid}, {"mirrored", c.mirrored},
      {"incomplete", c.incomplete}, {"unseen", c.unseen}, {"late", c.late},           {"out_of_order", c.out_of_order},
      {"unwell", c.unwell},         {"others", c.others}};
}

BodyWatch::BodyWatch(WatchedBodies wanted, Found found)
    : wanted_(std::move(wanted)), found_(std::move(found)), tools_(wanted_.tools.size()) {}

void BodyWatch::begin_anew() {
  tools_.assign(tools_.size(), {});
  reference_ = {};
  stamps_agree_ = false;
  least_delay_s_ = 1e300;
}

void BodyWatch::take(const IgtlHeader& header, const IgtlContent& content, double now_s) {
  if (content.fault != IgtlFault::none) {
    ++counts_.broken;
    return;
  }
  if (content.status != 1) {
    ++counts_.unwell;
    unwell_s_ = now_s;
  }
  if (header.stamp_s > 0 && content.count > 0) {
    least_delay_s_ = std::min(least_delay_s_ + clock_drift * std::max(0.0, now_s - last_s_), now_s - header.stamp_s);
    last_s_ = now_s;
  }
  for (int n = 0; n < std::min(content.count, igtl_most_bodies); ++n)
    take_body(content.bodies[n], header.stamp_s, now_s);
}

bool BodyWatch::in_time(Seen& seen, double stamp_s, double now_s) {
  if (!(stamp_s > 0)) return true;  // it has no clock
  if (stamp_s <= seen.stamp_s) {
    ++counts_.out_of_order;
    return false;
  }
  if (now_s - stamp_s > least_delay_s_ + wanted_.late_s) {
    ++counts_.late;
    return false;
  }
  return true;
}

void BodyWatch::take_body(const IgtlBody& body, double stamp_s, double now_s) {
  const std::string name = body.name;
  const auto found = std::find(wanted_.tools.begin(), wanted_.tools.end(), name);
  const bool is_reference = !wanted_.reference.empty() && name == wanted_.reference;
  if (found == wanted_.tools.end() && !is_reference) {
    ++counts_.others;
    const std::string shown = printable(name);
    if (strangers_.size() < most_strangers &&
        std::find(strangers_.begin(), strangers_.end(), shown) == strangers_.end())
      strangers_.push_back(shown);
    return;
  }
  RigidMap map;
  const float* c = body.columns;
  for (std::size_t k = 0; k < 3; ++k) map.turn.column[k] = {c[3 * k], c[3 * k + 1], c[3 * k + 2]};
  map.offset_mm = {c[9], c[10], c[11]};
  if (!body.turns) {
    ++counts_.incomplete;
    return;
  }
  if (map.turn == Mat3() && map.offset_mm == Vec3()) {
    ++counts_.unseen;
    return;
  }
  Mat3 turned = map.turn;
  for (Vec3& column : turned.column) column = -column;
  if (!is_finite(map.offset_mm) || !(norm(map.offset_mm) < most_mm) || !is_rotation(map.turn, rotation_off)) {
    ++(is_rotation(turned, rotation_off) ? counts_.mirrored : counts_.not_rigid);
    return;
  }
  Seen& seen = is_reference ? reference_ : tools_[std::size_t(found - wanted_.tools.begin())];
  if (!in_time(seen, stamp_s, now_s)) return;
  seen = {map, stamp_s, now_s, false};
  if (is_reference)
    for (std::size_t n = 0; n < tools_.size(); ++n) pair(n, now_s);
  else
    pair(std::size_t(found - wanted_.tools.begin()), now_s);
}

void BodyWatch::pair(std::size_t tool, double now_s) {
  Seen& seen = tools_[tool];
  if (seen.used) return;
  if (wanted_.reference.empty()) {
    seen.used = true;
    ++counts_.poses;
    found_(int(tool), seen.map, now_s);
    return;
  }
  if (reference_.now_s < -1e8) return;
  const bool stamped = seen.stamp_s > 0 && reference_.stamp_s > 0;
  const double apart = std::abs(stamped ? seen.stamp_s - reference_.stamp_s : seen.now_s - reference_.now_s);
  if (stamped && apart < same_stamp_s) stamps_agree_ = true;
  if (apart > (stamped && stamps_agree_ ? same_stamp_s : wanted_.together_s)) return;
  seen.used = true;
  ++counts_.poses;
  found_(int(tool), then(seen.map, inverse(reference_.map)), now_s);
}

}  // namespace trephine::track
