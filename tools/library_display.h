// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "library/build.h"

namespace trephine::tools {

/// Shows a library build on the terminal: one line that is repainted (cases done, failed and in work with their stages,
/// time left), and a line that stays for each case that ended. Elsewhere than on a terminal it writes only the lines
/// that stay; with `quiet` none.
class LibraryDisplay : public library::LibraryObserver {
 public:
  explicit LibraryDisplay(bool quiet);
  ~LibraryDisplay() override;
  void planning(double fraction) override;
  void began(int jobs) override;
  void started(const std::string& job) override;
  void working(const Named<json::JobStatus>& running, int done, int failed, double seconds_left) override;
  void finished(const std::string& job, const library::JobResult& result) override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trephine::tools
