/* SPDX-License-Identifier: GPL-3.0-or-later
 * A haptic device for `trephine-sim servo CASE --device udp` (packets: docs/haptics.md), C99 and POSIX:
 *   cc -std=c99 -o udp_client udp_client.c -lm
 *   udp_client ADDRESS PORT SECONDS X Y Z DX DY DZ DEPTH_MM [LOG]
 * Here the device is a mass that a spring draws from X Y Z (mm, LPS) along DX DY DZ, DEPTH_MM far. To drive another,
 * replace device_pose and device_force. LOG gets a line for each answer: sequence, tip and force, exact (%a). Ends with
 * 0; 1 where nothing answered; 2 where the servo says that another client is there, or that there is a fault. */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { VERSION = 1, POSE_BYTES = 80, FORCE_BYTES = 96, BUSY = 1, HISTORY = 1024 };
static const double period_s = 0.001, hold_s = 0.005, decay_s = 0.010;

/* ---- packets: little endian, whatever this machine is */
static void put(uint8_t* at, uint64_t v, int bytes) {
  for (int n = 0; n < bytes; ++n) at[n] = (uint8_t)(v >> 8 * n);
}
static uint64_t get(const uint8_t* at, int bytes) {
  uint64_t v = 0;
  for (int n = 0; n < bytes; ++n) v |= (uint64_t)at[n] << 8 * n;
  return v;
}
static void put_doubles(uint8_t* at, const double* v, int count) {
  for (int n = 0; n < count; ++n) {
    uint64_t u;
    memcpy(&u, v + n, 8);
    put(at + 8 * n, u, 8);
  }
}
static void get_doubles(const uint8_t* at, double* v, int count) {
  for (int n = 0; n < count; ++n) {
    const uint64_t u = get(at + 8 * n, 8);
    memcpy(v + n, &u, 8);
  }
}

typedef struct {
  double tip_mm[3], axis[3]; /* LPS; the axis is a unit vector from the tool's tip to its tail */
  uint32_t buttons;
} pose;

static void write_pose(uint8_t* out, const pose* p, uint32_t session, uint64_t sequence, double time_s) {
  memcpy(out, "TRPP", 4);
  put(out + 4, VERSION, 2);
  put(out + 6, 0, 2);
  put(out + 8, session, 4);
  put(out + 12, p->buttons, 4);
  put(out + 16, sequence, 8);
  put_doubles(out + 24, &time_s, 1);
  put_doubles(out + 32, p->tip_mm, 3);
  put_doubles(out + 56, p->axis, 3);
}

/* ---- the device */
static struct {
  double from[3], way[3], depth_mm, position[3], velocity[3], force[3];
} device;

static void device_pose(double dt_s, double time_s, pose* out) {
  const double mass_kg = 0.2, spring = 0.4, damping = 0.006; /* N/mm, N s/mm */
  const double aim = fmin(device.depth_mm, 20 * time_s);     /* mm/s */
  for (int step = 0; step < 32; ++step)
    for (int a = 0; a < 3; ++a) {
      const double pull = spring * (device.from[a] + device.way[a] * aim - device.position[a]);
      device.velocity[a] += (pull + device.force[a] - damping * device.velocity[a]) * 1000 / mass_kg * dt_s / 32;
      device.position[a] += device.velocity[a] * dt_s / 32;
    }
  for (int a = 0; a < 3; ++a) {
    out->tip_mm[a] = device.position[a];
    out->axis[a] = -device.way[a];
  }
  out->buttons = 0;
}
static void device_force(const double* newton) { memcpy(device.force, newton, sizeof device.force); }

