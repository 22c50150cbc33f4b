// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "base/progress.h"

namespace trephine::stages {

/// What several stages of one run make alike of the same data, made once and kept as long as the run: four zones of a
/// head are cut out of one cranial cavity by one place of the template. Stages ask for it by StageInputs::once.
class SharedWork {
 public:
  /// What `make` gives, or what it gave for the first caller with this key. Who asks while it is being made waits.
  /// Where `make` throws, its caller alone gets that: nothing is kept, and the next one makes it anew. Throws
  /// Cancelled.
  std::shared_ptr<const void> once(const std::string& key, const Progress& progress,
                                   const std::function<std::shared_ptr<const void>()>& make);

 private:
  struct Entry {
    bool made = false;
    std::shared_ptr<const void> value;
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Entry> entries_;
};

}  // namespace trephine::stages
