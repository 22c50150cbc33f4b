// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/felt_case.h"

#include "base/error.h"

namespace trephine {

FeltCase::FeltCase(const std::filesystem::path& folder, const std::string& shape)
    : loaded(load_case(folder)), feels(feels_of(loaded.manifest.haptic)), felt_shape(shape) {
  if (!loaded.has_haptic())
    throw Error(ExitCode::bad_input, folder.string(), "haptic", "the case has no haptic volume");
  if (shape.empty()) return;
  const HapticShape* only = loaded.haptic.find_shape(shape);
  if (!only) {
    std::string names;
    for (const HapticShape& s : loaded.haptic.shapes) names += (names.empty() ? "" : ", ") + s.name;
    throw Error(ExitCode::usage, "", "--shape", "the case has none of that name, but " + names);
  }
  for (int n = 1; n <= haptic_max_shapes; ++n)
    if (n != only->number) {
      ShapeFeel& f = feels[std::size_t(n)];
      f = {};
      f.front.touchable = f.back.touchable = false;
    }
}

RecordingHeader FeltCase::header() const {
  RecordingHeader h;
  h.case_token = loaded.manifest.case_token;
  const CaseFile* file = loaded.manifest.find_file(loaded.manifest.haptic.file);
  h.haptic_sha256 = file ? file->sha256 : "";
  h.feel_sha256 = feel_digest(feels);
  h.felt_shape = felt_shape;
  return h;
}

}  // namespace trephine
