// SPDX-License-Identifier: GPL-3.0-or-later
// What is heard of a drill, and how warm the bone becomes.
#include <gtest/gtest.h>

#include <cmath>

#include "drill/bone_heat.h"
#include "sound/drill_sound.h"

using namespace trephine;

namespace {

std::vector<sound::DrillHeard> ticks(double seconds, bool runs, double load = 0, double energy = 0,
                                     bool stalled = false, double dt_s = 0.001) {
  return std::vector<sound::DrillHeard>(std::size_t(std::lround(seconds / dt_s)),
                                        {dt_s, runs, stalled, load, energy, 8});
}

std::vector<sound::DrillHeard> with_flutes(std::vector<sound::DrillHeard> ticks, int flutes) {
  for (sound::DrillHeard& t : ticks) t.flutes = flutes;
  return ticks;
}

std::vector<sound::DrillHeard> operator+(std::vector<sound::DrillHeard> a, const std::vector<sound::DrillHeard>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The part of a frequency in the last half second.
double part_of(const std::vector<float>& samples, double hz, double rate = 48000) {
  const std::size_t count = std::size_t(rate / 2), begin = samples.size() - count;
  double re = 0, im = 0;
  for (std::size_t n = 0; n < count; ++n) {
    re += samples[begin + n] * std::cos(2 * M_PI * hz * double(n) / rate);
    im += samples[begin + n] * std::sin(2 * M_PI * hz * double(n) / rate);
  }
  return 2 * std::hypot(re, im) / double(count);
}

double loudness(const std::vector<float>& samples) {
  double sum = 0;
  const std::size_t begin = samples.size() - 24000;
  for (std::size_t n = begin; n < samples.size(); ++n) sum += double(samples[n]) * double(samples[n]);
  return std::sqrt(sum / 24000);
}

constexpr sound::BurrVoice voice{30000};  // 500 turns and 4,000 edges a second

}  // namespace

TEST(HapticsSound, TheSpindleAndItsEdges) {
  const std::vector<float> idle = sound::sound_of(ticks(2, true), voice, {}),
                           loaded = sound::sound_of(ticks(2, true, 1, 0.1), voice, {});
  EXPECT_EQ(idle.size(), 96000u);
  EXPECT_GT(part_of(idle, 500), 0.02);
  EXPECT_GT(part_of(idle, 4000), 0.01);
  EXPECT_LT(part_of(idle, 3700), 0.001) << "nothing between";
  // A full load takes a quarter of the speed, and the edges are heard more.
  EXPECT_GT(part_of(loaded, 3000), 3 * part_of(idle, 4000));
  EXPECT_LT(part_of(loaded, 4000), 0.3 * part_of(loaded, 3000));
  EXPECT_GT(loudness(loaded), 2 * loudness(idle));
}

TEST(HapticsSound, MaterialAndVoice) {
  const auto brightness = [](double energy) {
    const std::vector<float> s = sound::sound_of(with_flutes(ticks(2, true, 1, energy), 40), voice, {});
    double high = 0, low = 0;
    for (double hz = 5303; hz < 7000; hz += 53) high += part_of(s, hz);
    for (double hz = 1303; hz < 2800; hz += 53) low += part_of(s, hz);
    return high / low;
  };
  EXPECT_GT(brightness(0.1), 3 * brightness(0.01)) << "hard bone is brighter than soft";
  const std::vector<float> fine = sound::sound_of(with_flutes(ticks(2, true, 1, 0.1), 40), voice, {});
  EXPECT_LT(part_of(fine, 3000), 0.3 * part_of(fine, 15000)) << "a burr of forty edges sings at its own";
}

TEST(HapticsSound, SilentAtRestAndInAStall) {
  for (const float s : sound::sound_of(ticks(1, false), voice, {})) ASSERT_EQ(s, 0);
  EXPECT_LT(loudness(sound::sound_of(ticks(1, true) + ticks(5, false), voice, {})), 1e-3);
  EXPECT_LT(loudness(sound::sound_of(ticks(1, true, 1, 0.1) + ticks(1, true, 1, 0.1, true), voice, {})), 1e-3);
}

TEST(HapticsSound, APureFunctionWithinItsBounds) {
  const auto stroke =
      ticks(0.3, true) + ticks(0.4, true, 0.8, 0.1) + ticks(0.1, true, 1, 0.02, true) + ticks(0.5, false);
  const std::vector<float> once = sound::sound_of(stroke, voice, {}), again = sound::sound_of(stroke, voice, {});
  EXPECT_EQ(once, again);
  sound::SoundParams loud;
  loud.sound_gain = 1;
  for (const float s : sound::sound_of(stroke, voice, loud)) ASSERT_LE(std::abs(s), 1);
  // The same second in ticks of another length is as long, and sounds the same.
  const std::vector<float> slow = sound::sound_of(ticks(1, true, 0.5, 0.1, false, 0.004), voice, {}),
                           fast = sound::sound_of(ticks(1, true, 0.5, 0.1, false, 1.0 / 44100), voice, {});
  ASSERT_EQ(slow.size(), 48000u);
  ASSERT_NEAR(double(fast.size()), 48000, 1);
  for (std::size_t n = 0; n + 1 < fast.size(); ++n) ASSERT_EQ(slow[n], fast[n]) << n;
}

TEST(HapticsSound, AWavFile) {
  const std::string wav = sound::wav_bytes({0, 1, -1, 0.5f}, 48000);
  ASSERT_EQ(wav.size(), 44u + 8u);
  EXPECT_EQ(wav.substr(0, 4), "RIFF");
  EXPECT_EQ(wav.substr(8, 8), "WAVEfmt ");
  EXPECT_EQ(wav.substr(36, 4), "data");
  const auto at = [&](std::size_t n) {
    return int(std::int16_t(std::uint8_t(wav[n]) | std::uint8_t(wav[n + 1]) << 8));
  };
  EXPECT_EQ(at(4), 44);
  EXPECT_EQ(at(40), 8);
  EXPECT_EQ(std::uint16_t(at(24)), 48000);
  EXPECT_EQ(at(44), 0);
  EXPECT_EQ(at(46), 32767);
  EXPECT_EQ(at(48), -32767);
  EXPECT_EQ(at(50), 16384);
}

TEST(HapticsHeat, GoesToWhereGainAndLossAreEqual) {
  drill::HeatParams dry;
  dry.irrigation_ml_per_min = 0;
  drill::BoneHeat heat(dry, 3.5);
  for (int n = 0; n < 1000; ++n) heat.step(1, true, 1);
  // 2 pi k R of a half space, k = 0.54 W/mK.
  EXPECT_NEAR(heat.now_c(), 37 + 0.2 / (2 * M_PI * 0.54e-3 * 3.5), 1e-6);
  for (int n = 0; n < 1000; ++n) heat.step(0, false, 1);
  EXPECT_NEAR(heat.now_c(), 37, 1e-6);
  EXPECT_GT(heat.max_c(), 50) << "what was, stays told";
  EXPECT_GT(heat.above_harm_s(), 900);
}

TEST(HapticsHeat, IsCooledByIrrigation) {
  const auto after = [](double ml_per_min, double power_w) {
    drill::HeatParams p;
    p.irrigation_ml_per_min = ml_per_min;
    drill::BoneHeat heat(p, 3.5);
    for (int n = 0; n < 10000; ++n) heat.step(power_w, true, 0.001);
    return heat.max_c();
  };
  EXPECT_GT(after(0, 30), after(1, 30) + 5);
  EXPECT_GT(after(1, 30), after(40, 30) + 5);
  EXPECT_EQ(after(40, 0), 37);
  EXPECT_LT(after(40, 5), 47);
  EXPECT_GT(after(0, 5), 47);
}

TEST(HapticsHeat, TheDoseCountsMinutesAt43Degrees) {
  drill::HeatParams p;
  p.irrigation_ml_per_min = 0;
  drill::BoneHeat heat(p, 3.5);
  const double at_43 = 6 * 2 * M_PI * 0.54e-3 * 3.5 / 0.2;
  for (int n = 0; n < 600; ++n) heat.step(at_43, true, 1);
  EXPECT_NEAR(heat.now_c(), 43, 1e-6);
  const double before = heat.dose_min();
  for (int n = 0; n < 60; ++n) heat.step(at_43, true, 1);
  EXPECT_NEAR(heat.dose_min() - before, 1, 1e-6);
  // Ticks of another length end at the same temperature.
  drill::BoneHeat fine(p, 3.5), coarse(p, 3.5);
  for (int n = 0; n < 2000; ++n) fine.step(3, true, 0.0005);
  for (int n = 0; n < 50; ++n) coarse.step(3, true, 0.02);
  EXPECT_NEAR(fine.now_c(), coarse.now_c(), 1e-9);
}
