// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace trephine::publish {

CaseLock::CaseLock(const std::filesystem::path& case_folder) {
  const std::string file = (case_folder / ".lock").string();
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
  if (fd_ >= 0) close(fd_);
}

}  // namespace trephine::publish
