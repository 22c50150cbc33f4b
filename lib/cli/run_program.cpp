// SPDX-License-Identifier: GPL-3.0-or-later
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>

#include "base/child.h"
#include "base/error.h"
#include "base/error_text.h"
#include "base/joined.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cli/declarations.h"
#include "cli/job_status.h"
#include "cli/plain_output.h"
#include "cli/slicer_module.h"

namespace trephine::cli {
namespace {

int number(ExitCode code) { return static_cast<int>(code); }

using Pages = std::vector<std::pair<std::string, std::string>>;

// A hidden command that writes generated pages into a folder.
Command page_command(const Program& program, const std::string& name, const std::string& summary,
                     Pages (*make)(const Program&)) {
  Command c;
  c.name = name;
  c.summary = summary;
  c.hidden = true;
  c.arguments = {{"out", Argument::Kind::out_folder, "Folder for the pages.", true, false, false, {}}};
  c.run = [&program, make](const ParsedCommand& parsed) {
    const Pages pages = make(program);
    make_output_folder(parsed.path("out"));
    for (const auto& page : pages) write_file(parsed.path("out") / page.first, page.second);
    return ExitCode::ok;
  };
  return c;
}

// The commands that every program has. They refer to the program through the pointer, and it includes them.
void add_own_commands(Program& program) {
  Command completion;
  completion.name = "completion";
  completion.summary = "prints the script by which a shell completes";
  completion.description = "Completes commands, flags and the values of flags that have choices.";
  completion.examples = {"eval \"$(" + program.name + " completion bash)\"",
                         "eval \"$(" + program.name + " completion zsh)\"", program.name + " completion fish | source"};
  completion.arguments = {
      {"shell", Argument::Kind::choice, "Which shell.", true, true, false, {"bash", "zsh", "fish"}}};
  completion.run = [&program](const ParsedCommand& parsed) {
    const std::string shell = parsed.text("shell");
    std::cout << (shell == "fish"  ? fish_completion(program)
                  : shell == "zsh" ? zsh_completion(program)
                                   : bash_completion(program));
    return ExitCode::ok;
  };
  program.commands.push_back(page_command(program, "reference", "Write the reference pages", reference_pages));
  program.commands.push_back(page_command(program, "man", "Write the manual pages", man_pages));
  program.commands.push_back(std::move(completion));
}

[[noreturn]] void refuse_in_group(const std::string& group, const std::string& word,
                                  const std::vector<std::string>& known) {
  const std::string all = joined(known);
  const std::string near = nearest_name(word, known);
  throw Error(ExitCode::usage, "", word.empty() ? group : group + " " + word,
              word.empty()   ? "needs one of these after it: " + all
              : near.empty() ? "unknown command; these are known: " + all
                             : "unknown command; did you mean " + group + " " + near + "?");
}

// The command with which the words begin, and how many of them are its name.
const Command& find_command(const Program& program, const std::vector<std::string>& words, std::size_t& taken) {
  const std::string name = words[0], second = words.size() > 1 ? words[1] : "";
  std::vector<std::string> known = {"--help", "--version", "help"}, in_group;
  for (const Command& c : program.commands) {
    const std::string group = group_of(c);
    taken = group.empty() ? 1 : 2;
    if (c.name == (group.empty() ? name : name + " " + second)) return c;
    if (!c.hidden && group == name) in_group.push_back(c.name.substr(group.size() + 1));
    if (!c.hidden && (group.empty() || known.back() != group)) known.push_back(group.empty() ? c.name : group);
  }
  if (!in_group.empty()) refuse_in_group(name, second, in_group);
  const std::string near = nearest_name(name, known);
  throw Error(ExitCode::usage, "", name,
              std::string("unknown ") + (name.rfind("-", 0) == 0 ? "flag" : "command") +
                  (near.empty() ? "; " + program.name + " --help lists them" : "; did you mean " + near + "?"));
}

// The help of a command, or for the first word of a group the list of all its commands.
std::string help_of(const Program& program, const std::vector<std::string>& words, std::size_t& taken) {
  Program group = program;
  group.name += " " + words[0];
  group.commands.clear();
  for (Command c : program.commands)
    if (group_of(c) == words[0]) {
      c.name.erase(0, words[0].size() + 1);
      group.commands.push_back(std::move(c));
    }
  if (words.size() > 1 || group.commands.empty()) return command_help(program, find_command(program, words, taken));
  taken = 1;
  return program_help(group);
}

// Without a configuration, a wrong value must have been given on the command line.
void refuse_as_usage(const Command& command, const Error& e) {
  if (e.code() != ExitCode::bad_config) return;
  for (const Argument& a : command.arguments)
    if (a.name == "config") return;
  std::string field = e.field();
  for (const ParameterGroup& g : command.groups)
    if (g.make().set->find(field)) field = flag_of(field);
  throw Error(ExitCode::usage, e.file(), field, e.message()).in_case(e.case_token());
}

ExitCode run(const Program& program, const std::vector<std::string>& words, std::string& who) {
  if (words.empty())
    throw Error(ExitCode::usage, "", "", "a command is needed; " + program.name + " --help lists them");
  if (words[0] == "--help" || words[0] == "-h") {
    std::cout << program_help(program);
    return ExitCode::ok;
  }
  std::size_t taken = 0;
  if (words[0] == "help") {
    who += " help";
    const std::vector<std::string> rest(words.begin() + 1, words.end());
    const std::string text = rest.empty() ? program_help(program) : help_of(program, rest, taken);
    if (rest.size() > taken) throw Error(ExitCode::usage, "", rest[taken], "is one word too many");
    std::cout << text;
    return ExitCode::ok;
  }
  if (words[0] == "--version") {
    std::cout << program.name << " " << program.version << "\n";
    return ExitCode::ok;
  }
  if (words.size() == 2 && (words[1] == "--help" || words[1] == "-h")) {
    std::cout << help_of(program, {words[0]}, taken);
    return ExitCode::ok;
  }
  const bool as_module = words[0] == "slicer-module" && words.size() > 1;
  const std::vector<std::string> named(words.begin() + (as_module ? 1 : 0), words.end());
  const Command& command = find_command(program, named, taken);
  who += " " + command.name;
  std::vector<std::string> own(named.begin() + static_cast<std::ptrdiff_t>(taken), named.end());
  if (as_module) {
    if (own == std::vector<std::string>{"--xml"}) {
      std::cout << slicer_module_xml(program, command);
      return ExitCode::ok;
    }
    own = words_of_slicer(command, own);
  }
  for (const std::string& word : own) {
    if (word == "--") break;
    if (word != "--help" && word != "-h") continue;
    std::cout << command_help(program, command);
    return ExitCode::ok;
  }
  // What is wrong with the words is told in the form that they ask for, too.
  const auto end_of_options = std::find(own.begin(), own.end(), "--");
  if (std::find(own.begin(), end_of_options, "--json-log") != end_of_options) set_log_form({LogLevel::info, true, who});
  const ParsedCommand parsed = parse_command(command, own);
  const CommonParams& common = parsed.params<CommonParams>();
  set_thread_count(common.threads);
  set_log_form({common.log_level, common.json_log, who});
  try {
    return command.run(parsed);
  } catch (const Error& e) {
    refuse_as_usage(command, e);
    throw;
  }
}

// While the libraries are initialised, before main: nothing has been begun, so a request to stop ends the program as it
// does later. What ignores a signal goes on ignoring it until main.
extern "C" void stop_before_main(int) { ::_exit(static_cast<int>(ExitCode::cancelled)); }
void catch_early_signals() {
  for (const int number : {SIGINT, SIGTERM}) {
    struct sigaction now {};
    if (sigaction(number, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) std::signal(number, stop_before_main);
  }
}
using EarlyFunction = void (*)();
[[gnu::section(".preinit_array"), gnu::used]] const EarlyFunction run_before_all = catch_early_signals;

// What this process holds is of patients: a fault leaves no copy of it on the disk. A limit of 1 byte also keeps the
// kernel from handing it to a program that collects core files, which a limit of 0 does not.
void leave_no_core_file() {
  rlimit core{};
  if (::getrlimit(RLIMIT_CORE, &core) != 0) return;
  core.rlim_cur = std::min<rlim_t>(1, core.rlim_max);
  ::setrlimit(RLIMIT_CORE, &core);
}

void flush_output() {
  if (std::cout.flush() && std::fflush(stdout) == 0) return;
  // A reader that has what it wanted, as `head`, is no failure.
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  if (::poll(&out, 1, 0) == 1 && (out.revents & POLLERR)) return;
  throw Error(ExitCode::io, "standard output", "", "cannot be written");
}

// `trephine @3`: the words stand in file descriptor 3, each ended by a NUL, so that nobody reads them in the list of
// processes. `@-` is standard input.
std::vector<std::string> words_of(int argc, char** argv) {
  const std::vector<std::string> words(argv + std::min(1, argc), argv + argc);
  if (words.size() != 1 || words[0].size() < 2 || words[0][0] != '@') return words;
  const std::string where = words[0].substr(1);
  if (where.find_first_not_of("0123456789") != std::string::npos && where != "-") return words;
  const int fd = where == "-" || where.size() > 4 ? 0 : std::stoi(where);
  constexpr std::size_t most = 16 << 20;
  std::string bytes;
  char part[4096];
  for (ssize_t n = 0; (n = ::read(fd, part, sizeof part)) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 || bytes.size() > most) throw Error(ExitCode::usage, "", words[0], "no words can be read there");
    bytes.append(part, static_cast<std::size_t>(n));
  }
  if (!bytes.empty() && bytes.back() == '\0') bytes.pop_back();
  return bytes.empty() ? std::vector<std::string>{} : split_at(bytes, '\0');
}

}  // namespace

int run_program(const char* name, const std::function<Program()>& declare, int argc, char** argv) {
  std::string who = name;
  json::JobStatus status;
  const auto add = [&](const Error& e) {
    log_error(e.line(who));
    status.errors.push_back(error_text(e, false));
  };
  const auto end = [&](ExitCode code, const std::string& line = "") {
    if (!line.empty()) {
      log_error(who + ": " + line);
      status.errors.push_back(line);
    }
    write_job_status(status);
    return number(code);
  };
  try {
    leave_no_core_file();
    run_child_if_asked(argc, argv);
    has_job_status();
    install_signal_handlers();
    const PlainOutput plain;
    Program program = declare();
    add_own_commands(program);
    const std::vector<std::string> words = words_of(argc, argv);
    const ExitCode code = run(program, words, who);
    flush_output();
    return number(code);
  } catch (const ErrorList& e) {
    for (const Error& one : e.all()) add(one);
    return end(e.code());
  } catch (const Error& e) {
    add(e);
    return end(e.code());
  } catch (const Cancelled&) {
    return end(ExitCode::cancelled, "cancelled");
  } catch (const std::bad_alloc&) {
    status.out_of_memory = true;
    return end(ExitCode::internal, "out of memory");
  } catch (const std::exception& e) {
    return end(ExitCode::internal, std::string("internal error: ") + e.what());
  } catch (...) {
    return end(ExitCode::internal, "internal error of an unknown kind");
  }
}

}  // namespace trephine::cli
