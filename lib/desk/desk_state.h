// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of desk: what it holds, each part with its own lock, and the requests that it answers.
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "cases/load_case.h"
#include "desk/build_runner.h"
#include "desk/desk_library.h"
#include "desk/live_edit.h"
#include "desk/message.h"
#include "desk/open_case.h"
#include "desk/page_shelf.h"
#include "desk/trial.h"
#include "surface/trimesh.h"

namespace trephine::desk {

/// The cases whose voxels stay in memory. It may be called from several threads.
class OpenCases {
 public:
  /// `behind`: the old scan and fields are shown while new ones are computed; only where the scan did not change.
  enum class How { as_it_is, anew, behind };

  explicit OpenCases(DeskLibrary& library) : library_(library) {}
  std::shared_ptr<OpenCase> open(const std::string& token, How how);
  /// Of a case that was opened before; throws Error 66 where it was not, or its scan is not there yet.
  std::shared_ptr<OpenCase> looked_at(const std::string& token);
  /// What a run would warn of a landmark that is given at that place, of a case that is open. Where it was given
  /// before, it is not known where it is found, so the run alone says it.
  Warnings doubts_of(const std::string& token, const cases::CaseLandmark& given);
  void clear();

 private:
  DeskLibrary& library_;
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::shared_ptr<OpenCase>>> open_;  ///< the one looked at last is the last
};

/// What is tried before it is saved, one at a time. It may be called from several threads.
class Trials {
 public:
  /// Ends the one before. Throws what Trial throws.
  void start(DeskLibrary& library, const std::string& token, std::shared_ptr<const OpenCase> looked_at, TrialWish wish);
  /// Throws Error 66 where nothing was tried of that case.
  std::shared_ptr<Trial> of(const std::string& token);
  void end();

 private:
  std::mutex mutex_;
  std::shared_ptr<Trial> trial_;
  std::string token_;
};

/// The surfaces of a case before its last rebuild and now, by anatomy.
struct ComparedSurfaces {
  std::string token, state;  ///< state: SHA-256 of case.json, of built surfaces alone
  std::map<std::string, surface::TriMesh> was, is;
};

/// Surfaces that are drawn on the planes of a scan. It may be called from several threads.
class Comparisons {
 public:
  void keep(std::shared_ptr<const ComparedSurfaces> compared);
  /// Null where nothing was compared.
  std::shared_ptr<const ComparedSurfaces> last();
  /// The surfaces that the case holds now, read once for each state of it. Throws what load_case throws.
  std::shared_ptr<const ComparedSurfaces> built(const DeskLibrary& library, const std::string& token);

 private:
  std::mutex mutex_, built_mutex_;
  std::shared_ptr<const ComparedSurfaces> last_, built_;
};

struct DeskState {
  explicit DeskState(DeskOptions options)
      : library(std::move(options)),
        builder(library.options()),
        cases(library),
        pages(library.options().port, library.options().page_port) {}

  DeskLibrary library;
  BuildRunner builder;
  OpenCases cases;
  Comparisons comparisons;
  Trials trials;
  LiveEdit live;
  PageShelf pages;
};

/// What is answered at a path, by its method. What a handler throws says what is wrong (server.h makes an answer of
/// it).
struct Route {
  const char* method;
  Reply (*answer)(DeskState&, const Request&);
};
using Routes = std::map<std::string, Route>;

// Each in the file of its name: routes_library.cpp.
Routes library_routes();
Routes compare_routes();
Routes look_routes();
Routes change_routes();
Routes scene_routes();
Routes edit_routes();
Routes new_case_routes();
Routes drop_routes();

/// Keeps what the case is now beside the library, until it is kept again, for a comparison with what it becomes.
void keep_before(const DeskLibrary& library, const std::string& token);

/// Removes from beside LIBRARY.yaml what an earlier desk left: scans that were dropped more than a day ago and that no
/// case uses, drops that never were whole, texts that were to be judged.
void remove_unused_drops(const DeskOptions& options);

/// Adds the surfaces of a case that was read.
void put_surfaces(const cases::LoadedCase& loaded, std::map<std::string, surface::TriMesh>& to);

}  // namespace trephine::desk
