// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/job.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/error_text.h"
#include "base/file_descriptor.h"
#include "base/joined.h"
#include "base/memory_kills.h"
#include "base/progress.h"
#include "base/spawn.h"
#include "base/temporary_folder.h"
#include "base/text.h"
#include "base/write_file.h"
#include "json/job_status.h"
#include "library/series_state.h"
#include "publish/bring_case.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
constexpr int busy_tries = 6;
constexpr double busy_pause_s = 0.5, patience_s = 10;
constexpr std::size_t max_reason = 1500;
constexpr int stopped = -1;  // stands for an exit code: we stopped the job because its time was up

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

LibraryJob job_of(const std::string& name, const Json& json) {
  LibraryJob job;
  job.name = name;
  job.token = json.at("token");
  job.is_phantom = json.at("is_phantom");
  job.arguments = json.at("arguments").get<std::vector<std::string>>();
  job.settings_sha256 = json.at("settings");
  job.phantom = json.at("phantom");
  job.identity = json.at("identity");
  job.library = json.at("library").get<std::string>();
  job.series = json.at("series").get<std::string>();
  job.time_limit_s = json.at("time_limit_s");
  job.keep_going = json.at("keep_going");
  job.on_node = json.at("on_node");
  return job;
}

Json json_of(const LibraryJob& job) {
  return {{"token", job.token},
          {"is_phantom", job.is_phantom},
          {"arguments", job.arguments},
          {"settings", job.settings_sha256},
          {"phantom", job.phantom},
          {"identity", job.identity},
          {"library", job.library.string()},
          {"series", job.series.string()},
          {"time_limit_s", job.time_limit_s},
          {"keep_going", job.keep_going},
          {"on_node", job.on_node}};
}

LibraryJob find_job(const std::string& name) {
  const char* where = std::getenv(jobs_variable);
  if (!where) throw Error(ExitCode::usage, "", "library job", "is started by `trephine library build` only");
  std::ifstream file(where, std::ios::binary);
  return job_of(name, Json::parse(file).at(name));
}

void send(const JobEvent& event) {
  const char* where = std::getenv(events_variable);
  const int fd = where ? open(where, O_WRONLY | O_CLOEXEC) : -1;
  if (fd < 0) return;
  const std::string line = event_line(event);
  if (write(fd, line.data(), line.size()) < 0) {
  }  // if the build is gone, nobody needs the events
  close(fd);
}

std::string read_log(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  if (what.size() < 2) return;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

// The log without the series' path, which may hold a patient's name.
std::string clean_log(const fs::path& log, const fs::path& series) {
  const std::string before = read_log(log);
  std::string text = before;
  replace_all(text, series.string(), "SERIES");
  if (text != before) try {
      write_file(log, text);
    } catch (const Error&) {  // no log is better than a log with the path
      std::error_code ignored;
      fs::remove(log, ignored);
    }
  return text;
}

// The errors with which the command ended; the last line of its log where it died without any.
// Both without the series' path, which may hold a patient's name.
std::string reason_of(const json::JobStatus& status, const std::string& log, const fs::path& series) {
  std::string reason = joined(status.errors, "; ");
  if (reason.empty()) {
    std::istringstream lines(log);
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) reason = line;
  }
  replace_all(reason, series.string(), "SERIES");
  return printable(reason).substr(0, max_reason);
}

