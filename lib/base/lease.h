// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "base/file_descriptor.h"

namespace trephine {

/// A lock between processes of several hosts that share a folder over NFS, where flock may be missing, local to each
/// host, or kept for ever by a host that died. FOLDER/.lease/ holds exactly one entry, an empty file that is named
/// "free" or after its holder; taking, releasing and taking over are each one rename of that file, of which the file
/// server lets exactly one succeed. The holder renews the file's time; a lease that was not renewed for `lease_s` may
/// be taken over. Its age is the difference of two times that the file server gave, so that no host's clock counts. A
/// holder of this host and of the same process namespace that has ended counts as gone at once.
///
/// As with every lease, a holder that was stopped for longer than that (SIGSTOP, a host that slept) can lose it without
/// knowing: is_held() asks, and what is done under a lease must be harmless when it is done twice.
class Lease {
 public:
  static constexpr double default_lease_s = 120;

  /// Throws Error 75 where somebody else holds it, 73 where it cannot be made.
  explicit Lease(const std::filesystem::path& folder, double lease_s = default_lease_s);
  ~Lease();
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

  /// Whether it is still ours, also after its folder was renamed.
  bool is_held() const;

 private:
  enum class Attempt { taken, try_again, busy };
  Attempt make_new(const std::filesystem::path& folder);
  Attempt take(const std::string& from);
  bool may_be_taken_over(const std::string& holder) const;
  void renew_until_the_end();

  const double lease_s_;
  std::string name_;              // of the file while it is ours
  FileDescriptor folder_, file_;  // .lease, which may be renamed with the folder that holds it; and the file
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false;
  std::thread renewer_;
};

/// The name of the folder that a lease is made of.
constexpr const char* lease_folder = ".lease";

/// Whether other hosts can see the file's file system too: NFS, SMB, Lustre, BeeGFS, GPFS, Ceph, AFS, or FUSE, behind
/// which one may be. False where it cannot be told.
bool is_on_network(const std::filesystem::path& file);

}  // namespace trephine
