// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster/slurm.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/joined.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/spawn.h"
#include "base/text.h"

namespace trephine::cluster {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double answer_s = 120, pause_s = 2;  // Slurm's own programs give up after about as long
constexpr std::size_t max_told = 400;

struct Said {
  bool ended = true;
  int code = 0;
  std::string text;
};

std::string read_all(int fd) {
  std::string text;
  char buffer[65536];
  for (off_t at = 0;;) {
    const ssize_t n = ::pread(fd, buffer, sizeof buffer, at);
    if (n <= 0) return text;
    text.append(buffer, static_cast<std::size_t>(n));
    at += n;
  }
}

Said ask(const std::vector<std::string>& argv) {
  const FileDescriptor memory(memfd_create("said", MFD_CLOEXEC));
  SpawnRequest request;
  request.argv = argv;
  request.output = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(memory.get());
  request.environment = {{"LC_ALL", "C"}};
  // A user's own defaults would hide jobs from us, end others', or make of one submission something else.
  request.without = {"SQUEUE_*",           "SCANCEL_*",        "SACCT_*",         "SLURM_CLUSTERS",
                     "SBATCH_CLUSTERS",    "SBATCH_ARRAY_INX", "SBATCH_WAIT",     "SBATCH_MEM_PER_CPU",
                     "SBATCH_MEM_PER_GPU", "SBATCH_REQUEUE",   "SBATCH_JOB_NAME", "SBATCH_TIMELIMIT"};
  pid_t pid = 0;
  try {
    pid = spawn(request);
  } catch (const Error& e) {
    throw Error(ExitCode::internal, argv.front(), "",
                std::string(e.what()) + "; Debian's package slurm-client brings it");
  }
  Ended end = wait_for(pid, answer_s);
  if (!end.ended) {
    ::kill(pid, SIGKILL);
    end = wait_for(pid, until_it_ends_s);
    return {false, end.code, "no answer within " + to_text(answer_s) + " s"};
  }
  return {true, end.code, read_all(memory.get())};
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ';');
  return printable(text).substr(0, max_told);
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

// Whether the controller may do later what it did not do now.
bool may_pass(const Said& said) {
  if (!said.ended) return true;
  for (const char* words : {"Unable to contact slurm controller", "Connection refused", "Socket timed out",
                            "Resource temporarily unavailable", "Zero Bytes were transmitted", "Connection timed out",
                            "Transport endpoint is not connected", "Slurm controller not responding",
                            "Slurm backup controller in standby mode", "Unexpected message received"})
    if (said.text.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace

bool is_alive(const SlurmTask& task) {
  for (const char* ended :
       {"COMPLET", "FAIL", "CANCEL", "TIMEOUT", "NODE_FAIL", "BOOT_FAIL", "OUT_OF", "DEADLINE", "PREEMPTED", "REVOKED"})
    if (task.state.rfind(ended, 0) == 0) return false;
  return true;
}

std::string parse_submitted(const std::string& said) {
  std::istringstream lines(said);
  std::string line, found;
  while (std::getline(lines, line)) {
    const std::string number = line.substr(0, line.find(';'));  // "12;cluster" where there are several
    if (is_number(number)) found = number;
  }
  return found;
}

std::vector<SlurmTask> parse_tasks(const std::string& said) {
  std::vector<SlurmTask> all;
  std::istringstream lines(said);
  std::string line;
  while (std::getline(lines, line)) {
    std::vector<std::string> parts;
    std::istringstream in(line);
    for (std::string part; std::getline(in, part, '|');) parts.push_back(part);
    if (parts.size() < 3 || parts.size() > 5 || !is_number(parts[0]) || parts[2].empty()) continue;
    parts.resize(5);  // it waits, so that it has no node; accounts say no reason
    SlurmTask task{parts[0], -1, parts[2], parts[3], parts[4] == "None" ? "" : parts[4]};
    if (is_number(parts[1]) && parts[1].size() < 9) task.index = std::stoi(parts[1]);
    all.push_back(std::move(task));
  }
  return all;
}

long parse_max_array(const std::string& said) {
  std::istringstream lines(said);
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream in(line);
    std::string key, equals;
    long value = 0;
    if (in >> key >> equals >> value && key == "MaxArraySize") return value;
  }
  return 0;
}

std::string submit_to_slurm(const std::vector<std::string>& options, const std::string& script, double patience_s) {
  std::vector<std::string> argv = {"sbatch", "--parsable"};
  argv.insert(argv.end(), options.begin(), options.end());
  argv.push_back(script);
  const auto start = Clock::now();
  bool told = false;
  for (;;) {
    const Said said = ask(argv);
    if (said.ended && said.code == 0) {
      const std::string number = parse_submitted(said.text);
      if (!number.empty()) return number;
    }
    const bool out_of_patience = std::chrono::duration<double>(Clock::now() - start).count() > patience_s;
    if (cancel_requested()) throw Cancelled{};
    if (out_of_patience || !may_pass(said))
      throw Error(ExitCode::internal, "sbatch", "", "refused the jobs: " + one_line(said.text));
    if (!told) log_warning("sbatch: " + one_line(said.text) + "; asked again until it answers");
    told = true;
    std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
  }
}

std::optional<std::vector<SlurmTask>> tasks_of_slurm(const std::string& job_name) {
  const Said said =
      ask({"squeue", "--noheader", "--array", "--states=all", "--name=" + job_name, "--format=%F|%K|%T|%N|%r"});
  if (!said.ended || said.code != 0) return {};
  return parse_tasks(said.text);
}

std::vector<SlurmTask> parse_accounts(const std::string& said) {
  std::string as_of_queue;  // 7_12|OUT_OF_MEMORY|n1 is 7|12|OUT_OF_MEMORY|n1 there
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    const auto end = line.find('|'), mark = line.find('_');
    if (end == std::string::npos || mark == std::string::npos || mark > end) continue;
    line[mark] = '|';
    as_of_queue += line + "\n";
  }
  return parse_tasks(as_of_queue);
}

std::vector<SlurmTask> accounted_tasks(const std::vector<std::string>& arrays) {
  const std::string jobs = joined(arrays, ",");
  if (jobs.empty()) return {};
  try {
    const Said said =
        ask({"sacct", "--noheader", "--parsable2", "--allocations", "--format=JobID,State,NodeList", "--jobs=" + jobs});
    return said.ended && said.code == 0 ? parse_accounts(said.text) : std::vector<SlurmTask>();
  } catch (const Error&) {  // it is a package's own program, and may be missing
    return {};
  }
}

void cancel_in_slurm(const std::string& job_name) {
  const Said said = ask({"scancel", "--name=" + job_name});
  if (!said.ended || said.code != 0)
    throw Error(ExitCode::internal, "scancel", "", "did not end the jobs: " + one_line(said.text));
}

long max_array_of_slurm() {
  const Said said = ask({"scontrol", "show", "config"});
  return said.ended && said.code == 0 ? parse_max_array(said.text) : 0;
}

}  // namespace trephine::cluster
