/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Behaves to a C program as 3D Systems' libHD.so (OpenHaptics 3.4, HDAPI), without a device, for the tests of an
 * adaptor. Written from public references alone: hdDefines.h, hdDevice.h, hdScheduler.h "(c) 2004 SensAble
 * Technologies" of version 3.0, as they are stored in public repositories (constants, types and signatures; the handle
 * of no device is HD_INVALID_HANDLE 0xFFFFFFFF, while HD_BAD_HANDLE is the error 0x0104); the OpenHaptics Toolkit API
 * Reference Guide 3.0 to 3.5 as restated by the comments of public bindings (OH4CSharp), and the vendor's hduError.cpp
 * (which errors are of forces and pass, and which end the servo loop). A stylus sinks along -y by 10 mm/s for half a
 * second from the first frame, from (3, 20, 7) mm to (3, 15, 7) mm, and rests. Its transform is 16 doubles by columns,
 * Ry(20 degrees) Rx(-50 degrees), in mm at [12..14]; its z column points from the tip to the tail. Forces take effect
 * only where they are set within a frame within a callback of the scheduler. A device that is disabled prints one line
 * of JSON to stderr; one that never is prints it at the end, with "left_open": true. TREPHINE_FAKE: none, two ("Left
 * Device", "Right Device"), unplugged, nan, stalled (callbacks end; all three after a second), warm, exceeded (another
 * error of forces that passes, once), limit (0.88 N continuous), uncalibrated, update (hdUpdateCalibration is needed),
 * unscheduled (hdStartScheduler gives HD_TIMER_ERROR). */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef unsigned int HDuint, HDerror, HDenum, HHD, HDCallbackCode, HDWaitCode;
