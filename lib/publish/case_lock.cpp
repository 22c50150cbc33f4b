// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::publish {
namespace fs = std::filesystem;
namespace {

constexpr const char *lock_name = ".lock", *state_folder = ".library", *shared_name = "shared";

// The seconds of the leases in the library; 0 where it is not said to be shared.
double lease_of_library(const fs::path& case_folder) {
  const fs::path whole = fs::absolute(case_folder).lexically_normal();
  const fs::path plain = whole.has_filename() ? whole : whole.parent_path();
  const fs::path state = plain.filename() == state_folder ? plain : plain.parent_path() / state_folder;
  std::ifstream file(state / shared_name);
  double seconds = 0;
  return file >> seconds && seconds > 0 ? seconds : 0;
}

}  // namespace

bool is_lock(const std::string& name) { return name == lock_name || name.rfind(lease_folder, 0) == 0; }

void share_library(const fs::path& library, double lease_s) {
  const std::string text = to_text(lease_s) + "\n";
  const fs::path file = library / state_folder / shared_name;
  std::error_code ignored;
  if (fs::exists(file, ignored)) {
    const std::vector<char> before = read_file(file, 1 << 10);
    if (std::string(before.begin(), before.end()) == text) return;
  }
  write_file(file, text);
}

CaseLock::CaseLock(const fs::path& case_folder) {
  const double said_s = lease_of_library(case_folder);
  const bool network = is_on_network(case_folder);
  if (!network) lock_file(case_folder);
  if (!network && said_s <= 0) return;
  try {
    lease_ = std::make_unique<Lease>(case_folder, said_s > 0 ? said_s : Lease::default_lease_s);
  } catch (const Error& e) {
    if (fd_ >= 0) close(fd_);
    if (e.code() != ExitCode::busy) throw;
    throw Error(ExitCode::busy, case_folder.string(), "", "another run builds this case, try again when it is done");
  } catch (...) {
    if (fd_ >= 0) close(fd_);
    throw;
  }
}

void CaseLock::lock_file(const fs::path& case_folder) {
  const std::string file = (case_folder / lock_name).string();
  fd_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) throw Error(ExitCode::cannot_create, file, "", std::strerror(errno));
  if (flock(fd_, LOCK_EX | LOCK_NB) == 0) {
    // A run that failed removes its folder with the lock file, and a lock on a removed file keeps nobody out.
    struct stat held, there;
    if (fstat(fd_, &held) == 0 && stat(file.c_str(), &there) == 0 && held.st_ino == there.st_ino) return;
    close(fd_);
    throw Error(ExitCode::busy, case_folder.string(), "", "another run has just left this case, try again");
  }
  const int reason = errno;
  close(fd_);
  if (reason == EWOULDBLOCK)
    throw Error(ExitCode::busy, case_folder.string(), "", "another run builds this case, try again when it is done");
  throw Error(ExitCode::cannot_create, file, "", std::strerror(reason));
}

CaseLock::~CaseLock() {
  lease_.reset();
  if (fd_ >= 0) close(fd_);
}

}  // namespace trephine::publish
