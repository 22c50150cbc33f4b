// SPDX-License-Identifier: GPL-3.0-or-later
// Messages as libopenigtlink itself packs them, and what becomes of those that are broken, foreign or impossible.
#include <gtest/gtest.h>

#include <limits>

#include "track/igtl_library.h"
#include "track_fake.h"

using namespace track_fake;
using track::BodyWatch;
using track::IgtlContent;
using track::IgtlFault;
using track::IgtlHeader;
using track::MessageStream;

namespace {

struct Came {
  IgtlHeader header;
  IgtlContent content;
};
std::vector<Came> all_of(const Bytes& bytes, std::size_t piece, bool* good = nullptr) {
  std::vector<Came> came;
  MessageStream stream;
  bool is_good = true;
  for (std::size_t at = 0; at < bytes.size() && is_good; at += piece)
    is_good = stream.feed(bytes.data() + at, std::min(piece, bytes.size() - at),
                          [&](const IgtlHeader& h, const IgtlContent& c) {
                            came.push_back({h, c});
                          });
  if (good) *good = is_good;
  return came;
}
Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& p : parts) all.insert(all.end(), p.begin(), p.end());
  return all;
}
const RigidMap& a_map() {
  static const RigidMap map{turn_about({1, 2, 3}, 0.7), {10, -20, 30.5}};
  return map;
}
void expect_is(const track::IgtlBody& body, const std::string& name, const RigidMap& map) {
  EXPECT_EQ(body.name, name);
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(double(body.columns[3 * k + a]), map.turn.column[std::size_t(k)][a], 1e-6) << k << a;
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(double(body.columns[9 + a]), map.offset_mm[a], 1e-4);
}

TEST(TrackMessages, AreWhatTheLibraryPacked) {
  const RigidMap other{turn_about({0, 1, 0}, -2), {1, 2, 3}};
  const Bytes stream = joined({transform("StylusToTracker", a_map(), 1234.5), status(1, 1234.6),
                               tdata({{"Stylus", a_map()}, {"Head", other}, {"Point", other, 3}}, 1235.25)});
  for (const std::size_t piece : {std::size_t(1), std::size_t(57), std::size_t(59), stream.size()}) {
    const std::vector<Came> came = all_of(stream, piece);
    ASSERT_EQ(came.size(), 3u) << piece;
    EXPECT_STREQ(came[0].header.type, "TRANSFORM");
    EXPECT_NEAR(came[0].header.stamp_s, 1234.5, 1e-6);
    ASSERT_EQ(came[0].content.count, 1);
    expect_is(came[0].content.bodies[0], "StylusToTracker", a_map());
    EXPECT_EQ(came[1].content.status, 1);
    EXPECT_NEAR(came[2].header.stamp_s, 1235.25, 1e-6);
    ASSERT_EQ(came[2].content.count, 3);
    expect_is(came[2].content.bodies[0], "Stylus", a_map());
    expect_is(came[2].content.bodies[1], "Head", other);
    EXPECT_TRUE(came[2].content.bodies[1].turns);
    EXPECT_FALSE(came[2].content.bodies[2].turns) << "a point is taken for a body that turns";
  }
}

// A name of 20 letters, which fills its field, is not read beyond it.
TEST(TrackMessages, ANameMayFillItsField) {
  const std::string name = "ABCDEFGHIJKLMNOPQRST";
  const std::vector<Came> came = all_of(transform(name, a_map(), 1), 1000);
  ASSERT_EQ(came.size(), 1u);
  EXPECT_EQ(came[0].content.bodies[0].name, name);
}

TEST(TrackMessages, AWrongSumOrSizeIsBroken) {
  const Bytes good = transform("A", a_map(), 1);
  for (std::size_t at = track::igtl_header_bytes; at < good.size(); at += 7) {
    Bytes bad = good;
    bad[at] ^= 0x10;
    const std::vector<Came> came = all_of(bad, 1000);
    ASSERT_EQ(came.size(), 1u);
    EXPECT_EQ(came[0].content.fault, IgtlFault::crc) << at;
    EXPECT_EQ(came[0].content.count, 0);
  }
  Bytes shorter = good;  // the header says 40 bytes of body
  shorter[42 + 7] = 40;
  shorter.resize(track::igtl_header_bytes + 40);
  const std::vector<Came> came = all_of(joined({shorter, good}), 1000);
  ASSERT_EQ(came.size(), 2u);
  EXPECT_EQ(came[0].content.fault, IgtlFault::size);
  EXPECT_EQ(came[1].content.fault, IgtlFault::none);
}

// What we do not read is passed over, however large, and nothing of it is kept.
TEST(TrackMessages, OtherTypesArePassedOver) {
  igtl::StringMessage::Pointer text = igtl::StringMessage::New();
  text->SetDeviceName("Names");
  std::string long_text(60000, 'x');
  text->SetString(long_text);
  for (const std::size_t piece : {std::size_t(100), std::size_t(1) << 17}) {
    const std::vector<Came> came = all_of(joined({bytes_of(*text, 1), transform("A", a_map(), 2)}), piece);
    ASSERT_EQ(came.size(), 1u);
    EXPECT_EQ(came[0].content.count, 1);
  }
}

