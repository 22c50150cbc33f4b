// SPDX-License-Identifier: GPL-3.0-or-later
// The parent's side. The child's is in child_worker.cpp, what they share in child_protocol.h.
#include "base/child.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include "base/child_protocol.h"
#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/parallel.h"
#include "base/spawn.h"
#include "base/text.h"

namespace trephine {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& worker, const std::string& what) {
  throw Error(ExitCode::internal, "", worker, what);
}

Error limit_reached(const std::string& worker, const std::string& what) {
  return Error(ExitCode::internal, "", worker, what).because(Cause::child_limit);
}

// The limit on file sizes holds for shared memory, too; 0 where there is none below `bytes`.
std::uint64_t file_size_limit(std::uint64_t bytes) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= bytes) return 0;
  return std::max<std::uint64_t>(1, limit.rlim_cur);
}
[[noreturn]] void file_size_limit_reached(const std::string& worker) {
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  throw Error(ExitCode::io, "", worker,
              "the limit on file sizes, " + std::to_string(limit.rlim_cur) +
                  " bytes (ulimit -f), is too small for what is passed to or from a child process");
}

void check(const std::string& worker, bool good, const char* step) {
  if (good) return;
  if (errno == EMFILE || errno == ENFILE)
    throw Error(ExitCode::io, "", worker, "too few file descriptors for a child process: raise the limit (ulimit -n)");
  fail(worker, std::string("cannot start a child process: ") + step + ": " + std::strerror(errno));
}

// The descriptor is moved above the numbers that the child gets, so that one dup2 there cannot overwrite the source of
// another.
FileDescriptor moved_up(const std::string& worker, int fd, const char* step) {
  const FileDescriptor low(fd);
  check(worker, low.valid(), step);
  FileDescriptor high(::fcntl(low.get(), F_DUPFD_CLOEXEC, 16));
  if (!high.valid() && errno == EINVAL) errno = EMFILE;  // the limit lies below that number
  check(worker, high.valid(), "dup");
  return high;
}

FileDescriptor memory_file(const std::string& worker, const char* name) {
  return moved_up(worker, ::memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING), "memfd");
}

void write_all(const std::string& worker, int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), std::min<std::size_t>(bytes.size(), std::size_t{1} << 26));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EFBIG) file_size_limit_reached(worker);
    check(worker, n > 0, "passing the request");
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

std::filesystem::path& own_child_program() {
  static std::filesystem::path file = "/proc/self/exe";
  return file;
}

// A running child. However the scope is left, no process of the child remains.
class Process {
 public:
  explicit Process(pid_t pid) : pid_(pid) {}
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() { end(); }

  // True once the child has ended; `status` is then as waitpid gives it.
  bool ended(int& status) {
    if (pid_ > 0) {
      siginfo_t info{};
      int r;
      do r = ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
      while (r < 0 && errno == EINTR);
      if (r == 0 && info.si_pid == 0) return false;
      // Processes that the child started are killed too, while the number of its process group is still taken.
      ::kill(-pid_, SIGKILL);
      while ((r = ::waitpid(pid_, &status_, 0)) < 0 && errno == EINTR) {
      }
      if (r < 0)
        status_ = W_EXITCODE(0, SIGKILL);  // another part of the program has reaped it, so what it did is unknown
      pid_ = 0;
    }
    status = status_;
    return true;
  }
  void end() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::kill(-pid_, SIGKILL);
    while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = 0;
  }

 private:
  pid_t pid_;
  int status_ = 0;
};

pid_t start(const std::string& worker, const ChildLimits& limits, const ChildProgram& program, int request, int result,
            int pipe) {
  static_assert(child_request_fd == 3 && child_result_fd == 4 && child_pipe_fd == 5);
  SpawnRequest s;
  s.program = (program.file.empty() ? own_child_program() : program.file).string();
  s.argv = {"trephine",
            child_argument,
            worker,
            std::to_string(limits.memory_bytes),
            std::to_string(static_cast<long long>(std::ceil(std::max(1.0, limits.cpu_s)))),
            std::to_string(::getpid()),
            std::to_string(thread_count())};
  s.descriptors = {request, result, pipe};
  // Messages of libraries may hold a patient's data, so they are dropped; only a sanitizer's report has to be seen.
  s.shares_stderr = built_with_sanitizer;
  // The child has its own process group: Ctrl-C reaches the parent alone, which then kills the child.
  s.own_group = true;
  // The child sets its own limits, but only once it runs. A fault while its libraries are loaded must not leave a core
  // file either, so the right to write one is taken before the start.
  s.core_file = false;
  try {
    return spawn(s);
  } catch (const Error& e) {
    fail(worker, std::string("the child process ") + e.what());
  }
}

// Parses what the pipe holds. The child may be corrupted, so nothing that it sends is trusted.
class Messages {
 public:
  void add(const char* data, std::size_t size) { buffer_.append(data, size); }

  // Calls progress with the newest fraction, and keeps an error or the message that all is done.
  void take(const Progress& progress, const std::string& worker) {
    double fraction = -1;
    std::size_t at = 0;
    while (buffer_.size() - at >= sizeof(ChildMessage)) {
      ChildMessage m;
      std::memcpy(&m, buffer_.data() + at, sizeof m);
      if (m.size > child_message_limit) fail(worker, "the child sent nonsense");
      if (buffer_.size() - at - sizeof m < m.size) break;
      const std::string_view body(buffer_.data() + at + sizeof m, m.size);
      at += sizeof m + m.size;
      if (m.kind == ChildMessage::progress && body.size() == sizeof fraction) {
        std::memcpy(&fraction, body.data(), sizeof fraction);
      } else if (m.kind == ChildMessage::done) {
        done = true;
      } else if (m.kind == ChildMessage::error) {
        parts = unpack_child_error(body);
      }
    }
    buffer_.erase(0, at);
    if (fraction >= 0 && fraction <= 1) progress.report(fraction);
  }

