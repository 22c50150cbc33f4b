/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Behaves to a C program as Force Dimension's libdhd.so (SDK 3.x), without a device, for the tests of an adaptor.
 * Written from public references alone:
 *   dhdc.h "Haptic SDK ver 3.7.0-pre, (C) 2001-2016 Force Dimension", as it is stored in public repositories
 *     (signatures, enum dhd_errors, DHD_TIMEGUARD 1, DHD_MOTOR_SATURATED 2);
 *   the vendor's online reference as restated by EmDash00/forcedimension_core-python(-docs), SDK 3.14/3.16 (return
 * values, units m, N, Nm, threads, one last error for each thread, gravity compensation, several devices,
 * dhdGetMaxForce). A tip sinks along -z by 10 mm/s for half a second from its first read, from (10, 5, 20) mm to (10,
 * 5, 15) mm, and rests. Its frame is turned by 30 degrees about z: matrix[row][column], the columns are the tool's
 * axes. Every device that is closed prints one line of JSON to stderr; one that is never closed prints it at the end,
 * with "left_open": true. TREPHINE_FAKE: none, two (the second's ID is 5), unplugged, nan (both after a second),
 * timeguard, saturated, late (TREPHINE_FAKE_LATE_MS, 20), noopen, falcon, unenabled (dhdEnableForce fails), unsent
 * (sends fail after a second). */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef unsigned char uchar;
typedef unsigned short ushort;
typedef unsigned int uint;
enum {
  NO_ERROR,
  ERROR,
  ERROR_COM,
  ERROR_DHC_BUSY,
  ERROR_NO_DRIVER_FOUND,
  ERROR_NO_DEVICE_FOUND,
  ERROR_NOT_AVAILABLE,
  ERROR_TIMEOUT,
  ERROR_GEOMETRY,
  ERROR_EXPERT_MODE_DISABLED,
  ERROR_NOT_IMPLEMENTED,
  ERROR_OUT_OF_MEMORY,
  ERROR_DEVICE_NOT_READY,
  ERROR_FILE_NOT_FOUND,
  ERROR_CONFIGURATION,
  ERROR_INVALID_INDEX,
  ERROR_DEPRECATED,
  ERROR_NULL_ARGUMENT,
  ERROR_REDUNDANT_FAIL,
  ERROR_NOT_ENABLED,
  ERROR_DEVICE_IN_USE,
  ERROR_INVALID
};
enum { TIMEGUARD = 1, MOTOR_SATURATED = 2, DEVICES = 2, MOST_THREADS = 64 };
static const int ids[DEVICES] = {0, 5};

typedef struct {
  bool open, enabled, ever_enabled, reading;
  long opened, closed, reads, buttons, sends, wrong_id, default_id, before_enable, after_disable, not_finite, guarded;
  double begin_s, largest_n[3], last_n[3], largest_nm[3], held[3];
} device;
static device devices[DEVICES];
static int chosen = -1;          /* index of the default device */
static long strays, after_close; /* calls with an ID of no open device; of those, forces */
static int most_inside, inside;  /* calls at once */
static pthread_t threads[MOST_THREADS];
static int threads_seen;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static __thread int last_error;

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static bool is(const char* what) {
  const char* v = getenv("TREPHINE_FAKE");
  return v && strcmp(v, what) == 0;
}
static int count(void) { return is("none") ? 0 : is("two") ? 2 : 1; }
static int fails(int error) {
  last_error = error;
  return -1;
}
static void enter(void) {
  pthread_mutex_lock(&lock);
  if (++inside > most_inside) most_inside = inside;
  int n = 0;
  while (n < threads_seen && !pthread_equal(threads[n], pthread_self())) ++n;
  if (n == threads_seen && n < MOST_THREADS) threads[threads_seen++] = pthread_self();
}
static int leave(int result) {
  --inside;
  pthread_mutex_unlock(&lock);
  return result;
}
/* The open device of an ID, or NULL. */
static device* of(signed char id) {
  int n = chosen;
  if (id != -1)
    for (n = DEVICES - 1; n >= 0 && ids[n] != id; --n) {
    }
  if (n < 0 || !devices[n].open) {
    ++strays;
    last_error = id == -1 ? ERROR_NO_DEVICE_FOUND : ERROR_INVALID_INDEX;
    return NULL;
  }
  if (id == -1) ++devices[n].default_id;
  return &devices[n];
}
static double since_s(const device* d) { return d->begin_s > 0 ? now_s() - d->begin_s : 0; }

static void tell(const device* d, bool left_open) {
  fprintf(stderr,
          "{\"fake\":\"dhd\", \"id\":%d, \"opened\":%ld, \"closed\":%ld, \"left_open\":%s, \"enabled\":%s, "
          "\"enabled_at_close\":%s, \"reads\":%ld, \"guarded\":%ld, \"buttons\":%ld, \"sends\":%ld, "
          "\"largest_n\":[%.9g,%.9g,%.9g], \"last_n\":[%.9g,%.9g,%.9g], \"largest_nm\":[%.9g,%.9g,%.9g], "
          "\"wrong_id\":%ld, \"default_id\":%ld, \"after_close\":%ld, \"before_enable\":%ld, \"after_disable\":%ld, "
          "\"not_finite\":%ld, \"threads\":%d, \"at_once\":%d}\n",
          ids[d - devices], d->opened, d->closed, left_open ? "true" : "false", d->ever_enabled ? "true" : "false",
          d->enabled ? "true" : "false", d->reads, d->guarded, d->buttons, d->sends, d->largest_n[0], d->largest_n[1],
          d->largest_n[2], d->last_n[0], d->last_n[1], d->last_n[2], d->largest_nm[0], d->largest_nm[1],
          d->largest_nm[2], strays, d->default_id, after_close, d->before_enable, d->after_disable, d->not_finite,
          threads_seen, most_inside);
  fflush(stderr);
}
__attribute__((destructor)) static void end(void) {
  for (int n = 0; n < DEVICES; ++n)
    if (devices[n].open) tell(&devices[n], true);
}

int dhdErrorGetLast(void) { return last_error; }
const char* dhdErrorGetStr(int error) {
  static const char* const texts[] = {"no error",
                                      "undocumented error",
                                      "communication error",
                                      "device controller busy",
                                      "no driver found",
                                      "no device found",
                                      "command not available",
                                      "timeout",
                                      "geometric model error",
                                      "expert mode disabled",
                                      "not implemented",
                                      "out of memory",
                                      "device not ready",
                                      "file not found",
                                      "invalid configuration",
                                      "invalid index",
                                      "deprecated",
                                      "null argument",
                                      "redundant encoder failure",
                                      "not enabled",
                                      "device in use",
                                      "invalid argument"};
  return error >= 0 && error <= ERROR_INVALID ? texts[error] : "unknown error";
}
const char* dhdErrorGetLastStr(void) { return dhdErrorGetStr(last_error); }
void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
  if (major) *major = 3;
  if (minor) *minor = 17;
  if (release) *release = 6;
  if (revision) *revision = 0;
}
const char* dhdGetSDKVersionStr(void) { return "3.17.6"; }
void dhdEnableSimulator(bool on) { (void)on; }
int dhdGetDeviceCount(void) { return enter(), leave(count()); }
int dhdGetAvailableCount(void) { return enter(), leave(count()); }
int dhdGetDeviceID(void) { return enter(), leave(chosen < 0 ? fails(ERROR_NO_DEVICE_FOUND) : ids[chosen]); }
int dhdSetDevice(signed char id) {
  enter();
  device* d = of(id);
  if (!d) return leave(-1);
  chosen = (int)(d - devices);
  return leave(0);
}
/* An index of those that are connected, and no ID. An open one's ID is given again. */
int dhdOpenID(signed char index) {
  enter();
  if (count() == 0) return leave(fails(ERROR_NO_DEVICE_FOUND));
  if (index < 0 || index >= count()) return leave(fails(ERROR_INVALID_INDEX));
  if (is("noopen")) return leave(fails(ERROR_DEVICE_IN_USE));
  device* d = &devices[(int)index];
  chosen = index;
  if (!d->open) {
    d->open = true;
    d->enabled = false;
    d->begin_s = 0;
    ++d->opened;
  }
  return leave(ids[(int)index]);
}
int dhdOpen(void) {
  for (signed char n = 0; n < count(); ++n)
    if (!devices[(int)n].open) return dhdOpenID(n);
  return fails(ERROR_NO_DEVICE_FOUND);
}
int dhdClose(signed char id) {
  enter();
  device* d = of(id);
  if (!d) return leave(-1);
  d->open = false;
  ++d->closed;
  tell(d, false);
  d->enabled = false;
  if (chosen == (int)(d - devices)) chosen = -1;
  return leave(0);
}
int dhdStop(signed char id) {
  enter();
  device* d = of(id);
  if (d) d->enabled = false;
  return leave(d ? 0 : -1);
}
int dhdEnableForce(uchar val, signed char id) {
  enter();
  device* d = of(id);
  if (!d) return leave(-1);
  if (is("unenabled")) return leave(fails(ERROR_DEVICE_NOT_READY));
  d->enabled = val != 0;
  d->ever_enabled = d->ever_enabled || d->enabled;
  return leave(0);
}
int dhdSetBrakes(int val, signed char id) {
  enter();
  device* d = of(id);
  if (d && val) d->enabled = false;
  return leave(d ? 0 : -1);
}
const char* dhdGetSystemName(signed char id) {
  enter();
  const device* d = of(id);
  leave(0);
  return !d ? NULL : is("falcon") ? "Novint Falcon" : d == &devices[1] ? "sigma.7 right" : "omega.6 right";
}
int dhdGetSystemType(signed char id) {
  enter();
  const device* d = of(id);
  return leave(!d ? -1 : is("falcon") ? 60 : d == &devices[1] ? 104 : 34);
}
int dhdGetSerialNumber(ushort* sn, signed char id) {
  enter();
  const device* d = of(id);
  if (d && sn) *sn = (ushort)(1001 + (d - devices));
  return leave(d ? 0 : -1);
}
int dhdGetVersion(double* ver, signed char id) {
  enter();
  const device* d = of(id);
  if (d && ver) *ver = 3.0;
  return leave(d ? 0 : -1);
}
int dhdGetStatus(int status[16], signed char id) {
  enter();
  const device* d = of(id);
  if (!d) return leave(-1);
  const int all[16] = {1, 1, 1, 0, !d->enabled, d->enabled, 0, 1, !is("falcon"), 0, 1, 1, 1, 0, 0, 0};
  memcpy(status, all, sizeof all);
  return leave(0);
}
static bool told(signed char id, bool what) {
  enter();
  const device* d = of(id);
  leave(0);
  return d && what;
}
bool dhdIsLeftHanded(signed char id) { return told(id, false); }
bool dhdHasBase(signed char id) { return told(id, true); }
bool dhdHasWrist(signed char id) { return told(id, !is("falcon")); }
bool dhdHasActiveWrist(signed char id) { return told(id, is("two")); }
bool dhdHasGripper(signed char id) { return told(id, is("two")); }
bool dhdHasActiveGripper(signed char id) { return told(id, is("two")); }
static int done(signed char id) { return told(id, true) ? 0 : -1; }
int dhdSetGravityCompensation(int val, signed char id) {
  (void)val;
  return done(id);
}
int dhdSetStandardGravity(double g, signed char id) {
  (void)g;
  return done(id);
}
int dhdSetEffectorMass(double mass, signed char id) {
  (void)mass;
  return done(id);
}
int dhdEmulateButton(uchar val, signed char id) {
  (void)val;
  return done(id);
}
int dhdGetComMode(signed char id) { return done(id); }
int dhdReset(signed char id) { return done(id); }
int dhdGetEffectorMass(double* mass, signed char id) {
  if (mass) *mass = 0.19;
  return done(id);
}
double dhdGetComFreq(signed char id) { return done(id) == 0 ? 4.0 : 0; }
/* Limits that somebody has set; below 0: none, as after opening. They are not what the device can hold. */
double dhdGetMaxForce(signed char id) {
  (void)told(id, true);
  return -1.0;
}
double dhdGetMaxTorque(signed char id) {
  (void)told(id, true);
  return -1.0;
}
double dhdGetMaxGripperForce(signed char id) {
  (void)told(id, true);
  return -1.0;
}
int dhdSetMaxForce(double f, signed char id) {
  (void)f;
  return done(id);
}
int dhdSetMaxTorque(double t, signed char id) {
  (void)t;
  return done(id);
}
double dhdGetTime(void) { return now_s(); }
void dhdSleep(double s) { usleep((useconds_t)(1e6 * s)); }

