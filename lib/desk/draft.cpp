// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/draft.h"

#include <unistd.h>

#include <atomic>

#include "base/write_file.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

/// No other draft has it: not of this desk, nor of another one on the same library.
fs::path own_name(const fs::path& target) {
  static std::atomic<int> count{0};
  return target.parent_path() / (temporary_prefix + std::to_string(::getpid()) + "-desk-" + std::to_string(++count) +
                                 "-" + target.filename().string());
}

}  // namespace

Draft::Draft(const fs::path& target, const std::string& text) : file_(own_name(target)), name_(target) {
  remove_stale_temporaries(target.parent_path());  // of a desk that was killed
  write_file(file_, text);
}

Draft::~Draft() {
  std::error_code ignored;
  fs::remove(file_, ignored);
}

Error Draft::renamed(const Error& e) const {
  std::string file = e.file();
  if (const std::size_t at = file.find(file_.string()); at != std::string::npos)
    file.replace(at, file_.string().size(), name_.filename().string());
  return Error(e).refiled(file);
}

}  // namespace trephine::desk
