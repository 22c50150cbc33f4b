// SPDX-License-Identifier: GPL-3.0-or-later
// A device is registered to a screen that is seen in a mirror, by marks that a virtual hand touches.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "base/write_file.h"
#include "device/trajectory_device.h"
#include "scratch_folder.h"
#include "session/touch_marks.h"

using namespace trephine;
using device::DeviceReading;
using device::ScreenRegistration;

namespace {

const std::atomic<bool> never{false};

// A rotation about `axis`.
Mat3 turned(Vec3 axis, double degrees) {
  axis = normalized(axis);
  const double a = degrees * M_PI / 180, c = std::cos(a), s = std::sin(a);
  Mat3 m;
  for (int n = 0; n < 3; ++n) {
    Vec3 e;
    e[n] = 1;
    m.column[std::size_t(n)] = e * c + cross(axis, e) * s + axis * (dot(axis, e) * (1 - c));
  }
  return m;
}

// How the bench is built: from before the screen to the device.
struct Bench {
  Mat3 turn = turned({0.2, 1, -0.4}, 130);
  Vec3 offset_mm{310, -45, 120};
  double scale = 1;
  Vec3 device_of(Vec3 screen_mm) const { return turn * screen_mm * scale + offset_mm; }
};

session::RegisterParams params() {
  session::RegisterParams p;
  p.screen_width_mm = 520;
  p.screen_height_mm = 320;
  p.in_real_time = false;
  p.register_hz = 500;
  p.touch_wait_s = 5;
  return p;
}

// The hand at each place for half a second without and with the button. `noise_mm`: how it misses a mark.
std::vector<device::TrajectoryPoint> hand_over(const Bench& bench, std::vector<Vec3> screen_mm, double noise_mm,
                                               double restless_mm = 0) {
  std::mt19937 random(7);
  std::normal_distribution<double> miss(0, 1);
  std::vector<device::TrajectoryPoint> all;
  double time_s = 0;
  for (const Vec3 place : screen_mm) {
    const Vec3 at =
        bench.device_of(place + Vec3{miss(random) * noise_mm, miss(random) * noise_mm, miss(random) * noise_mm});
    for (int tries = 0; tries < 3; ++tries)
      for (const std::uint32_t button : {0u, 1u})
        for (int n = 0; n < 50; ++n) {
          DeviceReading r;
          r.tip_mm = at + Vec3{0, 0, n % 2 == 0 ? restless_mm : -restless_mm};
          r.buttons = button;
          all.push_back({time_s, r});
          time_s += 0.01;
        }
  }
  return all;
}

std::vector<Vec3> marks_and_air(double before_mm = 100) {
  std::vector<Vec3> all = session::screen_marks(params());
  all.push_back({10, 0, before_mm});
  return all;
}

// Each place is touched once: the trajectory's tries after the first are waited through by the button.
ScreenRegistration registered(const Bench& bench, const std::vector<Vec3>& places, double noise_mm,
                              session::RegisterParams p = params()) {
  std::vector<device::TrajectoryPoint> way = hand_over(bench, places, noise_mm);
  // One try a place is enough for a hand that holds still.
  std::vector<device::TrajectoryPoint> once;
  for (std::size_t n = 0; n < way.size(); ++n)
    if (n % 300 < 100) once.push_back({0.01 * double(once.size()), way[n].reading});
  device::Trajectory hand(once);
  return session::register_screen(hand, p, never, [](const std::string&) {});
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    return e.what();
  }
  return "";
}

// A device that stands still and keeps what it was sent.
struct Still : device::Device {
  DeviceReading pose;
  Vec3 felt_n;
  device::DeviceNews news;
  double damping_n_s_per_mm() const override { return 0.004; }
  bool read(double, DeviceReading& out) override {
    out = pose;
    return true;
  }
  void send(Vec3 force_n) override { felt_n = force_n; }
  void tell(const device::DeviceNews& n) override { news = n; }
};

}  // namespace

TEST(HapticsScreen, MarksThatAreTouchedGiveTheBenchBack) {
  for (const double scale : {1.0, 0.8}) {
    Bench bench;
    bench.scale = scale;
    session::RegisterParams p = params();
    p.fit_scale = scale != 1;
    const ScreenRegistration r = registered(bench, marks_and_air(), 0, p);
    EXPECT_LT(r.worst_mm, 1e-9);
    EXPECT_NEAR(r.scale, 1 / scale, 1e-9);
    for (const Vec3 screen : {Vec3{12, 34, 56}, Vec3{-200, 100, 0}, Vec3{0, -90, 180}})
      EXPECT_LT(norm(r.before_screen(bench.device_of(screen)) - screen), 1e-9);
    EXPECT_EQ(r.height_mm, 320);
  }
}

