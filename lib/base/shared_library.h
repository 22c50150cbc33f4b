// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace trephine {

/// A shared library that a user names, and whose C functions we call. It stays loaded to the end of the process, for
/// such libraries keep threads of their own.
class SharedLibrary {
 public:
  /// `prefix` is what the names of all its functions begin with, as in "trephine_peer_". Throws Error 65 where the file
  /// cannot be loaded.
  SharedLibrary(const std::filesystem::path& file, std::string prefix);

  /// Sets `function` to the library's function of that name, given without the prefix. Throws Error 65 naming it where
  /// it is missing.
  template <class F>
  void find(const std::string& name, F& function) const {
    function = reinterpret_cast<F>(address_of(name));
  }
  /// Calls the library's function `version`. Throws Error 65 where it gives another number than `used`.
  void require_version(int used) const;

  const std::string& file() const { return file_; }
  const std::string& prefix() const { return prefix_; }

 private:
  void* address_of(const std::string& name) const;

  std::string file_, prefix_;
  void* handle_ = nullptr;
};

/// What version() of a library of ours gives; raised where a function of one changes.
constexpr int own_library_version = 2;

/// A library of this program's own, which is loaded when it is first needed, for what it links takes long to load
/// (cmake/modules.cmake, trephine_library_on_demand). It lies in ../lib/trephine from the program's folder, or in that
/// folder. Throws Error 70 where it is not there, cannot be loaded, or is of another version of the program, or where
/// somebody else could have put it there (own_files.h).
SharedLibrary own_library(const std::string& name, const std::string& prefix);

}  // namespace trephine
