/* SPDX-License-Identifier: GPL-3.0-or-later
 * A haptic device for `trephine-sim servo CASE --device udp`, version 2 of its packets (docs/reference/udp-device.md), C99 and POSIX:
 *   cc -std=c99 -o udp_client udp_client.c -lm
 *   udp_client ADDRESS PORT SECONDS X Y Z DX DY DZ DEPTH_MM [LOG [PEDALS]]
 * Here the device is a mass that a spring draws from X Y Z (mm, LPS) along DX DY DZ, DEPTH_MM far, while the hand turns
 * it about its axis. To drive another, replace device_pose and device_force. LOG gets a line for each answer: sequence,
 * tip, force and torque, exact (%a), and events. PEDALS: 1 drills. Ends with 0; 1 where nothing answered; 2 where the
 * servo says that another client is there, or that there is a fault; 64 for a wrong argument, 73 where LOG cannot be
 * written, 74 without a socket. */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { VERSION = 2, POSE_BYTES = 96, FORCE_BYTES = 160, BUSY = 1, HISTORY = 1024 };
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
  double tip_mm[3], turn[4]; /* LPS; a unit quaternion x, y, z, w: from the tool's axes, tip to tail +z, to LPS */
  uint32_t pedals;           /* 1 drills, 2 marks an incision */
} pose;

static void write_pose(uint8_t* out, const pose* p, uint32_t session, uint64_t sequence, double time_s) {
  memset(out, 0, POSE_BYTES); /* flags, buttons, tool and command stay 0 */
  memcpy(out, "TRPP", 4);
  put(out + 4, VERSION, 2);
  put(out + 8, session, 4);
  put(out + 16, sequence, 8);
  put_doubles(out + 24, &time_s, 1);
  put_doubles(out + 32, p->tip_mm, 3);
  put_doubles(out + 56, p->turn, 4);
  put(out + 88, p->pedals, 4);
}

typedef struct {
  uint64_t of;
  uint32_t faults, events;
  int busy;
  double sent_s, force_n[3], torque_n_mm[3];
} answer;

static int read_force(const uint8_t* in, long bytes, uint32_t session, answer* out) {
  if (bytes != FORCE_BYTES || memcmp(in, "TRPF", 4) != 0 || get(in + 4, 2) != VERSION || get(in + 8, 4) != session)
    return 0;
  out->busy = (get(in + 6, 2) & BUSY) != 0;
  out->faults = (uint32_t)get(in + 12, 4);
  out->of = get(in + 16, 8);
  get_doubles(in + 24, &out->sent_s, 1);
  get_doubles(in + 40, out->force_n, 3);
  get_doubles(in + 64, out->torque_n_mm, 3);
  out->events = (uint32_t)get(in + 152, 4);
  return 1;
}

/* ---- the device */
static struct {
  double from[3], way[3], depth_mm, position[3], velocity[3], force[3];
  uint32_t pedals;
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
  memcpy(out->tip_mm, device.position, sizeof device.position);
  /* From +z to where the tail points, against the way, and by 1 rad/s about the axis before that. */
  const double x = -device.way[0], y = -device.way[1], z = -device.way[2], w = sqrt(fmax(0, 0.5 * (1 + z)));
  const double over[4] = {w > 1e-6 ? -0.5 * y / w : 1, w > 1e-6 ? 0.5 * x / w : 0, 0, w};
  const double s = sin(0.5 * time_s), c = cos(0.5 * time_s);
  out->turn[0] = over[0] * c + over[1] * s;
  out->turn[1] = over[1] * c - over[0] * s;
  out->turn[2] = over[3] * s;
  out->turn[3] = over[3] * c;
  out->pedals = device.pedals;
}
/* This one has no motors for a torque. */
static void device_force(const double* newton) { memcpy(device.force, newton, sizeof device.force); }

