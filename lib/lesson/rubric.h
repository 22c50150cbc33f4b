// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/params.h"

namespace trephine {

/// A rubric says by which limits a lesson is scored. It is data: configs/rubrics/*.yaml, which `trephine rubric`
/// compiles to the JSON that `trephine-sim score` reads. Every limit says where it comes from.

/// One limit; its unit is the end of its name.
struct RubricLimit {
  enum class From { none, thesis, ours };
  double limit = 0;
  From from = From::none;
  std::string why;
  template <class V>
  static void describe(V& v) {
    using P = RubricLimit;
    v.number(&P::limit, "limit", Range{0, 1e6}, "The limit, in the unit that its name ends in.").is_required();
    v.choice(&P::from, "from", {{"thesis", From::thesis}, {"ours", From::ours}},
             "Where it comes from: the dissertation, or our own choice.")
        .is_required();
    v.text(&P::why, "why", "The dissertation's table, or the reason for our choice.").is_required();
  }
  std::string fault() const {
    return why.find_first_not_of(" \t\r\n") == std::string::npos ? "why: is blank" : std::string();
  }
};

/// "Time to complete procedure".
struct TimeRubric {
  RubricLimit ideal_s, good_s, acceptable_s, allotted_s;
  template <class V>
  static void describe(V& v) {
    using P = TimeRubric;
    v.group(&P::ideal_s, "ideal_s", "Less than this scores 5.").is_required();
    v.group(&P::good_s, "good_s", "Less than this scores 4.").is_required();
    v.group(&P::acceptable_s, "acceptable_s", "Up to this scores 3.").is_required();
    v.group(&P::allotted_s, "allotted_s", "Up to this scores 2, beyond it 1.").is_required();
  }
  std::string fault() const;
};

/// The name of the first limit that is below the one before it, as a struct's fault() says it; "" where they ascend.
std::string descending_limit(const std::vector<std::pair<const char*, double>>& limits);

/// The rubric of a module. Every NAME_rubric.cpp of this folder defines `RubricType NAME_rubric()`, and CMake finds it.
struct RubricType {
  std::string module;  ///< as the rubric's own key `module` says
  AnyParams (*make)() = nullptr;
};
const std::vector<RubricType>& rubric_types();
/// Throws Error 65 with the field `module` where no module has that name.
const RubricType& rubric_type(const std::string& module);

/// The compiled rubric: JSON of all values, with a version and the SHA-256 of what it says.
std::string compile_rubric(const AnyParams& rubric);

struct CompiledRubric {
  std::string module;
  AnyParams rubric;
  std::string sha256;
};
/// Throws Error 65, naming the field, where it is no compiled rubric, of another version, of a module that is not
/// known, changed since it was compiled, or says what the declaration does not allow.
CompiledRubric read_rubric(std::string_view json);

}  // namespace trephine
