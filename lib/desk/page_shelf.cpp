// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/page_shelf.h"

#include "base/error.h"
#include "base/progress.h"
#include "desk/gate.h"
#include "page/case_page.h"

namespace trephine::desk {
namespace {

constexpr std::size_t most_waiting = 4;  // a frame that was left before it was filled never asks

}  // namespace

std::string PageShelf::put(const std::filesystem::path& case_folder) {
  const std::uint64_t mine = ++asked_;
  const std::lock_guard<std::mutex> one_at_a_time(making_);
  if (mine != asked_)
    throw Error(ExitCode::busy, "", "case", "gave way to the page of a case that was opened after it");
  std::string page = page::make_case_page(case_folder, {}, Progress({}, &cancel_requested()));
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.emplace_back(random_secret(), std::move(page));
  if (waiting_.size() > most_waiting) waiting_.pop_front();
  return "http://127.0.0.1:" + std::to_string(page_port_) + "/" + waiting_.back().first;
}

Reply PageShelf::take(const std::string& path) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto one = waiting_.begin(); one != waiting_.end(); ++one) {
    if (!same_secret(one->first, path)) continue;
    Reply reply;
    reply.content_type = "text/html; charset=utf-8";
    reply.body = std::move(one->second);
    reply.policy =
        "sandbox allow-scripts; " + page::case_page_policy() +
        "; connect-src 'none'; webrtc 'block'; frame-ancestors http://127.0.0.1:" + std::to_string(desk_port_);
    waiting_.erase(one);
    return reply;
  }
  throw Error(ExitCode::no_input, "", "", "there is no such page");
}

}  // namespace trephine::desk
