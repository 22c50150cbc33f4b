// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/settings.h"

#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"

namespace trephine::commands {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t max_bytes = 1 << 20;

std::string text_of(const Json& v) { return v.is_string() ? v.get<std::string>() : v.dump(); }

Json read_object(const std::string& file) {
  const std::vector<char> bytes = read_file(file, max_bytes);
  std::set<std::string> keys;
  std::string twice;
  const auto look = [&](int depth, Json::parse_event_t event, Json& key) {
    if (event == Json::parse_event_t::key && depth == 1 && !keys.insert(key.get<std::string>()).second)
      twice = key.get<std::string>();
    return depth < 4;  // no value of a parameter is deeper
  };
  try {
    const Json j = Json::parse(bytes.begin(), bytes.end(), look);
    if (!twice.empty()) throw Error(ExitCode::bad_input, file, twice, "comes twice");
    if (!j.is_object()) throw Error(ExitCode::bad_input, file, "", "must be a JSON object");
    return j;
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, file, "", "is no JSON");
  }
}

// Sets the parameter of that name, and returns whether a group has one.
bool set_parameter(cli::ParsedCommand& parsed, const std::string& file, const std::string& key, const Json& value) {
  for (AnyParams& group : parsed.groups) {
    const Parameter* p = group.set->find(key);
    if (!p || !p->is_value()) continue;
    if (!parsed.given.insert(key).second) return true;  // the command line says otherwise
    std::vector<std::string> items;
    if (value.is_array())
      for (const Json& item : value) items.push_back(text_of(item));
    else
      items.push_back(text_of(value));
    ParameterValue v;
    const std::string fault = parse_parameter(*p, items, v);
    if (!fault.empty()) throw Error(ExitCode::bad_input, file, key, fault);
    p->set(group.object.get(), v);
    return true;
  }
  return false;
}

}  // namespace

std::vector<cli::Argument> settings_arguments() {
  return {cli::argument(
              "settings", cli::Argument::Kind::in_file,
              "A JSON object of parameters by their names, such as {\"letters\": 1.5, \"wheel_mm\": 0.2}; what the "
              "command line gives comes first."),
          cli::argument("write_settings", cli::Argument::Kind::out_file,
                        "Write the values of all parameters to this file, which --settings reads.")};
}

cli::ParsedCommand with_settings(const cli::ParsedCommand& given) {
  cli::ParsedCommand parsed = given;
  const std::string file = parsed.text("settings");
  const Json settings = file.empty() ? Json::object() : read_object(file);
  for (const auto& [key, value] : settings.items())
    if (!set_parameter(parsed, file, key, value))
      throw Error(ExitCode::bad_input, file, key, "is no parameter of `" + parsed.command->name + "`");
  for (const AnyParams& group : parsed.groups)
    if (group.set->fault)
      if (const std::string fault = group.set->fault(group.object.get()); !fault.empty())
        throw Error(file.empty() ? ExitCode::usage : ExitCode::bad_input, file, "", fault);
  return parsed;
}

void write_settings(const cli::ParsedCommand& parsed) {
  if (!parsed.has("write_settings")) return;
  Json out = Json::object();
  for (const AnyParams& group : parsed.groups)
    for (const Parameter& p : group.set->parameters)
      if (p.is_value()) std::visit([&](const auto& v) { out[p.name] = v; }, group.get(p));
  write_file(parsed.path("write_settings"), out.dump(1) + "\n");
}

}  // namespace trephine::commands
