// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

namespace trephine {

/// Owns a file descriptor; -1 means none. For the sources of base only.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor() { reset(); }
  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  void reset() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

 private:
  int fd_ = -1;
};

/// A regular file opened for reading, with its size. Throws as read_file does.
struct InputFile {
  FileDescriptor fd;
  std::uint64_t size = 0;
};
InputFile open_input(const std::filesystem::path& file, std::uint64_t max_bytes);
/// All of it. Throws as read_file does.
std::vector<char> read_input(const InputFile& input, const std::filesystem::path& file);

/// Reads at most `size` bytes and returns their count, 0 at the end of the file. Throws Error 74 where reading fails.
std::size_t read_some(int fd, void* data, std::size_t size, const std::filesystem::path& file);

/// From now on a write beyond a limit on file sizes fails, as on a full disk, instead of ending the process.
void ignore_file_size_signal();

}  // namespace trephine