TEST(HapticsScreen, AHandThatMissesByAMillimetreIsAveragedAndTold) {
  const Bench bench;
  const ScreenRegistration r = registered(bench, marks_and_air(), 0.7);
  EXPECT_GT(r.rms_mm, 0.2);
  EXPECT_LT(r.rms_mm, 1.5);
  EXPECT_GE(r.worst_mm, r.rms_mm);
  EXPECT_LT(norm(r.before_screen(bench.device_of({50, 20, 60})) - Vec3{50, 20, 60}), 2);
}

TEST(HapticsScreen, WhatIsNoRegistrationIsRefused) {
  const Bench bench;
  // A mark that was touched beside it.
  std::vector<Vec3> beside = marks_and_air();
  beside[2] = beside[2] + Vec3{12, 0, 0};
  EXPECT_NE(refusal([&] { registered(bench, beside, 0); }).find("lower right"), std::string::npos);
  // Width and height of another screen.
  session::RegisterParams other = params();
  other.screen_width_mm = 480;
  EXPECT_NE(refusal([&] { registered(bench, marks_and_air(), 0, other); }).find("mm from where it was touched"),
            std::string::npos);
  // Marks as the screen shows them without the mirror: a plane fits them turned over, and only the air tells.
  std::vector<Vec3> mirrored = marks_and_air();
  for (Vec3& p : mirrored) p.x = -p.x;
  EXPECT_NE(refusal([&] { registered(bench, mirrored, 0); }).find("mirror image"), std::string::npos);
  EXPECT_NE(refusal([&] { registered(bench, marks_and_air(2), 0); }).find("2 mm before the screen"), std::string::npos);
  // Nobody touches; a hand that shakes.
  EXPECT_NE(refusal([&] {
              Still still;
              session::register_screen(still, params(), never, [](const std::string&) {});
            }).find("nobody touched"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              device::Trajectory shaking(hand_over(bench, marks_and_air(), 0, 2));
              session::register_screen(shaking, params(), never, [](const std::string&) {});
            }).find("held still"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              device::fit_screen({{0, 0, 0}, {50, 0, 0}, {100, 0, 0}}, {{0, 0, 0}, {50, 0, 0}, {100, 0, 0}}, false);
            }).find("one line"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              device::fit_screen({{0, 0, 0}, {50, 9, 0}}, {{0, 0, 0}, {50, 9, 0}}, false);
            }).find("fewer"),
            std::string::npos);
}

TEST(HapticsScreen, ARegistrationIsSavedAndLoaded) {
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "bench.json";
  const ScreenRegistration r = registered(Bench(), marks_and_air(), 0.4);
  write_file(file, device::to_json(r));
  const ScreenRegistration back = device::read_screen_registration(file);
  EXPECT_EQ(device::to_json(back), device::to_json(r));
  const auto refused = [&](const std::string& from, const std::string& to, const char* field) {
    std::string text = device::to_json(r);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    write_file(file, text);
    try {
      device::read_screen_registration(file);
      FAIL() << field;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.field(), field);
    }
  };
  refused("\"height_mm\": 320.0", "\"height_mm\": 0", "height_mm");
  refused("\"scale\": 1", "\"scale\": 0", "scale");
  refused("\"turn\"", "\"turns\"", "turn");
  refused("\"trephine_screen\": 1", "\"trephine_screen\": 9", "trephine_screen");
  refused("\"turn\": [\n  [\n   ", "\"turn\": [\n  [\n   9, ", "turn");
}

