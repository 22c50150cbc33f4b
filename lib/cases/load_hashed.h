// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "cases/load_case.h"

namespace trephine::cases {

/// A case, and the SHA-256 of the very case.json that was parsed: what is said of the case by that hash is said of
/// what was checked, whatever lies in the folder a moment later.
struct HashedCase {
  LoadedCase loaded;
  std::string sha256;
};
/// Throws what load_case throws.
HashedCase load_hashed_case(const std::filesystem::path& case_folder, LoadParts parts = {});

}  // namespace trephine::cases
