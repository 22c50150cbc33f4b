// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>

#include "base/error.h"

namespace trephine {

/// What a person can do about a result that is refused, as the end of a message: an existing key and where its value
/// must go, a stage, a series, a recipe, or the file to paint and bring back. Names that a person can write (keys,
/// stages) stand in backticks: a test finds each of them in the reference. A value that is known is a Setting.
struct Remedy {
  Message text;
};

/// The one way to make an Error of code 80 (quality gate), so that none is without a remedy. The message is
/// `what; remedy`.
inline Error refusal(const std::string& field, const std::string& what, const Remedy& remedy) {
  return Error(ExitCode::quality, "", field, what + "; " + remedy.text);
}

namespace remedies {

/// Of a surface that no program should have made: it is our fault, and what may go round it is other triangles.
inline const Remedy other_triangles{
    "this is a fault of the program: another `max_deviation_mm` of the stage before may go round it, `repair` mends a "
    "surface from elsewhere"};

}  // namespace remedies
}  // namespace trephine