typedef unsigned char HDboolean;
typedef unsigned long HDulong, HDSchedulerHandle;
typedef unsigned short HDushort;
typedef int HDint;
typedef float HDfloat;
typedef double HDdouble;
typedef long HDlong;
typedef const char* HDstring;
typedef struct {
  HDerror errorCode;
  int internalErrorCode;
  HHD hHD;
} HDErrorInfo;
typedef HDCallbackCode (*HDSchedulerCallback)(void*);
enum {
  HD_SUCCESS = 0,
  HD_INVALID_ENUM = 0x0100,
  HD_INVALID_VALUE = 0x0101,
  HD_INVALID_OPERATION = 0x0102,
  HD_INVALID_INPUT_TYPE = 0x0103,
  HD_BAD_HANDLE = 0x0104,
  HD_WARM_MOTORS = 0x0200,
  HD_EXCEEDED_MAX_FORCE = 0x0201,
  HD_EXCEEDED_MAX_FORCE_IMPULSE = 0x0202,
  HD_EXCEEDED_MAX_VELOCITY = 0x0203,
  HD_FORCE_ERROR = 0x0204,
  HD_DEVICE_FAULT = 0x0300,
  HD_DEVICE_ALREADY_INITIATED = 0x0301,
  HD_COMM_ERROR = 0x0302,
  HD_COMM_CONFIG_ERROR = 0x0303,
  HD_TIMER_ERROR = 0x0304,
  HD_ILLEGAL_BEGIN = 0x0400,
  HD_ILLEGAL_END = 0x0401,
  HD_FRAME_ERROR = 0x0402,
  HD_INVALID_PRIORITY = 0x0500,
  HD_SCHEDULER_FULL = 0x0501,
  HD_INVALID_LICENSE = 0x0600,
  HD_CURRENT_BUTTONS = 0x2000,
  HD_CURRENT_SAFETY_SWITCH = 0x2001,
  HD_CURRENT_INKWELL_SWITCH = 0x2002,
  HD_CURRENT_ENCODER_VALUES = 0x2010,
  HD_CURRENT_POSITION = 0x2050,
  HD_CURRENT_VELOCITY = 0x2051,
  HD_CURRENT_TRANSFORM = 0x2052,
  HD_CURRENT_ANGULAR_VELOCITY = 0x2053,
  HD_CURRENT_JOINT_ANGLES = 0x2100,
  HD_CURRENT_GIMBAL_ANGLES = 0x2150,
  HD_LAST_BUTTONS = 0x2200,
  HD_LAST_POSITION = 0x2250,
  HD_LAST_TRANSFORM = 0x2252,
  HD_LAST_GIMBAL_ANGLES = 0x2350,
  HD_VERSION = 0x2500,
  HD_DEVICE_MODEL_TYPE = 0x2501,
  HD_DEVICE_DRIVER_VERSION = 0x2502,
  HD_DEVICE_VENDOR = 0x2503,
  HD_DEVICE_SERIAL_NUMBER = 0x2504,
  HD_DEVICE_FIRMWARE_VERSION = 0x2505,
  HD_MAX_WORKSPACE_DIMENSIONS = 0x2550,
  HD_USABLE_WORKSPACE_DIMENSIONS = 0x2551,
  HD_TABLETOP_OFFSET = 0x2552,
  HD_INPUT_DOF = 0x2553,
  HD_OUTPUT_DOF = 0x2554,
  HD_CALIBRATION_STYLE = 0x2555,
  HD_UPDATE_RATE = 0x2600,
  HD_INSTANTANEOUS_UPDATE_RATE = 0x2601,
  HD_NOMINAL_MAX_STIFFNESS = 0x2602,
  HD_NOMINAL_MAX_FORCE = 0x2603,
  HD_NOMINAL_MAX_CONTINUOUS_FORCE = 0x2604,
  HD_MOTOR_TEMPERATURE = 0x2605,
  HD_SOFTWARE_VELOCITY_LIMIT = 0x2606,
  HD_SOFTWARE_FORCE_IMPULSE_LIMIT = 0x2607,
  HD_FORCE_RAMPING_RATE = 0x2608,
  HD_NOMINAL_MAX_DAMPING = 0x2609,
  HD_CURRENT_FORCE = 0x2700,
  HD_CURRENT_TORQUE = 0x2701,
  HD_CURRENT_JOINT_TORQUE = 0x2703,
  HD_CURRENT_GIMBAL_TORQUE = 0x2704,
  HD_LAST_FORCE = 0x2800,
  HD_FORCE_OUTPUT = 0x4000,
  HD_MAX_FORCE_CLAMPING = 0x4001,
  HD_FORCE_RAMPING = 0x4002,
  HD_SOFTWARE_FORCE_LIMIT = 0x4003,
  HD_ONE_FRAME_LIMIT = 0x4004,
  HD_CALIBRATION_OK = 0x5000,
  HD_CALIBRATION_NEEDS_UPDATE = 0x5001,
  HD_CALIBRATION_NEEDS_MANUAL_INPUT = 0x5002,
  HD_CALIBRATION_INKWELL = 4,
  DEVICES = 3,
  CALLBACKS = 16,
  ERRORS = 256
};
#define HD_INVALID_HANDLE 0xFFFFFFFFu
static const char* const names[DEVICES] = {"Default Device", "Left Device", "Right Device"};

typedef struct {
  bool open, force_output, clamping, ramping, one_frame, calibrated, ever_enabled, enabled_after_start;
  int frame; /* how many frames are open, one in the other */
  long frame_tick, begun, ended, twice, buttons_read;
  double begin_s, position_mm[3], velocity[3], set_n[3], last_n[3], largest_n[3];
  HDint buttons;
  long opened, reads, reads_outside_frame, sends, outside_frame, outside_callback, not_enabled, frames_open,
      device_not_current, not_finite, too_much, wrong_type;
} device;
typedef struct {
  HDSchedulerCallback f;
  void* data;
  HDushort priority;
  HDSchedulerHandle handle;
  bool used, running, synchronous, finished;
} callback;

