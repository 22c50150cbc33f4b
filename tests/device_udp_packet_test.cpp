// SPDX-License-Identifier: GPL-3.0-or-later
// The packets of the UDP device: as documented, and nothing else is taken for one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include "device/udp_packet.h"
#include "haptics/proxy.h"
#include "haptics/tool_belt.h"

using namespace trephine;

// The documented layout, byte by byte.
TEST(HapticsUdpPacket, PacketsOfVersion1AreAsDocumented) {
  device::UdpPose p;
  p.version = 1;
  p.session = 0x01020304;
  p.sequence = 0x1122334455667788;
  p.time_s = 1.5;
  p.reading.tip_mm = {1, 2, -3};
  p.reading.axis = {0, 1, 0};
  p.reading.buttons = 5;
  const auto b = device::encode_pose(p);
  const auto number = [&](const auto& bytes, std::size_t at) {
    double v;
    std::memcpy(&v, bytes.data() + at, 8);  // this machine is little endian
    return v;
  };
  ASSERT_EQ(b.size(), 80u);
  EXPECT_EQ(std::memcmp(b.data(), "TRPP\1\0\0\0\4\3\2\1\5\0\0\0\x88\x77\x66\x55\x44\x33\x22\x11", 24), 0);
  EXPECT_EQ(number(b, 24), 1.5);
  EXPECT_EQ(number(b, 48), -3);
  EXPECT_EQ(number(b, 64), 1);
  device::UdpPose back;
  ASSERT_TRUE(device::decode_pose(b.data(), b.size(), back));
  EXPECT_EQ(device::encode_pose(back), b);

  device::UdpForce f;
  f.version = 1;
  f.busy = true;
  f.session = 7;
  f.answers = 9;
  f.pose_time_s = 2;
  f.news.time_s = 3;
  f.news.proxy_mm = {4, 5, 6};
  f.news.touched = 2;
  f.news.inside = -1;
  f.news.faults = 8;
  f.force_n = {0.5, 0, 0.25};
  const auto c = device::encode_force(f);
  ASSERT_EQ(c.size(), 96u);
  EXPECT_EQ(std::memcmp(c.data(), "TRPF\1\0\1\0\7\0\0\0\10\0\0\0\11\0\0\0\0\0\0\0", 24), 0);
  EXPECT_EQ(number(c, 32), 3);
  EXPECT_EQ(number(c, 40), 0.5);
  EXPECT_EQ(number(c, 64), 4);
  EXPECT_EQ(std::memcmp(c.data() + 88, "\2\0\0\0\377\377\377\377", 8), 0);
  device::UdpForce again;
  ASSERT_TRUE(device::decode_force(c.data(), c.size(), again));
  EXPECT_EQ(device::encode_force(again), c);
}

