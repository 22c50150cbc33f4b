// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "config/said.h"
#include "config/yaml_document.h"
#include "lesson/rubric.h"

namespace trephine::tools {

/// A rubric as it stands in a file: the version of the format, and what its module declares.
struct RubricFile {
  config::VersionParams version;
  AnyParams rubric;
};
/// The file of that module with the defaults; its object is a RubricFile.
AnyParams rubric_file_params(const lesson::RubricType& type);

/// Reads the file by the declaration of the module that it names. Throws as read_yaml and ConfigFaults::raise do.
AnyParams read_rubric_yaml(const std::filesystem::path& file);

}  // namespace trephine::tools
