// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/shared_work.h"

#include <chrono>

namespace trephine::stages {

std::shared_ptr<const void> SharedWork::once(const std::string& key, const Progress& progress,
                                             const std::function<std::shared_ptr<const void>()>& make) {
  {
    std::unique_lock<std::mutex> lock(mutex_);
    for (auto found = entries_.find(key); found != entries_.end(); found = entries_.find(key)) {
      if (found->second.made) return found->second.value;
      progress.check();
      changed_.wait_for(lock, std::chrono::milliseconds(100));
    }
    entries_[key];
  }
  std::shared_ptr<const void> value;
  try {
    value = make();
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.erase(key);
    changed_.notify_all();
    throw;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_[key] = {true, value};
  changed_.notify_all();
  return value;
}

}  // namespace trephine::stages