TEST(TrackMessages, AnotherProtocolEndsTheStream) {
  bool good = true;
  Bytes later = transform("A", a_map(), 1);
  later[1] = 3;  // version 3 has another header behind this one
  EXPECT_TRUE(all_of(later, 1000, &good).empty());
  EXPECT_FALSE(good);
  const std::string web = "HTTP/1.1 400 Bad Request\r\nContent-Type: text/html\r\nConnection: close\r\n\r\n";
  EXPECT_TRUE(all_of(Bytes(web.begin(), web.end()), 1000, &good).empty());
  EXPECT_FALSE(good);
  Bytes endless = transform("A", a_map(), 1);
  for (int n = 42; n < 50; ++n) endless[std::size_t(n)] = 0xFF;  // its body's size
  all_of(endless, 1000, &good);
  EXPECT_FALSE(good);
}

TEST(TrackMessages, ARequestIsTheLibrarys) {
  std::uint8_t ask[track::igtl_ask_bytes];
  track::igtl().ask(ask);
  igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
  header->InitPack();
  std::memcpy(header->GetPackPointer(), ask, track::igtl_header_bytes);
  header->Unpack();
  EXPECT_STREQ(header->GetDeviceType(), "STT_TDATA");
  igtl::StartTrackingDataMessage::Pointer message = igtl::StartTrackingDataMessage::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  std::memcpy(message->GetPackBodyPointer(), ask + track::igtl_header_bytes, std::size_t(message->GetPackBodySize()));
  EXPECT_TRUE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) << "its check sum is wrong";
}

// Messages that are damaged anywhere, in pieces of any size: whatever is taken is a pose.
TEST(TrackMessages, DamagedOnesAreNoPoses) {
  Random random(11);
  const Bytes whole =
      joined({transform("Drill", a_map(), 1), status(1, 1), tdata({{"Drill", a_map()}, {"Head", a_map()}}, 2)});
  std::uint64_t taken = 0;
  for (int n = 0; n < 20000; ++n) {
    Bytes bytes = whole;
    for (int k = int(random(1, 5)); k > 0; --k)
      bytes[std::size_t(random(0, double(bytes.size())))] = std::uint8_t(random(0, 256));
    if (random() < 0.3) bytes.resize(std::size_t(random(1, double(bytes.size()))));
    BodyWatch watch({{"Drill"}, ""}, [&](int, const RigidMap& map, double) {
      ++taken;
      EXPECT_TRUE(is_rotation(map.turn, 2e-3) && is_finite(map.offset_mm));
      EXPECT_LT(norm(map.offset_mm - a_map().offset_mm), 1e-3) << "a damaged pose passes its check sum";
    });
    MessageStream stream;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t piece = std::min(bytes.size() - at, std::size_t(random(1, 300)));
      if (!stream.feed(bytes.data() + at, piece,
                       [&](const IgtlHeader& h, const IgtlContent& c) { watch.take(h, c, 1); }))
        break;
      at += piece;
    }
  }
  EXPECT_GT(taken, 1000u);
}

/// Two tools and a reference that are watched; what was found.
struct Watch {
  struct Found {
    int tool;
    RigidMap map;
    double now_s;
  };
  std::vector<Found> found;
  BodyWatch watch;
  MessageStream stream;
  explicit Watch(const std::string& reference = "Head")
      : watch({{"Drill", "Pointer"}, reference}, [this](int tool, const RigidMap& map, double now_s) {
          found.push_back({tool, map, now_s});
        }) {}
  void come(const Bytes& bytes, double now_s) {
    EXPECT_TRUE(feed(stream, bytes, [&](const IgtlHeader& h, const IgtlContent& c) { watch.take(h, c, now_s); }));
  }
};

TEST(TrackBodies, APoseIsBeforeTheReference) {
  Watch w;
  Theatre t;
  Random random(3);
  for (int n = 0; n < 20; ++n) {  // the head moves, and the tool stays on it
    t.reference_to_tracker = {turn_about(random.direction(), random(0, 3)), random.direction() * 900};
    const RigidMap body = t.body_at({1, 2, 3}, {0, 0, 1});
    const double at = 100 + 0.02 * n;
    w.come(transform("Drill", body, at), 5 + 0.02 * n);
    EXPECT_EQ(w.found.size(), std::size_t(n)) << "a tool is taken before a head of another time";
    w.come(transform("Head", t.reference_to_tracker, at), 5 + 0.02 * n);
    ASSERT_EQ(w.found.size(), std::size_t(n) + 1);
    EXPECT_LT(norm(w.found.back().map(t.tip_mm) - t.case_to_reference({1, 2, 3})), 2e-3);  // numbers are float32
  }
  EXPECT_EQ(w.watch.counts().poses, 20u);
}

