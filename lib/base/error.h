// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/exit_code.h"

namespace trephine {

/// The one error type. It says who must act (the exit code), where (the file; the tag, field or stage), and what is
/// wrong (the value, the limit or what to do). It is printed as one line, `trephine <tool>: <case token>: <file>:
/// <field>: <what>`, without the parts that are empty.
///
/// Code that throws fills in the parts that it knows; callers add the rest on the way up with `in_file`, `in_field` and
/// `in_case`, which keep what is already there. No part may ever hold a patient's name, ID or UID.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, std::string file, std::string field, const std::string& what);

  ExitCode code() const { return code_; }
  const std::string& case_token() const { return case_token_; }
  const std::string& file() const { return file_; }
  const std::string& field() const { return field_; }

  Error& in_case(const std::string& token);   ///< sets the case token if none is known
  Error& in_file(const std::string& file);    ///< sets the file if none is known
  Error& in_field(const std::string& field);  ///< sets the field, or prefixes "field: " where an inner one is known

  /// The line without a newline; control characters are replaced, so that a hostile file cannot forge a second line.
  std::string line(const std::string& program_and_tool) const;

 private:
  ExitCode code_;
  std::string case_token_, file_, field_;
};

/// Several faults found at once, as in a configuration, each printed on a line of its own. As an Error it stands for
/// the first of them.
class ErrorList : public Error {
 public:
  /// `all` must hold at least one error.
  explicit ErrorList(std::vector<Error> all) : Error(all.at(0)), all_(std::move(all)) {}
  const std::vector<Error>& all() const { return all_; }

 private:
  std::vector<Error> all_;
};

/// Runs f() and adds the field to an Error that passes through. This is the usual way to say in which stage it
/// happened.
template <class F>
auto with_field(const std::string& field, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (Error& e) {
    e.in_field(field);
    throw;
  }
}

/// Runs f() and adds the file to an Error that passes through.
template <class F>
auto with_file(const std::string& file, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (Error& e) {
    e.in_file(file);
    throw;
  }
}

/// Thrown by Progress when the user cancelled. It is not an Error, so that no code takes it for one and continues.
struct Cancelled {};

}  // namespace trephine
