// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <sys/types.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "desk/desk_library.h"
#include "json/job_status.h"

namespace trephine::desk {

/// Runs `trephine library build` as a process of its own: so it is stopped as by Ctrl-C, and a desk that dies takes it
/// along; the next build goes on where it was. One at a time.
class BuildRunner {
 public:
  explicit BuildRunner(const DeskOptions& options);
  ~BuildRunner();
  BuildRunner(const BuildRunner&) = delete;
  BuildRunner& operator=(const BuildRunner&) = delete;

  struct Status {
    bool running = false, ever = false, stopping = false;
    int code = 0;                    ///< of the last build
    double seconds = 0;              ///< since it began, or that it took
    std::vector<std::string> only;   ///< the cases that it was asked for; empty: all
    std::vector<std::string> lines;  ///< what it said
    Named<json::JobStatus> at_work;  ///< cases and phantoms, and how far each is
  };
  Status status() const;

  /// Throws Error 75 where a build runs, 64 where there is no LIBRARY.yaml.
  void start(const std::vector<std::string>& only);
  /// As Ctrl-C: jobs end, and the cases are the old or the new ones.
  void stop();

 private:
  void work();
  std::filesystem::path log_file() const;

  const DeskOptions& options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool asked_ = false, end_ = false;
  Status status_;
  double begin_s_ = 0;
  pid_t pid_ = 0;
  std::thread thread_;
};

}  // namespace trephine::desk
