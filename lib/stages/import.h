// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "dicom/import.h"
#include "look/look.h"

namespace trephine::stages {

/// The parameters of a case's import: those of `trephine import`, and the series.
struct ImportStageParams : dicom::ImportParams {
  std::string input;
  template <class V>
  static void describe(V& v) {
    v.template all_of<dicom::ImportParams>();
    v.text(&ImportStageParams::input, "input", "Folder, ZIP archive or file with the series.").names("file");
  }
};

/// The result of a case's import: the scan, and what a CT's picture shows.
struct ImportStageResult {
  dicom::ImportFigures scan;
  std::optional<look::LookFigures> seen;
  template <class V>
  static void describe(V& v) {
    v.all_of(&ImportStageResult::scan);
    v.all_of(&ImportStageResult::seen);
  }
};

}  // namespace trephine::stages
