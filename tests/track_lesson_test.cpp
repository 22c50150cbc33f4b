// SPDX-License-Identifier: GPL-3.0-or-later
// A lesson that was done by a simulated hand is done again by a tool that a tracker sees: its messages, its noise, its
// rate. The rows are the same, within a point.
#include <gtest/gtest.h>

#include <algorithm>

#include "haptics/servo.h"
#include "lessons_head.h"
#include "track/tracked_device.h"
#include "track_fake.h"

using namespace lesson_cases;
using namespace track_fake;

namespace {

/// The tool of a recording before a tracker. Buttons are the recording's own, as a foot and a keyboard give them.
class Again : public device::Device {
 public:
  Again(const haptics::Recording& recording, const Theatre& theatre, const track::Tracking& tracking, double hz,
        double noise_mm)
      : recording_(recording),
        theatre_(theatre),
        hz_(hz),
        noise_mm_(noise_mm),
        random_(4),
        device_(tracking, {}, 0.2, 0.2, [this] { return now_s_; }) {}
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double dt_s, device::DeviceReading& out) override {
    const haptics::ServoFrame& f = recording_.frames[std::min(tick_++, recording_.frames.size() - 1)];
    now_s_ = f.time_s;
    if (now_s_ >= next_s_) {
      next_s_ += 1 / hz_;
      const RigidMap body =
          theatre_.body_at({f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]}, {f.axis[0], f.axis[1], f.axis[2]});
      for (const Bytes& bytes :
           {transform("Pointer", seen(body, noise_mm_, random_), 100 + now_s_),
            transform("Head", seen(theatre_.reference_to_tracker, noise_mm_, random_), 100 + now_s_)})
        feed(stream_, bytes, [this](const auto& h, const auto& c) { device_.take(h, c); });
    }
    const bool there = device_.read(dt_s, out);
    out.buttons = f.buttons;
    return there;
  }
  void send(Vec3) override {}
  void tell(const device::DeviceNews& news) override { device_.tell(news); }
  std::size_t left() const { return recording_.frames.size() - std::min(tick_, recording_.frames.size()); }

 private:
  const haptics::Recording& recording_;
  const Theatre theatre_;
  const double hz_, noise_mm_;
  Random random_;
  double now_s_ = 0, next_s_ = 0;
  std::size_t tick_ = 0;
  track::MessageStream stream_;
  track::TrackedDevice device_;
};

/// The recording done again in the head, as it was before.
haptics::Recording tracked(Head& head, const haptics::Recording& direct, double hz, double noise_mm) {
  Theatre theatre;
  track::Tracking tracking;
  tracking.reference = "Head";
  tracking.reference_to_case = rows_of(inverse(theatre.case_to_reference));
  track::TrackedTool tool;
  tool.body = "Pointer";
  tool.tip_mm = theatre.tip_mm;
  tool.axis = theatre.axis;
  tracking.tools = {tool};
  tracking.target_error_mm = 0.4;
  head.felt().loaded.haptic = head.whole();
  haptics::Recording again;
  again.header = direct.header;
  again.header.device = "openigtlink";
  again.header.place_error_mm = track::place_error_mm(tracking);
  contact::ContactVolume contact(head.felt().loaded.haptic, again.header.contact);
  const std::unique_ptr<haptics::Drilling> drilling = head.felt().drilling_of(again.header, contact);
  haptics::ToolBelt belt(contact, head.felt().feels, again.header.force, again.header.shaft, again.header.tools,
                         drilling.get());
  Again device(direct, theatre, tracking, hz, noise_mm);
  haptics::PortParams port_params;
  again.header.port = port_params;
  haptics::DevicePort port(port_params, again.header.force);
  haptics::FrameQueue queue(4096);
  haptics::ServoParams params;
  params.rate_hz = direct.header.rate_hz;
  params.paced = params.realtime = false;
  haptics::Servo servo(belt, device, params, &queue);
  servo.set_port(&port);
  const std::atomic<bool> stop{false};
  while (device.left() > 0) {
    servo.run(std::min<std::uint64_t>(4096, device.left()), stop);
    queue.drain(again.frames);
  }
  again.header.outcome = haptics::outcome_of(head.felt().loaded.haptic, drilling->outcome());
  return again;
}

