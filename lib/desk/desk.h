// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "desk/desk_library.h"
#include "desk/message.h"

namespace trephine::desk {

struct DeskState;

/// The technician's desk (docs/how-to/desk.md): answers the requests of its pages. It is a consumer of the rooms below
/// as the commands are, and computes nothing of its own. answer() may be called from several threads.
class Desk {
 public:
  explicit Desk(DeskOptions options);
  ~Desk();
  /// What it throws says what is wrong (server.h makes an answer of it).
  Reply answer(const Request& request);
  /// The same for the server of pages (page_shelf.h).
  Reply page(const Request& request);
  /// Ends what runs: a build, cases that are being opened.
  void stop();

 private:
  std::unique_ptr<DeskState> state_;
};

}  // namespace trephine::desk
