// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/shared_library.h"

#include <dlfcn.h>

#include <utility>

#include "base/error.h"
#include "base/own_files.h"
#include "base/text.h"

namespace trephine {

SharedLibrary::SharedLibrary(const std::filesystem::path& file, std::string prefix)
    : file_(file.string()),
      prefix_(std::move(prefix)),
      handle_(dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_)
    throw Error(ExitCode::bad_input, file_, "", "is no library that can be loaded: " + printable(dlerror()));
}

void* SharedLibrary::address_of(const std::string& name) const {
  void* found = dlsym(handle_, (prefix_ + name).c_str());
  if (!found) throw Error(ExitCode::bad_input, file_, prefix_ + name, "is missing");
  return found;
}

void SharedLibrary::require_version(int used) const {
  int (*version)() = nullptr;
  find("version", version);
  if (const int given = version(); given != used)
    throw Error(ExitCode::bad_input, file_, "version",
                std::to_string(given) + ", this program uses " + std::to_string(used));
}

SharedLibrary own_library(const std::string& name, const std::string& prefix) {
  const std::filesystem::path file = own_file({"../lib/trephine/" + name + ".so", name + ".so"});
  if (file.empty())
    throw Error(ExitCode::internal, name + ".so", "",
                "is missing: it must lie in ../lib/trephine from the folder of the programs, or in that folder");
  try {
    // What it links is bound function by function when it is called, as it was when the program itself linked it; the
    // constructor below, which finds it loaded, would bind all of VTK's at once.
    dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    SharedLibrary library(file, prefix);
    library.require_version(own_library_version);
    return library;
  } catch (Error& e) {
    throw Error(ExitCode::internal, name + ".so", e.field(), e.what());
  }
}

}  // namespace trephine
