// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/scratch_file.h"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "base/error.h"
#include "base/write_file.h"

namespace trephine {
namespace {

// Linux moves at most 2 GiB less a page at once.
constexpr std::size_t piece_bytes = std::size_t{1} << 30;

FileDescriptor open_without_name(const std::filesystem::path& folder) {
  FileDescriptor fd(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (fd.valid() || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return fd;
  // A file system that knows no such files, as NFS: the name is taken away at once.
  std::string name = (folder / (temporary_prefix + std::to_string(::getpid()) + "-XXXXXX")).string();
  fd = FileDescriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (fd.valid()) ::unlink(name.c_str());
  return fd;
}

}  // namespace

ScratchFile::ScratchFile(const std::filesystem::path& folder) : folder_(folder), fd_(open_without_name(folder)) {
  ignore_file_size_signal();
  if (!fd_.valid())
    throw Error(ExitCode::cannot_create, folder.string(), "", std::string("no file can be made: ") + strerror(errno));
}

void ScratchFile::append(const void* data, std::size_t size) {
  for (const char* at = static_cast<const char*>(data); size > 0;) {
    const ssize_t n = ::write(fd_.get(), at, std::min(size, piece_bytes));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw Error(ExitCode::io, folder_.string(), "", std::string("cannot write: ") + strerror(n < 0 ? errno : ENOSPC));
    at += n;
    size -= static_cast<std::size_t>(n);
  }
}

void ScratchFile::read(std::uint64_t offset, void* data, std::size_t size) const {
  for (char* at = static_cast<char*>(data); size > 0;) {
    const ssize_t n = ::pread(fd_.get(), at, std::min(size, piece_bytes), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw Error(ExitCode::io, folder_.string(), "",
                  std::string("cannot read what was laid aside: ") + (n < 0 ? strerror(errno) : "the file ended"));
    at += n;
    offset += static_cast<std::uint64_t>(n);
    size -= static_cast<std::size_t>(n);
  }
}

}  // namespace trephine
