// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/rigid_fit.h"
#include "itk/transform.h"
#include "lesson/print_record.h"

namespace trephine::print {

using lesson::parse_print;
using lesson::PrintGap;
using lesson::PrintMark;
using lesson::PrintPart;
using lesson::PrintRecord;
using lesson::PrintTarget;
using lesson::read_print;
using lesson::to_json;

/// case_to_print as a map, and back.
inline itk::LinearMap map_of(const std::array<double, 12>& rows) {
  const RigidMap map = trephine::map_of(rows);
  return {map.turn, map.offset_mm};
}
inline std::array<double, 12> rows_of(const itk::LinearMap& map) {
  return trephine::rows_of({map.matrix, map.offset_mm});
}

}  // namespace trephine::print
