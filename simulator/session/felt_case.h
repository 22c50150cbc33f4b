// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "cases/load_case.h"
#include "haptics/feel.h"
#include "haptics/recording.h"

namespace trephine {

/// A loaded case that can be felt.
struct FeltCase {
  LoadedCase loaded;
  Feels feels;
  std::string felt_shape;

  /// Throws as load_case does; 65 where the case has no haptic volume; 64 for --shape where it has no such shape. If a
  /// shape is given, no other can be touched.
  FeltCase(const std::filesystem::path& folder, const std::string& shape);
  /// The case and shape of a recording.
  RecordingHeader header() const;
};

}  // namespace trephine