static device devices[DEVICES];
static HHD current = HD_INVALID_HANDLE;
static HDErrorInfo errors[ERRORS];
static int errors_kept;
static long errors_pushed, bad_handles;
static callback callbacks[CALLBACKS];
static HDSchedulerHandle next_handle;
static pthread_t scheduler;
static bool running, stop;
static double rate_hz = 1000, tick_begin_s;
static long tick;
static __thread bool in_callback;
static pthread_mutex_t lock;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static bool is(const char* what) {
  const char* v = getenv("TREPHINE_FAKE");
  return v && strcmp(v, what) == 0;
}
static void push(HDerror code) {
  if (errors_kept == ERRORS) memmove(errors, errors + 1, sizeof errors[0] * (size_t)--errors_kept);
  errors[errors_kept++] = (HDErrorInfo){code, 0, current};
  ++errors_pushed;
}
static device* of(HHD h) {
  if (h < DEVICES && devices[h].open) return &devices[h];
  ++bad_handles;
  push(HD_BAD_HANDLE);
  return NULL;
}
static double norm(const double* v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
static double most_n(void) { return 3.3; }
static double continuous_n(void) { return is("limit") ? 0.88 : 2.1; }

static void tell(const device* d, bool left_open) {
  int left = 0;
  for (int n = 0; n < CALLBACKS; ++n) left += callbacks[n].used;
  fprintf(
      stderr,
      "{\"fake\":\"hd\", \"name\":\"%s\", \"opened\":%ld, \"left_open\":%s, \"enabled\":%s, \"enabled_at_close\":%s, "
      "\"enabled_after_start\":%s, \"frames\":%ld, \"reads\":%ld, \"sends\":%ld, "
      "\"largest_n\":[%.9g,%.9g,%.9g], \"last_n\":[%.9g,%.9g,%.9g], \"last_frame_zero\":%s, \"outside_frame\":%ld, "
      "\"outside_callback\":%ld, \"reads_outside_frame\":%ld, \"frames_open\":%ld, \"frames_twice\":%ld, "
      "\"device_not_current\":%ld, \"wrong_handle\":%ld, \"before_enable\":%ld, \"not_finite\":%ld, "
      "\"over_most\":%ld, \"wrong_type\":%ld, \"scheduler_left_running\":%s, \"callbacks_left\":%d, "
      "\"errors_pushed\":%ld, \"errors_unread\":%d, \"calibrated\":%s}\n",
      names[d - devices], d->opened, left_open ? "true" : "false", d->ever_enabled ? "true" : "false",
      d->force_output ? "true" : "false", d->enabled_after_start ? "true" : "false", d->begun, d->reads, d->sends,
      d->largest_n[0], d->largest_n[1], d->largest_n[2], d->last_n[0], d->last_n[1], d->last_n[2],
      norm(d->last_n) == 0 ? "true" : "false", d->outside_frame, d->outside_callback, d->reads_outside_frame,
      d->frames_open + (d->frame > 0), d->twice, d->device_not_current, bad_handles, d->not_enabled, d->not_finite,
      d->too_much, d->wrong_type, running ? "true" : "false", left, errors_pushed, errors_kept,
      d->calibrated ? "true" : "false");
  fflush(stderr);
}
__attribute__((constructor)) static void begin(void) {
  pthread_mutexattr_t a;
  pthread_mutexattr_init(&a);
  pthread_mutexattr_settype(&a, PTHREAD_MUTEX_RECURSIVE);
  pthread_mutex_init(&lock, &a);
}
__attribute__((destructor)) static void end(void) {
  for (int n = 0; n < DEVICES; ++n)
    if (devices[n].open) tell(&devices[n], true);
}
#define IN pthread_mutex_lock(&lock)
#define OUT pthread_mutex_unlock(&lock)

HDErrorInfo hdGetError(void) {
  IN;
  HDErrorInfo e = {HD_SUCCESS, 0, current};
  if (errors_kept > 0) e = errors[--errors_kept];
  OUT;
  return e;
}
HDstring hdGetErrorString(HDerror code) {
  switch (code) {
    case HD_SUCCESS:
      return "Success";
    case HD_INVALID_ENUM:
      return "Invalid enum";
    case HD_INVALID_VALUE:
      return "Invalid value";
    case HD_INVALID_OPERATION:
      return "Invalid operation";
    case HD_INVALID_INPUT_TYPE:
      return "Invalid input type";
    case HD_BAD_HANDLE:
      return "Bad handle";
    case HD_WARM_MOTORS:
      return "Warm motors";
    case HD_EXCEEDED_MAX_FORCE:
      return "Exceeded maximum force";
    case HD_EXCEEDED_MAX_FORCE_IMPULSE:
      return "Exceeded maximum force impulse";
    case HD_EXCEEDED_MAX_VELOCITY:
      return "Exceeded maximum velocity";
    case HD_FORCE_ERROR:
      return "Force error";
    case HD_DEVICE_FAULT:
      return "Device fault";
    case HD_DEVICE_ALREADY_INITIATED:
      return "Device already initiated";
    case HD_COMM_ERROR:
      return "Communication error";
    case HD_COMM_CONFIG_ERROR:
      return "Communication configuration error";
    case HD_TIMER_ERROR:
      return "Timer error";
    case HD_ILLEGAL_BEGIN:
      return "Illegal begin frame";
    case HD_ILLEGAL_END:
      return "Illegal end frame";
    case HD_FRAME_ERROR:
      return "Frame error";
    case HD_INVALID_PRIORITY:
      return "Invalid priority";
    case HD_SCHEDULER_FULL:
      return "Scheduler full";
    case HD_INVALID_LICENSE:
      return "Invalid license";
    default:
      return "Unknown error";
  }
}

/* The first device where no name is given. The handle 0 is a good one. */
HHD hdInitDevice(HDstring name) {
  IN;
  HHD h = HD_INVALID_HANDLE;
  if (!name || strcmp(name, names[0]) == 0) h = 0;
  if (is("two"))
    for (unsigned n = 1; name && n < DEVICES; ++n)
      if (strcmp(name, names[n]) == 0) h = n;
  if (is("none")) h = HD_INVALID_HANDLE;
  if (h == HD_INVALID_HANDLE) {
    push(HD_DEVICE_FAULT);
  } else if (devices[h].open) {
    push(HD_DEVICE_ALREADY_INITIATED);
    h = HD_INVALID_HANDLE;
  } else {
    device* d = &devices[h];
    d->open = d->clamping = d->one_frame = true;
    d->force_output = d->ramping = false;
    d->frame = 0;
    d->frame_tick = -1;
    d->begin_s = 0;
    d->calibrated = !is("uncalibrated") && !is("update");
    ++d->opened;
    current = h;
  }
  OUT;
  return h;
}
void hdDisableDevice(HHD h) {
  IN;
  device* d = of(h);
  if (d) {
    tell(d, false);
    d->open = false;
    if (current == h) current = HD_INVALID_HANDLE;
  }
  OUT;
}
void hdMakeCurrentDevice(HHD h) {
  IN;
  if (of(h)) current = h;
  OUT;
}
HHD hdGetCurrentDevice(void) {
  IN;
  const HHD h = current;
  if (h == HD_INVALID_HANDLE) push(HD_BAD_HANDLE);
  OUT;
  return h;
}

static void sense(device* d) {
  if (d->begin_s <= 0) d->begin_s = now_s();
  const double t = now_s() - d->begin_s;
  if (is("unplugged") && t > 1) {
    push(HD_COMM_ERROR);
    return;
  }
  if (is("warm") && d->begun % 50 == 7) push(HD_WARM_MOTORS);
  if (is("exceeded") && d->begun == 100) push(HD_EXCEEDED_MAX_VELOCITY);
  d->position_mm[0] = 3;
  d->position_mm[1] = 20 - (t < 0.5 ? 10 * t : 5);
  d->position_mm[2] = 7;
  d->velocity[1] = t < 0.5 ? -10 : 0;
  if (is("nan") && t > 1) d->position_mm[0] = d->position_mm[1] = d->position_mm[2] = NAN;
  d->buttons = t > 0.3 ? 1 : 0;
}
/* Makes the device the current one. Frames of one device may lie in each other; else one frame is allowed in each tick.
 */
void hdBeginFrame(HHD h) {
  IN;
  device* d = of(h);
  if (d) {
    current = h;
    if (!in_callback && running) ++d->outside_callback;
    if (d->frame == 0 && in_callback && running && d->one_frame && d->frame_tick == tick) {
      ++d->twice;
      push(HD_ILLEGAL_BEGIN);
    } else if (d->frame++ == 0) {
      d->frame_tick = in_callback ? tick : -1;
      ++d->begun;
      memset(d->set_n, 0, sizeof d->set_n);
      sense(d);
    }
  }
  OUT;
}
void hdEndFrame(HHD h) {
  IN;
  device* d = of(h);
  if (d) {
    if (current != h) ++d->device_not_current;
    if (d->frame == 0) {
      push(HD_ILLEGAL_END);
    } else if (--d->frame == 0) {
      ++d->ended;
      if (in_callback) {
        double f[3] = {d->set_n[0], d->set_n[1], d->set_n[2]};
        if (norm(f) > 0 && !d->force_output) {
          ++d->not_enabled;
          f[0] = f[1] = f[2] = 0;
        }
        if (norm(f) > most_n()) {
          ++d->too_much;
          push(HD_EXCEEDED_MAX_FORCE);
          const double by = d->clamping ? most_n() / norm(f) : 0;
          for (int k = 0; k < 3; ++k) f[k] *= by;
        }
        memcpy(d->last_n, f, sizeof f);
        if (norm(f) > norm(d->largest_n)) memcpy(d->largest_n, f, sizeof f);
      }
    }
  }
  OUT;
}

static bool* capability(device* d, HDenum cap) {
  static bool spare;
  switch (cap) {
    case HD_FORCE_OUTPUT:
      return &d->force_output;
    case HD_MAX_FORCE_CLAMPING:
      return &d->clamping;
    case HD_FORCE_RAMPING:
      return &d->ramping;
    case HD_ONE_FRAME_LIMIT:
      return &d->one_frame;
    case HD_SOFTWARE_FORCE_LIMIT:
    case HD_SOFTWARE_VELOCITY_LIMIT:
    case HD_SOFTWARE_FORCE_IMPULSE_LIMIT:
      return &spare;
    default:
      push(HD_INVALID_ENUM);
      return NULL;
  }
}
static void able(HDenum cap, bool on) {
  IN;
  device* d = of(current);
  bool* c = d ? capability(d, cap) : NULL;
  if (c) *c = on;
  if (c && on && cap == HD_FORCE_OUTPUT) {
    if (running && !d->ever_enabled) d->enabled_after_start = true;
    d->ever_enabled = true;
  }
  OUT;
}
void hdEnable(HDenum cap) { able(cap, true); }
void hdDisable(HDenum cap) { able(cap, false); }
HDboolean hdIsEnabled(HDenum cap) {
  IN;
  device* d = of(current);
  const bool* c = d ? capability(d, cap) : NULL;
  const HDboolean on = c && *c;
  OUT;
  return on;
}

/* A value of the current device as doubles, and how many; 0 where there is none. */
static int value(HDenum p, double out[16]) {
  device* d = of(current);
  if (!d) return 0;
  const bool state = (p >= HD_CURRENT_BUTTONS && p < HD_VERSION) || p == HD_CURRENT_FORCE || p == HD_LAST_FORCE;
  if (state && d->frame == 0) ++d->reads_outside_frame;
  if (state) ++d->reads;
  const double a = 20 * 3.14159265358979323846 / 180, b = -50 * 3.14159265358979323846 / 180;
  const double ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b);
  /* Ry(a) Rx(b), by columns */
  const double t[16] = {ca,
                        0,
                        -sa,
                        0,
                        sa * sb,
                        cb,
                        ca * sb,
                        0,
                        sa * cb,
                        -sb,
                        ca * cb,
                        0,
                        d->position_mm[0],
                        d->position_mm[1],
                        d->position_mm[2],
                        1};
  const double nothing[6] = {0};
  const double box[6] = {-80, -60, -35, 80, 60, 35}, most[6] = {-210, -110, -85, 210, 205, 130};
  const double* from = NULL;
  double one = 0;
  int size = 1;
  switch (p) {
    case HD_CURRENT_POSITION:
    case HD_LAST_POSITION:
      from = d->position_mm;
      size = 3;
      break;
    case HD_CURRENT_VELOCITY:
      from = d->velocity;
      size = 3;
      break;
    case HD_CURRENT_TRANSFORM:
    case HD_LAST_TRANSFORM:
      from = t;
      size = 16;
      break;
    case HD_CURRENT_FORCE:
      from = d->set_n;
      size = 3;
      break;
    case HD_LAST_FORCE:
      from = d->last_n;
      size = 3;
      break;
    case HD_CURRENT_ANGULAR_VELOCITY:
    case HD_CURRENT_JOINT_ANGLES:
    case HD_CURRENT_GIMBAL_ANGLES:
    case HD_LAST_GIMBAL_ANGLES:
      from = nothing;
      size = 3;
      break;
    case HD_CURRENT_BUTTONS:
    case HD_LAST_BUTTONS:
      one = d->buttons;
      ++d->buttons_read;
      break;
    case HD_CURRENT_SAFETY_SWITCH:
    case HD_CURRENT_INKWELL_SWITCH:
      break;
    case HD_USABLE_WORKSPACE_DIMENSIONS:
      from = box;
      size = 6;
      break;
    case HD_MAX_WORKSPACE_DIMENSIONS:
      from = most;
      size = 6;
      break;
    case HD_TABLETOP_OFFSET:
      one = -110;
      break;
    case HD_INPUT_DOF:
      one = 6;
      break;
    case HD_OUTPUT_DOF:
      one = 3;
      break;
    case HD_CALIBRATION_STYLE:
      one = HD_CALIBRATION_INKWELL;
      break;
    case HD_UPDATE_RATE:
    case HD_INSTANTANEOUS_UPDATE_RATE:
      one = rate_hz;
      break;
    case HD_NOMINAL_MAX_STIFFNESS:
      one = 0.5;
      break; /* N/mm that a wall may have */
    case HD_NOMINAL_MAX_DAMPING:
      one = 0.003;
      break; /* that may be rendered; not the device's own */
    case HD_NOMINAL_MAX_FORCE:
      one = most_n();
      break;
    case HD_NOMINAL_MAX_CONTINUOUS_FORCE:
      one = continuous_n();
      break;
    case HD_MOTOR_TEMPERATURE:
      from = nothing;
      size = 6;
      break;
    case HD_SOFTWARE_VELOCITY_LIMIT:
      one = 1000;
      break;
    case HD_SOFTWARE_FORCE_IMPULSE_LIMIT:
      one = 10;
      break;
    case HD_FORCE_RAMPING_RATE:
      one = 1;
      break;
    default:
      push(HD_INVALID_ENUM);
      return 0;
  }
  memcpy(out, from ? from : &one, sizeof(double) * (size_t)size);
  return size;
}
#define GET(NAME, TYPE)                                 \
  void hdGet##NAME(HDenum p, TYPE* out) {               \
    IN;                                                 \
    double v[16];                                       \
    const int size = value(p, v);                       \
    for (int n = 0; n < size; ++n) out[n] = (TYPE)v[n]; \
    OUT;                                                \
  }
