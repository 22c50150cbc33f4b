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
#include "base/log.h"
#include "base/params.h"

namespace trephine::cli {

/// A command is declared once. Parsing, checks, help, reference pages, JSON schema and shell completion come from that
/// declaration.

/// An input or option of a command that is not a parameter.
struct Argument {
  enum class Kind {
    in_file,     ///< a file that must exist (66)
    in_folder,   ///< a folder that must exist (66)
    in_path,     ///< a file or folder that must exist (66)
    in_scan,     ///< the same, of a scan: its name may be a patient's, so that messages do not repeat it
    out_file,    ///< a file whose folder must exist and be writable (73)
    out_folder,  ///< a folder that must be writable, or possible to create (73)
    text,
    choice,
  };
  std::string name;  ///< snake_case: max_gap becomes --max-gap; the name of a positional argument is only shown
  Kind kind = Kind::in_file;
  std::string help;  ///< one sentence
  bool required = false;
  bool positional = false;
  bool repeated = false;             ///< may be given more than once
  std::vector<std::string> choices;  ///< for kind choice
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
  std::string name;         ///< one word, or two where the commands of a group share the first ("library build")
  std::string summary;      ///< one line, without a full stop
  std::string description;  ///< a paragraph or more (empty lines between them)
  std::vector<Argument> arguments;
  std::vector<ParameterGroup> groups;
  std::vector<std::string> examples;  ///< whole command lines
  std::function<ExitCode(const ParsedCommand&)> run;
  /// Whether this call writes no output folder (--dry-run), so that the folder need not be writable. Empty: it always
  /// writes.
  std::function<bool(const ParsedCommand&)> only_looks;
  bool hidden = false;  ///< not in the program's help, the reference or the completion
};

/// A command of the program into which its file is linked; so adding one is adding a file:
///
///     const cli::OwnCommand page_command([] {
///       cli::Command c;
///       ...
///       return c;
///     });
class OwnCommand {
 public:
  explicit OwnCommand(Command (*make)()) : make_(make), next_(first) { first = this; }
  /// All that the program has, by name.
  static std::vector<Command> all();
  /// Throws Error 70 where it has none of that name.
  static Command named(const std::string& name);

 private:
  static const OwnCommand* first;
  Command (*make_)();
  const OwnCommand* next_;
};

/// A command line after parsing: every parameter has its effective value, and every path was checked according to its
/// kind.
struct ParsedCommand {
  const Command* command = nullptr;
  std::vector<AnyParams> groups;                              ///< as in the command
  std::map<std::string, std::vector<std::string>> arguments;  ///< by name; only those that were given
  std::set<std::string> given;                                ///< names of the parameters that were given
  bool quiet = false;

  bool has(const std::string& argument) const { return arguments.count(argument) > 0; }
  /// The (first) value of the argument, or empty where it was not given.
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

/// The parameters of every command.
struct CommonParams {
  int threads = 0;
  bool quiet = false, json_log = false;
  LogLevel log_level = LogLevel::info;
  template <class V>
  static void describe(V& v) {
    using P = CommonParams;
    v.integer(&P::threads, "threads", Range{0, 1024},
              "Threads to use, 0 for one per core. The results are the same whatever the number.");
    v.flag(&P::quiet, "quiet", "Show no progress. Warnings and errors still appear on stderr.");
    v.choice(&P::log_level, "log_level",
             {{"error", LogLevel::error}, {"warning", LogLevel::warning}, {"info", LogLevel::info}},
             "Which lines appear on stderr: errors alone, warnings too, or all.");
    v.flag(&P::json_log, "json_log",
           "Write each line of stderr as one JSON object: time (UTC), level, program, text; and no progress bars.");
  }
};

struct Program {
  std::string name, version, summary;
  std::vector<Command> commands;
  /// The files that the manual page lists: (path, description).
  std::vector<std::pair<std::string, std::string>> files;
  /// More generated files for the reference folder: (file name, content).
  std::function<std::vector<std::pair<std::string, std::string>>()> more_reference_pages;
};

/// The main function of a program. It runs a bounded child if asked to, parses, runs the command, prints errors (one
/// line each on stderr) and returns the exit code: the code of an Error, where 78 becomes 64 for commands without an
/// argument `config`, because their parameters can only be wrong on the command line; 64 for a wrong command line, all
/// of whose faults are named at once; 130 where the user cancelled; 74 where stdout could not be written; 70 for an
/// unexpected exception. It adds `help [COMMAND]`, the command `completion bash` and the hidden commands `reference
/// --out DIR` (writes reference_pages) and `man --out DIR` (writes man_pages), and `slicer-module COMMAND` before any
/// command's words (cli/slicer_module.h). `declare` is called within this
/// function, so that an exception from it, such as lack of memory, ends the program as one from a command does.
int run_program(const char* name, const std::function<Program()>& declare, int argc, char** argv);

/// Reads the words after a command's name. Throws ErrorList (64) with all faults, then ErrorList (66, 73) for paths.
ParsedCommand parse_command(const Command& command, const std::vector<std::string>& words);

/// What the words "--help" and "--version" show.
std::string program_help(const Program& program);
std::string command_help(const Program& program, const Command& command);

/// The generated reference as pairs (file name, content): index.md, one page for each command, parameters.schema.json,
/// and the program's more_reference_pages. Throws Error 70 where a declaration is wrong (a repeated flag, a missing
/// help text, a name that is not snake_case).
std::vector<std::pair<std::string, std::string>> reference_pages(const Program& program);

/// Manual pages of section 1 in groff's man macros, as pairs (file name, content): PROGRAM.1, and PROGRAM-COMMAND.1 for
/// each command, which `man PROGRAM COMMAND` finds. They hold no date. Throws as reference_pages does.
std::vector<std::pair<std::string, std::string>> man_pages(const Program& program);

/// The JSON schema (draft 2020-12) of an object with these parameters as keys, as text with the given indent.
std::string json_schema_of(const AnyParams& defaults, int indent = 2);
/// The same of a file that programs write: all keys are there but those that are left out at their default, and more
/// may be.
std::string json_schema_of_written(const ParameterSet& set);

/// A script for bash's programmable completion of the program.
std::string bash_completion(const Program& program);
std::string zsh_completion(const Program& program);
std::string fish_completion(const Program& program);

}  // namespace trephine::cli
