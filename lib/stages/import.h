// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "dicom/import.h"

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

}  // namespace trephine::stages
