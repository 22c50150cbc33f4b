/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Force Dimension's devices (omega, delta, sigma) and the Novint Falcon, by the vendor's libdhd, which is loaded at run
 * time. Source: Force Dimension SDK 3.x, Haptic SDK reference (dhdc.h). Metres, newtons and newton metres; x to the
 * operator, y to the right, z up, which `--workspace-axes omega` turns into the patient's frame. A fake of the library
 * is all that was ever held with it. */
#include "device/adaptor.h"
#include "vendor_library.h"

enum { max_devices = 16, dhd_off = 0, dhd_on = 1 };

/* Those that return int give below 0 where they fail; what is above is no fault: DHD_TIMEGUARD (asked again too soon,
 * the pose is the last one), DHD_MOTOR_SATURATED. */
static struct {
  void* library;
  int (*count)(void);
  int (*open_id)(char);
  int (*close)(char);
  const char* (*name)(char);
  int (*enable_force)(unsigned char, char);
  int (*pose)(double*, double*, double*, double[3][3], char);
  unsigned int (*buttons)(char);
  int (*set_force)(double, double, double, double, double, double, double, char);
  double (*max_force)(char);        /* this one and the next are not in old versions */
  unsigned char (*has_wrist)(char); /* a bool of C++ */
  const char* (*last_error)(void);
} dhd;

typedef struct {
  int is_open, has_wrist;
  char id;
} handle;
static handle handles[max_devices];

static int load(void) {
  static const char* const names[] = {"libdhd.so.3", "libdhd.so", NULL};
  if (dhd.library) return 0;
  void* found = vendor_library("TREPHINE_DHD_LIBRARY", names, "Force Dimension's SDK");
  if (!found) return 1;
  if (vendor_function(found, "dhdGetDeviceCount", &dhd.count) || vendor_function(found, "dhdOpenID", &dhd.open_id) ||
      vendor_function(found, "dhdClose", &dhd.close) || vendor_function(found, "dhdGetSystemName", &dhd.name) ||
      vendor_function(found, "dhdEnableForce", &dhd.enable_force) ||
      vendor_function(found, "dhdGetPositionAndOrientationFrame", &dhd.pose) ||
      vendor_function(found, "dhdGetButtonMask", &dhd.buttons) ||
      vendor_function(found, "dhdSetForceAndTorqueAndGripperForce", &dhd.set_force) ||
      vendor_function(found, "dhdErrorGetLastStr", &dhd.last_error))
    return 1;
  void* optional = dlsym(found, "dhdGetMaxForce");
  memcpy(&dhd.max_force, &optional, sizeof optional);
  optional = dlsym(found, "dhdHasWrist");
  memcpy(&dhd.has_wrist, &optional, sizeof optional);
  dhd.library = found;
  return 0;
}

static int failed_call(const char* what) { return fail(what, dhd.last_error()); }

static handle* opened(int index) {
  if (load() || index < 0 || index >= max_devices) return NULL;
  handle* h = &handles[index];
  const int id = dhd.open_id((char)index);
  if (id < 0) {
    failed_call("dhdOpenID");
    return NULL;
  }
  h->is_open = 1;
  h->id = (char)id;
  h->has_wrist = !dhd.has_wrist || dhd.has_wrist(h->id);
  return h;
}

int trephine_adaptor_version(void) { return TREPHINE_ADAPTOR_VERSION; }

int trephine_adaptor_count(void) {
  if (load()) return -1;
  const int count = dhd.count();
  if (count < 0) failed_call("dhdGetDeviceCount");
  return count < max_devices ? count : max_devices;
}

int trephine_adaptor_name(int index, char* out, int size) {
  /* A device tells its name while it is open. */
  const int was_open = index >= 0 && index < max_devices && handles[index].is_open;
  handle* h = was_open ? &handles[index] : opened(index);
  if (!h) return 1;
  const char* name = dhd.name(h->id);
  snprintf(out, (size_t)size, "%s", name ? name : "Force Dimension");
  if (!was_open) {
    dhd.close(h->id);
    h->is_open = 0;
  }
  return 0;
}

void* trephine_adaptor_open(int index) { return opened(index); }

int trephine_adaptor_limits(void* device, trephine_adaptor_limits_t* out) {
  /* Continuous forces of the data sheets, where the SDK has no limit of its own. */
  static const struct {
    const char* name;
    double force_n;
  } known[] = {{"omega", 12}, {"delta", 20}, {"sigma", 20}, {"Falcon", 8}};
  const char id = ((handle*)device)->id;
  const char* name = dhd.name(id);
  memset(out, 0, sizeof *out);
  for (size_t n = 0; name && n < sizeof known / sizeof *known; ++n)
    if (strstr(name, known[n].name)) out->max_force_n = known[n].force_n;
  const double limit = dhd.max_force ? dhd.max_force(id) : -1;
  if (limit > 0 && (out->max_force_n == 0 || limit < out->max_force_n)) out->max_force_n = limit;
  return 0;
}

int trephine_adaptor_start(void* device) {
  return dhd.enable_force(dhd_on, ((handle*)device)->id) < 0 ? failed_call("dhdEnableForce") : 0;
}

int trephine_adaptor_read(void* device, trephine_adaptor_pose* out) {
  const handle* h = device;
  const char id = h->id;
  double p[3], frame[3][3]; /* by rows; its columns are the tool's own axes */
  if (dhd.pose(&p[0], &p[1], &p[2], frame, id) < 0) return failed_call("dhdGetPositionAndOrientationFrame");
  for (int a = 0; a < 3; ++a) {
    out->tip_mm[a] = 1000 * p[a];
    out->axis[a] = frame[a][0];                      /* x: to the operator, where the tail is */
    out->across[a] = h->has_wrist ? frame[a][2] : 0; /* else the frame never turns */
  }
  out->buttons = dhd.buttons(id);
  return 0;
}

int trephine_adaptor_send(void* device, const double force_n[3], const double torque_n_mm[3]) {
  return dhd.set_force(force_n[0], force_n[1], force_n[2], torque_n_mm[0] / 1000, torque_n_mm[1] / 1000,
                       torque_n_mm[2] / 1000, 0, ((handle*)device)->id) < 0
             ? failed_call("dhdSetForceAndTorqueAndGripperForce")
             : 0;
}

void trephine_adaptor_close(void* device) {
  handle* h = device;
  dhd.set_force(0, 0, 0, 0, 0, 0, 0, h->id);
  dhd.enable_force(dhd_off, h->id);
  dhd.close(h->id);
  h->is_open = 0;
}

const char* trephine_adaptor_error(void) { return failed; }
