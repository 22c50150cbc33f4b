/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A libasound.so.2 for tests: what is played is appended to the file that TREPHINE_ASOUND names; without that name there is no
 * device. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef void snd_pcm_t;

static FILE* file;

int snd_pcm_open(snd_pcm_t** pcm, const char* name, int stream, int mode) {
  const char* to = getenv("TREPHINE_ASOUND");
  (void)name, (void)stream, (void)mode;
  if (!to || !(file = fopen(to, "wb"))) return -2;
  *pcm = (snd_pcm_t*)file;
  return 0;
}
int snd_pcm_set_params(snd_pcm_t* pcm, int format, int access, unsigned channels, unsigned rate, int resample,
                       unsigned latency_us) {
  (void)pcm, (void)resample, (void)latency_us;
  return format == 14 && access == 3 && channels == 1 && rate == 48000 ? 0 : -22;
}
long snd_pcm_writei(snd_pcm_t* pcm, const void* samples, unsigned long frames) {
  const struct timespec as_long = {0, (long)(frames * 1000000000ul / 48000)};
  static int calls;
  (void)pcm;
  if (++calls == 3) return -32; /* as after a stall of the machine */
  if (frames > 100) frames = 100; /* no more at once */
  nanosleep(&as_long, NULL);
  return (long)fwrite(samples, 4, frames, file);
}
int snd_pcm_recover(snd_pcm_t* pcm, int fault, int silent) {
  (void)pcm, (void)silent;
  return fault == -32 ? 0 : fault;
}
int snd_pcm_close(snd_pcm_t* pcm) {
  (void)pcm;
  return fclose(file);
}
const char* snd_strerror(int fault) { return fault == -2 ? "No such file or directory" : "Invalid argument"; }
