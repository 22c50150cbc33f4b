// SPDX-License-Identifier: GPL-3.0-or-later
// How a hand moved: figures of motions that are known.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/pi.h"
#include "lessons/motion_figures.h"

namespace {

using namespace trephine;
using haptics::ServoFrame;

// A tip that follows a function of time at 1 kHz.
template <class F>
std::vector<ServoFrame> frames_of(double seconds, const F& x_mm) {
  std::vector<ServoFrame> frames(std::size_t(std::lround(seconds * 1000)));
  for (std::size_t n = 0; n < frames.size(); ++n) {
    frames[n].tick = n;
    frames[n].dt_s = 0.001;
    frames[n].time_s = 0.001 * double(n + 1);
    frames[n].tip_mm[0] = frames[n].proxy_mm[0] = x_mm(frames[n].time_s);
  }
  return frames;
}
std::map<std::string, double> figures_of(const std::vector<ServoFrame>& frames) {
  const auto all = lessons::motion_figures(frames);
  return {all.begin(), all.end()};
}
// From 0 to `way` with least jerk.
double min_jerk(double t, double way) { return way * (10 - 15 * t + 6 * t * t) * t * t * t; }

// The authors' own example: exp(-5 t^2) over two seconds gives -1.41403.
TEST(GroupMotion, TheSpectralArcLengthIsItsAuthors) {
  std::vector<double> speed;
  for (int n = 0; n < 200; ++n) speed.push_back(std::exp(-5 * std::pow(-1 + 0.01 * n, 2)));
  EXPECT_NEAR(lessons::spectral_arc_length(speed, 100), -1.41403, 0.000006);
  std::vector<double> stops = speed;
  for (int n = 0; n < 200; ++n) stops[std::size_t(n)] *= 1 + 0.5 * std::sin(2 * pi * 4 * 0.01 * n);
  EXPECT_LT(lessons::spectral_arc_length(stops, 100), -1.6);
}

TEST(GroupMotion, AStraightMovementIsEconomical) {
  const auto f = figures_of(frames_of(2, [](double t) { return min_jerk(t / 2, 100); }));
  EXPECT_NEAR(f.at("path_mm"), 100, 0.1);
  EXPECT_NEAR(f.at("economy_ratio"), 1, 1e-6);
  EXPECT_GT(f.at("smoothness_sparc"), -1.6);
  EXPECT_LT(f.at("tremor_um"), 60);
  EXPECT_EQ(f.count("contact_force_n"), 0u);
}

TEST(GroupMotion, ADetourCostsEconomyAndAStopIsIdle) {
  const auto f = figures_of(frames_of(3, [](double t) { return t < 1 ? 50 * t : t < 2 ? 50 : 50 - 25 * (t - 2); }));
  EXPECT_NEAR(f.at("path_mm"), 75, 0.5);
  EXPECT_NEAR(f.at("idle_s"), 1, 0.03);
  EXPECT_NEAR(f.at("economy_ratio"), 1, 0.01);  // two movements, each straight
  const auto back = figures_of(frames_of(2, [](double t) { return t < 1 ? 50 * t : 50 - 50 * (t - 1); }));
  EXPECT_LT(back.at("economy_ratio"), 0.05);  // there and back without a stop
}

TEST(GroupMotion, TremorIsItsRootMeanSquare) {
  const auto wave = [](double hz) {
    return figures_of(frames_of(5, [hz](double t) { return 0.2 * std::sin(2 * pi * hz * t); }));
  };
  // Means of 10 ms take a little off.
  EXPECT_NEAR(wave(10).at("tremor_um"), 200 / std::sqrt(2.0), 6);
  EXPECT_LT(wave(2).at("tremor_um"), 6);
  EXPECT_LT(wave(25).at("tremor_um"), 6);
}

TEST(GroupMotion, AChangeOfToolIsNoWay) {
  std::vector<ServoFrame> frames = frames_of(2, [](double t) { return t < 1 ? 0.0 : 500.0; });
  for (std::size_t n = 999; n < frames.size(); ++n) frames[n].buttons = 1u << 8;
  EXPECT_EQ(figures_of(frames).at("path_mm"), 0);
}

TEST(GroupMotion, ForceAndTissueAreTold) {
  std::vector<ServoFrame> frames = frames_of(2, [](double t) { return 10 * t; });
  for (std::size_t n = 1000; n < 2000; ++n) {
    frames[n].force_n[2] = 3;
    frames[n].touched = 1;
    frames[n].inside = 2;
  }
  const auto f = figures_of(frames);
  EXPECT_NEAR(f.at("force_integral_n_s"), 3, 1e-9);
  EXPECT_NEAR(f.at("tissue_force_integral_n_s"), 3, 1e-9);
  EXPECT_NEAR(f.at("contact_force_n"), 3, 1e-9);
  EXPECT_NEAR(f.at("tissue_path_mm"), 9.99, 1e-6);
  EXPECT_TRUE(figures_of({}).count("path_mm"));
}

TEST(GroupMotion, WhoIsOutsideOfTheBandIsToldWhatToDo) {
  const std::vector<lessons::ExpertBand> bands =
      lessons::expert_bands({{{"path_mm", 900}, {"tremor_um", 50}}, {{"path_mm", 1400}, {"tremor_um", 80}}});
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_EQ(bands[0].low, 900);
  EXPECT_EQ(bands[0].high, 1400);
  const std::vector<std::string> told = lessons::motion_advice({{"path_mm", 2140}, {"tremor_um", 60}}, bands);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0], "Your hand moved 2140 mm; experts' lie between 900 and 1400. Plan the way before you move.");
  EXPECT_TRUE(lessons::motion_advice({{"path_mm", 1460}}, bands).empty()) << "as good as in the band";
  EXPECT_EQ(lessons::motion_advice({{"path_mm", 1480}}, bands).size(), 1u);
  EXPECT_TRUE(lessons::motion_advice({{"path_mm", 500}}, bands).empty());  // less than an expert needs is no fault
}

}  // namespace
