// SPDX-License-Identifier: GPL-3.0-or-later
// Three processes: this program; the keeper, a bounded child (base/child.h) that makes the namespaces and watches time
// and memory; and the first process of the namespace, which starts the program, gathers its orphans, and with whose end
// the kernel ends all that is left.
#include "external/confined.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/child.h"
#include "base/error.h"
#include "external/descendants.h"
#include "external/hide.h"
#include "external/restrict.h"

namespace trephine::external {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
constexpr double patience_s = 30;  ///< beyond the program's own limit, for the keeper

/// What the first process of the namespace tells the keeper.
struct Told {
  int status = 0, why_not_started = 0;
  bool confined = true;  ///< or it was not started, because it must be
  char attributes_open[160] = {}, processes_open[160] = {};
};

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& w : words) all.push_back(w.data());
  all.push_back(nullptr);
  return all;
}

struct Work {
  std::vector<std::string> argv, environment, may_write;
  std::string folder, log;
  rlim_t file_bytes = 0;
  bool require_confined = false;
};

[[noreturn]] void become_program(Work& work, const Restriction& files, bool forbid_attributes, int failed) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setsid();  // it has no terminal into which it could write keys
  const int null = open("/dev/null", O_RDONLY);
  const int log = open(work.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, 0600);
  dup2(null, 0);
  dup2(log, 1);
  dup2(log, 2);
  const rlimit file{work.file_bytes, work.file_bytes};
  setrlimit(RLIMIT_FSIZE, &file);
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ, SIGHUP}) std::signal(number, SIG_DFL);
  std::vector<char*> argv = pointers(work.argv), environment = pointers(work.environment);
  errno = 0;
  if (chdir(work.folder.c_str()) == 0 && files.enter() &&
      (forbid_calls(forbid_attributes).empty() || !work.require_confined)) {
    fcntl(failed, F_SETFD, FD_CLOEXEC);
    for (int fd = 3; fd < 1024; ++fd)
      if (fd != failed) close(fd);
    execve(argv[0], argv.data(), environment.data());
  }
  const int why = errno ? errno : EPERM;
  (void)!write(failed, &why, sizeof why);
  _exit(127);
}

/// The first process of the namespace: it lives as long as the program, and takes in its orphans.
[[noreturn]] void be_first(Work& work, const Restriction& files, int tell) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  Told told;
  const Hiding hidden = hide_the_rest(work.may_write);
  hidden.attributes_open.copy(told.attributes_open, sizeof told.attributes_open - 1);
  hidden.processes_open.copy(told.processes_open, sizeof told.processes_open - 1);
  told.confined = hidden.attributes_open.empty() && hidden.processes_open.empty();
  if (work.require_confined && !told.confined) {
    (void)!write(tell, &told, sizeof told);
    _exit(0);
  }
  int ends[2];
  if (pipe(ends) != 0) _exit(1);
  const pid_t program = fork();
  if (program == 0) {
    close(ends[0]);
    become_program(work, files, !hidden.attributes_open.empty(), ends[1]);
  }
  close(ends[1]);
  if (program < 0 || read(ends[0], &told.why_not_started, sizeof told.why_not_started) < 0)
    told.why_not_started = EAGAIN;
  for (pid_t ended = 0; program > 0;) {
    int status = 0;
    ended = waitpid(-1, &status, 0);
    if (ended == program) {
      told.status = status;
      break;
    }
    if (ended < 0 && errno != EINTR) break;
  }
  (void)!write(tell, &told, sizeof told);
  _exit(0);
}

