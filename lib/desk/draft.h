// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace trephine::desk {

/// A text beside a configuration, under a name of its own, that is gone with the object: so the reader of
/// configurations judges it where its paths mean what they will mean, and nothing is written for good before that.
class Draft {
 public:
  Draft(const std::filesystem::path& target, const std::string& text);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// Calls read(file); what it throws names the target.
  template <class Read>
  auto judged(const Read& read) const {
    try {
      return read(file_);
    } catch (const ErrorList& list) {
      std::vector<Error> all;
      for (const Error& e : list.all()) all.push_back(renamed(e));
      throw ErrorList(all);
    } catch (const Error& e) {
      throw renamed(e);
    }
  }

 private:
  Error renamed(const Error& e) const;
  std::filesystem::path file_, name_;
};

}  // namespace trephine::desk
