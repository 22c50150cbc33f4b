/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 3D Systems' devices (Touch, Touch X, Phantom) by the vendor's libHD of OpenHaptics, which is loaded at run time.
 * Source: OpenHaptics Toolkit 3.4, HDAPI reference (hd.h, hdDefines.h). Millimetres and newtons; x to the right, y up,
 * z to the user, which `--workspace-axes touch` turns into the patient's frame. HDAPI takes forces within a frame of
 * its own scheduler's thread alone, so a callback there exchanges pose and force with us. It cannot list devices: the
 * default one is held, or those that TREPHINE_HD_DEVICES names as the vendor's setup does ("Left Device,Right Device").
 * A fake of the library is all that was ever held with it. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <time.h>

#include "device/adaptor.h"
#include "vendor_library.h"

typedef unsigned int hd_enum, hd_device;
typedef struct {
  unsigned int code;
  int internal_code;
  hd_device device;
} hd_error;
typedef unsigned int (*hd_callback)(void*);

/* Of hdDefines.h. */
enum {
  hd_current_buttons = 0x2000,
  hd_current_transform = 0x2052,
  hd_device_model_type = 0x2501,
  hd_usable_workspace_dimensions = 0x2551,
  hd_calibration_style = 0x2555,
  hd_nominal_max_continuous_force = 0x2604,
  hd_current_force = 0x2700,
  hd_force_output = 0x4000,
  hd_calibration_needs_update = 0x5001,
  hd_calibration_needs_manual_input = 0x5002,
  hd_callback_done = 0,
  hd_callback_continue = 1
};
#define HD_INVALID_HANDLE 0xFFFFFFFFu

enum { max_devices = 8, name_size = 64 };
static const double stale_s = 0.05, no_frame_s = 0.2;

static struct {
  void* library;
  hd_device (*init)(const char*);
  void (*disable_device)(hd_device);
  void (*make_current)(hd_device);
  void (*begin_frame)(hd_device);
  void (*end_frame)(hd_device);
  void (*get_double)(hd_enum, double*);
  void (*get_integer)(hd_enum, int*);
  const char* (*get_string)(hd_enum);
  void (*set_double)(hd_enum, const double*);
  void (*enable)(hd_enum);
  hd_error (*get_error)(void);
  const char* (*error_string)(unsigned int);
  hd_enum (*check_calibration)(void);
  void (*update_calibration)(hd_enum);
  void (*start_scheduler)(void);
  void (*stop_scheduler)(void);
  unsigned long (*schedule)(hd_callback, void*, unsigned short);
  void (*unschedule)(unsigned long);
} hd;

typedef struct {
  hd_device device;
  int is_open, is_started;
  unsigned long callback;
  pthread_mutex_t mutex; /* of what follows */
  trephine_adaptor_pose pose;
  double force_n[3], sent_s, frame_s;
  int frames, is_lost, is_closing;
  char fault[96];
} handle;
static handle handles[max_devices];

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void sleep_ms(long ms) {
  const struct timespec t = {0, ms * 1000000};
  nanosleep(&t, NULL);
}

static int load(void) {
  static const char* const names[] = {"libHD.so.3.4", "libHD.so.3", "libHD.so", NULL};
  if (hd.library) return 0;
  void* found = vendor_library("TREPHINE_HD_LIBRARY", names, "3D Systems' OpenHaptics");
  if (!found) return 1;
  const struct {
    const char* name;
    void* function;
  } all[] = {{"hdInitDevice", &hd.init},
             {"hdDisableDevice", &hd.disable_device},
             {"hdMakeCurrentDevice", &hd.make_current},
             {"hdBeginFrame", &hd.begin_frame},
             {"hdEndFrame", &hd.end_frame},
             {"hdGetDoublev", &hd.get_double},
             {"hdGetIntegerv", &hd.get_integer},
             {"hdGetString", &hd.get_string},
             {"hdSetDoublev", &hd.set_double},
             {"hdEnable", &hd.enable},
             {"hdGetError", &hd.get_error},
             {"hdGetErrorString", &hd.error_string},
             {"hdCheckCalibration", &hd.check_calibration},
             {"hdUpdateCalibration", &hd.update_calibration},
             {"hdStartScheduler", &hd.start_scheduler},
             {"hdStopScheduler", &hd.stop_scheduler},
             {"hdScheduleAsynchronous", &hd.schedule},
             {"hdUnschedule", &hd.unschedule}};
  for (size_t n = 0; n < sizeof all / sizeof *all; ++n)
    if (vendor_function(found, all[n].name, all[n].function)) return 1;
  hd.library = found;
  return 0;
}

