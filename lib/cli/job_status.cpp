// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/job_status.h"

#include <cstdlib>
#include <string>

namespace trephine::cli {
namespace {

const std::string& status_file() {
  static const std::string file = [] {
    const char* named = std::getenv(json::job_status_variable);
    std::string out = named ? named : "";
    unsetenv(json::job_status_variable);
    return out;
  }();
  return file;
}

}  // namespace

bool has_job_status() { return !status_file().empty(); }

void write_job_status(const json::JobStatus& status) {
  if (has_job_status()) json::write_job_status(status_file(), status);
}

}  // namespace trephine::cli
