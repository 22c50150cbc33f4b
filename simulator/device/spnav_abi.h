// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// The part of libspnav.so.0's interface that is called, declared here so that its headers are not needed to build.
/// tests/spnav_stub.c holds it against <spnav.h> where that is installed.
namespace spnav_abi {

enum { motion = 1, button = 2 };

struct Motion {
  int type, x, y, z, rx, ry, rz;
  unsigned int period;
  int* data;
};
struct Button {
  int type, press, number;
};
union Event {
  int type;
  Motion motion;
  Button button;
  int room[64];  // libspnav's union has further events, of at most 9 ints
};

extern "C" {
int spnav_open(void);
int spnav_close(void);
int spnav_fd(void);
int spnav_poll_event(Event* event);
}

}  // namespace spnav_abi
