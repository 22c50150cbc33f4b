// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace trephine::publish {

/// Lets only one run at a time build a case: an flock on <case>/.lock, which ends with the process even if it is
/// killed. Throws Error 75 where another run holds it, 73 where it cannot be made. It is released with the object; the
/// empty file stays.
class CaseLock {
 public:
  explicit CaseLock(const std::filesystem::path& case_folder);
  ~CaseLock();
  CaseLock(const CaseLock&) = delete;
  CaseLock& operator=(const CaseLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace trephine::publish
