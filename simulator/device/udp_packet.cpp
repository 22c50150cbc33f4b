// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/udp_packet.h"

#include <cmath>
#include <cstring>
#include <type_traits>

#include "haptics/haptic_state.h"
#include "haptics/tool_belt.h"

namespace trephine::device {
namespace {

constexpr char pose_magic[5] = "TRPP", force_magic[5] = "TRPF";
constexpr std::uint16_t busy_bit = 1, locked_bit = 2;  // of a force
constexpr std::uint16_t lifted_bit = 1;                // of a pose

// The turn from a tool's own coordinates, with its tip at 0 and its tail towards +z, to those of the case.
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
  double length() const { return std::sqrt(x * x + y * y + z * z + w * w); }
  bool is_known() const { return is_finite({x, y, z}) && std::isfinite(w); }
};

Quaternion quaternion_of(Vec3 axis, Vec3 across) {
  if (!is_finite(axis) || !is_finite(across)) return {NAN, NAN, NAN, NAN};
  const Mat3 m = haptics::frame_of(axis, across);
  const auto at = [&](int r, int c) { return m.column[std::size_t(c)][r]; };
  // The largest of the four first [Shepperd 1978].
  const double trace = at(0, 0) + at(1, 1) + at(2, 2);
  int most = 3;
  double largest = trace;
  for (int a = 0; a < 3; ++a)
    if (at(a, a) > largest) {
      largest = at(a, a);
      most = a;
    }
  double q[4];
  const double root = std::sqrt(1 + 2 * largest - trace), part = 0.5 / root;
  if (most == 3) {
    const double r = std::sqrt(1 + trace);
    q[3] = 0.5 * r;
    for (int a = 0; a < 3; ++a) q[a] = (at((a + 2) % 3, (a + 1) % 3) - at((a + 1) % 3, (a + 2) % 3)) * 0.5 / r;
  } else {
    const int i = most, j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 0.5 * root;
    q[j] = (at(j, i) + at(i, j)) * part;
    q[k] = (at(k, i) + at(i, k)) * part;
    q[3] = (at(k, j) - at(j, k)) * part;
  }
  return {q[0], q[1], q[2], q[3]};
}

void directions_of(const Quaternion& q, Vec3& axis, Vec3& across) {
  const double n = 2 / (q.length() * q.length());
  axis = normalized(Vec3{n * (q.x * q.z + q.w * q.y), n * (q.y * q.z - q.w * q.x), 1 - n * (q.x * q.x + q.y * q.y)});
  across = normalized(Vec3{1 - n * (q.y * q.y + q.z * q.z), n * (q.x * q.y + q.w * q.z), n * (q.x * q.z - q.w * q.y)});
}

bool is_unit(double length) { return length > 0.99 && length < 1.01; }

struct Writer {
  std::uint8_t* at;
  void magic(const char* m) {
    std::memcpy(at, m, 4);
    at += 4;
  }
  template <class U>
  std::enable_if_t<std::is_unsigned_v<U>> put(U v) {
    for (std::size_t n = 0; n < sizeof v; ++n) *at++ = std::uint8_t(v >> 8 * n);
  }
  void put(double v) {
    std::uint64_t u;
    std::memcpy(&u, &v, 8);
    put(u);
  }
  void put(Vec3 v) {
    for (int a = 0; a < 3; ++a) put(v[a]);
  }
  void put(const Quaternion& q) {
    put(Vec3{q.x, q.y, q.z});
    put(q.w);
  }
};

struct Reader {
  const std::uint8_t* at;
  bool magic(const char* m) {
    at += 4;
    return std::memcmp(at - 4, m, 4) == 0;
  }
  template <class U>
  U get() {
    U v = 0;
    for (std::size_t n = 0; n < sizeof v; ++n) v = U(v | U(*at++) << 8 * n);
    return v;
  }
  double number() {
    const std::uint64_t u = get<std::uint64_t>();
    double v;
    std::memcpy(&v, &u, 8);
    return v;
  }
  Vec3 vec() {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = number();
    return v;
  }
  Quaternion quaternion() {
    const Vec3 v = vec();
    return {v.x, v.y, v.z, number()};
  }
};

}  // namespace

UdpBytes encode_pose(const UdpPose& pose) {
  const bool first = pose.version == 1;
  UdpBytes out;
  out.count = first ? udp_pose_bytes_1 : udp_pose_bytes;
  Writer w{out.bytes.data()};
  w.magic(pose_magic);
  w.put(std::uint16_t(pose.version));
  w.put(std::uint16_t(!first && pose.lifted ? lifted_bit : 0));
  w.put(pose.session);
  w.put(pose.reading.buttons);
  w.put(pose.sequence);
  w.put(pose.time_s);
  w.put(pose.reading.tip_mm);
  if (first) {
    w.put(pose.reading.axis);
    return out;
  }
  w.put(quaternion_of(pose.reading.axis, pose.reading.across));
  w.put(pose.pedals);
  w.put(std::uint16_t(pose.tool));
  w.put(std::uint16_t(pose.command));
  return out;
}

