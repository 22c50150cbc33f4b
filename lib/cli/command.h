// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/exit_code.h"
#include "base/params.h"

namespace trephine {

/// A command is declared once: parsing, checks, help, reference pages, JSON schema and shell completion come from it.

/// What a command takes besides its parameters.
struct Argument {
  enum class Kind {
    in_file,     ///< must be there (66)
    in_folder,   ///< must be there (66)
    in_path,     ///< a file or folder that must be there (66)
    out_file,    ///< its folder must be there and be writable (73)
    out_folder,  ///< must be writable, or possible to create (73)
    text,
    choice,
  };
  std::string name;  ///< snake_case: max_gap becomes --max-gap; of a positional one only shown
  Kind kind = Kind::in_file;
  std::string help;  ///< one sentence
  bool required = false;
  bool positional = false;
  bool repeated = false;             ///< may be given more than once
  std::vector<std::string> choices;  ///< of kind choice
};

/// Parameters (base/params.h) under a title of their own in the help.
struct ParameterGroup {
  std::string title;
  std::function<AnyParams()> make;  ///< with the defaults

  template <class P>
  static ParameterGroup of(const std::string& title) {
    return {title, [] { return AnyParams::make<P>(); }};
  }
};

struct ParsedCommand;

struct Command {
  std::string name;         ///< one word; or two, of which commands of a group share the first ("library build")
  std::string summary;      ///< one line, without a full stop
  std::string description;  ///< a paragraph or more (empty lines between them)
  std::vector<Argument> arguments;
  std::vector<ParameterGroup> groups;
  std::vector<std::string> examples;  ///< whole command lines
  std::function<ExitCode(const ParsedCommand&)> run;
  /// Whether this call writes no output folder (--dry-run): then that need not be writable. Empty: it always writes.
  std::function<bool(const ParsedCommand&)> only_looks;
  bool hidden = false;  ///< left out of the program's help, the reference and completion
};

/// A command line that was understood: every parameter has its effective value, and every path was checked as its kind
/// says.
struct ParsedCommand {
  const Command* command = nullptr;
  std::vector<AnyParams> groups;                              ///< as in the command
  std::map<std::string, std::vector<std::string>> arguments;  ///< by name; only what was given
  std::set<std::string> given;                                ///< names of the parameters that were given
  bool quiet = false;

  bool has(const std::string& argument) const { return arguments.count(argument) > 0; }
  /// The (first) value, or empty where it was not given.
  std::string text(const std::string& argument) const;
  std::filesystem::path path(const std::string& argument) const { return text(argument); }
  std::vector<std::string> all(const std::string& argument) const;
  /// The first group whose type is P; the command must have one.
  template <class P>
  const P& params() const {
    for (const AnyParams& g : groups)
      if (g.set == &parameters_of<P>()) return g.as<P>();
    no_such_group();
  }

 private:
  [[noreturn]] void no_such_group() const;
};

/// What every command takes: --threads and --quiet.
struct CommonParams {
  int threads = 0;
  bool quiet = false;
  template <class V>
  static void describe(V& v) {
    using P = CommonParams;
    v.integer(&P::threads, "threads", Range{0, 1024},
              "Threads to use, 0 for one per core; the results are the same whatever it is.");
    v.flag(&P::quiet, "quiet", "Show no progress; warnings and errors still appear on stderr.");
  }
};

struct Program {
  std::string name, version, summary;
  std::vector<Command> commands;
  std::string reference_folder = "docs/reference";  ///< named by its pages
  /// What the manual page tells of files: (path, what it is).
  std::vector<std::pair<std::string, std::string>> files;
  /// More generated files for the reference folder: (file name, content).
  std::function<std::vector<std::pair<std::string, std::string>>()> more_reference_pages;
};

/// A program's main: runs a bounded child if asked, parses, runs the command, prints errors (a line each on stderr) and
/// returns the exit code: an Error's own, 78 becoming 64 for commands without an argument `config`, whose parameters
/// can only be wrong on the command line; 64 for the command line, every fault of which is named at once; 130 where the
/// user cancelled; 74 where stdout could not be written; 70 for what nobody expected. Adds `help [COMMAND]`, the
/// command `completion bash`, and, not shown, `reference --out DIR` (writes reference_pages) and `man --out DIR`
/// (man_pages).
/// `declare` is called within: what it throws, no memory say, ends the program as what a command throws.
int run_program(const char* name, const std::function<Program()>& declare, int argc, char** argv);

/// Reads a command's own words (after its name). Throws ErrorList (64) with all faults, then ErrorList (66, 73) for
/// paths.
ParsedCommand parse_command(const Command& command, const std::vector<std::string>& words);

/// The words "--help" and "--version" and what they show.
std::string program_help(const Program& program);
std::string command_help(const Program& program, const Command& command);

/// The generated reference: (file name, content): index.md, a page a command, parameters.schema.json, and the program's
/// more_reference_pages. Throws 70 where a declaration is at fault (a flag twice, a help missing, a name not
/// snake_case).
std::vector<std::pair<std::string, std::string>> reference_pages(const Program& program);

/// Manual pages of section 1 in groff's man macros: (file name, content): PROGRAM.1 and PROGRAM-COMMAND.1 for each
/// command, which `man PROGRAM COMMAND` finds. They hold no date. Throws as reference_pages does.
std::vector<std::pair<std::string, std::string>> man_pages(const Program& program);

/// The JSON schema (draft 2020-12) of an object with these parameters as keys, as text with the given indent.
std::string json_schema_of(const AnyParams& defaults, int indent = 2);

/// A script for bash's programmable completion of the program.
std::string bash_completion(const Program& program);

}  // namespace trephine
