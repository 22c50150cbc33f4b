// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/early_warnings.h"

#include "base/log.h"
#include "publish/run_case.h"
#include "publish/series_hashes.h"

namespace trephine::publish {

bool tells_at_once(const std::string& node) {
  const stages::StageType* type = stages::find_stage(node);
  return type && type->tells_at_once;
}

EarlyWarnings::EarlyWarnings(pipeline::RunObserver& observer, std::string token,
                             const std::map<std::string, double>& seconds_before,
                             std::function<void(const Report&)> scan_is_read)
    : observer_(observer), token_(std::move(token)), scan_is_read_(std::move(scan_is_read)) {
  if (const auto before = seconds_before.find(publishing_step); before != seconds_before.end())
    publishing_before_s_ = before->second;
}

void EarlyWarnings::planned(const std::vector<std::pair<std::string, double>>& expected_s) {
  auto all = expected_s;
  // 0.77 to 1.17 times what it took for seven heads, a chest and a lumbar spine, with page and pictures.
  double stages_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  for (const auto& [node, seconds] : expected_s) stages_s += seconds;
  all.emplace_back(publishing_step, publishing_before_s_.value_or(0.8 + 0.24 * stages_s));
  observer_.planned(all);
}

void EarlyWarnings::finished(const std::string& node, const std::string& how, double seconds, const Report& report) {
  if (tells_at_once(node))
    for (const std::string& w : report.warnings) log_warning(token_ + ": " + node + ": " + w);
  observer_.finished(node, how, seconds, report);
  if (node == pipeline::import_name()) scan_is_read_(report);
}

}  // namespace trephine::publish
