// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace trephine {

/// The one way in which the program writes an output: a temporary file in the target's folder, all bytes written,
/// fsync, close, rename over the target, fsync of the folder. The target is the old file or the new one, never a
/// mixture, also over NFS and after a crash. Every step is checked.
///
/// Throws Error 73 where the temporary file cannot be created (missing or read-only folder), 74 where writing, syncing
/// or renaming fails (disk full); the temporary file is removed and the old target is left as it was. Mode 0644 less
/// umask. (Only where the last fsync, of the folder, fails is the new file already in place: 74 then means "perhaps not
/// durable".) Without a commit() the destructor removes the temporary file. A target that is a symbolic link is written
/// through; a device or pipe (/dev/stdout) is written straight; SIGXFSZ is ignored from the first FileWriter on, so
/// that a limit on file sizes is a 74 like a full disk.
class FileWriter {
 public:
  explicit FileWriter(std::filesystem::path target);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(std::string_view bytes);
  void write(const void* data, std::size_t size) { write({static_cast<const char*>(data), size}); }
  /// In place of bytes that were written before, such as a header that holds a count. False, and nothing is written,
  /// where the target is a device or pipe.
  bool overwrite(std::uint64_t offset, std::string_view bytes);
  void commit();
  std::uint64_t bytes_written() const { return bytes_; }

 private:
  [[noreturn]] void fail(const char* step);
  std::filesystem::path target_, temporary_;  ///< temporary_ is empty for a device and once it is renamed
  int fd_ = -1, folder_fd_ = -1;
  std::uint64_t bytes_ = 0;
};

/// FileWriter for bytes that are all there.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// The whole file, at most max_bytes. Throws 66 where it is missing or unreadable or a folder, 65 above the limit, 74
/// where reading fails or the file shrinks meanwhile.
std::vector<char> read_file(const std::filesystem::path& file, std::uint64_t max_bytes = std::uint64_t{1} << 34);

/// Creates the folder and its parents. Throws 73 where it cannot, or where it is not writable.
void make_output_folder(const std::filesystem::path& folder);

/// The temporary names that FileWriter uses in a folder begin with this; what a killed process left behind is found by
/// it.
constexpr const char* temporary_prefix = ".trephine-tmp-";

/// Removes temporary files in the folder whose process no longer runs on this host and that nobody, on another host or
/// in another container, holds locked (a FileWriter locks its file). Returns how many.
int remove_stale_temporaries(const std::filesystem::path& folder);

/// The system calls of FileWriter, so that a test can make any of them fail. The same signatures and errno as in libc.
struct FileCalls {
  int (*open)(const char* path, int flags, unsigned mode);
  long (*write)(int fd, const void* data, std::size_t size);
  int (*fsync)(int fd);
  int (*close)(int fd);
  int (*rename)(const char* from, const char* to);
};
FileCalls& file_calls();

}  // namespace trephine