int dhdGetPositionAndOrientationFrame(double* px, double* py, double* pz, double matrix[3][3], signed char id) {
  if (is("late")) {
    const char* ms = getenv("TREPHINE_FAKE_LATE_MS");
    usleep(1000u * (useconds_t)(ms ? atoi(ms) : 20));
  }
  enter();
  device* d = of(id);
  if (!d) return leave(-1);
  if (!px || !py || !pz) return leave(fails(ERROR_NULL_ARGUMENT));
  if (d->begin_s <= 0) d->begin_s = now_s();
  const double t = since_s(d);
  if (is("unplugged") && t > 1) return leave(fails(ERROR_COM));
  ++d->reads;
  const bool guarded = is("timeguard") && d->reads % 2 == 0;
  if (!guarded) {
    d->held[0] = 0.010;
    d->held[1] = 0.005;
    d->held[2] = 0.020 - (t < 0.5 ? 0.010 * t : 0.005);
    if (is("nan") && t > 1) d->held[0] = d->held[1] = d->held[2] = NAN;
  } else {
    ++d->guarded;
  }
  *px = d->held[0];
  *py = d->held[1];
  *pz = d->held[2];
  if (matrix) {
    const double a = is("falcon") ? 0 : 3.14159265358979323846 / 6;
    const double turned[3][3] = {{cos(a), -sin(a), 0}, {sin(a), cos(a), 0}, {0, 0, 1}};
    memcpy(matrix, turned, sizeof turned);
  }
  return leave(guarded ? TIMEGUARD : 0);
}
int dhdGetPosition(double* px, double* py, double* pz, signed char id) {
  return dhdGetPositionAndOrientationFrame(px, py, pz, NULL, id);
}
int dhdGetOrientationFrame(double matrix[3][3], signed char id) {
  double x, y, z;
  return dhdGetPositionAndOrientationFrame(&x, &y, &z, matrix, id);
}
/* The mask has no value that says that it failed: then it is 0. */
uint dhdGetButtonMask(signed char id) {
  enter();
  device* d = of(id);
  if (d) ++d->buttons;
  const bool lost = d && is("unplugged") && since_s(d) > 1;
  if (lost) last_error = ERROR_COM;
  return (uint)leave(d && !lost && since_s(d) > 0.3 ? 1 : 0);
}
int dhdGetButton(int index, signed char id) { return (int)(dhdGetButtonMask(id) >> index & 1); }

