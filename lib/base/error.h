// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "base/exit_code.h"

namespace trephine {

/// A value of a parameter that answers a refusal. The parameter is one of the stage that refuses: "gaps".
struct Setting {
  std::string parameter, value;
  std::string stage = "";  ///< of another stage than the one that refuses: it is worded as a run's wherever it is shown
};

/// What is wrong, in words. Settings have places in them, which are worded where the message is shown: a command's
/// flags are `--gaps interpolate`, a run's settings `--set import.gaps=interpolate`, and a page may show a button.
class Message {
 public:
  Message() = default;
  Message(std::string text) : form_(std::move(text)) {}                     // NOLINT: a text is a message
  Message(const char* text) : form_(text) {}                                // NOLINT
  Message(const Setting& setting) : form_(1, place), settings_{setting} {}  // NOLINT
  Message(std::string form, std::vector<Setting> settings) : form_(std::move(form)), settings_(std::move(settings)) {}
  friend Message operator+(Message before, const Message& behind) {
    before.form_ += behind.form_;
    before.settings_.insert(before.settings_.end(), behind.settings_.begin(), behind.settings_.end());
    return before;
  }

  bool empty() const { return form_.empty(); }
  const std::vector<Setting>& settings() const { return settings_; }
  const std::string& form() const { return form_; }
  /// With settings as flags; or, where the stage is named, as a run's settings.
  std::string text(const std::string& stage = "") const;

 private:
  static constexpr char place = '\x01';
  std::string form_;
  std::vector<Setting> settings_;
};

inline Message operator+(std::string before, const Setting& behind) {
  return Message(std::move(before)) + Message(behind);
}

/// Why an error was thrown, where code does more than pass it on.
enum class Cause {
  other,
  child_limit,         ///< a child process reached a limit of time or memory
  child_died,          ///< a child process died of a fault of its own
  other_encoding,      ///< the file is whole, and stores its values in a way that this reader does not know
  missing_slices,      ///< the positions of the slices make no volume
  refused_output,      ///< of an anatomy (about()) whose field is good, what is published of it is not
  too_many_triangles,  ///< a refused output: its surface has more than the scene allows
};

inline bool is_of_output(Cause cause) { return cause == Cause::refused_output || cause == Cause::too_many_triangles; }

/// The one error type. It says who must act (the exit code), where (the file; the tag, field or stage), and what is
/// wrong (the value, the limit or what to do). It is printed as one line, `trephine <tool>: <case token>: <file>:
/// <field>: <what>`, without the parts that are empty.
///
/// Code that throws fills in the parts that it knows; callers add the rest on the way up with `in_file`, `in_field`,
/// `in_stage` and `in_case`, which keep what is already there. No part may ever hold a patient's name, ID or UID.
class Error : public std::exception {
 public:
  Error(ExitCode code, std::string file, std::string field, const Message& what);

  ExitCode code() const { return code_; }
  Cause cause() const { return cause_; }
  const std::string& case_token() const { return case_token_; }
  const std::string& file() const { return file_; }
  const std::string& field() const { return field_; }
  /// In a run, the stage that threw it: "brain.segment", "import". Empty where it was none.
  const std::string& stage() const { return stage_; }
  /// The parts that a refusal finds fault with, the likeliest one first, so that who can do without may go on.
  const std::vector<std::string>& about() const { return about_; }
  const Message& message() const { return message_; }
  const char* what() const noexcept override { return what_.c_str(); }

  Error& because(Cause cause);                ///< sets the cause if none is known
  Error& in_case(const std::string& token);   ///< sets the case token if none is known
  Error& in_file(const std::string& file);    ///< sets the file if none is known
  Error& in_field(const std::string& field);  ///< sets the field, or prefixes "field: " where one is known
  Error& in_stage(
      const std::string& stage);  ///< sets the stage, for which settings are worded then, and the field as above
  Error& finds_fault_with(std::vector<std::string> parts);  ///< sets about()
  Error& recoded(ExitCode code);
  Error& refiled(std::string file);  ///< sets the file, whatever it was
  Error& reworded(const Message& what);
  Error& worded_for(const std::string& stage);  ///< words the settings as those of a run, of that stage

  /// The line without a newline; control characters are replaced, so that a hostile file cannot forge a second line.
  std::string line(const std::string& program_and_tool) const;

 private:
  ExitCode code_;
  Cause cause_ = Cause::other;
  std::string case_token_, file_, field_, stage_;
  std::vector<std::string> about_;
  Message message_;
  std::string what_;
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

/// Runs f() and adds the field to an Error that passes through.
template <class F>
auto with_field(const std::string& field, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (Error& e) {
    e.in_field(field);
    throw;
  }
}

/// Runs f() and adds the stage of a run to an Error that passes through.
template <class F>
auto with_stage(const std::string& stage, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (Error& e) {
    e.in_stage(stage);
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