TEST(TrackBodies, WithoutCommonStampsTheyMayBeALittleApart) {
  Watch w;
  w.come(transform("Head", a_map(), 10), 1);
  w.come(transform("Drill", a_map(), 10.03), 1.03);
  EXPECT_EQ(w.found.size(), 1u);
  w.come(transform("Drill", a_map(), 10.08), 1.08);
  EXPECT_EQ(w.found.size(), 1u) << "a head of 80 ms before is taken";
  Watch clockless;  // no stamps at all: by the time at which they come
  clockless.come(transform("Head", a_map(), 0), 1);
  clockless.come(transform("Drill", a_map(), 0), 1.01);
  clockless.come(transform("Drill", a_map(), 0), 1.2);
  EXPECT_EQ(clockless.found.size(), 1u);
}

TEST(TrackBodies, WithoutAReferencePosesAreOfTheTracker) {
  Watch w("");
  w.come(tdata({{"Pointer", a_map()}, {"Drill", a_map()}}, 3), 1);
  ASSERT_EQ(w.found.size(), 2u);
  EXPECT_EQ(w.found[0].tool, 1);
  EXPECT_LT(norm(w.found[0].map.offset_mm - a_map().offset_mm), 1e-4);
}

TEST(TrackBodies, WhatIsNoPoseIsNotTaken) {
  Watch w("");
  double at = 1;
  const auto come = [&](RigidMap map) {
    at += 0.02;
    w.come(transform("Drill", map, at), at);
  };
  RigidMap mirrored = a_map();
  mirrored.turn.column[2] = -mirrored.turn.column[2];
  RigidMap scaled = a_map(), sheared = a_map(), nan = a_map(), lost = a_map(), far = a_map();
  for (Vec3& c : scaled.turn.column) c = c * 0.001;  // metres
  sheared.turn.column[1] += sheared.turn.column[0] * 0.01;
  nan.turn.column[1].y = std::numeric_limits<double>::quiet_NaN();
  lost.offset_mm.x = std::numeric_limits<double>::infinity();
  far.offset_mm.x = 1e30;
  come(mirrored);
  EXPECT_EQ(w.watch.counts().mirrored, 1u);
  for (const RigidMap& map : {scaled, sheared, nan, lost, far}) come(map);
  EXPECT_EQ(w.watch.counts().not_rigid, 5u);
  come({});  // the identity: it is out of view
  EXPECT_EQ(w.watch.counts().unseen, 1u);
  w.come(tdata({{"Drill", a_map(), 3}}, 9), 9);
  w.come(tdata({{"Drill", a_map(), 4}}, 9.1), 9.1);
  EXPECT_EQ(w.watch.counts().incomplete, 2u);
  EXPECT_TRUE(w.found.empty());
  w.come(transform("Stylus", a_map(), 9.2), 9.2);
  EXPECT_EQ(w.watch.counts().others, 1u);
  EXPECT_EQ(w.watch.strangers(), std::vector<std::string>{"Stylus"});
  w.come(transform("Drill", a_map(), 9.3), 9.3);
  EXPECT_EQ(w.found.size(), 1u);
}

TEST(TrackBodies, LateAndOutOfOrderAreNotTaken) {
  Watch w("");
  w.come(transform("Drill", a_map(), 50.00), 1.01);  // the clocks differ by 49 s, and it takes 10 ms
  w.come(transform("Drill", a_map(), 50.02), 1.03);
  w.come(transform("Drill", a_map(), 50.02), 1.04);  // twice
  w.come(transform("Drill", a_map(), 50.01), 1.05);
  EXPECT_EQ(w.watch.counts().out_of_order, 2u);
  EXPECT_EQ(w.found.size(), 2u);
  w.come(transform("Drill", a_map(), 50.10), 1.40);  // 290 ms later than the others
  EXPECT_EQ(w.watch.counts().late, 1u);
  w.come(transform("Drill", a_map(), 50.45), 1.46);
  EXPECT_EQ(w.found.size(), 3u);
  w.come(transform("Drill", a_map(), 20), 2);  // its clock was set anew
  EXPECT_EQ(w.found.size(), 3u) << "what is old by our clock is taken";
  w.watch.begin_anew();
  w.come(transform("Drill", a_map(), 20.1), 2.1);
  EXPECT_EQ(w.found.size(), 4u) << "a new connection is compared with the old one";
}

TEST(TrackBodies, AStatusThatIsNotWellIsKept) {
  Watch w("");
  w.come(status(1, 1), 1);
  EXPECT_LT(w.watch.unwell_s(), 0);
  w.come(status(13, 2), 2);  // device not ready
  EXPECT_EQ(w.watch.unwell_s(), 2);
  EXPECT_EQ(w.watch.counts().unwell, 1u);
}

}  // namespace
