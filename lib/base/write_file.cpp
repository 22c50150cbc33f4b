// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/write_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/lease.h"
#include "base/text.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

std::atomic<unsigned> g_counter{0};

std::string reason(int number) {
  char buffer[128];
  return strerror_r(
      number, buffer,
      sizeof buffer);  // GNU's strerror_r may return a text of its own, in English as long as no locale is set
}

// A link of root, as /dev/stdout, is followed.
bool is_link_of_another(const fs::path& file) {
  struct stat s {};
  return ::lstat(file.c_str(), &s) == 0 && S_ISLNK(s.st_mode) && s.st_uid != 0 && s.st_uid != ::geteuid();
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

// A process that has ended does not count as running, even before its parent waits for it.
bool is_running(pid_t pid) {
  if (::kill(pid, 0) != 0 && errno == ESRCH) return false;
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  if (!std::getline(stat, line)) return true;
  const std::size_t name_end = line.rfind(')');  // end of the program's name, which may hold any character
  return name_end == std::string::npos || name_end + 2 >= line.size() ||
         (line[name_end + 2] != 'Z' && line[name_end + 2] != 'X');
}

constexpr double day_s = 86400;  // hosts' clocks may differ by minutes

double age_s(const fs::path& file) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  return error ? 0 : std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

bool is_stale(const fs::path& file) {
  const std::string name = file.filename();
  const std::string rest = name.substr(std::strlen(temporary_prefix));
  const auto pid = parse_integer(rest.substr(0, rest.find('-')));
  if (!pid || *pid <= 0) return false;
  if (is_running(static_cast<pid_t>(*pid))) return false;
  // A process of another host may have it open, and locks may not reach from host to host.
  if (is_on_network(file) && age_s(file) < day_s) return false;
  const FileDescriptor fd(::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!fd.valid()) return false;
  return ::flock(fd.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

}  // namespace

void ignore_file_size_signal() {
  static const bool done = [] {
    struct sigaction old {};
    if (sigaction(SIGXFSZ, nullptr, &old) == 0 && old.sa_handler == SIG_DFL) std::signal(SIGXFSZ, SIG_IGN);
    return true;
  }();
  (void)done;
}

FileCalls& file_calls() {
  static FileCalls calls{[](const char* path, int flags, unsigned mode) { return ::open(path, flags, mode); },
                         [](int fd, const void* data, std::size_t size) -> long { return ::write(fd, data, size); },
                         [](int fd) { return ::fsync(fd); }, [](int fd) { return ::close(fd); },
                         [](const char* from, const char* to) { return ::rename(from, to); }};
  return calls;
}

FileWriter::FileWriter(fs::path target) : FileWriter(std::move(target), Links::followed) {}

FileWriter::FileWriter(fs::path target, Links links) : target_(std::move(target)) {
  ignore_file_size_signal();
  const auto cannot = [&](const std::string& why) -> Error {
    if (folder_fd_ >= 0) ::close(folder_fd_);
    return Error(ExitCode::cannot_create, target_.string(), "", "cannot be created: " + why);
  };
  if (!target_.has_filename()) throw cannot("it names no file");
  std::error_code ignored;
  fs::path real = target_;
  const bool follows = links == Links::followed && !is_link_of_another(target_);
  if (follows && fs::is_symlink(target_, ignored) && fs::exists(target_, ignored))
    real = fs::canonical(target_, ignored);
  const fs::file_status status = follows ? fs::status(target_, ignored) : fs::symlink_status(target_, ignored);
  if (fs::is_directory(status)) throw cannot("it is a folder");
  if (follows && (fs::is_character_file(status) || fs::is_fifo(status))) {
    fd_ = file_calls().open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY, 0);
    if (fd_ < 0) throw cannot(reason(errno));
    return;
  }
  if (follows && fs::exists(status) && !fs::is_regular_file(status)) throw cannot("it is not a file");

  const fs::path folder = folder_of(real);
  folder_fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_fd_ < 0) throw cannot("its folder: " + reason(errno));
  const std::string ending = real.filename().string().substr(0, 60);
  for (int attempt = 0; fd_ < 0; ++attempt) {
    temporary_ =
        folder / (temporary_prefix + std::to_string(::getpid()) + "-" + std::to_string(g_counter++) + "-" + ending);
    fd_ = file_calls().open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (fd_ >= 0 || errno == EINTR) continue;
    // A process of the same number may have left its file here, so the next counter is tried.
    if (errno == EEXIST && attempt < 1000) continue;
    const int number = errno;
    temporary_.clear();
    throw cannot(reason(number));
  }
  ::flock(fd_, LOCK_EX | LOCK_NB);  // the lock tells remove_stale_temporaries that the file is in use; a file system
                                    // without locks is no fault
  target_ = real;
}

FileWriter::~FileWriter() {
  if (fd_ >= 0) file_calls().close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  if (folder_fd_ >= 0) ::close(folder_fd_);
}

void FileWriter::fail(const char* step) {
  const int number = errno;
  if (fd_ >= 0) file_calls().close(std::exchange(fd_, -1));
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
  throw Error(ExitCode::io, target_.string(), "", std::string(step) + " failed: " + reason(number));
}

