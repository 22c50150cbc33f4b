// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_needs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/log.h"
#include "base/memory_budget.h"
#include "base/text.h"

namespace trephine::publish {

// Measured values. Memory grows with the area of the surfaces rather than with the volume: with nine anatomies 317 MB
// at 2.9 million voxels, 365 to 618 at 6.3, 513 at 9.4, 871 to 937 at 28, 824 to 1,045 at 46 and 1,022 to 1,149 at 50;
// with a skull alone 256 at 6.3, 379 to 474 at 28 and 563 at 50. A case: 2 MB at 16,000 voxels, 37 MB at 50 million,
// with a page (6 MB) and a CT (noise hardly compresses) 47, 65, 80 and 82 MB at 24, 28, 42 and 46. Its stages in the
// cache, fields (growing with volume) and surfaces (growing with area): 80 MB at 6.3 million, 560 MB at 50 million.
CaseNeeds case_needs(std::uint64_t voxels_count, std::size_t anatomies_count, bool with_ct, bool with_page) {
  const double mega = static_cast<double>(voxels_count) / 1e6;
  const double ct_mb = with_ct ? 0.85 * mega : 0, page_mb = with_page ? std::min(6.0, 1 + mega) : 0;
  const double memory_mb = 80 + std::sqrt(mega) * (65 + 8.3 * static_cast<double>(anatomies_count));
  return {memory_mb, 3 + 0.8 * mega + ct_mb + page_mb, 6 * mega + 20 * std::cbrt(mega * mega)};
}

std::uint64_t voxels_by_report(const Report& scan) {
  const ParameterValue* size = scan.find("size");
  unsigned long long n[3] = {0, 0, 0};
  if (!size || std::sscanf(std::get<std::string>(*size).c_str(), "%llux%llux%llu", &n[0], &n[1], &n[2]) != 3) return 0;
  return n[0] * n[1] * n[2];
}

std::string megabytes_text(double mb) {
  const auto rounded = [](double v) { return to_text(std::round(v * 10) / 10); };
  return mb < 1000 ? rounded(mb) + " MB" : rounded(mb / 1000) + " GB";
}

void require_disk(const std::filesystem::path& folder, double need_mb) {
  std::error_code error;
  const double free_mb = static_cast<double>(std::filesystem::space(folder, error).available) / 1e6;
  if (error || need_mb <= free_mb) return;
  throw Error(ExitCode::cannot_create, folder.string(), "disk",
              megabytes_text(need_mb) + " are needed by estimate, " + megabytes_text(free_mb) +
                  " are free; --no-check-disk begins all the same");
}

void tell_memory(const std::string& case_token, std::uint64_t voxels_count, double need_mb) {
  if (voxels_count < 1'000'000) return;
  const double there_mb = static_cast<double>(available_memory_bytes()) / 1e6;
  const std::string text = case_token + ": about " + megabytes_text(10 * std::round(need_mb / 10)) +
                           " of memory by estimate, " + megabytes_text(there_mb) + " are available";
  if (need_mb <= there_mb)
    log_line(text);
  else
    log_warning(text + ": end other programs, or take larger voxels (`--set resample.spacing_mm=[1,1,1]`)");
}

}  // namespace trephine::publish
