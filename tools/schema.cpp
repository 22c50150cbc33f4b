// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iostream>

#include "cli/argument.h"
#include "cli/command.h"
#include "schemas.h"

namespace trephine::tools {

const cli::OwnCommand schema_command([] {
  const auto pages = [](const auto& each) {
    static const std::string ending = ".schema.json";
    for (const auto& [name, text] : file_schemas())
      if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
        each(name.substr(0, name.size() - ending.size()), text);
  };
  cli::Command c;
  c.name = "schema";
  c.summary = "prints the JSON schema of a kind of file";
  c.description =
      "Writes the schema (draft 2020-12) of case.json, or of a file that a user writes, to the standard output, from "
      "the declarations in the program. Editors that know JSON schemas complete and check keys with it. The package "
      "installs the same below /usr/share/doc/trephine/docs/reference/trephine/.";
  c.examples = {"trephine schema configuration >configuration.schema.json"};
  cli::Argument kind = cli::positional_argument("kind", cli::Argument::Kind::choice, "Of which file.");
  pages([&](const std::string& name, const std::string&) { kind.choices.push_back(name); });
  c.arguments = {kind};
  c.run = [pages](const cli::ParsedCommand& parsed) {
    pages([&](const std::string& name, const std::string& text) {
      if (name == parsed.text("kind")) std::cout << text;
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