  bool done = false;
  std::vector<std::string> parts;  // code, case, file, field, what, cause

 private:
  std::string buffer_;
};

[[noreturn]] void throw_child_error(const std::string& worker, const std::vector<std::string>& parts) {
  const auto code = parse_integer(parts[0]);
  constexpr ExitCode known[] = {ExitCode::usage,         ExitCode::bad_input, ExitCode::no_input, ExitCode::internal,
                                ExitCode::cannot_create, ExitCode::io,        ExitCode::busy,     ExitCode::bad_config,
                                ExitCode::quality,       ExitCode::privacy};
  for (const ExitCode k : known)
    if (code && static_cast<int>(k) == *code) {
      Error e(k, parts[2], parts[3], parts[4]);
      if (!parts[1].empty()) e.in_case(parts[1]);
      const auto cause = parse_integer(parts[5]);
      for (const Cause c : {Cause::child_limit, Cause::other_encoding})
        if (cause && static_cast<int>(c) == *cause) e.because(c);
      throw e;
    }
  fail(worker, "the child sent an error of an unknown kind");
}

Error death_of(const std::string& worker, int status, const ChildLimits& limits) {
  if (!WIFSIGNALED(status))
    return Error(ExitCode::internal, "", worker,
                 "the child ended with status " + std::to_string(WEXITSTATUS(status)) + " and no result");
  const int number = WTERMSIG(status);
  if (number == SIGXCPU)
    return limit_reached(worker, "CPU time limit " + to_text(std::ceil(std::max(1.0, limits.cpu_s))) + " s reached");
  if (number == SIGXFSZ)
    return limit_reached(worker, "its result is larger than the " + child_memory_limit_text(limits.memory_bytes));
  const bool killed = number == SIGKILL;  // by a person, or for want of memory
  Error e(ExitCode::internal, "", worker,
          "the child was killed by signal " + std::to_string(number) + (killed ? " (out of memory?)" : ""));
  return killed ? e : e.because(Cause::child_died);
}

ChildResult map_result(const std::string& worker, int fd) {
  // From here on nobody can shrink the file under the mapping, whoever still holds it open. The kernel says EBUSY while
  // it moves the file's pages itself, as it does when memory is short.
  const auto seal = [fd] { return ::fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) == 0; };
  bool sealed = seal();
  for (int tries = 0; !sealed && errno == EBUSY && tries < 50; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    sealed = seal();
  }
  check(worker, sealed, "sealing the result");
  struct stat s {};
  check(worker, ::fstat(fd, &s) == 0, "the result's size");
  if (s.st_size == 0) return {};
  const auto size = static_cast<std::size_t>(s.st_size);
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, 0);
  check(worker, data != MAP_FAILED, "mapping the result");
  return {static_cast<const char*>(data), size};
}

}  // namespace

ChildResult::ChildResult(ChildResult&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

ChildResult& ChildResult::operator=(ChildResult&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

ChildResult::~ChildResult() {
  if (data_) ::munmap(const_cast<char*>(data_), size_);
}

void set_child_program(const std::filesystem::path& file) { own_child_program() = file; }

ChildResult run_child(const std::string& worker, std::string_view request, const ChildLimits& limits,
                      const Progress& progress, const ChildProgram& program) {
  progress.check();
  const FileDescriptor request_file = memory_file(worker, "trephine-request");
  write_all(worker, request_file.get(), request);
  check(worker, ::fcntl(request_file.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) == 0, "seal");
  const FileDescriptor result_file = memory_file(worker, "trephine-result");
  int ends[2];
  check(worker, ::pipe2(ends, O_CLOEXEC) == 0, "pipe");
  const FileDescriptor read_end(ends[0]);
  FileDescriptor write_end = moved_up(worker, ends[1], "pipe");
  check(worker, ::fcntl(read_end.get(), F_SETFL, O_NONBLOCK) == 0, "pipe");

  const auto deadline = Clock::now() + std::chrono::duration<double>(limits.wall_s);
  Process process(start(worker, limits, program, request_file.get(), result_file.get(), write_end.get()));
  write_end.reset();

  Messages messages;
  bool open = true, ended = false;
  int status = 0;
  // After the child has ended, what the pipe still holds is read once more.
  while (!ended) {
    if (open) {
      pollfd p{read_end.get(), POLLIN, 0};
      ::poll(&p, 1, 20);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ended = process.ended(status);
    char buffer[1 << 16];
    ssize_t n = 0;
    while (open && (n = ::read(read_end.get(), buffer, sizeof buffer)) != 0) {
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) break;
      messages.add(buffer, static_cast<std::size_t>(n));
      messages.take(progress, worker);
      progress.check();
      if (!ended && Clock::now() > deadline) break;
    }
    if (n == 0) open = false;
    progress.check();
    if (!ended && Clock::now() > deadline)
      throw limit_reached(worker, "wall clock limit " + to_text(limits.wall_s) + " s reached");
  }
  if (messages.parts.size() == child_error_parts) throw_child_error(worker, messages.parts);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ && file_size_limit(limits.memory_bytes))
    file_size_limit_reached(worker);
  if (!messages.done || !WIFEXITED(status) || WEXITSTATUS(status) != 0) throw death_of(worker, status, limits);
  return map_result(worker, result_file.get());
}

}  // namespace trephine