TEST(HapticsUdpPacket, PacketsOfVersion2AreAsDocumented) {
  device::UdpPose p;
  p.session = 0x01020304;
  p.sequence = 9;
  p.time_s = 1.5;
  p.reading.tip_mm = {1, 2, -3};
  p.reading.axis = {1, 0, 0};  // the tool's z to x, its x to -z: half a right angle's sine about y
  p.reading.across = {0, 0, -1};
  p.reading.buttons = 0x40;
  p.lifted = true;
  p.pedals = 3;
  p.tool = 5;
  p.command = 2;
  const device::UdpBytes b = device::encode_pose(p);
  const auto number = [](const device::UdpBytes& bytes, std::size_t at) {
    double v;
    std::memcpy(&v, bytes.data() + at, 8);
    return v;
  };
  ASSERT_EQ(b.size(), 96u);
  EXPECT_EQ(std::memcmp(b.data(), "TRPP\2\0\1\0\4\3\2\1\100\0\0\0\11\0\0\0\0\0\0\0", 24), 0);
  EXPECT_EQ(number(b, 48), -3);
  EXPECT_NEAR(number(b, 56), 0, 1e-12);
  EXPECT_NEAR(number(b, 64), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(number(b, 72), 0, 1e-12);
  EXPECT_NEAR(number(b, 80), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(std::memcmp(b.data() + 88, "\3\0\0\0\5\0\2\0", 8), 0);
  device::UdpPose back;
  ASSERT_TRUE(device::decode_pose(b.data(), b.size(), back));
  EXPECT_LT(norm(back.reading.axis - p.reading.axis), 1e-12);
  EXPECT_LT(norm(back.reading.across - p.reading.across), 1e-12);
  EXPECT_EQ(back.reading.buttons, 0x40u | 3u | 5u << 8 | 2u << 16 | haptics::haptic_button::lifted);

  device::UdpForce f;
  f.session = 7;
  f.answers = 9;
  f.news.time_s = 3;
  f.news.torque_n_mm = {7, 8, 9};
  f.news.proxy_mm = {4, 5, 6};
  f.news.axis = {1, 0, 0};
  f.news.across = {0, 0, -1};
  f.news.touched = 2;
  f.news.events = haptics::haptic_event::popped;
  f.news.locked = true;
  f.news.tool = 3;
  f.force_n = {0.5, 0, 0.25};
  const device::UdpBytes c = device::encode_force(f);
  ASSERT_EQ(c.size(), 160u);
  EXPECT_EQ(std::memcmp(c.data(), "TRPF\2\0\2\0\7\0\0\0", 12), 0);
  EXPECT_EQ(number(c, 40), 0.5);
  EXPECT_EQ(number(c, 64), 7);
  EXPECT_EQ(number(c, 104), 6);
  EXPECT_NEAR(number(c, 120), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(number(c, 136), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(std::memcmp(c.data() + 144, "\2\0\0\0\0\0\0\0\10\0\0\0\3\0\0\0", 16), 0);
  device::UdpForce again;
  ASSERT_TRUE(device::decode_force(c.data(), c.size(), again));
  EXPECT_EQ(again.news.torque_n_mm, f.news.torque_n_mm);
  EXPECT_TRUE(again.news.locked);
  EXPECT_EQ(again.news.tool, 3);
}

// Any orientation comes back, half turns included.
TEST(HapticsUdpPacket, OrientationsComeBack) {
  std::mt19937_64 rng(3);
  const auto any = [&] { return double(rng() % 2001) / 1000 - 1; };
  for (int n = 0; n < 2000; ++n) {
    device::UdpPose p, back;
    p.sequence = 1;
    const Mat3 m =
        n < 24 ? haptics::frame_of({double(n % 3 == 0), double(n % 3 == 1), n % 3 == 2 ? n % 2 ? 1.0 : -1.0 : 0},
                                   {double(n % 3 == 1), double(n % 3 == 2), n % 3 == 0 ? n % 4 < 2 ? 1.0 : -1.0 : 0})
               : haptics::frame_of(normalized(Vec3{any(), any(), any() + 1e-3}), {any(), any() + 1e-3, any()});
    p.reading.axis = m.column[2];
    p.reading.across = m.column[0];
    const device::UdpBytes b = device::encode_pose(p);
    ASSERT_TRUE(device::decode_pose(b.data(), b.size(), back));
    ASSERT_LT(norm(back.reading.axis - m.column[2]) + norm(back.reading.across - m.column[0]), 1e-9) << n;
  }
}

TEST(HapticsUdpPacket, MalformedPosesOfVersion2AreRefused) {
  device::UdpPose p, out;
  p.sequence = 1;
  p.reading.across = {1, 0, 0};
  const device::UdpBytes good = device::encode_pose(p);
  const auto decodes = [&](const device::UdpBytes& b) { return device::decode_pose(b.data(), b.size(), out); };
  const auto with = [&](std::size_t at, std::uint8_t value) {
    device::UdpBytes b = good;
    b.bytes[at] = value;
    return b;
  };
  ASSERT_TRUE(decodes(good));
  EXPECT_FALSE(device::decode_pose(good.data(), device::udp_pose_bytes_1, out)) << "as long as one of version 1";
  for (const auto& [at, value] : std::map<std::size_t, std::uint8_t>{{0, 'X'},
                                                                     {4, 1},
                                                                     {4, 3},
                                                                     {5, 1},
                                                                     {6, 2},
                                                                     {7, 1},
                                                                     {88, 4},
                                                                     {91, 1},
                                                                     {92, 16},
                                                                     {93, 1},
                                                                     {94, std::uint8_t(haptics::belt_command::count)},
                                                                     {95, 1}})
    EXPECT_FALSE(decodes(with(at, value))) << at;
  for (const double w : {0.98, 1.02, 1e200}) {
    device::UdpBytes b = good;
    std::memcpy(b.bytes.data() + 80, &w, 8);
    EXPECT_FALSE(decodes(b)) << w;
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  device::UdpBytes b = good;
  std::memcpy(b.bytes.data() + 64, &nan, 8);
  ASSERT_TRUE(decodes(b)) << "the device's fault, for the servo to latch";
  EXPECT_FALSE(is_finite(out.reading.axis));
  // Whatever bits change, what is taken is a pose with unit directions across each other, or a fault of the device.
  std::mt19937_64 rng(11);
  int taken = 0;
  for (int n = 0; n < 200000; ++n) {
    b = good;
    for (std::uint64_t flips = 1 + rng() % 4; flips > 0; --flips) b.bytes[rng() % 96] ^= std::uint8_t(1 << rng() % 8);
    if (!decodes(b)) continue;
    ++taken;
    const device::DeviceReading& r = out.reading;
    if (!is_finite(r.axis)) continue;
    ASSERT_NEAR(norm(r.axis), 1, 1e-9);
    ASSERT_NEAR(norm(r.across), 1, 1e-9);
    ASSERT_NEAR(dot(r.axis, r.across), 0, 1e-9);
    ASSERT_EQ(int(r.buttons >> 8 & 15), out.tool);
  }
  EXPECT_GT(taken, 1000);
}

TEST(HapticsUdpPacket, MalformedPosesAreRefused) {
  device::UdpPose p, out;
  p.version = 1;
  p.sequence = 1;
  const auto decodes = [&](const device::UdpPose& pose) {
    const auto b = device::encode_pose(pose);
    return device::decode_pose(b.data(), b.size(), out);
  };
  ASSERT_TRUE(decodes(p));
  device::UdpBytes b = device::encode_pose(p);
  EXPECT_FALSE(device::decode_pose(b.data(), b.size() - 1, out));
  EXPECT_FALSE(device::decode_pose(b.data(), 0, out));
  for (const std::size_t at : {0u, 3u, 4u, 5u}) {
    b = device::encode_pose(p);
    b.bytes[at] ^= 2;
    EXPECT_FALSE(device::decode_pose(b.data(), b.size(), out)) << at;
  }
  device::UdpPose bad = p;
  bad.sequence = 0;
  EXPECT_FALSE(decodes(bad));
  bad = p;
  bad.time_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(decodes(bad));
  for (const double length : {0.0, 0.98, 1.02}) {
    bad = p;
    bad.reading.axis = {0, length, 0};
    EXPECT_FALSE(decodes(bad)) << length;
  }
  bad.reading.axis = {0, std::numeric_limits<double>::infinity(), 0};
  EXPECT_TRUE(decodes(bad)) << "the device's fault, for the servo to latch";
}
