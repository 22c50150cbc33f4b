// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// The part of libasound.so.2's interface that is called, declared here so that its headers are not needed to build.
namespace asound_abi {

enum { playback = 0, interleaved = 3, float_le = 14 };
struct Pcm;

extern "C" {
int snd_pcm_open(Pcm** pcm, const char* name, int stream, int mode);
int snd_pcm_set_params(Pcm* pcm, int format, int access, unsigned channels, unsigned rate, int soft_resample,
                       unsigned latency_us);
long snd_pcm_writei(Pcm* pcm, const void* samples, unsigned long frames);
int snd_pcm_recover(Pcm* pcm, int fault, int silent);
int snd_pcm_close(Pcm* pcm);
const char* snd_strerror(int fault);
}

}  // namespace asound_abi
