// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/job_status.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"

namespace trephine::json {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobStatus::Stage, name, fraction)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobStatus, fraction, stages, errors, out_of_memory)

namespace {
constexpr std::uint64_t max_bytes = 1 << 20;
}

void write_job_status(const std::filesystem::path& file, const JobStatus& status) {
  try {
    const nlohmann::json json = status;
    write_file(file, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n", Links::replaced);
  } catch (const std::exception&) {  // of the disk, or for want of memory
  }
}

std::optional<JobStatus> read_job_status(const std::filesystem::path& file) {
  try {
    const std::vector<char> bytes = read_file(file, max_bytes);
    return nlohmann::json::parse(bytes.begin(), bytes.end()).get<JobStatus>();
  } catch (const Error&) {
  } catch (const nlohmann::json::exception&) {
  }
  return std::nullopt;
}

}  // namespace trephine::json
