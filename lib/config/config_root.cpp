// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/config_root.h"

#include <algorithm>

namespace trephine {
namespace fs = std::filesystem;
namespace {

constexpr const char* root_marker = "trephine.root";

}  // namespace

fs::path absolute_path(const fs::path& p) { return fs::weakly_canonical(fs::absolute(p)); }

fs::path root_of(const fs::path& config) {
  const fs::path own = absolute_path(config).parent_path();
  for (fs::path folder = own;; folder = folder.parent_path()) {
    std::error_code ignored;
    if (fs::exists(folder / root_marker, ignored)) return folder;
    if (folder == folder.parent_path()) return own;
  }
}

bool lies_in(const fs::path& path, const fs::path& root) {
  const auto [r, p] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  return r == root.end() || (r->empty() && std::next(r) == root.end());
}

}  // namespace trephine
