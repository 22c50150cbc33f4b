// SPDX-License-Identifier: GPL-3.0-or-later
#include "named_values.h"

#include "base/error.h"
#include "base/params.h"
#include "base/text.h"

namespace trephine::tools {

std::pair<std::string, std::string> named_value(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw Error(ExitCode::usage, "", flag, text + ", must be NAME=VALUE");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::vector<double> numbers_of(const std::string& flag, const std::string& text, std::size_t count) {
  const std::vector<std::string> items = split_at(text, ',');
  // Read as every other number is: without locale, octal numbers or infinity.
  Parameter numbers;
  numbers.kind = ParameterKind::numbers;
  numbers.count = count;
  ParameterValue value;
  const std::string fault = parse_parameter(numbers, items, value);
  if (!fault.empty()) throw Error(ExitCode::usage, "", flag, text + ", " + fault);
  return std::get<std::vector<double>>(value);
}

bool holds_hu(const grid::NrrdKeys& keys) {
  const auto content = keys.find("content");
  return content != keys.end() && content->second == "HU";
}

double number_of(const std::string& flag, const std::string& text, double least, double most) {
  const double v = numbers_of(flag, text, 1)[0];
  if (v >= least && v <= most) return v;
  throw Error(ExitCode::usage, "", flag,
              text + ", must be from " + to_text(ParameterValue(least)) + " to " + to_text(ParameterValue(most)));
}

std::map<std::string, Vec3> named_positions(const std::string& flag, const std::vector<std::string>& texts) {
  std::map<std::string, Vec3> all;
  for (const std::string& text : texts) {
    const auto [name, value] = named_value(flag, text);
    const std::vector<double> p = numbers_of(flag, value, 3);
    if (!all.emplace(name, Vec3{p[0], p[1], p[2]}).second)
      throw Error(ExitCode::usage, "", flag, name + ", is given twice");
  }
  return all;
}

std::vector<std::pair<std::string, std::filesystem::path>> named_paths(const std::string& flag,
                                                                       const std::vector<std::string>& texts) {
  std::vector<std::pair<std::string, std::filesystem::path>> all;
  for (const std::string& text : texts) {
    const auto [name, value] = named_value(flag, text);
    for (const auto& one : all)
      if (one.first == name) throw Error(ExitCode::usage, "", flag, name + ", is given twice");
    all.emplace_back(name, value);
  }
  return all;
}

}  // namespace trephine::tools
