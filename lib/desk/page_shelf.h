// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

#include "desk/message.h"

namespace trephine::desk {

/// The pages of cases, on their way into a frame of the desk. What lies in a case's report folder may be a stranger's
/// page, so it is never shown: the page is made anew of what case.json names. It comes from an origin of its own (a
/// port of its own), under a path that nobody can guess and that gives this page, once, and nothing else. May be called
/// from several threads.
class PageShelf {
 public:
  /// `desk_port`: whose frames may hold a page. `page_port`: at which pages are served.
  PageShelf(int desk_port, int page_port) : desk_port_(desk_port), page_port_(page_port) {}

  /// Makes the page of a case and returns the address at which it can be had once. Throws what make_case_page throws,
  /// and Error 75 where another page was asked for while this one waited for its turn.
  std::string put(const std::filesystem::path& case_folder);
  /// The page at a path that put() gave, for the first who asks. Throws Error 66 where there is none.
  Reply take(const std::string& path);

 private:
  const int desk_port_, page_port_;
  std::atomic<std::uint64_t> asked_{0};
  std::mutex making_, mutex_;
  std::deque<std::pair<std::string, std::string>> waiting_;  ///< pages by their paths, the newest last
};

}  // namespace trephine::desk
