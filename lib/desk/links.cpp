// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/links.h"

#include "base/error.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

void require_no_link(const fs::path& path, const std::string& name) {
  std::error_code ignored;
  if (!fs::is_symlink(fs::symlink_status(path, ignored))) return;
  throw Error(ExitCode::bad_input, name, "",
              "is a symbolic link, and the desk follows none, for it would read and write where the link leads: put "
              "what is meant there itself, or open the library in which it lies");
}

}  // namespace

void require_no_links(const fs::path& place) {
  const std::string name = place.filename().string();
  require_no_link(place, name);
  std::error_code error;
  for (fs::recursive_directory_iterator it(place, error), end; !error && it != end; it.increment(error))
    require_no_link(it->path(), name + "/" + it->path().lexically_relative(place).generic_string());
}

void require_no_links(const DeskOptions& options, const std::string& token) {
  const fs::path own = options.library / ".library";
  for (const char* below : {"", "cases", "settings", "phantoms", "logs", "desk.lock", "desk-build.log"})
    require_no_link(below[0] ? own / below : own, below[0] ? std::string(".library/") + below : ".library");
  require_no_links(own / "desk");
  if (token.empty()) return;
  require_no_links(options.library / token);
  require_no_link(own / "logs" / ("case." + token + ".log"), token + ".log");
  for (const char* what : {"inputs", "built", "result"})
    require_no_link(own / "cases" / (token + "." + what + ".json"), token + "." + what + ".json");
}

}  // namespace trephine::desk
