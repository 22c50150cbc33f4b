/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A vendor's adaptor for tests: two devices that sink 10 mm a second onto what is below; the second is lost after a
 * second. TREPHINE_STUB says otherwise: "none" has no devices, "fails" does not open, "tells" says
 * at the end what it felt. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "device/adaptor.h"

typedef struct {
  int index, reads;
  double begin_s, force_n;
} stub;

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static int is(const char* what) {
  const char* v = getenv("TREPHINE_STUB");
  return v && strcmp(v, what) == 0;
}

int trephine_adaptor_version(void) { return is("later") ? 7 : TREPHINE_ADAPTOR_VERSION; }
int trephine_adaptor_count(void) { return is("none") ? 0 : 2; }
int trephine_adaptor_name(int index, char* out, int size) {
  snprintf(out, (size_t)size, "stub %d", index);
  return 0;
}
void* trephine_adaptor_open(int index) {
  stub* s = is("fails") ? NULL : calloc(1, sizeof *s);
  if (s) s->index = index;
  return s;
}
int trephine_adaptor_limits(void* device, trephine_adaptor_limits_t* out) {
  (void)device;
  out->max_force_n = 2;
  out->damping_n_s_per_mm = 0.001;
  return 0;
}
int trephine_adaptor_start(void* device) {
  ((stub*)device)->begin_s = now_s();
  return 0;
}
int trephine_adaptor_read(void* device, trephine_adaptor_pose* out) {
  stub* s = device;
  const double t = now_s() - s->begin_s;
  if (s->index == 1 && t > 1) return 1;
  out->tip_mm[0] = 1;
  out->tip_mm[1] = -20;
  out->tip_mm[2] = 300 + 16 - (t < 0.5 ? 10 * t : 5);
  out->axis[2] = 1;
  out->buttons = ++s->reads > 3 ? 1u : 0u;
  return 0;
}
int trephine_adaptor_send(void* device, const double force_n[3], const double torque_n_mm[3]) {
  (void)torque_n_mm;
  stub* s = device;
  if (force_n[2] > s->force_n) s->force_n = force_n[2];
  return 0;
}
void trephine_adaptor_close(void* device) {
  if (is("tells")) fprintf(stderr, "stub closed after %.2f N\n", ((stub*)device)->force_n);
  free(device);
}
const char* trephine_adaptor_error(void) { return "the cable is out"; }