int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx, double ty, double tz, double fg,
                                        signed char id) {
  enter();
  device* d = of(id);
  if (!d) {
    ++after_close;
    return leave(-1);
  }
  const double f[3] = {fx, fy, fz}, t[3] = {tx, ty, tz};
  ++d->sends;
  if (!isfinite(fx) || !isfinite(fy) || !isfinite(fz) || !isfinite(tx) || !isfinite(ty) || !isfinite(tz) ||
      !isfinite(fg)) {
    ++d->not_finite;
    return leave(fails(ERROR_INVALID));
  }
  memcpy(d->last_n, f, sizeof f);
  const bool any = fx != 0 || fy != 0 || fz != 0 || tx != 0 || ty != 0 || tz != 0 || fg != 0;
  if (any && !d->ever_enabled) ++d->before_enable;
  if (any && d->ever_enabled && !d->enabled) ++d->after_disable;
  const double* l = d->largest_n;
  if (fx * fx + fy * fy + fz * fz > l[0] * l[0] + l[1] * l[1] + l[2] * l[2]) memcpy(d->largest_n, f, sizeof f);
  l = d->largest_nm;
  if (tx * tx + ty * ty + tz * tz > l[0] * l[0] + l[1] * l[1] + l[2] * l[2]) memcpy(d->largest_nm, t, sizeof t);
  if ((is("unplugged") || is("unsent")) && since_s(d) > 1) return leave(fails(ERROR_COM));
  return leave(is("saturated") ? MOTOR_SATURATED : 0);
}
int dhdSetForceAndTorque(double fx, double fy, double fz, double tx, double ty, double tz, signed char id) {
  return dhdSetForceAndTorqueAndGripperForce(fx, fy, fz, tx, ty, tz, 0, id);
}
int dhdSetForceAndGripperForce(double fx, double fy, double fz, double fg, signed char id) {
  return dhdSetForceAndTorqueAndGripperForce(fx, fy, fz, 0, 0, 0, fg, id);
}
int dhdSetForce(double fx, double fy, double fz, signed char id) {
  return dhdSetForceAndTorqueAndGripperForce(fx, fy, fz, 0, 0, 0, 0, id);
}
