// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"

#include <algorithm>

#include "base/error_text.h"
#include "base/text.h"

namespace trephine {

std::string Message::text(const std::string& stage) const {
  std::string out;
  std::size_t next = 0;
  for (const char c : form_) {
    if (c != place || next == settings_.size()) {
      out += c;
      continue;
    }
    const Setting& s = settings_[next++];
    const std::string& of = s.stage.empty() ? stage : s.stage;
    if (!of.empty()) {
      out += "--set " + of + "." + s.parameter + "=" + s.value;
      continue;
    }
    std::string flag = s.parameter;
    std::replace(flag.begin(), flag.end(), '_', '-');
    out += s.value == "true" ? "--" + flag : s.value == "false" ? "--no-" + flag : "--" + flag + " " + s.value;
  }
  return out;
}

Error::Error(ExitCode code, std::string file, std::string field, const Message& what)
    : code_(code), file_(std::move(file)), field_(std::move(field)), message_(what), what_(what.text()) {}

Error& Error::because(Cause cause) {
  if (cause_ == Cause::other) cause_ = cause;
  return *this;
}

Error& Error::in_case(const std::string& token) {
  if (case_token_.empty()) case_token_ = token;
  return *this;
}

Error& Error::in_file(const std::string& file) {
  if (file_.empty()) file_ = file;
  return *this;
}

Error& Error::in_field(const std::string& field) {
  field_ = field_.empty() ? field : field + ": " + field_;
  return *this;
}

Error& Error::in_stage(const std::string& stage) {
  if (stage_.empty()) {
    stage_ = stage;
    what_ = message_.text(stage_);
  }
  return in_field(stage);
}

Error& Error::finds_fault_with(std::vector<std::string> parts) {
  about_ = std::move(parts);
  return *this;
}

Error& Error::recoded(ExitCode code) {
  code_ = code;
  return *this;
}

Error& Error::refiled(std::string file) {
  file_ = std::move(file);
  return *this;
}

Error& Error::reworded(const Message& what) {
  message_ = what;
  what_ = what.text(stage_);
  return *this;
}

Error& Error::worded_for(const std::string& stage) {
  what_ = message_.text(stage);
  return *this;
}

std::string error_text(const Error& e, bool with_case) {
  std::string text;
  for (const std::string& part : {with_case ? e.case_token() : "", e.file(), e.field()})
    if (!part.empty()) text += part + ": ";
  return printable(text + e.what());
}

std::string Error::line(const std::string& program_and_tool) const {
  return printable(program_and_tool) + ": " + error_text(*this);
}

}  // namespace trephine
