// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"

namespace trephine {

/// What a person should know of a result: an identifier, which code may compare, and the values that it is about. The
/// words are a form with the values' names in braces ("the shift of {shift_mm:.1f} mm"), which `to_text` fills where a
/// person reads them; no code does. It holds nothing that differs between equal runs (no time, path or thread count),
/// and names no patient.
struct Warning {
  std::string id;  ///< snake_case, one for each kind: "no_midsagittal_plane"
  std::string form;
  Named<ParameterValue> values;
  template <class V>
  static void describe(V& v) {
    v.text(&Warning::id, "id", "Which kind of warning it is.");
    v.text(&Warning::form, "form", "Its words, with the names of the values in braces.");
    v.map(&Warning::values, "values", "What it is about.");
  }
};
using Warnings = std::vector<Warning>;

/// One line, in words. Without values the form is the line. Throws Error 70 where the form names a value that is not
/// there, or in a way that does not fit it.
std::string to_text(const Warning& warning);

}  // namespace trephine