// What a program that is started with @3 reads as its command line: a file without a name.
FileDescriptor words_to_read(const std::vector<std::string>& words) {
  std::string bytes;
  for (const std::string& w : words) bytes += w + '\0';
  const FileDescriptor made(memfd_create("words", MFD_CLOEXEC));
  if (!made.valid() || write(made.get(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()) ||
      lseek(made.get(), 0, SEEK_SET) != 0)
    throw Error(ExitCode::internal, "", "library job", std::string("no memory file: ") + std::strerror(errno));
  constexpr int above_those_of_spawn = 16;
  return FileDescriptor(fcntl(made.get(), F_DUPFD_CLOEXEC, above_those_of_spawn));
}

// Runs the command once, within its time limit. Afterwards none of its processes runs any more.
Ended run_once(const LibraryJob& job, const LibraryState& state) {
  SpawnRequest request;
  // The words hold the series' path, which may hold a patient's name: they do not stand in the list of processes.
  const FileDescriptor words = words_to_read(job.arguments);
  request.argv = {own_program().string(), "@3"};
  request.descriptors = {words.get()};
  request.output = state.log_file(job.name);
  request.environment = {{json::job_status_variable, state.status_file(job.name)}};
  json::write_job_status(state.status_file(job.name), {});
  const pid_t pid = spawn(request);
  const auto start = Clock::now();
  for (;;) {
    const double left_s = job.time_limit_s > 0 ? job.time_limit_s - seconds_since(start) : 1;
    Ended end = wait_for(pid, std::clamp(left_s, 0.0, 1.0));
    if (end.ended) return end;
    if (job.time_limit_s <= 0 || seconds_since(start) < job.time_limit_s) continue;
    kill(pid, SIGTERM);  // the command cleans up, and its children die with it
    end = wait_for(pid, patience_s);
    if (!end.ended) {
      kill(pid, SIGKILL);
      end = wait_for(pid, 1e6);
    }
    if (end.code != 0 || end.signal) end.code = stopped;  // otherwise it ended successfully at that moment
    return end;
  }
}

void record_phantom(const LibraryState& state, const LibraryJob& job) {
  const fs::path series = state.phantom_folder(job.token) / "dicom";
  const Json record = {{"identity", job.identity},
                       {"files", sign_files(series).sha256},
                       {"series", dicom::hash_of_series_input(series, {})}};
  write_file(state.phantom_record(job.token), record.dump(1) + "\n");
}

bool phantom_is_there(const LibraryState& state, const LibraryJob& job) {
  try {
    const std::vector<char> bytes = read_file(state.phantom_record(job.phantom), 1 << 16);
    return Json::parse(bytes.begin(), bytes.end()).at("identity") == job.identity;
  } catch (const std::exception&) {
    return false;
  }
}

// What a run on a node made there goes into the library. While another run holds the case it is tried again.
void bring(const LibraryJob& job, const fs::path& from) {
  for (int attempt = 1;; ++attempt) try {
      return publish::bring_case(from, job.library, job.token);
    } catch (const Error& e) {
      if (e.code() != ExitCode::busy || attempt == busy_tries || cancel_requested()) throw;
      poll(nullptr, 0, static_cast<int>(1000 * busy_pause_s));
    }
}

JobResult do_job(const LibraryJob& asked) {
  LibraryJob job = asked;
  std::optional<TemporaryFolder> node;
  if (job.on_node && !job.is_phantom) {
    node.emplace();
    const auto out = std::find(job.arguments.begin(), job.arguments.end(), "--out");
    if (out != job.arguments.end() && out + 1 != job.arguments.end()) *(out + 1) = node->path().string();
  }
  const LibraryState state(job.library);
  const fs::path log = state.log_file(job.name);
  if (!job.phantom.empty() && !phantom_is_there(state, job))
    return {static_cast<int>(ExitCode::no_input), "its phantom " + job.phantom + " could not be made", 0, 0, 0};
  std::error_code ignored;
  if (job.is_phantom) fs::remove(state.phantom_record(job.token), ignored);
  const auto start = Clock::now();
  JobResult result;
  Ended end;
  const std::uint64_t killed_before = memory_kills();
  for (int attempt = 1;; ++attempt) {
    end = run_once(job, state);
    if (end.code != static_cast<int>(ExitCode::busy) || attempt == busy_tries || cancel_requested()) break;
    poll(nullptr, 0, static_cast<int>(1000 * busy_pause_s));
  }
  const json::JobStatus status = json::read_job_status(state.status_file(job.name)).value_or(json::JobStatus{});
  fs::remove(state.status_file(job.name), ignored);
  result.code = end.code;
  result.memory_mb = end.memory_mb;
  result.cpu_s = end.cpu_s;
  if (end.code == 0) {
    clean_log(log, job.series);
    if (job.is_phantom) {
      record_phantom(state, job);
    } else {
      if (node) bring(job, node->path());
      const BuiltCase built = describe_built(job.library / job.token, job.settings_sha256);
      // The plan did not know the series of a phantom that was only just made.
      if (!job.phantom.empty()) write_inputs(state, job.token, built.inputs);
      write_built(state, job.token, built);
    }
  } else {
    if (node) publish::bring_refused(node->path(), job.library, job.token);
    result.reason = reason_of(status, clean_log(log, job.series), job.series);
    if (node) replace_all(result.reason, node->path().string() + "/", "");
    replace_all(result.reason, job.library.string() + "/", "");
    if (result.reason.empty()) result.reason = "failed; its log could not be written";
    if (end.code == stopped) {
      result.code = static_cast<int>(ExitCode::internal);
      result.reason = "stopped after " + to_text(job.time_limit_s) + " s, its time limit";
      result.lack = Lack::time;
    } else if (end.signal == SIGINT || end.signal == SIGTERM || cancel_requested()) {
      result.code = static_cast<int>(ExitCode::cancelled);
    } else if (end.signal) {
      result.code = static_cast<int>(ExitCode::internal);
      result.reason = "killed by signal " + std::to_string(end.signal);
      result.signal = end.signal;
    }
    const bool killed_for_memory = job.on_node && memory_kills() > killed_before;
    if (killed_for_memory) result.reason = "the kernel killed it for want of memory: " + result.reason;
    if (killed_for_memory || status.out_of_memory) result.lack = Lack::memory;
  }
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace

std::string jobs_json(const std::vector<LibraryJob>& jobs) {
  Json all = Json::object();
  for (const LibraryJob& job : jobs) all[job.name] = json_of(job);
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string job_line(const LibraryJob& job) {
  Json json = json_of(job);
  json["name"] = job.name;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

LibraryJob parse_job_line(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    return job_of(json.at("name"), json);
  } catch (const nlohmann::json::exception& e) {
    throw Error(ExitCode::bad_input, "", "job", e.what());
  }
}

std::string event_line(const JobEvent& event) {
  Json json = {{"job", event.name}};
  if (event.is_end) {
    json["code"] = event.result.code;
    json["reason"] = event.result.reason;
    json["seconds"] = event.result.seconds;
    json["memory_mb"] = event.result.memory_mb;
    json["cpu_s"] = event.result.cpu_s;
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

bool parse_event(const std::string& line, JobEvent& event) {
  try {
    const Json json = Json::parse(line);
    event = {};
    event.name = json.at("job");
    event.is_end = json.contains("code");
    if (event.is_end)
      event.result = {json.at("code"), json.at("reason"), json.at("seconds"), json.at("memory_mb"), json.at("cpu_s")};
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

JobResult do_library_job(const LibraryJob& job) {
  JobResult result;
  try {
    result = do_job(job);
  } catch (const Error& e) {
    result.code = static_cast<int>(e.code());
    result.reason = error_text(e, false);
    replace_all(result.reason, printable(job.library.string() + "/"), "");
    result.reason = result.reason.substr(0, max_reason);
  } catch (const std::bad_alloc&) {
    result = {static_cast<int>(ExitCode::internal), "out of memory", 0, 0, 0, Lack::memory};
  }
  return result;
}

bool is_done_already(const LibraryJob& job) {
  const LibraryState state(job.library);
  LibraryJob made = job;
  made.phantom = job.token;
  if (job.is_phantom) return phantom_is_there(state, made);
  const auto built = read_built(state, job.token);
  const auto inputs = read_inputs(state, job.token);
  return built && built->inputs.settings_sha256 == job.settings_sha256 &&
         (!inputs || inputs->series_sha256.empty() || inputs->series_sha256 == built->inputs.series_sha256) &&
         fault_of_built(job.library / job.token, *built).empty();
}

int run_library_job(const std::string& name) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // when Ninja ends, however that happens
  LibraryJob job;
  try {
    job = find_job(name);
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::usage, "", name, "no such job");
  }
  send({name, false, {}});
  const JobResult result = do_library_job(job);
  send({name, true, result});
  return job.keep_going && result.code != static_cast<int>(ExitCode::cancelled) ? 0 : result.code;
}

}  // namespace trephine::library
