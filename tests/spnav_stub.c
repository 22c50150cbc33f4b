/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A libspnav.so.0 for tests. What a 3D mouse would say comes as lines through the pipe that TREPHINE_SPNAV names:
 * "m X Y Z RX RY RZ" or "b NUMBER DOWN". Without that name no daemon answers. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#if defined(__has_include)
#if __has_include(<spnav.h>)
#include <spnav.h>
#define WITH_SPNAV
#endif
#endif

typedef struct {
  int type, x, y, z, rx, ry, rz;
  unsigned period;
  int* data;
} motion;
typedef struct {
  int type, press, number;
} button;
#ifdef WITH_SPNAV
/* What simulator/device/spnav_abi.h declares is what the library has. */
_Static_assert(sizeof(motion) == sizeof(struct spnav_event_motion), "size of a motion");
_Static_assert(offsetof(motion, rz) == offsetof(struct spnav_event_motion, rz), "rz");
_Static_assert(offsetof(motion, data) == offsetof(struct spnav_event_motion, data), "data");
_Static_assert(offsetof(button, press) == offsetof(struct spnav_event_button, press), "press");
_Static_assert(offsetof(button, number) == offsetof(struct spnav_event_button, bnum), "number");
_Static_assert(sizeof(spnav_event) <= 64 * sizeof(int), "room");
_Static_assert(SPNAV_EVENT_MOTION == 1 && SPNAV_EVENT_BUTTON == 2, "kinds");
#else
typedef void spnav_event;
#endif

static int pipe_ = -1;

int spnav_open(void) {
  const char* name = getenv("TREPHINE_SPNAV");
  if (!name) return -1;
  pipe_ = open(name, O_RDONLY | O_NONBLOCK);
  return pipe_ < 0 ? -1 : 0;
}
int spnav_close(void) { return close(pipe_); }
int spnav_fd(void) { return pipe_; }
int spnav_poll_event(spnav_event* event) {
  char line[128];
  size_t n = 0;
  while (n + 1 < sizeof line && read(pipe_, line + n, 1) == 1 && line[n] != '\n') ++n;
  line[n] = 0;
  motion m = {1, 0, 0, 0, 0, 0, 0, 0, NULL};
  button b = {2, 0, 0};
  if (sscanf(line, "m %d %d %d %d %d %d", &m.x, &m.y, &m.z, &m.rx, &m.ry, &m.rz) == 6) {
    memcpy(event, &m, sizeof m);
    return 1;
  }
  if (sscanf(line, "b %d %d", &b.number, &b.press) == 2) {
    memcpy(event, &b, sizeof b);
    return 2;
  }
  return 0;
}