/* ---- the loop */
static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char** argv) {
  if (argc < 11) return fprintf(stderr, "udp_client ADDRESS PORT SECONDS X Y Z DX DY DZ DEPTH_MM [LOG]\n"), 64;
  struct sockaddr_in to;
  memset(&to, 0, sizeof to);
  to.sin_family = AF_INET;
  to.sin_port = htons((uint16_t)atoi(argv[2]));
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  if (fd < 0 || inet_pton(AF_INET, argv[1], &to.sin_addr) != 1 || connect(fd, (struct sockaddr*)&to, sizeof to) != 0)
    return perror("udp_client"), 74;
  const double seconds = atof(argv[3]);
  double length = 0;
  for (int a = 0; a < 3; ++a) {
    device.from[a] = device.position[a] = atof(argv[4 + a]);
    device.way[a] = atof(argv[7 + a]);
    length += device.way[a] * device.way[a];
  }
  for (int a = 0; a < 3; ++a) device.way[a] /= sqrt(length);
  device.depth_mm = atof(argv[10]);
  FILE* log = argc > 11 ? fopen(argv[11], "w") : NULL;

  static pose sent[HISTORY];
  const uint32_t session = (uint32_t)getpid();
  uint64_t sequence = 0, answered = 0, answers = 0;
  uint32_t faults = 0;
  int busy = 0;
  double force[3] = {0, 0, 0}, most_n = 0, slowest_s = 0;
  const double begin = now_s();
  double due = begin, start = begin, heard = begin;
  while (due < begin + seconds) {
    pose* p = &sent[++sequence % HISTORY];
    if (answers == 0) start = due; /* it waits for the servo's first answer */
    device_pose(sequence > 1 ? period_s : 0, due - start, p);
    uint8_t packet[POSE_BYTES];
    write_pose(packet, p, session, sequence, now_s() - begin);
    (void)send(fd, packet, sizeof packet, 0); /* where nobody listens the force decays */
    due += period_s;
    if (now_s() > due + 0.1) due = now_s(); /* slept through: no burst of old poses */
    for (double left = due - now_s(); left > 0; left = due - now_s()) {
      fd_set set;
      FD_ZERO(&set);
      FD_SET(fd, &set);
      const struct timespec patience = {0, (long)(1e9 * left)};
      if (pselect(fd + 1, &set, NULL, NULL, &patience, NULL) <= 0) continue;
      uint8_t in[FORCE_BYTES + 1];
      if (recv(fd, in, sizeof in, 0) != FORCE_BYTES) continue;
      if (memcmp(in, "TRPF", 4) != 0 || get(in + 4, 2) != VERSION || get(in + 8, 4) != session) continue;
      const uint64_t of = get(in + 16, 8);
      if ((get(in + 6, 2) & BUSY) != 0) busy = 1;
      if (busy || of <= answered || of > sequence) continue;
      double sent_s, newton[3];
      get_doubles(in + 24, &sent_s, 1);
      get_doubles(in + 40, newton, 3);
      const double size = sqrt(newton[0] * newton[0] + newton[1] * newton[1] + newton[2] * newton[2]);
      if (!isfinite(size)) continue;
      memcpy(force, newton, sizeof force);
      faults |= (uint32_t)get(in + 12, 4);
      most_n = fmax(most_n, size);
      heard = now_s();
      slowest_s = fmax(slowest_s, heard - begin - sent_s);
      answered = of;
      ++answers;
      const double* x = sent[of % HISTORY].tip_mm;
      if (log && sequence - of < HISTORY)
        fprintf(log, "%llu %a %a %a %a %a %a\n", (unsigned long long)of, x[0], x[1], x[2], force[0], force[1], force[2]);
    }
    /* What nobody renews is held, then decays: a servo that stalls neither kicks nor pushes on. */
    const double age = now_s() - heard, share = age <= hold_s ? 1 : exp((hold_s - age) / decay_s);
    const double renewed[3] = {force[0] * share, force[1] * share, force[2] * share};
    device_force(renewed);
  }
  if (log) fclose(log);
  printf("%llu poses, %llu answers, the slowest after %.2f ms, force at most %.3f N%s, faults %u\n",
         (unsigned long long)sequence, (unsigned long long)answers, 1e3 * slowest_s, most_n,
         busy ? ", another client is there" : "", (unsigned)faults);
  return busy || faults != 0 ? 2 : answers == 0 ? 1 : 0;
}
