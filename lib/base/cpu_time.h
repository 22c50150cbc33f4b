// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <time.h>

namespace trephine {

/// What all threads of this process have taken of the processors since it began, ms.
inline double process_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
}

}  // namespace trephine
