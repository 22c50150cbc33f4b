// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trephine {

/// The exit codes of our programs. The numbers are those of sysexits.h where it has one.
enum class ExitCode : int {
  ok = 0,              ///< done; everything that was asked for was reached
  usage = 64,          ///< an unknown flag, contradictory options, or a choice is needed
  bad_input = 65,      ///< bad input data
  no_input = 66,       ///< input not found or not readable
  internal = 70,       ///< internal error, or a child died or ran over its limits
  cannot_create = 73,  ///< an output cannot be created
  io = 74,             ///< I/O error while reading or writing
  busy = 75,           ///< another process is building this case: try again
  bad_config = 78,     ///< bad configuration
  quality = 80,        ///< the result is not good enough to publish
  privacy = 81,        ///< refused by the privacy gate
  cancelled = 130,     ///< Ctrl-C, with the number that shells report
};

}  // namespace trephine
