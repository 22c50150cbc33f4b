// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/build_runner.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>

#include "base/error.h"
#include "base/spawn.h"
#include "base/text.h"
#include "base/write_file.h"
#include "library/build.h"
#include "library/library_state.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

double clock_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr std::size_t max_lines = 400;

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> out;
  std::ifstream in(file, std::ios::binary);
  for (std::string line; std::getline(in, line);) {
    out.push_back(printable(line));
    if (out.size() > max_lines) out.erase(out.begin());
  }
  return out;
}

/// The jobs that this build began and that have not ended: a status of before it is of a build that was killed.
Named<json::JobStatus> at_work(const library::LibraryState& state, fs::file_time_type since) {
  Named<json::JobStatus> out;
  std::error_code error;
  for (fs::directory_iterator it(state.folder() / "logs", error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->path().extension() != library::LibraryState::status_suffix) continue;
    if (it->last_write_time(ignored) < since) continue;
    const std::string job = it->path().stem().string();
    if (const auto status = json::read_job_status(it->path())) out.emplace_back(job.substr(job.find('.') + 1), *status);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return out;
}

}  // namespace

BuildRunner::BuildRunner(const DeskOptions& options) : options_(options), thread_([this] { work(); }) {}

BuildRunner::~BuildRunner() {
  stop();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

fs::path BuildRunner::log_file() const { return options_.library / ".library" / "desk-build.log"; }

BuildRunner::Status BuildRunner::status() const {
  Status out;
  double begin_s = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    out = status_;
    begin_s = begin_s_;
  }
  out.lines = out.ever ? lines_of(log_file()) : std::vector<std::string>();
  if (out.running) {
    out.seconds = clock_s() - begin_s;
    const auto since = fs::file_time_type::clock::now() - std::chrono::milliseconds(int64_t(out.seconds * 1000));
    out.at_work = at_work(library::LibraryState(options_.library), since);
  }
  return out;
}

void BuildRunner::start(const std::vector<std::string>& only) {
  if (options_.config.empty())
    throw Error(ExitCode::usage, "", "--config", "is needed: the LIBRARY.yaml that says what the library is made of");
  const std::lock_guard<std::mutex> lock(mutex_);
  if (status_.running || asked_) throw Error(ExitCode::busy, "", "", "a build runs already");
  asked_ = true;
  status_ = {};
  status_.ever = status_.running = true;
  status_.only = only;
  begin_s_ = clock_s();
  wake_.notify_all();
}

void BuildRunner::stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (pid_ > 0 && !status_.stopping) {
    status_.stopping = true;
    ::kill(pid_, SIGINT);
  }
}

void BuildRunner::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return asked_ || end_; });
    if (end_) return;
    asked_ = false;
    SpawnRequest request;
    request.program = own_program().string();
    request.argv = {"trephine", "library", "build", options_.config.string(), "--out", options_.library.string()};
    for (const std::string& token : status_.only) request.argv.insert(request.argv.end(), {"--case", token});
    for (const fs::path& root : options_.roots) request.argv.insert(request.argv.end(), {"--root", root.string()});
    request.output = log_file();
    request.own_group = true;
    int code = static_cast<int>(ExitCode::internal);
    try {
      make_private_folder(options_.library / ".library");
      pid_ = spawn(request);
      for (;;) {
        lock.unlock();
        const Ended ended = wait_for(pid_, 0.2);
        lock.lock();
        if (ended.ended) {
          code = ended.code;
          break;
        }
        if (end_ && !status_.stopping) ::kill(pid_, SIGINT);
      }
    } catch (const Error&) {  // status() tells the code
    }
    pid_ = 0;
    status_.running = status_.stopping = false;
    status_.code = code;
    status_.seconds = clock_s() - begin_s_;
  }
}

}  // namespace trephine::desk
