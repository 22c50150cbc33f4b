// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of publish: a run's observer between the stages and whoever looks on.
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "pipeline/executor.h"

namespace trephine::publish {

/// Tells at once what the scan is not suited for: a run that is refused later may be refused because of it. Calls
/// `scan_is_read` with the figures of the import; what that throws ends the run. All else goes on to `observer`, the
/// plan with the seconds of publishing: those of an earlier run, else a share of what the stages take.
class EarlyWarnings : public pipeline::RunObserver {
 public:
  EarlyWarnings(pipeline::RunObserver& observer, std::string token, const std::map<std::string, double>& seconds_before,
                std::function<void(const dicom::ImportFigures&)> scan_is_read);
  void planned(const std::vector<std::pair<std::string, double>>& expected_s) override;
  void publishing() override { observer_.publishing(); }
  void started(const std::string& node) override { observer_.started(node); }
  void progressed(const std::string& node, double fraction) override { observer_.progressed(node, fraction); }
  void finished(const std::string& node, bool cached, double seconds, const stages::StageOutcome& made) override;

 private:
  pipeline::RunObserver& observer_;
  const std::string token_;
  std::optional<double> publishing_before_s_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  const std::function<void(const dicom::ImportFigures&)> scan_is_read_;
};

}  // namespace trephine::publish
