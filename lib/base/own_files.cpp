// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/own_files.h"

#include <sys/stat.h>

#include "base/error.h"
#include "base/spawn.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

// Who may write to the program's own file gains nothing by a library of his.
bool is_trusted(const fs::path& path, const struct stat& program, bool follow) {
  struct stat s {};
  if ((follow ? ::stat(path.c_str(), &s) : ::lstat(path.c_str(), &s)) != 0) return false;
  if (s.st_uid != 0 && s.st_uid != program.st_uid) return false;
  if (S_ISLNK(s.st_mode)) return true;  // its mode says nothing
  const bool same_group = s.st_gid == program.st_gid && (program.st_mode & S_IWGRP) != 0;
  return (s.st_mode & S_IWOTH) == 0 && ((s.st_mode & S_IWGRP) == 0 || same_group);
}

void require_trusted(const fs::path& file) {
  struct stat program {};
  if (::stat("/proc/self/exe", &program) != 0)
    throw Error(ExitCode::internal, "/proc/self/exe", "", "cannot be read: is /proc mounted?");
  const fs::path real = fs::canonical(file);
  for (const fs::path& named : {file, real})
    for (const fs::path& path : {named, named.parent_path()})
      if (!is_trusted(path, program, false) || !is_trusted(path, program, true))
        throw Error(ExitCode::internal, file.string(), "owner",
                    "it would run with your rights, but '" + path.string() +
                        "' belongs to somebody other than root and the program's owner, or others may write to it: "
                        "take the program as it was installed, or let its owner own the file and the folder '" +
                        named.parent_path().string() + "' and run chmod go-w on both");
}

}  // namespace

fs::path own_file(const std::vector<fs::path>& places) {
  const fs::path folder = own_program().parent_path();
  for (const fs::path& place : places) {
    const fs::path file = (folder / place).lexically_normal();
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    require_trusted(file);
    return file;
  }
  return {};
}

}  // namespace trephine
