// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/config_root.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/text.h"

namespace trephine::config {
namespace fs = std::filesystem;
namespace {

constexpr const char* root_marker = "trephine.root";

constexpr int max_links = 40;  // as the kernel

// Part by part, as the kernel follows a path. The parts of a path that does not exist yet are only names; a ".." after
// one of them would leave it to whoever makes the folder, or a link of its name, where the path leads.
fs::path follow(const fs::path& p, std::string& fault) {
  std::vector<fs::path> rest;  // the next part last
  const auto push = [&](const fs::path& parts) {
    const std::vector<fs::path> list(parts.begin(), parts.end());
    rest.insert(rest.end(), list.rbegin(), list.rend());
  };
  fs::path done = "/";
  int links = 0;
  bool exists = true;
  push(fs::absolute(p));
  while (!rest.empty()) {
    const fs::path part = rest.back();
    rest.pop_back();
    if (part.empty() || part == "." || part == "/") continue;
    if (part == "..") {
      if (!exists)
        return fault = "goes up again from " + done.filename().string() + ", which does not exist", fs::path();
      done = done.parent_path();
      continue;
    }
    const fs::path next = done / part;
    struct stat s {};
    if (exists && ::lstat(next.c_str(), &s) != 0) {
      if (errno != ENOENT && errno != ENOTDIR) return fault = std::strerror(errno), fs::path();
      exists = false;
    }
    if (exists && S_ISLNK(s.st_mode)) {
      if (++links > max_links) return fault = "leads through symbolic links in a circle", fs::path();
      std::error_code error;
      const fs::path target = fs::read_symlink(next, error);
      if (error) return fault = error.message(), fs::path();
      if (target.is_absolute()) done = "/";
      push(target);
      continue;
    }
    done = next;
  }
  if (done.string().size() >= 4096) return fault = std::strerror(ENAMETOOLONG), fs::path();
  return done;
}

// What a path is followed to, unless it cannot be named to the system at all.
fs::path follow_text(const fs::path& p, std::string& fault) {
  if (p.native().find('\0') != std::string::npos) return fault = "holds a NUL", fs::path();
  try {
    return follow(p, fault);
  } catch (const fs::filesystem_error& e) {
    fault = e.code().message();
    return {};
  }
}

}  // namespace

fs::path absolute_path(const fs::path& p) {
  std::string fault;
  fs::path out = follow_text(p, fault);
  if (!fault.empty()) throw Error(ExitCode::no_input, printable(p.string()), "", fault);
  return out;
}

fs::path root_of(const fs::path& config) {
  const fs::path own = absolute_path(config).parent_path();
  for (fs::path folder = own;; folder = folder.parent_path()) {
    std::error_code ignored;
    if (fs::exists(folder / root_marker, ignored)) return folder;
    if (folder == folder.parent_path()) return own;
  }
}

bool lies_in(const fs::path& path, const fs::path& root) {
  const auto [r, p] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  return r == root.end() || (r->empty() && std::next(r) == root.end());
}

fs::path path_in_roots(const fs::path& folder, const std::string& text, const std::vector<fs::path>& roots,
                       std::string& fault) {
  std::string why;
  const fs::path path = follow_text(folder / text, why);
  if (why.empty()) {
    if (std::any_of(roots.begin(), roots.end(), [&](const fs::path& root) { return lies_in(path, root); })) return path;
    why = "leads out of the root " + roots[0].string() +
          "; an empty file trephine.root in a folder above makes that the root, and --root adds one";
  }
  fault = printable(text) + ", " + why;
  return {};
}

}  // namespace trephine::config