/// The keeper's work; its result is JSON.
void keep(ChildRequest& r) {
  const Json in = Json::parse(r.request());
  Work work;
  work.argv = in.at("argv").get<std::vector<std::string>>();
  work.environment = in.at("environment").get<std::vector<std::string>>();
  work.folder = in.at("folder").get<std::string>();
  work.log = in.at("log").get<std::string>();
  work.file_bytes = in.at("file_bytes").get<std::uint64_t>();
  work.may_write = in.at("may_write").get<std::vector<std::string>>();
  work.require_confined = in.at("require_confined").get<bool>();
  const double time_limit_s = in.at("time_limit_s");
  const auto memory_bytes = in.at("memory_bytes").get<std::uint64_t>();

  const Separation apart = separate(memory_bytes);
  const Restriction files(work.may_write);
  std::string open;
  for (const std::string& one : {apart.network_open, apart.services_open, files.open()})
    if (!one.empty()) open += (open.empty() ? "" : ", ") + one;
  const auto not_confined = [](const std::string& why) {
    return Error(ExitCode::internal, "", "require_confined",
                 "the kernel does not confine the program, and it was not started (" + why + ")");
  };
  if (work.require_confined && !open.empty()) throw not_confined(open);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  int ends[2];
  if (pipe(ends) != 0) throw Error(ExitCode::internal, "", "external", "no pipe can be made");
  const pid_t first = fork();
  if (first == 0) {
    close(ends[0]);
    be_first(work, files, ends[1]);
  }
  close(ends[1]);
  if (first < 0) throw Error(ExitCode::internal, "", "external", "no process can be started");

  Told told;
  bool timed_out = false, over_memory = false, heard = false;
  const auto start = Clock::now();
  for (;;) {
    int status = 0;
    if (waitpid(first, &status, WNOHANG) == first) {
      heard = read(ends[0], &told, sizeof told) == sizeof told;
      break;
    }
    timed_out = std::chrono::duration<double>(Clock::now() - start).count() > time_limit_s;
    over_memory = !timed_out && memory_of_descendants(getpid(), first) > memory_bytes;
    if (timed_out || over_memory) break;
    usleep(50000);
    r.report(0);
  }
  end_descendants(getpid());
  const std::string attributes_open = told.attributes_open, processes_open = told.processes_open;
  if (work.require_confined && heard && !told.confined)
    throw not_confined(attributes_open + (attributes_open.empty() || processes_open.empty() ? "" : ", ") +
                       processes_open);
  const bool ended = heard && told.why_not_started == 0;
  Json out{{"timed_out", timed_out}, {"over_memory", over_memory}, {"network_open", apart.network_open}};
  out["services_open"] = apart.services_open;
  out["files_open"] = files.open();
  out["attributes_open"] = attributes_open;
  out["processes_open"] = processes_open;
  out["not_started"] = told.why_not_started ? std::strerror(told.why_not_started) : "";
  out["signal"] = ended && WIFSIGNALED(told.status) ? WTERMSIG(told.status) : 0;
  out["code"] = ended && WIFEXITED(told.status) ? WEXITSTATUS(told.status) : 0;
  if (!ended && !timed_out && !over_memory && told.why_not_started == 0) out["signal"] = SIGKILL;
  r.write(out.dump());
}

const ChildWorker keeper("external", keep);

}  // namespace

ConfinedResult run_confined(const ConfinedRequest& request, const Progress& progress) {
  std::vector<std::string> environment, may_write = request.may_write;
  for (const auto& [name, value] : request.environment) environment.push_back(name + "=" + value);
  may_write.push_back(request.folder.string());
  const auto bytes = [](double gb) { return std::uint64_t(gb * 1e9); };
  const Json in{{"argv", request.argv},
                {"environment", environment},
                {"folder", request.folder.string()},
                {"log", request.log.string()},
                {"may_write", may_write},
                {"file_bytes", bytes(request.file_limit_gb)},
                {"require_confined", request.require_confined},
                {"time_limit_s", request.time_limit_s},
                {"memory_bytes", bytes(request.memory_limit_gb)}};
  ChildLimits limits;
  limits.memory_bytes = std::uint64_t{1} << 62;  // the program inherits what limits the keeper
  limits.cpu_s = 1e9;
  limits.wall_s = request.time_limit_s + patience_s;
  const ChildResult result = run_child("external", in.dump(), limits, progress);
  const Json out = Json::parse(result.bytes());
  ConfinedResult made;
  made.code = out.at("code");
  made.signal = out.at("signal");
  made.timed_out = out.at("timed_out");
  made.over_memory = out.at("over_memory");
  made.not_started = out.at("not_started");
  made.network_open = out.at("network_open");
  made.services_open = out.at("services_open");
  made.files_open = out.at("files_open");
  made.attributes_open = out.at("attributes_open");
  made.processes_open = out.at("processes_open");
  return made;
}

}  // namespace trephine::external
