// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/params.h"

namespace trephine::sound {

struct SoundParams {
  double sound_hz = 48000, sound_gain = 0.5;
  template <class V>
  static void describe(V& v) {
    using P = SoundParams;
    v.number(&P::sound_hz, "sound_hz", Range{8000, 192000}, "Samples in each second.");
    v.number(&P::sound_gain, "sound_gain", Range{0, 1}, "How loud it is.");
  }
};

/// What is heard of a drill whatever it does: how fast it turns without a load.
struct BurrVoice {
  double spindle_rpm = 60000;
};

/// What a drill does in one tick.
struct DrillHeard {
  double dt_s = 0.001;
  bool runs = false;            ///< its pedal is down
  bool stalled = false;         ///< and it is pressed so hard that it stands
  double load_ratio = 0;        ///< of its power, 0 to 1
  double energy_j_per_mm3 = 0;  ///< of what it removes, 0: nothing; hard bone sounds brighter than soft
  int flutes = 8;               ///< edges of the burr in hand
};

/// The sound of a drill, tick by tick: the spindle's turns and its edges, which follow its speed as it runs up, is
/// loaded and runs down; and the noise of cutting, whose loudness follows the load and whose colour the material. The
/// measures are ours. Equal ticks give equal samples; it neither allocates nor draws on anything but what it is told.
class DrillSound {
 public:
  DrillSound(const SoundParams& params, const BurrVoice& voice);
  /// How many samples the tick has: its time in whole samples, what is left over goes to the next.
  std::size_t samples_of(double dt_s);
  /// Writes that many samples, -1 to 1.
  void render(const DrillHeard& heard, float* out, std::size_t count);

 private:
  const double rate_hz_, gain_, voice_hz_;
  double left_ = 0, turn_ = 0, speed_ = 0, load_ = 0, bright_ = 0;
  double noise_1_ = 0, noise_2_ = 0;
  std::uint32_t seed_ = 1;
};

/// The sound of all ticks, one after the other.
std::vector<float> sound_of(const std::vector<DrillHeard>& ticks, const BurrVoice& voice, const SoundParams& params);
/// A WAV file of 16 bit, one channel.
std::string wav_bytes(const std::vector<float>& samples, double rate_hz);

}  // namespace trephine::sound
