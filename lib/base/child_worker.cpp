// SPDX-License-Identifier: GPL-3.0-or-later
// The child's side of base/child.h.
#include <cxxabi.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <typeinfo>

#include "base/child.h"
#include "base/child_protocol.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

namespace trephine {
namespace {

using Clock = std::chrono::steady_clock;

std::map<std::string, std::function<void(ChildRequest&)>>& workers() {
  static std::map<std::string, std::function<void(ChildRequest&)>> all;
  return all;
}

void write_all(int fd, const void* data, std::size_t size) {
  const char* p = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = ::write(fd, p, std::min<std::size_t>(size, std::size_t{1} << 26));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && (errno == ENOSPC || errno == ENOMEM)) throw std::bad_alloc();
    if (n <= 0)
      throw Error(ExitCode::internal, "", "", std::string("handing over the result failed: ") + std::strerror(errno));
    p += n;
    size -= static_cast<std::size_t>(n);
  }
}

void send(ChildMessage::Kind kind, std::string_view body) {
  const ChildMessage head{kind, static_cast<std::uint32_t>(body.size())};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.append(body);
  write_all(child_pipe_fd, bytes.data(), bytes.size());
}

class Request final : public ChildRequest {
 public:
  explicit Request(std::uint64_t memory_bytes) : memory_bytes_(memory_bytes) {
    struct stat s {};
    if (::fstat(child_request_fd, &s) != 0) throw std::bad_alloc();
    size_ = static_cast<std::size_t>(s.st_size);
    if (size_ == 0) return;
    void* data = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, child_request_fd, 0);
    if (data == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<const char*>(data);
  }
  std::string_view request() const override { return {data_, size_}; }

  using ChildRequest::write;
  void write(const void* data, std::size_t size) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    // Pages of the result are not part of this process's address space, so the limit is checked here.
    if (size > memory_bytes_ - written_) throw std::bad_alloc();
    written_ += size;
    if (buffer_.size() + size < buffer_limit) {
      buffer_.append(static_cast<const char*>(data), size);
      return;
    }
    write_buffer();
    write_all(child_result_fd, data, size);
  }

  void report(double fraction) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto now = Clock::now();
    if (now - reported_ < std::chrono::milliseconds(20)) return;
    reported_ = now;
    send(ChildMessage::progress, {reinterpret_cast<const char*>(&fraction), sizeof fraction});
  }

  void finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    write_buffer();
    send(ChildMessage::done, {});
  }

 private:
  static constexpr std::size_t buffer_limit = 1 << 16;
  void write_buffer() {
    write_all(child_result_fd, buffer_.data(), buffer_.size());
    buffer_.clear();
  }
  std::mutex mutex_;
  const char* data_ = nullptr;
  std::size_t size_ = 0;
  std::uint64_t memory_bytes_, written_ = 0;
  std::string buffer_;
  Clock::time_point reported_{};
};

void limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  rlimit now{};
  ::getrlimit(resource, &now);
  const rlimit wanted{std::min(soft, now.rlim_max), std::min(hard, now.rlim_max)};
  if (::setrlimit(resource, &wanted) != 0) throw Error(ExitCode::internal, "", "", "the child cannot limit itself");
}

void confine(std::uint64_t memory_bytes, rlim_t cpu_s, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // the parent died before the line above
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ}) std::signal(number, SIG_DFL);
  const int fd = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (fd >= 0) {  // where memory runs out, the kernel should end this process before another; it works without as well
    (void)!::write(fd, "500", 3);
    ::close(fd);
  }
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_CPU, cpu_s, cpu_s + 2);
  limit(RLIMIT_FSIZE, memory_bytes, memory_bytes);
  if (built_with_sanitizer) return;
  limit(RLIMIT_AS, memory_bytes, memory_bytes);
  ::prctl(PR_SET_DUMPABLE, 0);  // a core that is piped to a collector does not obey RLIMIT_CORE
}

void send_error(const Error& e) {
  std::vector<std::string> parts = {
      std::to_string(static_cast<int>(e.code())), e.case_token(), e.file(), e.field(), e.what(),
      std::to_string(static_cast<int>(e.cause()))};
  for (auto& p : parts) p.resize(std::min<std::size_t>(p.size(), child_message_limit / 8));
  send(ChildMessage::error, pack_child_error(parts));
}

std::string type_name(const std::exception& e) {
  int status = 0;
  char* name = abi::__cxa_demangle(typeid(e).name(), nullptr, nullptr, &status);
  const std::string text = status == 0 && name ? name : typeid(e).name();
  std::free(name);
  return text;
}

// Runs the worker and sends what went wrong to the parent. The text of a foreign exception may quote the file that was
// read, so only the exception's type is told.
bool work(const std::string& name, std::uint64_t memory_bytes) {
  try {
    const auto found = workers().find(name);
    if (found == workers().end()) throw Error(ExitCode::internal, "", name, "no such worker in this program");
    Request request(memory_bytes);
    found->second(request);
    request.finish();
    return true;
  } catch (const Error& e) {
    send_error(e);
  } catch (const std::bad_alloc&) {
    send_error(Error(ExitCode::internal, "", name, child_memory_limit_text(memory_bytes) + " reached")
                   .because(Cause::child_limit));
  } catch (const std::exception& e) {
    send_error(Error(ExitCode::internal, "", name, "unexpected exception of type " + type_name(e)));
  }
  return false;
}

}  // namespace

ChildWorker::ChildWorker(const char* name, std::function<void(ChildRequest&)> function) {
  workers()[name] = std::move(function);
}

void run_child_if_asked(int argc, char** argv) {
  if (argc != 7 || std::strcmp(argv[1], child_argument) != 0) return;
  const auto memory_bytes = parse_integer(argv[3]), cpu_s = parse_integer(argv[4]), parent = parse_integer(argv[5]),
             threads = parse_integer(argv[6]);
  if (!memory_bytes || !cpu_s || !parent || !threads) ::_exit(static_cast<int>(ExitCode::usage));
  bool good = false;
  try {
    confine(static_cast<std::uint64_t>(*memory_bytes), static_cast<rlim_t>(*cpu_s), static_cast<pid_t>(*parent));
    set_thread_count(static_cast<int>(*threads));
    good = work(argv[2], static_cast<std::uint64_t>(*memory_bytes));
  } catch (...) {  // the pipe is gone or memory is too short to say so; the exit status says it
  }
  ::_exit(good ? 0 : 1);
}

std::string pack_child_error(const std::vector<std::string>& parts) {
  std::string bytes;
  for (const auto& part : parts) bytes += std::to_string(part.size()) + ":" + part;
  return bytes;
}

std::vector<std::string> unpack_child_error(std::string_view bytes) {
  std::vector<std::string> parts;
  while (!bytes.empty()) {
    const std::size_t colon = bytes.find(':');
    if (colon == std::string_view::npos) return {};
    const auto size = parse_integer(bytes.substr(0, colon));
    bytes.remove_prefix(colon + 1);
    if (!size || *size < 0 || static_cast<unsigned long long>(*size) > bytes.size()) return {};
    parts.emplace_back(bytes.substr(0, static_cast<std::size_t>(*size)));
    bytes.remove_prefix(static_cast<std::size_t>(*size));
  }
  if (parts.size() != child_error_parts) return {};
  return parts;
}

std::string child_memory_limit_text(std::uint64_t bytes) {
  return "memory limit " + std::to_string(bytes >> 20) + " MiB";
}

}  // namespace trephine