void FileWriter::write(std::string_view bytes) {
  if (fd_ < 0) throw Error(ExitCode::internal, target_.string(), "", "written to after its end");
  while (!bytes.empty()) {
    // Linux moves at most 2^31 - 4096 bytes a call; smaller steps also let a limit or a full disk show early.
    const long n = file_calls().write(fd_, bytes.data(), std::min<std::size_t>(bytes.size(), std::size_t{1} << 26));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) fail("writing");
    bytes.remove_prefix(static_cast<std::size_t>(n));
    bytes_ += static_cast<std::uint64_t>(n);
  }
}

bool FileWriter::overwrite(std::uint64_t offset, std::string_view bytes) {
  if (fd_ < 0 || offset > bytes_ || bytes.size() > bytes_ - offset)
    throw Error(ExitCode::internal, target_.string(), "", "overwritten where nothing was written");
  if (temporary_.empty()) return false;
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) fail("writing");
    bytes.remove_prefix(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return true;
}

void FileWriter::commit() {
  if (fd_ < 0) throw Error(ExitCode::internal, target_.string(), "", "committed after its end");
  const bool device = temporary_.empty();
  const auto sync = [](int fd) {
    int result;
    do result = file_calls().fsync(fd);
    while (result != 0 && errno == EINTR);
    return result;
  };
  // EINVAL and EROFS: an object that cannot be synced (a pipe, a folder on some file systems) holds nothing to sync.
  if (sync(fd_) != 0 && !(device && (errno == EINVAL || errno == EROFS))) fail("fsync");
  // On EINTR Linux has closed the file nevertheless.
  if (file_calls().close(std::exchange(fd_, -1)) != 0 && errno != EINTR) fail("closing");
  if (device) return;
  if (file_calls().rename(temporary_.c_str(), target_.c_str()) != 0) fail("renaming");
  temporary_.clear();
  if (sync(folder_fd_) != 0 && errno != EINVAL) fail("fsync of the folder");
}

void write_file(const fs::path& target, std::string_view bytes) { write_file(target, bytes, Links::followed); }

void write_file(const fs::path& target, std::string_view bytes, Links links) {
  FileWriter writer(target, links);
  writer.write(bytes);
  writer.commit();
}

InputFile open_input(const fs::path& file, std::uint64_t max_bytes) {
  InputFile input;
  do input.fd = FileDescriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  while (!input.fd.valid() && errno == EINTR);
  if (!input.fd.valid()) {
    const std::string why = errno == ENOENT ? "not found" : "cannot be read: " + reason(errno);
    throw Error(ExitCode::no_input, file.string(), "", why);
  }
  struct stat status {};
  if (::fstat(input.fd.get(), &status) != 0)
    throw Error(ExitCode::io, file.string(), "", "fstat failed: " + reason(errno));
  if (S_ISDIR(status.st_mode)) throw Error(ExitCode::no_input, file.string(), "", "is a folder, a file is needed");
  if (!S_ISREG(status.st_mode)) throw Error(ExitCode::no_input, file.string(), "", "is not a regular file");
  input.size = static_cast<std::uint64_t>(status.st_size);
  if (input.size > max_bytes)
    throw Error(ExitCode::bad_input, file.string(), "",
                std::to_string(input.size) + " bytes, at most " + std::to_string(max_bytes) + " are accepted");
  return input;
}

std::size_t read_some(int fd, void* data, std::size_t size, const fs::path& file) {
  for (;;) {
    const ssize_t n = ::read(fd, data, std::min<std::size_t>(size, std::size_t{1} << 26));
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR) throw Error(ExitCode::io, file.string(), "", "reading failed: " + reason(errno));
  }
}

std::vector<char> read_input(const InputFile& input, const fs::path& file) {
  std::vector<char> bytes(input.size);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::size_t n = read_some(input.fd.get(), bytes.data() + done, bytes.size() - done, file);
    if (n == 0) throw Error(ExitCode::io, file.string(), "", "became shorter while it was read");
    done += n;
  }
  return bytes;
}

std::vector<char> read_file(const fs::path& file, std::uint64_t max_bytes) {
  return read_input(open_input(file, max_bytes), file);
}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw Error(ExitCode::cannot_create, folder.string(), "", "the folder cannot be created: " + reason(error.value()));
  if (!fs::is_directory(folder, error)) throw Error(ExitCode::cannot_create, folder.string(), "", "is not a folder");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw Error(ExitCode::cannot_create, folder.string(), "", "the folder is not writable: " + reason(errno));
}

void make_private_folder(const fs::path& folder) {
  if (folder.has_parent_path()) make_output_folder(folder.parent_path());
  if (::mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST)
    throw Error(ExitCode::cannot_create, folder.string(), "", "the folder cannot be created: " + reason(errno));
  std::error_code ignored;
  if (fs::is_symlink(folder, ignored))
    throw Error(ExitCode::cannot_create, folder.string(), "",
                "is a symbolic link, and what is of patients would go where it leads: replace it by a folder");
  make_output_folder(folder);
}

int remove_stale_temporaries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> stale;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().rfind(temporary_prefix, 0) == 0 && is_stale(it->path()))
      stale.push_back(it->path());
  int removed = 0;
  for (const fs::path& file : stale) removed += ::unlink(file.c_str()) == 0;
  return removed;
}

}  // namespace trephine
