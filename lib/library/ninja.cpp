// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/ninja.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <set>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/progress.h"
#include "base/spawn.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr double smallest_class_mb = 256;
constexpr std::uintmax_t smallest_disk_bytes = 1 << 20;

// The memory that the heaviest possible choice of jobs takes.
double worst_case_mb(const MemoryPools& pools) {
  double sum = 0;
  int left = pools.jobs;
  for (std::size_t k = pools.class_mb.size(); k-- > 0 && left > 0;) {
    const int n = std::min(left, pools.places[k]);
    sum += n * pools.class_mb[k];
    left -= n;
  }
  return sum;
}

// A path for Ninja's file: in single quotes for the shell, with $ doubled for Ninja.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '$')
      out += "$$";
    else
      out += c;
  }
  return out + "'";
}

// What the jobs read: memory behind a path that exists as long as this process.
FileDescriptor memory_file(const std::string& bytes) {
  FileDescriptor fd(memfd_create("trephine-library-jobs", MFD_CLOEXEC));
  std::size_t done = 0;
  while (fd.valid() && done < bytes.size()) {
    const ssize_t n = write(fd.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno != EINTR) break;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  if (!fd.valid() || done < bytes.size()) throw Error(ExitCode::internal, "", "jobs", std::strerror(errno));
  return fd;
}

std::string path_to(const FileDescriptor& fd) {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(fd.get());
}

class Events {
 public:
  Events() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw Error(ExitCode::internal, "", "pipe", std::strerror(errno));
    read_ = FileDescriptor(ends[0]);
    write_ = FileDescriptor(ends[1]);  // kept open, so that the pipe never ends
  }
  std::string path() const { return path_to(write_); }
  // Waits at most this long for the first event.
  std::vector<JobEvent> take(double seconds) {
    pollfd p{read_.get(), POLLIN, 0};
    poll(&p, 1, static_cast<int>(seconds * 1000));
    char buffer[65536];
    for (ssize_t n; (n = read(read_.get(), buffer, sizeof buffer)) > 0;)
      text_.append(buffer, static_cast<std::size_t>(n));
    std::vector<JobEvent> all;
    for (std::size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1)) {
      JobEvent event;
      if (parse_event(text_.substr(0, end), event)) all.push_back(std::move(event));
    }
    return all;
  }

 private:
  FileDescriptor read_, write_;
  std::string text_;
};

// However run_ninja is left (for lack of memory, say), the jobs are asked to stop, so that they clean up, and are
// waited for.
struct Running {
  explicit Running(pid_t p) : pid(p) {}
  Running(const Running&) = delete;
  ~Running() {
    constexpr double patience_s = 10;
    if (pid == 0) return;
    kill(pid, SIGINT);  // Ninja passes it on to the jobs and waits for them
    if (wait_for(pid, patience_s).ended) return;
    kill(pid, SIGKILL);
    wait_for(pid, 1e6);
  }
  pid_t pid;
};

}  // namespace

std::size_t MemoryPools::class_of(double memory_mb) const {
  for (std::size_t k = 0; k < class_mb.size(); ++k)
    if (memory_mb <= class_mb[k]) return k;
  return class_mb.empty() ? 0 : class_mb.size() - 1;
}

MemoryPools make_pools(const std::vector<double>& memory_mb, double budget_mb, int jobs) {
  MemoryPools pools;
  pools.jobs = std::max(jobs, 1);
  std::set<double> classes;
  for (const double mb : memory_mb) {
    double limit = smallest_class_mb;
    while (limit < mb) limit *= 2;
    classes.insert(limit);
  }
  // The bound of a class is the memory of its largest job, not the power of two above it.
  for (const double limit : classes) {
    double most = 0;
    for (const double mb : memory_mb)
      if (mb <= limit && (limit == smallest_class_mb || mb > limit / 2)) most = std::max(most, mb);
    pools.class_mb.push_back(most);
    pools.places.push_back(pools.jobs);
  }
  // Places are taken from the heaviest class that has more than one, then from all classes.
  while (worst_case_mb(pools) > budget_mb) {
    const auto many = std::find_if(pools.places.rbegin(), pools.places.rend(), [](int n) { return n > 1; });
    if (many != pools.places.rend())
      --*many;
    else if (pools.jobs > 1)
      --pools.jobs;
    else
      break;  // one job alone exceeds the budget: it is tried nevertheless
  }
  return pools;
}