UdpBytes encode_force(const UdpForce& force) {
  const bool first = force.version == 1;
  const DeviceNews& news = force.news;
  UdpBytes out;
  out.count = first ? udp_force_bytes_1 : udp_force_bytes;
  Writer w{out.bytes.data()};
  w.magic(force_magic);
  w.put(std::uint16_t(force.version));
  w.put(std::uint16_t((force.busy ? busy_bit : 0) | (!first && news.locked ? locked_bit : 0)));
  w.put(force.session);
  w.put(news.faults);
  w.put(force.answers);
  w.put(force.pose_time_s);
  w.put(news.time_s);
  w.put(force.force_n);
  if (!first) w.put(news.torque_n_mm);
  w.put(news.proxy_mm);
  if (!first) w.put(quaternion_of(news.axis, news.across));
  w.put(std::uint32_t(news.touched));
  w.put(std::uint32_t(news.inside));
  if (first) return out;
  w.put(news.events);
  w.put(std::uint32_t(news.tool));
  return out;
}

bool decode_pose(const std::uint8_t* bytes, std::size_t count, UdpPose& out) {
  if (count != udp_pose_bytes_1 && count != udp_pose_bytes) return false;
  Reader r{bytes};
  if (!r.magic(pose_magic)) return false;
  out = {};
  out.version = r.get<std::uint16_t>();
  const bool first = out.version == 1;
  if (count != (first ? udp_pose_bytes_1 : udp_pose_bytes) || out.version < 1 || out.version > udp_version)
    return false;
  const auto flags = r.get<std::uint16_t>();
  out.session = r.get<std::uint32_t>();
  out.reading.buttons = r.get<std::uint32_t>();
  out.sequence = r.get<std::uint64_t>();
  out.time_s = r.number();
  out.reading.tip_mm = r.vec();
  const bool usable = out.sequence > 0 && std::isfinite(out.time_s);
  if (first) {
    out.reading.axis = r.vec();
    return usable && (!is_finite(out.reading.axis) || is_unit(norm(out.reading.axis)));
  }
  const Quaternion q = r.quaternion();
  out.pedals = r.get<std::uint32_t>();
  out.tool = r.get<std::uint16_t>();
  out.command = r.get<std::uint16_t>();
  if (!usable || (flags & ~lifted_bit) != 0 ||
      (out.pedals & ~(haptics::Drilling::pedal | haptics::Drilling::mark)) != 0 ||
      out.tool > int(haptics::belt_button::tool_mask) || !haptics::belt_command::is_known(out.command))
    return false;
  out.lifted = (flags & lifted_bit) != 0;
  // The fields' own bits of the buttons are theirs alone.
  constexpr std::uint32_t own = haptics::Drilling::pedal | haptics::Drilling::mark |
                                haptics::belt_button::tool_mask << haptics::belt_button::tool_shift |
                                haptics::belt_button::command_mask << haptics::belt_button::command_shift |
                                haptics::haptic_button::lifted;
  out.reading.buttons = (out.reading.buttons & ~own) | out.pedals |
                        std::uint32_t(out.tool) << haptics::belt_button::tool_shift |
                        std::uint32_t(out.command) << haptics::belt_button::command_shift |
                        (out.lifted ? haptics::haptic_button::lifted : 0);
  if (!q.is_known()) {
    out.reading.axis = {NAN, NAN, NAN};  // for the servo to latch
    return true;
  }
  if (!is_unit(q.length())) return false;
  directions_of(q, out.reading.axis, out.reading.across);
  return true;
}

bool decode_force(const std::uint8_t* bytes, std::size_t count, UdpForce& out) {
  if (count != udp_force_bytes_1 && count != udp_force_bytes) return false;
  Reader r{bytes};
  if (!r.magic(force_magic)) return false;
  out = {};
  out.version = r.get<std::uint16_t>();
  const bool first = out.version == 1;
  if (count != (first ? udp_force_bytes_1 : udp_force_bytes) || out.version < 1 || out.version > udp_version)
    return false;
  const auto flags = r.get<std::uint16_t>();
  out.busy = (flags & busy_bit) != 0;
  out.session = r.get<std::uint32_t>();
  out.news.faults = r.get<std::uint32_t>();
  out.answers = r.get<std::uint64_t>();
  out.pose_time_s = r.number();
  out.news.time_s = r.number();
  out.force_n = r.vec();
  if (!first) out.news.torque_n_mm = r.vec();
  out.news.proxy_mm = r.vec();
  if (!first) directions_of(r.quaternion(), out.news.axis, out.news.across);
  out.news.touched = std::int32_t(r.get<std::uint32_t>());
  out.news.inside = std::int32_t(r.get<std::uint32_t>());
  if (first) return true;
  out.news.locked = (flags & locked_bit) != 0;
  out.news.events = r.get<std::uint32_t>();
  out.news.tool = std::int32_t(r.get<std::uint32_t>());
  return true;
}

}  // namespace trephine::device
