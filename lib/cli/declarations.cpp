// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/declarations.h"

#include <algorithm>

#include "base/error.h"
#include "base/joined.h"

namespace trephine::cli {
namespace {

void check_name(const std::string& command, const std::string& name) {
  const auto good = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || name[0] < 'a' || name[0] > 'z' || !std::all_of(name.begin(), name.end(), good))
    throw Error(ExitCode::internal, "", command + " " + name, "declared with a name that is not snake_case");
}

}  // namespace

std::string page_of(const Command& command) {
  std::string page = command.name;
  std::replace(page.begin(), page.end(), ' ', '-');
  return page;
}

std::string group_of(const Command& command) {
  const std::size_t space = command.name.find(' ');
  return space == std::string::npos ? std::string() : command.name.substr(0, space);
}

std::string flag_of(const std::string& name) {
  std::string flag = "--" + name;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

std::string placeholder_of(const Argument& argument) {
  switch (argument.kind) {
    case Argument::Kind::in_file:
    case Argument::Kind::out_file:
      return "FILE";
    case Argument::Kind::in_folder:
    case Argument::Kind::out_folder:
      return "FOLDER";
    case Argument::Kind::in_path:
    case Argument::Kind::in_scan:
      return "PATH";
    case Argument::Kind::text:
      return "TEXT";
    case Argument::Kind::choice:
      break;
  }
  return joined(argument.choices, "|");
}

std::string placeholder_of(const Parameter& parameter) {
  switch (parameter.kind) {
    case ParameterKind::number:
      return "NUMBER";
    case ParameterKind::integer:
      return "INTEGER";
    case ParameterKind::flag:
      return "";
    case ParameterKind::text:
      return "TEXT";
    case ParameterKind::any:
      return "VALUE";
    case ParameterKind::choice:
      return "CHOICE";
    case ParameterKind::group:
      return "KEY=VALUE,...";
    case ParameterKind::list:
    case ParameterKind::map: {
      const Parameter* only = parameter.item_set().only_value();
      const bool named = parameter.kind == ParameterKind::map;
      if (only) return (named ? "NAME=" : "") + placeholder_of(*only);
      return named ? "NAME[:KEY=VALUE,...]" : "KEY=VALUE,...";
    }
    case ParameterKind::steps:
      return "NAME[:KEY=VALUE,...]";
    case ParameterKind::numbers:
      break;
  }
  std::string all;
  for (std::size_t i = 0; i < parameter.count; ++i) all += i == 0 ? "N" : ",N";
  return all;
}

std::string name_of(const Argument& argument) {
  if (!argument.positional) return flag_of(argument.name);
  std::string name = argument.name;
  for (char& c : name) c = c == '_' ? '-' : static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return name;
}

std::string usage_of(const Argument& argument) {
  if (!argument.positional) return name_of(argument) + " " + placeholder_of(argument);
  return argument.kind == Argument::Kind::choice ? placeholder_of(argument) : name_of(argument);
}

std::string usage_of(const Parameter& parameter) {
  if (parameter.kind == ParameterKind::flag) return "--[no-]" + flag_of(parameter.name).substr(2);
  const bool repeated = parameter.kind == ParameterKind::list || parameter.kind == ParameterKind::map;
  return flag_of(parameter.name) + " " + placeholder_of(parameter) + (repeated ? " ..." : "");
}

std::vector<std::pair<std::string, DeclaredParameter>> listed_of(const AnyParams& defaults) {
  std::vector<std::pair<std::string, DeclaredParameter>> listed;
  for (const DeclaredParameter& d : declared_of(defaults)) {
    const bool top = d.path == d.parameter->name;
    listed.emplace_back(top ? usage_of(*d.parameter) : d.path, d);
  }
  return listed;
}

std::vector<std::string> usage_of(const Program& program, const Command& command) {
  std::vector<std::string> parts = {program.name + " " + command.name};
  for (const bool positional : {true, false})
    for (const Argument& a : command.arguments) {
      if (a.positional != positional) continue;
      const std::string more = a.repeated ? "..." : "";
      parts.push_back(a.required ? usage_of(a) + more : "[" + usage_of(a) + "]" + more);
    }
  parts.emplace_back("[parameters]");
  return parts;
}

std::vector<ParameterGroup> all_groups(const Command& command) {
  std::vector<ParameterGroup> groups = command.groups;
  groups.push_back(ParameterGroup::of<CommonParams>(common_title));
  return groups;
}

void check_declarations(const Program& program) {
  std::set<std::string> commands;
  for (const Command& c : program.commands) {
    if (!commands.insert(c.name).second) throw Error(ExitCode::internal, "", c.name, "declared twice");
    if (c.summary.empty() || !c.run)
      throw Error(ExitCode::internal, "", c.name, "declared without a summary or a function");
    const std::string group = group_of(c);
    if (!group.empty()) check_name(c.name, group);
    std::string own = group.empty() ? c.name : c.name.substr(group.size() + 1);
    std::replace(own.begin(), own.end(), '-', '_');
    check_name(c.name, own);
    for (const Command& other : program.commands)
      if (!group.empty() && other.name == group) throw Error(ExitCode::internal, "", group, "declared as a group too");
    std::set<std::string> flags = {"--help"};
    const auto add = [&](const std::string& name, const std::string& help) {
      check_name(c.name, name);
      if (help.empty()) throw Error(ExitCode::internal, "", c.name + " " + flag_of(name), "declared without a help");
      if (!flags.insert(flag_of(name)).second)
        throw Error(ExitCode::internal, "", c.name + " " + flag_of(name), "declared twice");
    };
    bool open_end = false;
    for (const Argument& a : c.arguments) {
      add(a.name, a.help);
      if (a.positional && open_end)
        throw Error(ExitCode::internal, "", c.name + " " + a.name, "stands behind an argument without an end");
      open_end = open_end || (a.positional && (a.repeated || !a.required));
    }
    for (const ParameterGroup& g : all_groups(c))
      for (const Parameter& p : g.make().set->parameters) {
        add(p.name, p.help);
        if (p.kind == ParameterKind::flag) add("no_" + p.name, p.help);
      }
  }
}

std::string ParsedCommand::text(const std::string& argument) const {
  const auto found = arguments.find(argument);
  return found == arguments.end() ? std::string() : found->second.at(0);
}

std::vector<std::string> ParsedCommand::all(const std::string& argument) const {
  const auto found = arguments.find(argument);
  return found == arguments.end() ? std::vector<std::string>() : found->second;
}

void ParsedCommand::no_such_group() const {
  throw Error(ExitCode::internal, "", command ? command->name : "", "has no parameters of this type");
}

const OwnCommand* OwnCommand::first = nullptr;

std::vector<Command> OwnCommand::all() {
  std::vector<Command> out;
  for (const OwnCommand* c = first; c; c = c->next_) out.push_back(c->make_());
  std::sort(out.begin(), out.end(), [](const Command& a, const Command& b) { return a.name < b.name; });
  return out;
}

Command OwnCommand::named(const std::string& name) {
  for (Command& c : all())
    if (c.name == name) return std::move(c);
  throw Error(ExitCode::internal, "", name, "is no command of this program");
}

}  // namespace trephine::cli
