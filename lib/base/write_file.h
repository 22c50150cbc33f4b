// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace trephine {

/// The one way in which the program writes an output: a temporary file in the target's folder, all bytes written,
/// fsync, close, rename over the target, fsync of the folder. The target is always the old file or the new one, never a
/// mixture, also over NFS and after a crash. Every step is checked.
///
/// Throws Error 73 where the temporary file cannot be created (missing or read-only folder), 74 where writing, syncing
/// or renaming fails (disk full). In both cases the temporary file is removed and the old target is left as it was.
/// (Only where the last step, the fsync of the folder, fails is the new file already in place: 74 then means "perhaps
/// not durable".) The file's mode is 0644 less umask. Without a commit() the destructor removes the temporary file.
///
/// A target that is a symbolic link is written through where the link is of root or of who runs the program; a link of
/// anybody else is replaced, for it would let him choose what is overwritten. A device or pipe (/dev/stdout) is written
/// directly. With Links::replaced whatever has the target's name is replaced: for a name that nobody typed, in a folder
/// that others may write to. SIGXFSZ is ignored from the first FileWriter on, so that a limit on file sizes gives Error
/// 74 as a full disk does.
enum class Links { followed, replaced };
class FileWriter {
 public:
  explicit FileWriter(std::filesystem::path target);
  FileWriter(std::filesystem::path target, Links links);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(std::string_view bytes);
  void write(const void* data, std::size_t size) { write({static_cast<const char*>(data), size}); }
  /// Replaces bytes that were written before, such as a header that holds a count. Returns false and writes nothing
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

/// Writes a file whose bytes are all there.
void write_file(const std::filesystem::path& target, std::string_view bytes);
void write_file(const std::filesystem::path& target, std::string_view bytes, Links links);

/// Reads the whole file, at most max_bytes. Throws Error 66 where it is missing, unreadable or a folder, 65 where it is
/// larger than the limit, 74 where reading fails or the file shrinks meanwhile.
std::vector<char> read_file(const std::filesystem::path& file, std::uint64_t max_bytes = std::uint64_t{1} << 34);

/// Creates the folder and its parents. Throws Error 73 where that fails or where the folder is not writable.
void make_output_folder(const std::filesystem::path& folder);
/// The same, of a folder that holds what is of patients: nobody but who made it may read, list or enter it. One that is
/// there keeps its mode. Throws Error 73 also where it is a symbolic link, which would lead elsewhere.
void make_private_folder(const std::filesystem::path& folder);

/// The names of FileWriter's temporary files begin with this, so that files left by a killed process can be found.
constexpr const char* temporary_prefix = ".trephine-tmp-";

/// Removes the temporary files in the folder whose process no longer runs on this host, unless a process on another
/// host or in another container holds them locked (a FileWriter locks its file). Returns how many were removed.
int remove_stale_temporaries(const std::filesystem::path& folder);

/// The system calls of FileWriter, with the signatures and errno of libc, so that a test can make any of them fail.
struct FileCalls {
  int (*open)(const char* path, int flags, unsigned mode);
  long (*write)(int fd, const void* data, std::size_t size);
  int (*fsync)(int fd);
  int (*close)(int fd);
  int (*rename)(const char* from, const char* to);
};
FileCalls& file_calls();

}  // namespace trephine
