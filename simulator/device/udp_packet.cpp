// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/udp_packet.h"

#include <cmath>
#include <cstring>

namespace trephine {
namespace {

constexpr char pose_magic[5] = "TRPP", force_magic[5] = "TRPF";
constexpr std::uint16_t busy_bit = 1;

struct Writer {
  std::uint8_t* at;
  void magic(const char* m) {
    std::memcpy(at, m, 4);
    at += 4;
  }
  template <class U>
  void put(U v) {
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
};

}  // namespace

std::array<std::uint8_t, udp_pose_bytes> encode_pose(const UdpPose& pose) {
  std::array<std::uint8_t, udp_pose_bytes> out{};
  Writer w{out.data()};
  w.magic(pose_magic);
  w.put(std::uint16_t{udp_version});
  w.put(std::uint16_t{0});
  w.put(pose.session);
  w.put(pose.reading.buttons);
  w.put(pose.sequence);
  w.put(pose.time_s);
  w.put(pose.reading.tip_mm);
  w.put(pose.reading.axis);
  return out;
}

std::array<std::uint8_t, udp_force_bytes> encode_force(const UdpForce& force) {
  std::array<std::uint8_t, udp_force_bytes> out{};
  Writer w{out.data()};
  w.magic(force_magic);
  w.put(std::uint16_t{udp_version});
  w.put(std::uint16_t(force.busy ? busy_bit : 0));
  w.put(force.session);
  w.put(force.news.faults);
  w.put(force.answers);
  w.put(force.pose_time_s);
  w.put(force.news.time_s);
  w.put(force.force_n);
  w.put(force.news.proxy_mm);
  w.put(std::uint32_t(force.news.touched));
  w.put(std::uint32_t(force.news.inside));
  return out;
}

bool decode_pose(const std::uint8_t* bytes, std::size_t count, UdpPose& out) {
  if (count != udp_pose_bytes) return false;
  Reader r{bytes};
  if (!r.magic(pose_magic) || r.get<std::uint16_t>() != udp_version) return false;
  r.get<std::uint16_t>();
  out.session = r.get<std::uint32_t>();
  out.reading.buttons = r.get<std::uint32_t>();
  out.sequence = r.get<std::uint64_t>();
  out.time_s = r.number();
  out.reading.tip_mm = r.vec();
  out.reading.axis = r.vec();
  const double length = norm(out.reading.axis);
  if (is_finite(out.reading.axis) && !(length > 0.99 && length < 1.01)) return false;
  return out.sequence > 0 && std::isfinite(out.time_s);
}

bool decode_force(const std::uint8_t* bytes, std::size_t count, UdpForce& out) {
  if (count != udp_force_bytes) return false;
  Reader r{bytes};
  if (!r.magic(force_magic) || r.get<std::uint16_t>() != udp_version) return false;
  out.busy = (r.get<std::uint16_t>() & busy_bit) != 0;
  out.session = r.get<std::uint32_t>();
  out.news.faults = r.get<std::uint32_t>();
  out.answers = r.get<std::uint64_t>();
  out.pose_time_s = r.number();
  out.news.time_s = r.number();
  out.force_n = r.vec();
  out.news.proxy_mm = r.vec();
  out.news.touched = std::int32_t(r.get<std::uint32_t>());
  out.news.inside = std::int32_t(r.get<std::uint32_t>());
  return true;
}

}  // namespace trephine
