// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/spawn.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include "base/error.h"
#include "base/file_descriptor.h"

extern char** environ;

namespace trephine {
namespace fs = std::filesystem;

namespace {

/// Everything that the child needs. It is made before the fork, because the child may not allocate.
struct Plan {
  const SpawnRequest& request;
  std::vector<char*> argv, environment;
  std::vector<std::string> own_environment;
  std::string program, output, folder;
  pid_t parent = getpid();
  int failed = -1;  ///< the pipe through which the child says why it could not start

  explicit Plan(const SpawnRequest& r)
      : request(r),
        program(r.program.empty() ? r.argv[0] : r.program),
        output(r.output.string()),
        folder(r.folder.string()) {
    for (const std::string& word : r.argv) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    for (char** e = environ; *e; ++e) {
      const std::string name(*e, std::strcspn(*e, "="));
      bool replaced = false;
      for (const auto& [key, value] : r.environment) replaced = replaced || key == name;
      for (const std::string& key : r.without)
        replaced = replaced ||
                   (key.back() == '*' ? name.compare(0, key.size() - 1, key, 0, key.size() - 1) == 0 : key == name);
      if (!replaced) environment.push_back(*e);
    }
    for (const auto& [key, value] : r.environment) own_environment.push_back(key + "=" + value);
    for (std::string& text : own_environment) environment.push_back(text.data());
    environment.push_back(nullptr);
  }
};

void reset_signals() {
  for (int n = 1; n < NSIG; ++n) {
    struct sigaction a {};
    if (sigaction(n, nullptr, &a) != 0) continue;
    const bool stays_ignored = a.sa_handler == SIG_IGN && n != SIGINT && n != SIGTERM && n != SIGPIPE && n != SIGXFSZ;
    if (a.sa_handler == SIG_DFL || stays_ignored) continue;
    a = {};
    a.sa_handler = SIG_DFL;
    sigaction(n, &a, nullptr);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void place_descriptors(const Plan& plan) {
  const int null = open("/dev/null", O_RDWR);
  int out = plan.output.empty() ? -1 : open(plan.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600);
  if (out < 0) out = null;
  dup2(null, 0);
  if (!plan.request.shares_stdout) dup2(out, 1);
  if (!plan.request.shares_stderr) dup2(out, 2);
  int next = 3;
  for (const int fd : plan.request.descriptors) dup2(fd, next++);
  dup3(plan.failed, next, O_CLOEXEC);
  closefrom(next + 1);
}

/// Runs in the child until it executes the program. The child shares our memory meanwhile, so it makes only
/// async-signal-safe calls and writes to none of our memory.
[[noreturn]] void become(const Plan& plan) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != plan.parent) _exit(127);
  if (plan.request.own_group) setpgid(0, 0);
  if (!plan.request.core_file) {
    rlimit core{};
    getrlimit(RLIMIT_CORE, &core);
    core.rlim_cur = 0;
    setrlimit(RLIMIT_CORE, &core);
  }
  reset_signals();
  place_descriptors(plan);
  if (plan.folder.empty() || chdir(plan.folder.c_str()) == 0)
    execvpe(plan.program.c_str(), plan.argv.data(), plan.environment.data());
  const int why = errno;
  const int failed = 3 + static_cast<int>(plan.request.descriptors.size());
  if (write(failed, &why, sizeof why) != sizeof why) _exit(126);
  _exit(127);
}

/// Calls vfork in such a way that none of our signal handlers can run in the child.
pid_t start(const Plan& plan) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t pid = vfork();
  if (pid == 0) become(plan);
  const int why = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = why;
  return pid;
}

}  // namespace

pid_t spawn(const SpawnRequest& request) {
  Plan plan(request);
  const auto refuse = [&](int why) {
    throw Error(ExitCode::internal, request.argv[0], "", std::string("cannot be started: ") + std::strerror(why));
  };
  const int lowest = 4 + static_cast<int>(request.descriptors.size());
  for (const int fd : request.descriptors)
    if (fd < lowest) refuse(EBADF);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) refuse(errno);
  const FileDescriptor told(ends[0]);
  FileDescriptor low(ends[1]), failed(fcntl(ends[1], F_DUPFD_CLOEXEC, lowest));
  if (!failed.valid()) refuse(errno);
  low.reset();
  plan.failed = failed.get();
  const pid_t pid = start(plan);
  if (pid < 0) refuse(errno);
  failed.reset();
  int why = 0;
  ssize_t n = 0;
  do n = read(told.get(), &why, sizeof why);
  while (n < 0 && errno == EINTR);
  if (n != sizeof why) return pid;
  while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
  refuse(why);
  return -1;
}

Ended wait_for(pid_t pid, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  int pause_ms = 1;
  for (;;) {
    int status = 0;
    rusage usage{};
    const pid_t got = wait4(pid, &status, WNOHANG, &usage);
    if (got == pid || (got < 0 && errno != EINTR)) {
      Ended out;
      out.ended = true;
      out.signal = got == pid && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
      out.code = out.signal ? 128 + out.signal : got == pid ? WEXITSTATUS(status) : 127;
      out.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024;
      for (const timeval& t : {usage.ru_utime, usage.ru_stime})
        out.cpu_s += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
      return out;
    }
    if (Clock::now() >= end) return {};
    poll(nullptr, 0, pause_ms);
    pause_ms = pause_ms < 20 ? pause_ms * 2 : 20;
  }
}

fs::path own_program() { return fs::read_symlink("/proc/self/exe"); }

}  // namespace trephine
