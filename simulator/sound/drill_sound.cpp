// SPDX-License-Identifier: GPL-3.0-or-later
#include "sound/drill_sound.h"

#include <algorithm>
#include <cmath>

namespace trephine::sound {
namespace {

// Of a spindle: how fast it runs up, and down; what a full load takes of its speed.
constexpr double up_s = 0.12, down_s = 0.5, stopping_s = 0.03, droop = 0.25;
constexpr double smooth_s = 0.01;       // of load and colour, so that nothing clicks
constexpr double highest_ratio = 0.45;  // of the sample rate: what lies above is left out and not folded back
constexpr double turns_share = 0.10, edges_idle = 0.05, edges_loaded = 0.30, noise_loaded = 0.5;
constexpr int turns_overtones = 3, edges_overtones = 4;
constexpr double soft_hz = 1500, hard_hz = 6000, hard_j_per_mm3 = 0.1;  // the colour of cutting

double toward(double value, double to, double dt_s, double slowness_s) {
  return value + (to - value) * (1 - std::exp(-dt_s / slowness_s));
}

void put(std::string& out, std::uint32_t value, int bytes) {
  for (int n = 0; n < bytes; ++n) out.push_back(char(value >> 8 * n & 255));
}

}  // namespace

DrillSound::DrillSound(const SoundParams& p, const BurrVoice& voice)
    : rate_hz_(p.sound_hz), gain_(p.sound_gain), voice_hz_(voice.spindle_rpm / 60) {}

std::size_t DrillSound::samples_of(double dt_s) {
  left_ += dt_s * rate_hz_;
  const double whole = std::floor(left_ + 1e-6);
  left_ -= whole;
  return std::size_t(std::max(0.0, whole));
}

void DrillSound::render(const DrillHeard& h, float* out, std::size_t count) {
  const double step = 1 / rate_hz_;
  const double to_speed = h.stalled || !h.runs ? 0 : 1 - droop * std::clamp(h.load_ratio, 0.0, 1.0);
  const double slowness = h.stalled ? stopping_s : h.runs ? up_s : down_s;
  const double to_load = h.runs && !h.stalled ? std::clamp(h.load_ratio, 0.0, 1.0) : 0;
  const double to_bright = h.energy_j_per_mm3 > 0 ? std::min(1.0, h.energy_j_per_mm3 / hard_j_per_mm3) : bright_;
  for (std::size_t n = 0; n < count; ++n) {
    speed_ = toward(speed_, to_speed, step, slowness);
    load_ = toward(load_, to_load, step, smooth_s);
    bright_ = toward(bright_, to_bright, step, smooth_s);
    const double hz = voice_hz_ * speed_;
    turn_ += hz * step;
    turn_ -= std::floor(turn_);
    double sample = 0;
    const auto tones = [&](double per_turn, int overtones, double loud) {
      for (int k = 1; k <= overtones && k * per_turn * hz < highest_ratio * rate_hz_; ++k)
        sample += loud / k * std::sin(2 * M_PI * k * per_turn * turn_);
    };
    tones(1, turns_overtones, turns_share * speed_);
    tones(std::max(1, h.flutes), edges_overtones, (edges_idle + edges_loaded * load_) * speed_);
    // A resonance of the noise, louder and fuller with the load, that swells with each turn.
    seed_ = seed_ * 1664525u + 1013904223u;
    const double white = double(seed_ >> 8) / double(1 << 23) - 1;
    const double centre = std::min(soft_hz + (hard_hz - soft_hz) * bright_, highest_ratio * rate_hz_);
    const double w = 2 * M_PI * centre * step, r = std::exp(-w / 3);
    const double noise = white * (1 - r) + 2 * r * std::cos(w) * noise_1_ - r * r * noise_2_;
    noise_2_ = noise_1_;
    noise_1_ = noise;
    sample += noise_loaded * std::sqrt(load_) * noise * (0.7 + 0.3 * std::sin(2 * M_PI * turn_));
    out[n] = float(gain_ * std::tanh(sample));
  }
}

std::vector<float> sound_of(const std::vector<DrillHeard>& ticks, const BurrVoice& voice, const SoundParams& params) {
  DrillSound sound(params, voice);
  std::vector<float> out;
  for (const DrillHeard& t : ticks) {
    const std::size_t begin = out.size(), count = sound.samples_of(t.dt_s);
    out.resize(begin + count);
    sound.render(t, out.data() + begin, count);
  }
  return out;
}

std::string wav_bytes(const std::vector<float>& samples, double rate_hz) {
  constexpr std::uint32_t format_bytes = 16, pcm = 1, channels = 1, bytes = 2, head = 36;
  const std::uint32_t rate = std::uint32_t(std::lround(rate_hz)), data = std::uint32_t(samples.size() * bytes);
  std::string out = "RIFF";
  put(out, head + data, 4);
  out += "WAVEfmt ";
  put(out, format_bytes, 4);
  put(out, pcm, 2);
  put(out, channels, 2);
  put(out, rate, 4);
  put(out, rate * bytes, 4);
  put(out, bytes, 2);
  put(out, 8 * bytes, 2);
  out += "data";
  put(out, data, 4);
  out.reserve(out.size() + data);
  for (const float s : samples)
    put(out, std::uint32_t(std::lround(std::clamp(double(s), -1.0, 1.0) * 32767)) & 0xffff, 2);
  return out;
}

}  // namespace trephine::sound
