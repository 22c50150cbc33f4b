// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

/// The bytes as a file of this process's own, overwritten by the next ones and removed at its end.
inline const std::filesystem::path& as_file(const std::uint8_t* data, std::size_t size) {
  static struct File {
    std::string name = (std::filesystem::temp_directory_path() / "trephine-fuzz-XXXXXX").string();
    int fd = mkstemp(name.data());
    std::filesystem::path path = name;
    ~File() { unlink(name.c_str()); }
  } file;
  if (file.fd < 0 || ftruncate(file.fd, 0) != 0 || pwrite(file.fd, data, size, 0) != static_cast<ssize_t>(size))
    std::abort();
  return file.path;
}