TEST(HapticsScreen, TheToolIsSeenWhereTheHandIs) {
  const Bench bench;
  const ScreenRegistration r = registered(bench, marks_and_air(), 0);
  auto still = std::make_unique<Still>();
  Still& hand = *still;
  auto view = std::make_shared<device::Mailbox<device::ScreenView>>();
  device::ScreenDevice screen(std::move(still), r, view);
  const Vec3 before{40, -25, 60};
  hand.pose.tip_mm = bench.device_of(before);
  hand.pose.axis = bench.turn * Vec3{0, 0, 1};  // towards the user
  hand.pose.buttons = 1;
  DeviceReading out;
  ASSERT_TRUE(screen.read(0, out));
  EXPECT_GT(norm(out.tip_mm), 1000) << "no view is known yet";
  EXPECT_EQ(out.buttons, 0u);
  // Two views, as when somebody turns the picture: 320 mm of the screen show 160 mm of the case.
  for (const bool front : {true, false}) {
    device::ScreenView v;
    v.middle_mm = {1, -20, 300};
    v.right = front ? Vec3{-1, 0, 0} : Vec3{0, 1, 0};
    v.up = {0, 0, 1};
    v.toward = cross(v.right, v.up);
    v.height_mm = 160;
    view->write(v);
    ASSERT_TRUE(screen.read(0.001, out));
    const Vec3 seen = v.middle_mm + (v.right * before.x + v.up * before.y + v.toward * before.z) * 0.5;
    EXPECT_LT(norm(out.tip_mm - seen), 1e-9);
    EXPECT_LT(norm(out.axis - v.toward), 1e-9);
    EXPECT_EQ(out.buttons, 1u);
    // A force towards the user in the picture is one towards him at the hand; work and damping fit the scale.
    screen.send(v.toward * 2);
    EXPECT_LT(norm(hand.felt_n - bench.turn * Vec3{0, 0, 2}), 1e-9);
    device::DeviceNews news;
    news.proxy_mm = seen;
    news.axis = v.up;
    screen.tell(news);
    EXPECT_LT(norm(hand.news.proxy_mm - hand.pose.tip_mm), 1e-9);
    EXPECT_LT(norm(hand.news.axis - bench.turn * Vec3{0, 1, 0}), 1e-9);
    EXPECT_NEAR(screen.damping_n_s_per_mm(), 0.004 / 0.5, 1e-12);
  }
}

TEST(HapticsScreen, AViewThatIsZoomedOutMakesNoWallStiffer) {
  auto still = std::make_unique<Still>();
  Still& hand = *still;
  auto view = std::make_shared<device::Mailbox<device::ScreenView>>();
  ScreenRegistration r;
  r.turn = turned({0, 0, 1}, 0);
  r.height_mm = 320;
  device::ScreenDevice screen(std::move(still), r, view);
  DeviceReading out;
  for (const double scale : {0.5, 1.0, 4.0}) {
    view->write({{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 320 * scale});
    hand.pose.tip_mm = {0, 0, -1};
    ASSERT_TRUE(screen.read(0.001, out));
    EXPECT_NEAR(out.tip_mm.z, -scale, 1e-12);
    screen.send(Vec3{0, 0, 1} * -out.tip_mm.z * 0.8);  // a wall of 0.8 N/mm at z = 0
    EXPECT_NEAR(hand.felt_n.z, 0.8 * std::min(scale, 1.0), 1e-12) << "for each mm of the hand";
  }
}

// A window that is not the whole screen: where its point lies on the screen, there the hand is.
TEST(HapticsScreen, AWindowsPlaceOnItsScreenIsTakenIntoAccount) {
  // 800 x 600 of a screen of 1920 x 1200 that is 320 mm high; the window's middle 300 px right of the screen's and 150
  // up.
  const double px_mm = 320.0 / 1200;
  device::ScreenView window{{1, -20, 300}, {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 90};
  const device::ScreenView whole = device::over_screen(window, {-300.0 / 600, -150.0 / 600, 1200.0 / 600});
  EXPECT_NEAR(whole.height_mm, 180, 1e-9);
  auto still = std::make_unique<Still>();
  Still& hand = *still;
  auto view = std::make_shared<device::Mailbox<device::ScreenView>>();
  view->write(whole);
  ScreenRegistration r;
  r.turn = turned({0, 0, 1}, 0);
  r.height_mm = 320;
  device::ScreenDevice screen(std::move(still), r, view);
  DeviceReading out;
  hand.pose.tip_mm = {300 * px_mm, 150 * px_mm, 0};  // at the window's middle
  ASSERT_TRUE(screen.read(0.001, out));
  EXPECT_LT(norm(out.tip_mm - window.middle_mm), 1e-9);
  hand.pose.tip_mm = {400 * px_mm, 150 * px_mm, 0};  // 100 px farther right: 100 / 600 of what the window shows
  ASSERT_TRUE(screen.read(0.001, out));
  EXPECT_LT(norm(out.tip_mm - window.middle_mm - window.right * 15), 1e-9);
}

TEST(HapticsScreen, TheSheetShowsEveryMarkWhereItIsTouched) {
  const std::string sheet = session::marks_sheet(params(), "scaleY(-1)");
  EXPECT_NE(sheet.find("viewBox=\"-260 -160 520 320\""), std::string::npos) << sheet;
  EXPECT_NE(sheet.find("M-216 -128h16"), std::string::npos) << "upper left: 8 mm beside (-208, 128)";
  EXPECT_NE(sheet.find(">5</text>"), std::string::npos);
  EXPECT_NE(sheet.find("scaleY(-1)"), std::string::npos);
}
