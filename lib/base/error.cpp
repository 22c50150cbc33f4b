// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"

#include "base/text.h"

namespace trephine {

Error::Error(ExitCode code, std::string file, std::string field, const std::string& what)
    : std::runtime_error(what), code_(code), file_(std::move(file)), field_(std::move(field)) {}

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

std::string Error::line(const std::string& program_and_tool) const {
  std::string text = program_and_tool;
  for (const std::string* part : {&case_token_, &file_, &field_})
    if (!part->empty()) text += ": " + *part;
  text += std::string(": ") + what();
  return printable(text);
}

}  // namespace trephine
