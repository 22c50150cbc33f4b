// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/own_files.h"

#include <sys/stat.h>

#include <deque>

#include "base/error.h"
#include "base/spawn.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

// Who may write to the program's own file gains nothing by a library of his.
bool is_trusted(const fs::path& path, const struct stat& program) {
  struct stat s {};
  if (::lstat(path.c_str(), &s) != 0) return false;
  if (s.st_uid != 0 && s.st_uid != program.st_uid) return false;
  if (S_ISLNK(s.st_mode)) return true;  // its mode says nothing
  const bool same_group = s.st_gid == program.st_gid && (program.st_mode & S_IWGRP) != 0;
  return (s.st_mode & S_IWOTH) == 0 && ((s.st_mode & S_IWGRP) == 0 || same_group);
}

// Every link on the way to the file, and at last the file, each in a folder without links.
std::vector<fs::path> ways_to(const fs::path& file) {
  constexpr std::size_t most_links = 40;  // as the kernel's
  std::vector<fs::path> ways;
  fs::path at;
  for (std::deque<fs::path> rest(file.begin(), file.end()); !rest.empty() && ways.size() < most_links;) {
    const fs::path next = rest.front();
    rest.pop_front();
    at = next == ".." ? at.parent_path() : next.empty() || next == "." ? at : at / next;
    if (!fs::is_symlink(at)) continue;
    ways.push_back(at);
    const fs::path to = fs::read_symlink(at);
    rest.insert(rest.begin(), to.begin(), to.end());
    at = at.parent_path();
  }
  ways.push_back(at);
  return ways;
}

void require_trusted(const fs::path& file) {
  struct stat program {};
  if (::stat("/proc/self/exe", &program) != 0)
    throw Error(ExitCode::internal, "/proc/self/exe", "", "cannot be read: is /proc mounted?");
  for (const fs::path& named : ways_to(file))
    for (const fs::path& path : {named, named.parent_path()})
      if (!is_trusted(path, program))
        throw Error(ExitCode::internal, file.string(), "owner",
                    file.filename().string() + " would run with your rights, but '" + path.string() +
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
