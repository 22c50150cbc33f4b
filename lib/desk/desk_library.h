// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "config/config.h"
#include "library/plan.h"

namespace trephine::desk {

struct DeskOptions {
  std::filesystem::path library;  ///< the folder with the cases
  std::filesystem::path config;   ///< LIBRARY.yaml; empty: cases are looked at, and nothing is changed or built
  std::vector<std::filesystem::path> roots;  ///< further folders that paths may lead to
  int port = 0, page_port = 0;               ///< of the desk, and of the pages of cases
  std::string program_version;               ///< as `library build` records it
};

/// A case as LIBRARY.yaml has it.
struct DeskCase {
  std::string token;
  library::LibraryCase entry;
  std::filesystem::path series;
  std::vector<std::string> at;        ///< where LIBRARY.yaml lists it: cases, 3
  std::filesystem::path config;       ///< what a change is written to
  std::filesystem::path copied_from;  ///< not empty: `config` is not there yet, and begins as a copy of this file
  std::string fixed;                  ///< why nothing of it can be changed; empty: it can be
  std::vector<std::string> reasons;   ///< why it would be built; empty: it is up to date
  std::string fault;                  ///< why it cannot be built

  /// The file that says now what the case is made of.
  const std::filesystem::path& text_file() const { return copied_from.empty() ? config : copied_from; }
  /// The folder beside the configuration with what was done by hand: patches and the journal.
  std::filesystem::path hand_folder() const { return config.parent_path() / (token + ".desk"); }
};

/// What the desk knows of its library. It may be called from several threads.
class DeskLibrary {
 public:
  explicit DeskLibrary(DeskOptions options) : options_(std::move(options)) {}
  const DeskOptions& options() const { return options_; }

  /// Finds anew which cases there are, and which are stale and why (library/plan.h); nothing is written. Throws what
  /// read_library_config and make_plan throw; 64 where there is no LIBRARY.yaml.
  std::vector<DeskCase> plan();
  /// The case as the last plan has it, or as a new one does. Throws Error 66 where there is none, 65 where
  /// a symbolic link stands for, or lies in, the folder with what was done by hand.
  DeskCase find(const std::string& token);
  /// The overrides with which `library build` reads the case's configuration.
  config::ConfigOverrides overrides_of(const DeskCase& one) const;
  /// Where an uploaded or chosen path may lie: the root of LIBRARY.yaml and the further roots.
  std::vector<std::filesystem::path> roots() const;

 private:
  std::vector<DeskCase> planned_;
  const DeskOptions options_;
  std::mutex mutex_;
};

}  // namespace trephine::desk
