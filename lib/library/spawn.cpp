// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/spawn.h"

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

extern char** environ;

namespace trephine {
namespace fs = std::filesystem;

pid_t spawn(const SpawnRequest& request) {
  // All that allocates is done before fork: only async-signal-safe calls follow in the child.
  std::vector<char*> argv;
  for (const std::string& word : request.argv) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  std::vector<std::string> own;
  std::vector<char*> environment;
  for (char** e = environ; *e; ++e) {
    const std::string name(*e, std::strcspn(*e, "="));
    bool replaced = false;
    for (const auto& [key, value] : request.environment) replaced = replaced || key == name;
    if (!replaced) environment.push_back(*e);
  }
  for (const auto& [key, value] : request.environment) own.push_back(key + "=" + value);
  for (std::string& text : own) environment.push_back(text.data());
  environment.push_back(nullptr);
  const std::string output = request.output.string(), folder = request.folder.string();
  int failed[2];
  if (pipe2(failed, O_CLOEXEC) != 0)
    throw Error(ExitCode::internal, request.argv[0], "", std::string("cannot be started: ") + std::strerror(errno));
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    if (request.own_group) setpgid(0, 0);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_DFL);
    const int null = open("/dev/null", O_RDWR);
    int out = output.empty() ? -1 : open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0644);
    if (out < 0) out = null;
    dup2(null, 0);
    dup2(out, 1);
    dup2(out, 2);
    if (folder.empty() || chdir(folder.c_str()) == 0) {
      environ = environment.data();
      execvp(argv[0], argv.data());
    }
    const int why = errno;
    if (write(failed[1], &why, sizeof why) != sizeof why) _exit(126);
    _exit(127);
  }
  const int fork_errno = errno;
  close(failed[1]);
  int why = 0;
  ssize_t n = 0;
  if (pid > 0) do
      n = read(failed[0], &why, sizeof why);
    while (n < 0 && errno == EINTR);
  close(failed[0]);
  if (pid < 0) why = fork_errno;
  if (pid > 0 && n == sizeof why) waitpid(pid, nullptr, 0);
  if (pid < 0 || n == sizeof why)
    throw Error(ExitCode::internal, request.argv[0], "", std::string("cannot be started: ") + std::strerror(why));
  return pid;
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