/* ---- the loop */
static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* NAN where the word is none. */
static double number(const char* word) {
  char* end;
  const double v = strtod(word, &end);
  return end == word || *end ? NAN : v;
}
static int refuse(int code, const char* word, const char* what) {
  return fprintf(stderr, "udp_client: %s: %s\n", word, what), code;
}

int main(int argc, char** argv) {
  if (argc < 11)
    return fprintf(stderr, "udp_client ADDRESS PORT SECONDS X Y Z DX DY DZ DEPTH_MM [LOG [PEDALS]]\n"), 64;
  for (int n = 2; n < argc; ++n)
    if (n != 11 && !isfinite(number(argv[n]))) return refuse(64, argv[n], "is no number");
  const double port = number(argv[2]), seconds = number(argv[3]), pedals = argc > 12 ? number(argv[12]) : 0;
  if (port < 1 || port > 65535) return refuse(64, argv[2], "is no port, 1 to 65535");
  if (pedals < 0 || pedals > 3) return refuse(64, argv[12], "are no pedals, 0 to 3");
  struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  if (inet_pton(AF_INET, argv[1], &to.sin_addr) != 1) return refuse(64, argv[1], "is no IPv4 address in numbers");
  for (int a = 0; a < 3; ++a) device.from[a] = device.position[a] = number(argv[4 + a]);
  for (int a = 0; a < 3; ++a) device.way[a] = number(argv[7 + a]);
  const double length = hypot(hypot(device.way[0], device.way[1]), device.way[2]);
  if (!(length > 0)) return refuse(64, "DX DY DZ", "must have a length");
  for (int a = 0; a < 3; ++a) device.way[a] /= length;
  device.depth_mm = number(argv[10]);
  device.pedals = (uint32_t)pedals;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  if (fd < 0 || connect(fd, (struct sockaddr*)&to, sizeof to) != 0) return refuse(74, argv[1], strerror(errno));
  FILE* log = argc > 11 ? fopen(argv[11], "w") : NULL;
  if (argc > 11 && !log) return refuse(73, argv[11], strerror(errno));

  static pose sent[HISTORY];
  const uint32_t session = (uint32_t)getpid();
  uint64_t sequence = 0, answered = 0, answers = 0;
  uint32_t faults = 0, events = 0;
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
      answer is;
      if (!read_force(in, (long)recv(fd, in, sizeof in, 0), session, &is)) continue;
      busy |= is.busy;
      if (busy || is.of <= answered || is.of > sequence) continue;
      const double size = sqrt(is.force_n[0] * is.force_n[0] + is.force_n[1] * is.force_n[1] + is.force_n[2] * is.force_n[2]);
      if (!isfinite(size)) continue;
      memcpy(force, is.force_n, sizeof force);
      faults |= is.faults;
      events |= is.events;
      most_n = fmax(most_n, size);
      heard = now_s();
      slowest_s = fmax(slowest_s, heard - begin - is.sent_s);
      answered = is.of;
      ++answers;
      const double *x = sent[is.of % HISTORY].tip_mm, *t = is.torque_n_mm;
      if (log && sequence - is.of < HISTORY)
        fprintf(log, "%llu %a %a %a %a %a %a %a %a %a %u\n", (unsigned long long)is.of, x[0], x[1], x[2], force[0],
                force[1], force[2], t[0], t[1], t[2], (unsigned)is.events);
    }
    /* What nobody renews is held, then decays: a servo that stalls neither kicks nor pushes on. */
    const double age = now_s() - heard, share = age <= hold_s ? 1 : exp((hold_s - age) / decay_s);
    const double renewed[3] = {force[0] * share, force[1] * share, force[2] * share};
    device_force(renewed);
  }
  if (log) fclose(log);
  printf("%llu poses, %llu answers, the slowest after %.2f ms, force at most %.3f N%s, events %u, faults %u\n",
         (unsigned long long)sequence, (unsigned long long)answers, 1e3 * slowest_s, most_n,
         busy ? ", another client is there" : "", (unsigned)events, (unsigned)faults);
  return busy || faults != 0 ? 2 : answers == 0 ? 1 : 0;
}
