// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "config/said.h"
#include "lesson/rubric.h"

namespace trephine {

/// A rubric as it stands in a file.
struct RubricFileParams : VersionParams, VentriculostomyRubric {
  template <class V>
  static void describe(V& v) {
    v.template all_of<VersionParams>();
    v.template all_of<VentriculostomyRubric>();
  }
};

}  // namespace trephine