GET(Integerv, HDint)
GET(Booleanv, HDboolean)
GET(Longv, HDlong)
/* Buttons are integers. */
static void get_real(HDenum p, double* d, float* f) {
  IN;
  double v[16];
  if (p == HD_CURRENT_BUTTONS || p == HD_LAST_BUTTONS) {
    if (current < DEVICES) ++devices[current].wrong_type;
    push(HD_INVALID_INPUT_TYPE);
  } else {
    const int size = value(p, v);
    for (int n = 0; n < size; ++n) {
      if (d) d[n] = v[n];
      if (f) f[n] = (float)v[n];
    }
  }
  OUT;
}
void hdGetDoublev(HDenum p, HDdouble* out) { get_real(p, out, NULL); }
void hdGetFloatv(HDenum p, HDfloat* out) { get_real(p, NULL, out); }
HDstring hdGetString(HDenum p) {
  IN;
  HDstring s = NULL;
  const device* d = of(current);
  if (d) switch (p) {
      case HD_DEVICE_MODEL_TYPE:
        s = "Touch";
        break;
      case HD_DEVICE_VENDOR:
        s = "3D Systems";
        break;
      case HD_DEVICE_SERIAL_NUMBER:
        s = d == &devices[0] ? "2016-0001" : d == &devices[1] ? "2016-0002" : "2016-0003";
        break;
      case HD_VERSION:
        s = "3.4.0";
        break;
      case HD_DEVICE_DRIVER_VERSION:
        s = "2016.2";
        break;
      default:
        push(HD_INVALID_ENUM);
    }
  OUT;
  return s;
}