/* Takes the errors off the library's stack; what the device fails by, NULL where none is of the device. Warm motors and
 * limits that were exceeded are of a force, which the library then lowers by itself. */
static const char* device_fault(void) {
  const char* fault = NULL;
  for (hd_error e = hd.get_error(); e.code != 0; e = hd.get_error())
    if (e.code < 0x0200 || e.code > 0x02ff) fault = hd.error_string(e.code);
  return fault;
}
static int device_failed(const char* what) {
  const char* fault = device_fault();
  return fault ? fail(what, fault) : 0;
}

/* The name of a device in TREPHINE_HD_DEVICES; empty for the default one. 0 where there is none of that index. */
static int configured(int index, char* out) {
  const char* list = getenv("TREPHINE_HD_DEVICES");
  *out = 0;
  if (!list || !*list) return index == 0;
  for (; index > 0; --index) {
    list = strchr(list, ',');
    if (!list) return 0;
    ++list;
  }
  snprintf(out, name_size, "%.*s", (int)strcspn(list, ","), list);
  return 1;
}

static handle* opened(int index) {
  char name[name_size];
  if (load() || index < 0 || index >= max_devices || !configured(index, name)) return NULL;
  handle* h = &handles[index];
  h->device = hd.init(*name ? name : NULL);
  const int fault = device_failed("hdInitDevice");
  if (h->device == HD_INVALID_HANDLE) {
    if (!fault) fail("hdInitDevice", "gives no device");
    return NULL;
  }
  pthread_mutex_init(&h->mutex, NULL);
  h->is_open = 1;
  return h;
}

/* In the thread of the library's scheduler, a thousand times a second. */
static unsigned int exchange(void* of) {
  handle* h = of;
  double t[16] = {0}; /* by columns: the tool's own axes, and its place */
  int buttons = 0;
  hd.begin_frame(h->device);
  hd.get_double(hd_current_transform, t);
  hd.get_integer(hd_current_buttons, &buttons);
  pthread_mutex_lock(&h->mutex);
  /* Nobody sends any more: no force is held. */
  const int old = h->is_closing || h->is_lost || now_s() - h->sent_s > stale_s;
  const double force_n[3] = {old ? 0 : h->force_n[0], old ? 0 : h->force_n[1], old ? 0 : h->force_n[2]};
  pthread_mutex_unlock(&h->mutex);
  hd.set_double(hd_current_force, force_n);
  hd.end_frame(h->device);
  const char* fault = device_fault();
  pthread_mutex_lock(&h->mutex);
  if (fault && !h->is_lost) snprintf(h->fault, sizeof h->fault, "%s", fault);
  h->is_lost = h->is_lost || fault;
  if (!h->is_lost) { /* what a frame read that failed is no pose */
    for (int a = 0; a < 3; ++a) {
      h->pose.tip_mm[a] = t[12 + a];
      h->pose.axis[a] = t[8 + a]; /* z: from the stylus's tip to its tail */
      h->pose.across[a] = t[a];
    }
    h->pose.buttons = (uint32_t)buttons;
  }
  h->frame_s = now_s();
  ++h->frames;
  pthread_mutex_unlock(&h->mutex);
  return hd_callback_continue;
}

int trephine_adaptor_version(void) { return TREPHINE_ADAPTOR_VERSION; }

