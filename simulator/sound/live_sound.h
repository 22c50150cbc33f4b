// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "sound/drill_sound.h"

namespace trephine::sound {

struct LiveSoundParams : SoundParams {
  bool sound = false;
  std::string sound_device = "default";
  template <class V>
  static void describe(V& v) {
    using P = LiveSoundParams;
    v.flag(&P::sound, "sound", "The drill is heard, by ALSA's library (Debian: libasound2), which is loaded then.");
    v.text(&P::sound_device, "sound_device", "The device that plays it, as ALSA names it.");
    v.template all_of<SoundParams>();
  }
};

/// A drill that is heard while it runs. A thread of its own asks what it does a hundred times a second and plays it;
/// the servo never waits for it. A device that fails later is silent from then on.
class LiveSound {
 public:
  /// `heard` is called from that thread until the destructor returns; its dt_s is not looked at. Throws Error 66 where
  /// the library is not installed or there is no such device.
  LiveSound(const LiveSoundParams& params, const BurrVoice& voice, std::function<DrillHeard()> heard);
  ~LiveSound();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trephine::sound
