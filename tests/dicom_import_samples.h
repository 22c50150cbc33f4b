// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A small series, and what becomes of it and of its like in an import.
#include <cstdint>
#include <filesystem>
#include <string>

#include "base/error.h"
#include "dicom/import.h"
#include "dicom_synthetic.h"

namespace trephine::import_samples {

using synthetic::Scan;
using synthetic::tag;

constexpr auto position_tag = tag(0x20, 0x32), orientation_tag = tag(0x20, 0x37), spacing_tag = tag(0x28, 0x30),
               slope_tag = tag(0x28, 0x1053), intercept_tag = tag(0x28, 0x1052), pixels_tag = tag(0x7fe0, 0x10);

inline Scan small() {
  Scan s;
  s.columns = 20;
  s.rows = 16;
  s.slices = 6;
  s.blobs = synthetic::four_blobs(6, 3);
  return s;
}

inline std::int64_t count(const Report& r, const std::string& name) {
  const ParameterValue* v = r.find(name);
  return v ? std::get<std::int64_t>(*v) : -1;
}

struct Refused {
  int code = 0;
  std::string line;
};

inline Refused outcome(const std::filesystem::path& path, const dicom::ImportParams& params = {}) {
  try {
    dicom::import_series(path, params);
  } catch (const Error& e) {
    return {static_cast<int>(e.code()), e.line("import")};
  }
  return {};
}

inline Refused outcome(const Scan& scan, const dicom::ImportParams& params = {}) {
  const ScratchFolder folder;
  scan.write(folder);
  return outcome(folder.path(), params);
}

}  // namespace trephine::import_samples
