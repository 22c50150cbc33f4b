// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/desk.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "cases/case.h"
#include "desk/json_reply.h"

namespace trephine::desk {
namespace {

constexpr std::size_t max_open = 2;  ///< cases whose voxels stay in memory

}  // namespace

int number_of(const Request& request, const std::string& name) {
  const auto number = parse_integer(request.value(name));
  if (!number || *number < -1000000 || *number > 1000000)
    throw Error(ExitCode::usage, "", name, "must be a whole number");
  return static_cast<int>(*number);
}

double real_of(const Request& request, const std::string& name) {
  const auto number = parse_number(request.value(name));
  if (!number) throw Error(ExitCode::usage, "", name, "must be a number");
  return *number;
}

Desk::Desk(DeskOptions options) : library_(std::move(options)), builder_(library_.options()) {}

const std::map<std::string, Desk::Route>& Desk::routes() {
  static const std::map<std::string, Route> all = {
      {"", {"GET", &Desk::page}},
      {"icon", {"GET", &Desk::icon}},
      {"api/library", {"GET", &Desk::library_cases}},
      {"api/plan", {"GET", &Desk::plan}},
      {"api/build", {"POST", &Desk::build}},
      {"api/stop", {"POST", &Desk::stop_build}},
      {"api/status", {"GET", &Desk::build_status}},
      {"api/log", {"GET", &Desk::log}},
      {"api/lessons", {"GET", &Desk::lessons}},
      {"api/compare", {"GET", &Desk::compare}},
      {"api/cut", {"GET", &Desk::cut}},
      {"api/approve", {"POST", &Desk::approve}},
      {"api/open", {"GET", &Desk::open}},
      {"api/slice", {"GET", &Desk::slice}},
      {"api/field", {"GET", &Desk::field}},
      {"api/plane", {"GET", &Desk::plane}},
      {"api/grow", {"GET", &Desk::grow}},
      {"api/between", {"POST", &Desk::between}},
      {"api/case", {"GET", &Desk::case_info}},
      {"api/landmark", {"POST", &Desk::landmark}},
      {"api/holes", {"POST", &Desk::holes}},
      {"api/scene", {"POST", &Desk::scene}},
      {"api/value", {"POST", &Desk::value}},
      {"api/try", {"POST", &Desk::try_change}},
      {"api/tried", {"GET", &Desk::tried}},
      {"api/patch", {"POST", &Desk::patch}},
      {"api/switch", {"POST", &Desk::switch_patch_route}},
      {"api/snake", {"POST", &Desk::snake}},
      {"api/try_edit", {"POST", &Desk::try_edit}},
      {"api/edit", {"POST", &Desk::edit}},
      {"api/draft", {"GET", &Desk::draft}},
      {"api/keep", {"POST", &Desk::keep_draft}},
      {"api/folders", {"GET", &Desk::folders}},
      {"api/series", {"GET", &Desk::series}},
      {"api/picture", {"GET", &Desk::series_picture}},
      {"api/new", {"POST", &Desk::new_case}},
      {"api/drop", {"POST", &Desk::drop}},
      {"api/dropped", {"POST", &Desk::dropped}},
  };
  return all;
}

Reply Desk::answer(const Request& request) {
  // Every case is named by its token alone, wherever a request names one; so no name of a case is a path.
  if (request.query.count("case")) cases::validate_case_token(request.value("case"), ExitCode::usage);
  if (request.path.rfind("case/", 0) == 0) {
    if (request.method != "GET") throw Error(ExitCode::usage, "", "method", "must be GET");
    return report_file(request);
  }
  const auto found = routes().find(request.path);
  if (found == routes().end()) throw Error(ExitCode::no_input, "", "", "the desk has no such page");
  if (found->second.method != request.method)
    throw Error(ExitCode::usage, "", "method", std::string("must be ") + found->second.method);
  return (this->*found->second.handler)(request);
}

void Desk::stop() {
  builder_.stop();
  std::shared_ptr<Trial> gone;
  const std::lock_guard<std::mutex> lock(mutex_);
  gone = std::move(trial_);
  live_.forget();
  open_.clear();
}

std::shared_ptr<OpenCase> Desk::opened(const std::string& token, Opening how) {
  std::shared_ptr<OpenCase> gone;  // ends its thread after the lock is released
  const auto place = [&] {
    return std::find_if(open_.begin(), open_.end(), [&](const auto& one) { return one.first == token; });
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const auto at = place(); at != open_.end()) {
      std::rotate(at, at + 1, open_.end());  // the one that was looked at last stands last
      if (how == Opening::as_it_is) return open_.back().second;
      gone = open_.back().second;
      if (how == Opening::anew) open_.pop_back();
    }
  }
  if (how == Opening::anew) gone.reset();
  auto made = std::make_shared<OpenCase>(library_, library_.find(token), gone.get());
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const auto at = place(); at != open_.end()) open_.erase(at);
  open_.emplace_back(token, made);
  if (open_.size() > max_open) {
    gone = open_.front().second;
    open_.erase(open_.begin());
  }
  return made;
}

std::shared_ptr<OpenCase> Desk::looked_at_case(const std::string& token) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [name, one] : open_)
    if (name == token && one->scan()) return one;
  throw Error(ExitCode::no_input, "", "case", "is not open");
}

std::shared_ptr<Trial> Desk::trial_of(const std::string& token) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!trial_ || trial_of_ != token) throw Error(ExitCode::no_input, "", "case", "nothing was tried of it");
  return trial_;
}

}  // namespace trephine::desk