static void set_force(HDenum p, const double* v) {
  IN;
  device* d = of(current);
  if (!d) {
    OUT;
    return;
  }
  if (p == HD_CURRENT_FORCE) {
    ++d->sends;
    if (d->frame == 0) {
      ++d->outside_frame;
      for (int n = 0; n < DEVICES; ++n)
        if (n != (int)current && devices[n].frame > 0) ++d->device_not_current;
      push(HD_INVALID_OPERATION);
    } else if (!isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2])) {
      ++d->not_finite;
      push(HD_INVALID_VALUE);
    } else {
      if (!in_callback) ++d->outside_callback;
      memcpy(d->set_n, v, sizeof d->set_n);
    }
  } else if (p != HD_CURRENT_TORQUE && p != HD_CURRENT_JOINT_TORQUE && p != HD_CURRENT_GIMBAL_TORQUE &&
             p != HD_SOFTWARE_VELOCITY_LIMIT && p != HD_SOFTWARE_FORCE_IMPULSE_LIMIT && p != HD_FORCE_RAMPING_RATE) {
    push(HD_INVALID_ENUM);
  }
  OUT;
}
void hdSetDoublev(HDenum p, const HDdouble* v) { set_force(p, v); }
void hdSetFloatv(HDenum p, const HDfloat* v) {
  const bool three =
      p == HD_CURRENT_FORCE || p == HD_CURRENT_TORQUE || p == HD_CURRENT_JOINT_TORQUE || p == HD_CURRENT_GIMBAL_TORQUE;
  const double d[3] = {v[0], three ? v[1] : 0, three ? v[2] : 0};
  set_force(p, d);
}

