// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trephine {

/// How long a small fixed work takes here and now, in seconds: the best of five tries of about 30 ms each. Half of it
/// is smoothing of a volume on all threads (thread_count), half a chase through memory on one, which is about what the
/// stages of a case do. The ratio of two such figures says how much slower one machine is than another at a case,
/// roughly: it knows neither disks nor who else works later. What a program computes must not depend on it, only what
/// it tells of time.
double calibration_seconds();

}  // namespace trephine