/* HDAPI says of a device whether it is there, and what it is, while it is held. 0 where it is not. */
static int looked_at(int index, char* out, int size) {
  const int was_open = index >= 0 && index < max_devices && handles[index].is_open;
  handle* h = was_open ? &handles[index] : opened(index);
  if (!h) return 0;
  hd.make_current(h->device);
  const char* model = hd.get_string(hd_device_model_type);
  if (out) snprintf(out, (size_t)size, "%s", model && *model ? model : "OpenHaptics");
  device_failed("hdGetString");
  if (!was_open) {
    hd.disable_device(h->device);
    memset(h, 0, sizeof *h);
  }
  return 1;
}

int trephine_adaptor_count(void) {
  char name[name_size];
  if (load()) return -1;
  int count = 0;
  while (count < max_devices && configured(count, name)) ++count;
  return count > 1 || looked_at(0, NULL, 0) ? count : 0;
}

int trephine_adaptor_name(int index, char* out, int size) { return !looked_at(index, out, size); }

void* trephine_adaptor_open(int index) { return opened(index); }

int trephine_adaptor_limits(void* device, trephine_adaptor_limits_t* out) {
  double box[6] = {0};
  memset(out, 0, sizeof *out);
  hd.make_current(((handle*)device)->device);
  hd.get_double(hd_nominal_max_continuous_force, &out->max_force_n);
  hd.get_double(hd_usable_workspace_dimensions, box);
  for (int a = 0; a < 3; ++a) out->workspace_mm[a] = box[3 + a] > box[a] ? box[3 + a] - box[a] : 0;
  device_failed("limits");
  return 0;
}

int trephine_adaptor_start(void* device) {
  handle* h = device;
  hd.make_current(h->device);
  hd_enum calibration = hd.check_calibration();
  if (calibration == hd_calibration_needs_update) {
    int style = 0;
    hd.get_integer(hd_calibration_style, &style);
    hd.update_calibration((hd_enum)style);
    calibration = hd.check_calibration();
  }
  if (calibration == hd_calibration_needs_manual_input)
    return fail("the device is not calibrated",
                "put the stylus into its inkwell, or hold it as the vendor's setup shows");
  hd.enable(hd_force_output);
  if (device_failed("hdEnable")) return 1;
  h->callback = hd.schedule(exchange, h, 65535 / 2);
  hd.start_scheduler();
  h->is_started = 1;
  return device_failed("hdStartScheduler");
}

int trephine_adaptor_read(void* device, trephine_adaptor_pose* out) {
  handle* h = device;
  for (int tries = 0;; ++tries) {
    pthread_mutex_lock(&h->mutex);
    *out = h->pose;
    const int frames = h->frames, lost = h->is_lost;
    const double age_s = now_s() - h->frame_s;
    if (lost) fail("libHD", h->fault);
    pthread_mutex_unlock(&h->mutex);
    if (lost) return 1;
    if (frames > 0) return age_s > no_frame_s ? fail("libHD", "its scheduler gives no frame") : 0;
    if (tries > 1000) return fail("libHD", "its scheduler gives no frame");
    sleep_ms(1);
  }
}

int trephine_adaptor_send(void* device, const double force_n[3], const double torque_n_mm[3]) {
  handle* h = device;
  (void)torque_n_mm; /* the Touch has three driven axes */
  pthread_mutex_lock(&h->mutex);
  memcpy(h->force_n, force_n, sizeof h->force_n);
  h->sent_s = now_s();
  const int lost = h->is_lost;
  pthread_mutex_unlock(&h->mutex);
  return lost;
}

void trephine_adaptor_close(void* device) {
  handle* h = device;
  if (h->is_started) {
    pthread_mutex_lock(&h->mutex);
    h->is_closing = 1;
    const int frames = h->frames;
    pthread_mutex_unlock(&h->mutex);
    for (int n = 0, now = frames; n < 50 && now < frames + 2; ++n) { /* a whole frame without a force */
      sleep_ms(1);
      pthread_mutex_lock(&h->mutex);
      now = h->frames;
      pthread_mutex_unlock(&h->mutex);
    }
    hd.stop_scheduler();
    hd.unschedule(h->callback);
  }
  hd.disable_device(h->device);
  memset(h, 0, sizeof *h);
}

const char* trephine_adaptor_error(void) { return failed; }
