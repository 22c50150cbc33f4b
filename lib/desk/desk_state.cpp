// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/desk_state.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "cases/load_case.h"
#include "head/landmarks_parts.h"

namespace trephine::desk {
namespace {

constexpr std::size_t max_open = 2;  ///< cases whose voxels stay in memory

}  // namespace

std::shared_ptr<OpenCase> OpenCases::open(const std::string& token, How how) {
  std::shared_ptr<OpenCase> gone;  // ends its thread after the lock is released
  const auto place = [&] {
    return std::find_if(open_.begin(), open_.end(), [&](const auto& one) { return one.first == token; });
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const auto at = place(); at != open_.end()) {
      std::rotate(at, at + 1, open_.end());  // the one that was looked at last stands last
      if (how == How::as_it_is) return open_.back().second;
      gone = open_.back().second;
      if (how == How::anew) open_.pop_back();
    }
  }
  if (how == How::anew) gone.reset();
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

std::shared_ptr<OpenCase> OpenCases::looked_at(const std::string& token) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [name, one] : open_)
    if (name == token && one->scan()) return one;
  throw Error(ExitCode::no_input, "", "case", "is not open");
}

Warnings OpenCases::doubts_of(const std::string& token, const cases::CaseLandmark& given) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Warnings out;
  for (const auto& [name, one] : open_)
    if (name == token)
      for (const cases::CaseLandmark& l : one->now().landmarks)
        if (l.name == given.name && l.source != "given")
          if (const auto doubt = head::doubt_given(given, head::FoundPoint{l.position_mm, l.confidence}))
            out.push_back(*doubt);
  return out;
}

void OpenCases::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  open_.clear();
}

void Trials::start(DeskLibrary& library, const std::string& token, std::shared_ptr<const OpenCase> looked_at,
                   TrialWish wish) {
  end();
  auto made = std::make_shared<Trial>(library, library.find(token), std::move(looked_at), std::move(wish));
  const std::lock_guard<std::mutex> lock(mutex_);
  trial_ = std::move(made);
  token_ = token;
}

std::shared_ptr<Trial> Trials::of(const std::string& token) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!trial_ || token_ != token) throw Error(ExitCode::no_input, "", "case", "nothing was tried of it");
  return trial_;
}

void Trials::end() {
  std::shared_ptr<Trial> gone;  // ends its thread after the lock is released
  const std::lock_guard<std::mutex> lock(mutex_);
  gone = std::move(trial_);
}

void Comparisons::keep(std::shared_ptr<const ComparedSurfaces> compared) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_ = std::move(compared);
}

std::shared_ptr<const ComparedSurfaces> Comparisons::last() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_;
}

std::shared_ptr<const ComparedSurfaces> Comparisons::built(const DeskLibrary& library, const std::string& token) {
  const std::filesystem::path folder = library.options().library / token;
  const std::string state = sha256_of_file(folder / "case.json");
  const std::lock_guard<std::mutex> lock(built_mutex_);  // several planes ask at once, and one of them reads
  if (built_ && built_->token == token && built_->state == state) return built_;
  auto made = std::make_shared<ComparedSurfaces>();
  made->token = token;
  made->state = state;
  put_surfaces(cases::load_case(folder), made->is);
  built_ = std::move(made);
  return built_;
}

}  // namespace trephine::desk
