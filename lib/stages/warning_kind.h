// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/warning.h"

namespace trephine::stages {

/// How much a warning weighs for who uses what a stage made.
enum class Severity {
  wrong,  ///< it speaks against an anatomy, which therefore is not good
  look,   ///< a person should look before the case is used
  note,   ///< how the case was made, which a person may want to know
};
const char* to_text(Severity severity);

/// What a kind of warning means for a case: one table for all stages, by the warning's identifier.
struct WarningKind {
  Severity severity = Severity::look;
  /// The anatomies that a wrong one speaks against, by their usual names. Empty: the one whose stage gave it. It never
  /// speaks against anatomies that a case has not.
  std::vector<std::string> about;
  /// Whether it speaks against the places of landmarks, too: the whole scan may be stretched.
  bool about_landmarks = false;
};

/// A warning as it is told: its words, with who gave it.
struct GradedWarning {
  std::string text;
  Severity severity = Severity::look;
};

/// A kind that the table does not hold is one to look at.
WarningKind kind_of(const Warning& warning);

/// The identifiers that speak against an anatomy.
std::vector<std::string> wrong_kinds();

}  // namespace trephine::stages