std::string ninja_file(const std::vector<NinjaJob>& jobs, const MemoryPools& pools, const std::string& program) {
  std::string text =
      "# Written anew by every `trephine library build`. No output of these rules is ever made: all run.\n";
  text += "ninja_required_version = 1.8\nbuilddir = .\n\n";
  for (std::size_t k = 0; k < pools.places.size(); ++k)
    text += "pool memory" + std::to_string(k) + "\n  depth = " + std::to_string(pools.places[k]) + "\n";
  // With exec the job is Ninja's own child and dies with it.
  text += "\nrule job\n  command = exec " + quoted(program) + " library job $out\n  description = $out\n\n";
  for (const NinjaJob& j : jobs) {
    text += "build " + j.job.name + ": job";
    for (std::size_t i = 0; i < j.after.size(); ++i) text += (i == 0 ? " || " : " ") + j.after[i];
    text += "\n  pool = memory" + std::to_string(pools.class_of(j.memory_mb)) + "\n";
  }
  return text;
}

void run_ninja(const std::vector<NinjaJob>& jobs, const MemoryPools& pools, const NinjaOptions& options,
               const std::function<void(const JobEvent&)>& event, const std::function<void()>& tick) {
  for (const char* old : {".ninja_log", ".ninja_deps"}) {
    std::error_code ignored;
    fs::remove(options.folder / old, ignored);
  }
  write_file(options.folder / "build.ninja", ninja_file(jobs, pools, own_program().string()));
  std::vector<LibraryJob> list;
  for (const NinjaJob& j : jobs) list.push_back(j.job);
  const FileDescriptor memory = memory_file(jobs_json(list));
  Events events;
  SpawnRequest request;
  request.argv = {"ninja", "-f", "build.ninja", "-j", std::to_string(pools.jobs), "-k", options.keep_going ? "0" : "1"};
  request.folder = options.folder;
  request.output = options.folder / "logs" / "ninja.log";
  request.environment = {{jobs_variable, path_to(memory)}, {events_variable, events.path()}};
  request.own_group = true;
  pid_t pid = 0;
  try {
    pid = spawn(request);
  } catch (const Error& e) {
    throw Error(ExitCode::internal, "ninja", "", std::string(e.what()) + "; the package ninja-build brings it");
  }
  Running running(pid);
  bool told = false;
  int failed = 0;
  std::set<std::string> open;
  Ended end;
  const auto hand_on = [&](const JobEvent& e) {
    e.is_end ? void(open.erase(e.name)) : void(open.insert(e.name));
    failed += e.is_end && e.result.code != 0;
    event(e);
  };
  const auto take = [&](double seconds) {
    for (const JobEvent& e : events.take(seconds)) hand_on(e);
  };
  while (!end.ended) {
    take(options.tick_s);
    tick();
    if (cancel_requested() && !told) {
      told = true;
      kill(pid, SIGINT);
    }
    end = wait_for(pid, 0);
    if (end.ended) running.pid = 0;
  }
  take(0);
  if (cancel_requested()) throw Cancelled{};
  // These jobs ran out of memory or were killed from outside; the others were built nevertheless.
  for (const std::string& name : std::set<std::string>(open))
    hand_on({name, true, {static_cast<int>(ExitCode::internal), "ended without a word, see its log", 0, 0, 0}});
  // The job that failed gives its own reason; Ninja may have stopped for the same one, such as a full disk.
  if (end.code == 0 || failed > 0) return;
  std::error_code error;
  if (fs::space(options.folder, error).available < smallest_disk_bytes && !error)
    throw Error(ExitCode::io, options.folder.string(), "ninja", "the disk is full");
  throw Error(ExitCode::internal, (options.folder / "logs" / "ninja.log").string(), "ninja",
              end.signal ? "killed by signal " + std::to_string(end.signal) : "failed, see its log");
}

}  // namespace trephine::library
