// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/early_warnings.h"

#include "base/log.h"
#include "publish/run_case.h"
#include "publish/series_hashes.h"
#include "stages/import.h"

namespace trephine::publish {

EarlyWarnings::EarlyWarnings(pipeline::RunObserver& observer, std::string token,
                             const std::map<std::string, double>& seconds_before,
                             std::function<void(const dicom::ImportFigures&)> scan_is_read)
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

void EarlyWarnings::finished(const std::string& node, bool cached, double seconds, const stages::StageOutcome& made) {
  if (const auto* type = stages::find_stage(node); type && type->warns_at_once())
    for (const Warning& w : made.warnings) log_warning(token_ + ": " + node + ": " + to_text(w));
  observer_.finished(node, cached, seconds, made);
  if (node == pipeline::import_name()) scan_is_read_(result_as<stages::ImportStageResult>(made.result).scan);
}

}  // namespace trephine::publish
