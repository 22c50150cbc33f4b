// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "desk/build_runner.h"
#include "desk/desk_library.h"
#include "desk/live_edit.h"
#include "desk/message.h"
#include "desk/open_case.h"
#include "desk/trial.h"
#include "surface/trimesh.h"

namespace trephine::desk {

/// The technician's desk (docs/desk.md): answers the requests of its pages. It is a consumer of the rooms below as the
/// commands are, and computes nothing of its own. answer() may be called from several threads.
class Desk {
 public:
  explicit Desk(DeskOptions options);
  /// What it throws says what is wrong (server.h makes an answer of it).
  Reply answer(const Request& request);
  /// Ends what runs: a build, cases that are being opened.
  void stop();

 private:
  using Handler = Reply (Desk::*)(const Request&);
  struct Route {
    const char* method;
    Handler handler;
  };
  static const std::map<std::string, Route>& routes();

  // routes_library.cpp
  Reply page(const Request&);
  Reply icon(const Request&);
  Reply report_file(const Request&);
  Reply library_cases(const Request&);
  Reply plan(const Request&);
  Reply build(const Request&);
  Reply stop_build(const Request&);
  Reply build_status(const Request&);
  Reply log(const Request&);
  Reply approve(const Request&);
  Reply lessons(const Request&);
  // routes_compare.cpp
  Reply compare(const Request&);
  Reply cut(const Request&);
  // routes_look.cpp
  Reply open(const Request&);
  Reply slice(const Request&);
  Reply field(const Request&);
  Reply plane(const Request&);
  Reply grow(const Request&);
  Reply between(const Request&);
  // routes_change.cpp
  Reply case_info(const Request&);
  Reply landmark(const Request&);
  Reply holes(const Request&);
  Reply value(const Request&);
  Reply try_change(const Request&);
  Reply tried(const Request&);
  Reply patch(const Request&);
  Reply switch_patch_route(const Request&);
  Reply draft(const Request&);
  Reply keep_draft(const Request&);
  // routes_scene.cpp
  Reply scene(const Request&);
  // routes_edit.cpp
  Reply snake(const Request&);
  Reply try_edit(const Request&);
  Reply edit(const Request&);
  // routes_new.cpp
  Reply folders(const Request&);
  Reply series(const Request&);
  Reply series_picture(const Request&);
  Reply new_case(const Request&);
  // routes_drop.cpp
  Reply drop(const Request&);
  Reply dropped(const Request&);

  /// `behind`: the old scan and fields are shown while new ones are computed; only where the scan did not change.
  enum class Opening { as_it_is, anew, behind };
  std::shared_ptr<OpenCase> opened(const std::string& token, Opening how);
  /// Of a case that was opened before; throws Error 66 where it was not, or its scan is not there yet.
  std::shared_ptr<OpenCase> looked_at(const Request& request) { return looked_at_case(request.value("case")); }
  std::shared_ptr<OpenCase> looked_at_case(const std::string& token);
  /// Throws Error 66 where nothing was tried of that case.
  std::shared_ptr<Trial> trial_of(const std::string& token);

  DeskLibrary library_;
  BuildRunner builder_;
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::shared_ptr<OpenCase>>> open_;  ///< the one looked at last is the last
  /// The surfaces of a case before its last rebuild and now, by anatomy.
  struct Compared {
    std::string token, state;  ///< state: SHA-256 of case.json, of built surfaces alone
    std::map<std::string, surface::TriMesh> was, is;
  };
  std::shared_ptr<const Compared> compared_;
  /// Throws what load_case throws.
  std::shared_ptr<const Compared> built_surfaces(const std::string& token);
  std::mutex built_mutex_;
  std::shared_ptr<const Compared> built_;
  std::shared_ptr<Trial> trial_;
  std::string trial_of_;
  LiveEdit live_;
};

/// Keeps what the case is now beside the library, until it is kept again, for a comparison with what it becomes.
void keep_before(const DeskLibrary& library, const std::string& token);

}  // namespace trephine::desk
