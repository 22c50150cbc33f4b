/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loaded before the program (LD_PRELOAD), so that a pipe answers as the kernel's event device of a gamepad does: its
 * name, buttons and axes. TREPHINE_PAD=mouse: it has no buttons of a gamepad. What is pushed comes through the pipe.
 * For Debian's machines of 64 bits, whose programs call ioctl by that name. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <linux/input.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>

static void set(unsigned char* bits, int n) { bits[n / 8] |= (unsigned char)(1u << (n % 8)); }

int ioctl(int descriptor, unsigned long request, ...) {
  va_list rest;
  va_start(rest, request);
  void* data = va_arg(rest, void*);
  va_end(rest);
  if (_IOC_TYPE(request) != 'E') {
    int (*real)(int, unsigned long, ...) = (int (*)(int, unsigned long, ...))dlsym(RTLD_NEXT, "ioctl");
    return real(descriptor, request, data);
  }
  const unsigned number = _IOC_NR(request);
  if (number >= 0x40) { /* EVIOCGABS */
    const unsigned axis = number - 0x40;
    struct input_absinfo info = {0};
    if (axis > ABS_RZ) return -1;
    info.maximum = axis == ABS_Z || axis == ABS_RZ ? 255 : 32767;
    info.minimum = axis == ABS_Z || axis == ABS_RZ ? 0 : -32768;
    memcpy(data, &info, sizeof info);
    return 0;
  }
  memset(data, 0, _IOC_SIZE(request));
  if (request == EVIOCGNAME(_IOC_SIZE(request))) {
    strcpy(data, "Stub Pad\n");
    return 8;
  }
  if (request == EVIOCGBIT(EV_KEY, _IOC_SIZE(request))) {
    const char* kind = getenv("TREPHINE_PAD");
    if (!kind || strcmp(kind, "mouse") != 0) set(data, BTN_GAMEPAD);
  }
  return (int)_IOC_SIZE(request);
}
