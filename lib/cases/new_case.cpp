// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/new_case.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"

namespace trephine::cases {
namespace fs = std::filesystem;
namespace {

constexpr const char* ending = ".new";

// "library/head/" is a folder named "head".
fs::path plain(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

bool is_free_for_case(const fs::path& case_folder) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(case_folder, error).type();
  if (type == fs::file_type::not_found) return true;
  return type == fs::file_type::directory && fs::is_empty(case_folder, error) && !error;
}

fs::path new_case_folder(const fs::path& case_folder) {
  const fs::path whole = plain(case_folder);
  return whole.parent_path() / ("." + whole.filename().string() + ending);
}

bool is_new_case_folder(const std::string& name) {
  const std::string end = ending;
  return name.size() > 1 + end.size() && name[0] == '.' && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

void let_case_appear(const fs::path& made_in, const fs::path& case_folder) {
  const fs::path to = plain(case_folder);
  if (::rename(made_in.c_str(), to.c_str()) != 0)
    throw Error(ExitCode::io, case_folder.string(), "",
                std::string("the case cannot take its place: ") + std::strerror(errno));
  const int library = ::open(to.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = library >= 0 && ::fsync(library) == 0;
  const int reason = errno;
  if (library >= 0) ::close(library);
  if (!synced && reason != EINVAL)  // a file system that cannot sync folders
    throw Error(ExitCode::io, case_folder.string(), "", std::string("perhaps not durable: ") + std::strerror(reason));
}

}  // namespace trephine::cases
