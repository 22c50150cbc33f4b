// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "cli/declarations.h"

namespace trephine::cli {
namespace {

constexpr std::size_t line_width = 100;

// Breaks the text into lines of at most line_width, each indented by `indent` spaces; empty lines stay.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out, line;
  const auto flush = [&] {
    if (!line.empty()) out += std::string(indent, ' ') + line + "\n";
    line.clear();
  };
  std::string word;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const char c = i < text.size() ? text[i] : ' ';
    if (c != ' ' && c != '\n') {
      word += c;
      continue;
    }
    if (!word.empty() && indent + line.size() + 1 + word.size() > line_width) flush();
    if (!word.empty()) line += (line.empty() ? "" : " ") + word;
    word.clear();
    if (c == '\n' && i + 1 < text.size() && text[i + 1] == '\n') {
      flush();
      out += "\n";
    }
  }
  flush();
  return out;
}

std::string usage_text(const std::vector<std::string>& parts) {
  std::string out, line = "Usage:";
  for (const std::string& part : parts) {
    if (line.size() + 1 + part.size() > line_width) {
      out += line + "\n";
      line = std::string(8, ' ');
    }
    line += " " + part;
  }
  return out + line + "\n";
}

std::string entry(const std::string& usage, const std::string& help) { return "  " + usage + "\n" + wrapped(help, 8); }

}  // namespace

std::string program_help(const Program& program) {
  std::string text = program.name + " " + program.version + ": " + program.summary + "\n\n";
  text += "Usage: " + program.name + " COMMAND [arguments]\n\nCommands:\n";
  std::size_t width = 0;
  for (const Command& c : program.commands)
    if (!c.hidden) width = std::max(width, c.name.size());
  for (const Command& c : program.commands)
    if (!c.hidden) text += "  " + c.name + std::string(width + 2 - c.name.size(), ' ') + c.summary + "\n";
  text += "\n" + entry("--help", help_help) + entry("--version", version_help);
  return text + "\n" + program.name + " COMMAND --help, or " + program.name +
         " help COMMAND, shows what a command takes.\n";
}

std::string command_help(const Program& program, const Command& command) {
  std::string text = program.name + " " + command.name + ": " + command.summary + "\n\n";
  text += usage_text(usage_of(program, command));
  if (!command.description.empty()) text += "\n" + wrapped(command.description, 0);
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const Argument& a : command.arguments) {
    std::string how = a.required ? " (required" : "";
    if (a.repeated) how += how.empty() ? " (may be repeated" : ", may be repeated";
    text += entry(usage_of(a), a.help + how + (how.empty() ? "" : ")"));
  }
  for (const ParameterGroup& g : all_groups(command)) {
    const AnyParams defaults = g.make();
    text += "\n" + g.title + ":\n";
    for (const auto& [usage, d] : listed_of(defaults))
      text += entry(usage, d.parameter->help + " (" + describe_parameter(*d.parameter, d.defaults.get()) + ")");
  }
  text += entry("--help", help_help);
  if (!command.examples.empty()) text += "\nExamples:\n";
  for (const std::string& e : command.examples) text += "  " + e + "\n";
  return text;
}

}  // namespace trephine::cli
