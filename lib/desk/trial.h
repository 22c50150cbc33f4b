// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/report.h"
#include "config/yaml_edit.h"
#include "desk/open_case.h"

namespace trephine::desk {

/// What is to be seen before it is saved: the outline of an anatomy with other thresholds or seeds, or a burr hole
/// as it would be placed.
struct TrialWish {
  std::vector<config::YamlChange> changes;  ///< of the case's configuration, as they would be saved
  std::string anatomy;                      ///< whose field is wanted; empty: none
  std::string step;                         ///< a step of an anatomy whose field is wanted as it gives it; empty: none
  std::optional<std::size_t> hole;          ///< which of the case's burr holes is wanted, and no other one
};

/// Computes it as `run` would, with the library's cache of stages, in a thread of its own; the configuration on the
/// disk stays as it is. What was computed is in the cache: a later build of the same lines need not do it again.
class Trial {
 public:
  /// `looked_at` has its scan. Throws what edited_yaml and read_case_config throw.
  Trial(const DeskLibrary& library, DeskCase one, std::shared_ptr<const OpenCase> looked_at, TrialWish wish);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  struct Now {
    bool running = true;
    std::string doing;  ///< the stage that is computed
    double fraction = 0;
    std::string fault;                                    ///< empty: it ended well, or runs
    std::vector<std::pair<std::string, Report>> reports;  ///< of the field's stage, and of each hole by its name
    bool has_field = false;
    /// Of the anatomy's field as it is drawn now, and with what is tried; only with an anatomy.
    std::optional<std::pair<double, double>> volumes_ml;
  };
  Now now() const;
  /// Null until it is there.
  std::shared_ptr<const DrawnField> field() const;

 private:
  class Watcher;
  void work(const TrialWish& wish);

  const DeskLibrary& library_;
  const std::shared_ptr<const OpenCase> looked_at_;
  config::CaseConfig config_;
  mutable std::mutex mutex_;
  Now now_;
  std::shared_ptr<const DrawnField> field_;
  std::atomic<bool> cancel_{false};
  std::thread thread_;
};

}  // namespace trephine::desk
