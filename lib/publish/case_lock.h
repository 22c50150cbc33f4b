// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>

#include "base/lease.h"

namespace trephine::publish {

/// Lets only one run at a time build a case: an flock on <case>/.lock, which ends with the process even if it is
/// killed. Where other hosts work on the library too, a lease as well (base/lease.h): in a library that a cluster
/// builds (share_library), and on a file system of the network, where the lease stands alone. Throws Error 75 where
/// another run holds it, 73 where it cannot be made. It is released with the object; the empty file stays.
class CaseLock {
 public:
  /// The folder of a case, or a library's folder .library.
  explicit CaseLock(const std::filesystem::path& case_folder);
  ~CaseLock();
  CaseLock(const CaseLock&) = delete;
  CaseLock& operator=(const CaseLock&) = delete;

  /// False where a lease was lost: the process stood still for longer than it lasts, and another may have it now.
  bool is_held() const { return !lease_ || lease_->is_held(); }

 private:
  void lock_file(const std::filesystem::path& case_folder);
  int fd_ = -1;
  std::unique_ptr<Lease> lease_;
};

/// From now on every lock in this library is a lease of that many seconds too. Throws Error 73 and 74.
void share_library(const std::filesystem::path& library, double lease_s);

/// The names in a case's folder that are locks.
bool is_lock(const std::string& name);

}  // namespace trephine::publish
