// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/temporary_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "base/error.h"

namespace trephine {
namespace {
namespace fs = std::filesystem;

constexpr const char* prefix = "trephine-held-";  // that of older programs, which did not lock theirs, was trephine-

// Of this user, and no link.
FileDescriptor open_own(const fs::path& folder) {
  FileDescriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat s {};
  if (fd.valid() && (::fstat(fd.get(), &s) != 0 || s.st_uid != ::geteuid())) fd.reset();
  return fd;
}

// Whether that is still what the name leads to: another process may have removed it before it was locked.
bool is_at(const FileDescriptor& fd, const fs::path& folder) {
  struct stat open {
  }, named{};
  return ::fstat(fd.get(), &open) == 0 && ::lstat(folder.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

void remove_left(const fs::path& in) {
  std::error_code ignored;
  for (fs::directory_iterator it(in, fs::directory_options::skip_permission_denied, ignored), end; it != end;
       it.increment(ignored)) {
    if (ignored) return;
    if (it->path().filename().string().rfind(prefix, 0) != 0) continue;
    const FileDescriptor fd = open_own(it->path());
    if (!fd.valid() || ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0 || !is_at(fd, it->path())) continue;
    std::error_code kept;
    fs::remove_all(it->path(), kept);
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code none;
  const fs::path in = fs::temp_directory_path(none);
  if (none) throw Error(ExitCode::cannot_create, "", "TMPDIR", "no temporary folder: " + none.message());
  remove_left(in);
  const std::string pattern = (in / (std::string(prefix) + "XXXXXX")).string();
  for (;;) {
    std::string name = pattern;
    if (!mkdtemp(name.data()))
      throw Error(ExitCode::cannot_create, name, "", std::string("no temporary folder: ") + std::strerror(errno));
    lock_ = open_own(name);
    if (lock_.valid()) (void)::flock(lock_.get(), LOCK_EX);
    if (!lock_.valid() || is_at(lock_, name)) {
      path_ = name;
      return;
    }
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void TemporaryFolder::fill(std::uint64_t bytes, const std::function<void()>& write) const {
  try {
    write();
  } catch (const Error& e) {
    // What failed may have removed what it had written, so it is asked how much there was room for.
    std::error_code unknown;
    const fs::space_info room = fs::space(path_, unknown);
    if (e.code() != ExitCode::io || unknown || room.available >= bytes) throw;
    throw Error(
        ExitCode::io, path_.parent_path().string(), "TMPDIR",
        fmt::format("the folder for temporary files has {:.1f} MB left, and up to {:.1f} are written there: make "
                    "room, or set TMPDIR to a folder that has it",
                    1e-6 * double(room.available), 1e-6 * double(bytes)));
  }
}

}  // namespace trephine
