// SPDX-License-Identifier: GPL-3.0-or-later
#include "sound/live_sound.h"

#include <dlfcn.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "sound/asound_abi.h"

namespace trephine::sound {
namespace {

constexpr double block_s = 0.01;
constexpr unsigned latency_us = 40000;

[[noreturn]] void fail(const std::string& what) { throw Error(ExitCode::no_input, "", "--sound", what); }

struct Library {
  decltype(&asound_abi::snd_pcm_open) open = nullptr;
  decltype(&asound_abi::snd_pcm_set_params) set_params = nullptr;
  decltype(&asound_abi::snd_pcm_writei) write = nullptr;
  decltype(&asound_abi::snd_pcm_recover) recover = nullptr;
  decltype(&asound_abi::snd_pcm_close) close = nullptr;
  decltype(&asound_abi::snd_strerror) error = nullptr;

  Library() {
    void* handle = ::dlopen("libasound.so.2", RTLD_NOW | RTLD_LOCAL);
    if (!handle) fail("libasound.so.2 is not installed: install it (Debian: apt install libasound2) or leave it away");
    find(handle, "snd_pcm_open", open);
    find(handle, "snd_pcm_set_params", set_params);
    find(handle, "snd_pcm_writei", write);
    find(handle, "snd_pcm_recover", recover);
    find(handle, "snd_pcm_close", close);
    find(handle, "snd_strerror", error);
  }
  template <class F>
  static void find(void* handle, const char* name, F& function) {
    function = reinterpret_cast<F>(::dlsym(handle, name));
    if (!function) fail(std::string("libasound.so.2 has no ") + name);
  }
};

}  // namespace

struct LiveSound::Impl {
  Library library;
  asound_abi::Pcm* pcm = nullptr;
  LiveSoundParams params;
  DrillSound drill;
  std::function<DrillHeard()> heard;
  std::atomic<bool> stop{false};
  std::thread thread;

  Impl(const LiveSoundParams& p, const BurrVoice& voice, std::function<DrillHeard()> asked)
      : params(p), drill(p, voice), heard(std::move(asked)) {
    const auto checked = [&](int fault) {
      if (fault >= 0) return;
      const std::string why = library.error(fault);
      if (pcm) library.close(pcm);
      fail("no sound device " + params.sound_device + " (" + why +
           "): name another with --sound-device, or leave it away");
    };
    checked(library.open(&pcm, params.sound_device.c_str(), asound_abi::playback, 0));
    checked(library.set_params(pcm, asound_abi::float_le, asound_abi::interleaved, 1,
                               unsigned(std::lround(params.sound_hz)), 1, latency_us));
    thread = std::thread([this] { play(); });
  }
  ~Impl() {
    stop = true;
    thread.join();
    library.close(pcm);
  }

  void play() {
    std::vector<float> block;
    while (!stop) {
      DrillHeard now = heard();
      now.dt_s = block_s;
      block.resize(drill.samples_of(block_s));
      drill.render(now, block.data(), block.size());
      for (std::size_t written = 0; written < block.size() && !stop;) {
        const long count = library.write(pcm, block.data() + written, block.size() - written);
        if (count >= 0)
          written += std::size_t(count);
        else if (library.recover(pcm, int(count), 1) < 0)
          return;
      }
    }
  }
};

LiveSound::LiveSound(const LiveSoundParams& params, const BurrVoice& voice, std::function<DrillHeard()> heard)
    : impl_(std::make_unique<Impl>(params, voice, std::move(heard))) {}
LiveSound::~LiveSound() = default;

}  // namespace trephine::sound