// The loop: what the simulated hand did, seen by a tracker, has the same rows.
void expect_same_rows(const std::vector<std::pair<double, double>>& hz_and_noise_mm) {
  Head head(Kind::whole);
  const std::string steps =
      std::string(perfect_marks) + "," + perfect_hole +
      R"(, {"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}},
                                "finish")";
  const Head::Done direct = head.run(steps, 1000);
  for (const auto& [hz, noise_mm] : hz_and_noise_mm) {
    Head::Done again;
    again.recording = tracked(head, direct.recording, hz, noise_mm);
    head.score(again);
    std::cout << hz << " Hz, " << noise_mm << " mm:";
    ASSERT_EQ(direct.score.rows.size(), again.score.rows.size());
    for (std::size_t n = 0; n < direct.score.rows.size(); ++n) {
      const lessons::ScoreRow &a = direct.score.rows[n], &b = again.score.rows[n];
      EXPECT_EQ(a.score.has_value(), b.score.has_value()) << a.name;
      EXPECT_LE(std::abs(a.score.value_or(0) - b.score.value_or(0)), 1) << a.name << ": " << b.why;
      std::cout << " " << a.name << " " << a.score.value_or(0) << " " << b.score.value_or(0);
    }
    EXPECT_EQ(direct.score.outcome(), again.score.outcome());
    const double off = norm(direct.last_tip() - again.last_tip());
    EXPECT_LT(off, 1.5);
    for (const auto& [row, figure] : {std::pair{"burr_hole", "removed_mm3"}, std::pair{"depth", "depth_mm"}})
      std::cout << "; " << figure << " " << direct.measured(row, figure) << " " << again.measured(row, figure);
    std::cout << "; tips apart " << off << " mm\n";
  }
}
TEST(TrackedLesson, HasTheRowsOfTheSimulatedOne) { expect_same_rows({{60, 0.2}}); }
TEST(LongTrackedLesson, HasTheRowsOfTheSimulatedOne) {
  expect_same_rows({{100, 0.1}, {60, 0.3}, {20, 0.1}, {20, 0.3}});
}

// Of a row with a limit that is smaller than how far the tool may have been off nothing is said.
TEST(TrackedLesson, ARowWithASmallerLimitIsNotJudged) {
  lessons::LessonScore score;
  const auto row = [&](const char* name, std::vector<std::pair<std::string, double>> limits) {
    lessons::ScoreRow r;
    r.name = name;
    r.score = 3;
    r.decided_s = 1;
    for (const auto& [of, limit] : limits) r.limits.push_back({of, {limit, lesson::RubricLimit::From::ours, "test"}});
    score.rows.push_back(r);
    score.advice.push_back({name, {}});
  };
  row("tip", {{"foramen_mm", 5}, {"near_mm", 10}});
  row("breach", {{"two_mm", 2}, {"none_mm", 0}});
  row("speed", {{"five_mm_per_s", 1}});
  row("time", {{"ideal_s", 1}});
  lessons::doubt_places(score, 0.5);
  for (const lessons::ScoreRow& r : score.rows) EXPECT_TRUE(r.score) << r.name;
  EXPECT_EQ(score.advice.size(), 4u);
  lessons::doubt_places(score, 3);
  EXPECT_TRUE(score.rows[0].score);
  EXPECT_FALSE(score.rows[1].score);
  EXPECT_FALSE(score.rows[1].decided_s);
  EXPECT_EQ(score.rows[1].why.english(), "the tool may have been 3.0 mm off, and a limit is 2 mm");
  EXPECT_TRUE(score.rows[2].score);
  EXPECT_TRUE(score.rows[3].score);
  EXPECT_EQ(score.advice.size(), 3u);
}

}  // namespace
