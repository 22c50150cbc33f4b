// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/open_beneath.h"

#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/file_descriptor.h"

namespace trephine {
namespace {

constexpr int read_only = O_RDONLY | O_CLOEXEC | O_NONBLOCK;

// Every part in turn, and none of them a link.
int open_by_parts(FileDescriptor folder, const std::filesystem::path& relative) {
  for (auto part = relative.begin(); part != relative.end(); ++part) {
    if (*part == "..") {
      errno = EXDEV;
      return -1;
    }
    if (part->empty() || *part == ".") continue;
    const bool last = std::next(part) == relative.end();
    const int fd =
        ::openat(folder.get(), part->c_str(), (last ? read_only : O_PATH | O_DIRECTORY | O_CLOEXEC) | O_NOFOLLOW);
    if (fd < 0) {
      if (errno == ELOOP) errno = EXDEV;
      return -1;
    }
    if (last) return fd;
    folder = FileDescriptor(fd);
  }
  errno = EISDIR;
  return -1;
}

}  // namespace

int open_beneath(const std::filesystem::path& folder, const std::filesystem::path& relative) {
  FileDescriptor root(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!root.valid()) return -1;
  open_how how{};
  how.flags = read_only;
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
  for (int tries = 0;; ++tries) {
    const long fd = ::syscall(SYS_openat2, root.get(), relative.c_str(), &how, sizeof how);
    if (fd >= 0) return static_cast<int>(fd);
    if (errno == EAGAIN && tries < 100) continue;  // something was renamed meanwhile
    if (errno != ENOSYS && errno != EPERM) return -1;
    return open_by_parts(std::move(root), relative);
  }
}

}  // namespace trephine
