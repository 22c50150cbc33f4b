// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "cli/command.h"

namespace trephine {

/// Makes an optional argument; the caller sets its other members.
inline Argument argument(const std::string& name, Argument::Kind kind, const std::string& help) {
  Argument a;
  a.name = name;
  a.kind = kind;
  a.help = help;
  return a;
}

}  // namespace trephine
