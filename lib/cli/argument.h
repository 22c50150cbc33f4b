// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "cli/command.h"

namespace trephine::cli {

/// Makes an optional argument; the caller sets its other members.
inline Argument argument(const std::string& name, Argument::Kind kind, const std::string& help) {
  Argument a;
  a.name = name;
  a.kind = kind;
  a.help = help;
  return a;
}

/// One that must be given.
inline Argument required_argument(const std::string& name, Argument::Kind kind, const std::string& help) {
  Argument a = argument(name, kind, help);
  a.required = true;
  return a;
}

/// One that must be given, by its place on the line.
inline Argument positional_argument(const std::string& name, Argument::Kind kind, const std::string& help) {
  Argument a = required_argument(name, kind, help);
  a.positional = true;
  return a;
}

}  // namespace trephine::cli
