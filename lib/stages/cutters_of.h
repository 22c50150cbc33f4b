// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "boolean/cutter_use.h"
#include "stages/stage.h"

namespace trephine::stages {

/// The cutters of the ports "cutters.*", in the order of the ports' names. A name that occurs twice gets a number.
inline std::vector<boolean::Cutter> cutters_of(const StageInputs& inputs) {
  std::vector<boolean::Cutter> all;
  for (const auto& [name, cutters] : inputs.all<std::vector<boolean::Cutter>>("cutters"))
    all.insert(all.end(), cutters->begin(), cutters->end());
  return boolean::with_unique_names(std::move(all));
}

}  // namespace trephine::stages
