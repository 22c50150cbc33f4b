// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>
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
  /// What cuts, where the recording's tool does; else null. Throws as Drilling and cutter_of do.
  std::unique_ptr<Drilling> drilling_of(const RecordingHeader& header, ContactVolume& contact);
  /// The case and shape of a recording.
  RecordingHeader header() const;
};

/// The case and the tool as a recording has them. Throws Error 65, naming the file, where they are others.
FeltCase felt_again(const std::filesystem::path& folder, const std::string& file, const RecordingHeader& header);
Tool tool_again(const std::string& file, const ToolParams& params);

}  // namespace trephine