HDenum hdCheckCalibration(void) {
  IN;
  const device* d = of(current);
  const HDenum c = d && d->calibrated ? HD_CALIBRATION_OK
                   : is("update")     ? HD_CALIBRATION_NEEDS_UPDATE
                                      : HD_CALIBRATION_NEEDS_MANUAL_INPUT;
  OUT;
  return c;
}
HDenum hdCheckCalibrationStyle(void) { return HD_CALIBRATION_INKWELL; }
void hdUpdateCalibration(HDenum style) {
  IN;
  device* d = of(current);
  if (style != HD_CALIBRATION_INKWELL)
    push(HD_INVALID_VALUE);
  else if (d && !is("uncalibrated"))
    d->calibrated = true;
  OUT;
}

static bool lies_still(void) {
  if (!is("stalled")) return false;
  for (int n = 0; n < DEVICES; ++n)
    if (devices[n].open && devices[n].begin_s > 0 && now_s() - devices[n].begin_s > 1) return true;
  return false;
}
static void* schedule(void* unused) {
  (void)unused;
  struct timespec next;
  clock_gettime(CLOCK_MONOTONIC, &next);
  IN;
  while (!stop) {
    ++tick;
    tick_begin_s = now_s();
    bool was[CALLBACKS] = {false};
    while (!lies_still()) {
      int n = -1;
      for (int k = 0; k < CALLBACKS; ++k)
        if (callbacks[k].used && !callbacks[k].finished && !was[k] &&
            (n < 0 || callbacks[k].priority > callbacks[n].priority))
          n = k;
      if (n < 0) break;
      was[n] = true;
      callback* c = &callbacks[n];
      c->running = true;
      OUT;
      in_callback = true;
      const HDCallbackCode code = c->f(c->data);
      in_callback = false;
      IN;
      c->running = false;
      if (code == 0) {
        c->finished = true;
        if (!c->synchronous) c->used = false;
      }
      pthread_cond_broadcast(&changed);
    }
    for (int k = 0; k < DEVICES; ++k)
      if (devices[k].open && devices[k].frame > 0) { /* begun and not ended within its tick */
        ++devices[k].frames_open;
        devices[k].frame = 0;
        push(HD_FRAME_ERROR);
      }
    OUT;
    next.tv_nsec += (long)(1e9 / rate_hz);
    for (; next.tv_nsec >= 1000000000; next.tv_nsec -= 1000000000) ++next.tv_sec;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
    IN;
  }
  OUT;
  return NULL;
}
void hdStartScheduler(void) {
  IN;
  if (is("unscheduled"))
    push(HD_TIMER_ERROR);
  else if (!running) {
    stop = false;
    running = pthread_create(&scheduler, NULL, schedule, NULL) == 0;
  }
  OUT;
}
void hdStopScheduler(void) {
  IN;
  const bool was = running && !pthread_equal(pthread_self(), scheduler);
  stop = true;
  OUT;
  if (!was) return;
  pthread_join(scheduler, NULL);
  IN;
  running = false;
  pthread_cond_broadcast(&changed);
  OUT;
}
void hdSetSchedulerRate(HDulong rate) {
  IN;
  if (rate == 500 || rate == 1000)
    rate_hz = (double)rate;
  else
    push(HD_INVALID_VALUE);
  OUT;
}
static callback* add(HDSchedulerCallback f, void* data, HDushort priority) {
  for (int n = 0; n < CALLBACKS; ++n)
    if (!callbacks[n].used) {
      callbacks[n] = (callback){f, data, priority, next_handle++, true, false, false, false};
      return &callbacks[n];
    }
  push(HD_SCHEDULER_FULL);
  return NULL;
}
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback f, void* data, HDushort priority) {
  IN;
  const callback* c = add(f, data, priority);
  const HDSchedulerHandle h = c ? c->handle : HD_INVALID_HANDLE;
  OUT;
  return h;
}
/* Returns when the callback is done; without a running scheduler it is called at once. */
void hdScheduleSynchronous(HDSchedulerCallback f, void* data, HDushort priority) {
  IN;
  if (!running || pthread_equal(pthread_self(), scheduler)) {
    OUT;
    const bool was = in_callback;
    in_callback = true;
    while (f(data) != 0) {
    }
    in_callback = was;
    return;
  }
  callback* c = add(f, data, priority);
  if (c) {
    c->synchronous = true;
    while (!c->finished && running) pthread_cond_wait(&changed, &lock);
    c->used = false;
  }
  OUT;
}
void hdUnschedule(HDSchedulerHandle h) {
  IN;
  for (int n = 0; n < CALLBACKS; ++n)
    if (callbacks[n].used && callbacks[n].handle == h) {
      callbacks[n].used = false;
      while (callbacks[n].running && running && !pthread_equal(pthread_self(), scheduler))
        pthread_cond_wait(&changed, &lock);
    }
  OUT;
}
HDboolean hdWaitForCompletion(HDSchedulerHandle h, HDWaitCode wait) {
  IN;
  bool there = true;
  while (there) {
    there = false;
    for (int n = 0; n < CALLBACKS; ++n) there = there || (callbacks[n].used && callbacks[n].handle == h);
    if (!there || wait == 0 || !running) break;
    pthread_cond_wait(&changed, &lock);
  }
  OUT;
  return there;
}
HDdouble hdGetSchedulerTimeStamp(void) { return now_s() - tick_begin_s; }
/* For tests: the force that acts on device 0 now. */
void fake_last_n(double out[3]) {
  IN;
  memcpy(out, devices[0].last_n, sizeof devices[0].last_n);
  OUT;
}
HDboolean hdDeploymentLicense(const char* vendor, const char* application, const char* password) {
  (void)vendor, (void)application, (void)password;
  return 1;
}
