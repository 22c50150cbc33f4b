// SPDX-License-Identifier: GPL-3.0-or-later
// The only place that knows CLI11. It splits the words into flags and values; what they mean, and all that is wrong
// with them, is found here, so that every fault is named at once.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "cli/declarations.h"

namespace trephine::cli {
namespace {

class Parser {
 public:
  explicit Parser(const Command& command) : command_(command), app_(command.summary, command.name) {
    parsed_.command = &command;
    app_.set_help_flag();
    app_.allow_extras();
    for (const Argument& a : command.arguments)
      if (!a.positional) add_valued(flag_of(a.name));
    for (const ParameterGroup& g : all_groups(command)) {
      groups_.push_back(g.make());
      for (const Parameter& p : groups_.back().set->parameters) {
        if (p.kind != ParameterKind::flag) {
          add_valued(flag_of(p.name));
          continue;
        }
        for (const std::string& name : {flag_of(p.name), flag_of("no_" + p.name)}) {
          options_[name] = app_.add_flag(name);
          known_.push_back(name);
        }
      }
    }
    known_.emplace_back("--help");
  }

  ParsedCommand parse(const std::vector<std::string>& words) {
    split(words);
    read_positionals();
    for (const Argument& a : command_.arguments)
      if (!a.positional) read_argument(a, values_of(flag_of(a.name)));
    for (AnyParams& g : groups_)
      for (const Parameter& p : g.set->parameters) read_parameter(g, p);
    if (!faults_.empty()) throw ErrorList(faults_);
    parsed_.quiet = groups_.back().as<CommonParams>().quiet;
    parsed_.groups = groups_;
    check_paths(parsed_);
    return std::move(parsed_);
  }

 private:
  void add_valued(const std::string& flag) {
    CLI::Option* o = app_.add_option(flag);
    o->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    options_[flag] = o;
    valued_.insert(flag);
    known_.push_back(flag);
  }

  void fault(const std::string& field, const std::string& what) {
    faults_.emplace_back(ExitCode::usage, "", field, what);
  }

  void split(const std::vector<std::string>& words) {
    const auto end = std::find(words.begin(), words.end(), "--");
    std::vector<std::string> list;
    for (auto w = words.begin(); w != end; ++w) {
      // CLI11 takes the next word as the value of "--flag=".
      if (!w->empty() && w->back() == '=' && valued_.count(w->substr(0, w->size() - 1))) {
        list.push_back(w->substr(0, w->size() - 1));
        list.emplace_back();
      } else {
        list.push_back(*w);
      }
    }
    const std::string last = list.empty() ? "" : list.back();
    std::reverse(list.begin(), list.end());  // the order that CLI11 wants
    try {
      app_.parse(list);
    } catch (const CLI::ArgumentMismatch&) {
      throw ErrorList({Error(ExitCode::usage, "", last, "needs a value")});
    } catch (const CLI::ParseError& e) {
      throw ErrorList({Error(ExitCode::usage, "", "", e.what())});
    }
    for (const std::string& extra : app_.remaining()) {
      if (extra.size() > 1 && extra[0] == '-') {
        const std::string name = extra.substr(0, extra.find('='));
        const std::string near = nearest_name(name, known_);
        fault(name, near.empty() ? "unknown flag" : "unknown flag; did you mean " + near + "?");
      } else {
        positionals_.push_back(extra);
      }
    }
    if (end != words.end()) positionals_.insert(positionals_.end(), end + 1, words.end());
  }

  // Beside an unknown flag, a stray word may be that flag's value, so too many or too few words are not reported.
  void read_positionals() {
    const bool sure = faults_.empty();
    auto next = positionals_.begin();
    for (const Argument& a : command_.arguments) {
      if (!a.positional) continue;
      std::vector<std::string> values;
      while (next != positionals_.end() && (values.empty() || a.repeated)) values.push_back(*next++);
      if (!values.empty() || sure) read_argument(a, values);
    }
    for (; sure && next != positionals_.end(); ++next) fault(*next, "is one word too many");
  }

  // The values of a flag, as words. A value that looks like a flag means that the value was forgotten.
  std::vector<std::string> values_of(const std::string& flag) {
    std::vector<std::string> values = options_.at(flag)->results();
    if (!valued_.count(flag)) return values;
    for (const std::string& v : values)
      if (v.size() > 2 && v.compare(0, 2, "--") == 0) fault(flag, "needs a value; " + v + " is none");
    return values;
  }

  void read_argument(const Argument& a, const std::vector<std::string>& values) {
    const std::string field = name_of(a);
    const std::string asked = a.kind == Argument::Kind::choice ? "must be " + placeholder_of(a) : "";
    if (values.empty()) {
      if (a.required) fault(field, "is needed: " + a.help + (asked.empty() ? "" : " It " + asked + "."));
      return;
    }
    if (values.size() > 1 && !a.repeated) fault(field, "was given " + std::to_string(values.size()) + " times");
    for (const std::string& v : values) {
      if (v.empty() && a.kind != Argument::Kind::text) fault(field, "is empty");
      if (a.kind == Argument::Kind::choice && std::find(a.choices.begin(), a.choices.end(), v) == a.choices.end())
        fault(field, v + ": " + asked);
    }
    parsed_.arguments[a.name] = values;
  }

  void read_parameter(AnyParams& group, const Parameter& p) {
    std::vector<std::string> values = values_of(flag_of(p.name));
    if (p.kind == ParameterKind::flag)
      for (const std::string& v : values_of(flag_of("no_" + p.name))) {
        if (v != "true") fault(flag_of("no_" + p.name), "takes no value");
        values.emplace_back("false");
      }
    if (values.empty()) return;
    if (!p.is_value()) return read_items(group, p, values);
    if (values.size() > 1) return fault(flag_of(p.name), "was given " + std::to_string(values.size()) + " times");
    ParameterValue value;
    const std::string& text = values[0];
    const auto items = p.kind == ParameterKind::numbers ? split_at(text, ',') : std::vector<std::string>{text};
    const std::string what = parse_parameter(p, items, value);
    if (!what.empty()) return fault(flag_of(p.name), (text.empty() ? "is empty" : text) + ": " + what);
    p.set(group.object.get(), value);
    parsed_.given.insert(p.name);
  }

  void read_items(AnyParams& group, const Parameter& p, const std::vector<std::string>& values) {
    if (p.kind == ParameterKind::group && values.size() > 1)
      return fault(flag_of(p.name), "was given " + std::to_string(values.size()) + " times");
    p.clear(group.object.get());
    for (const std::string& text : values)
      if (const std::string what = parse_item(p, group.object.get(), text); !what.empty())
        fault(flag_of(p.name), (text.empty() ? "is empty" : text) + ": " + what);
    parsed_.given.insert(p.name);
  }

  const Command& command_;
  CLI::App app_;
  std::map<std::string, CLI::Option*> options_;
  std::set<std::string> valued_;
  std::vector<std::string> known_, positionals_;
  std::vector<AnyParams> groups_;
  std::vector<Error> faults_;
  ParsedCommand parsed_;
};

}  // namespace

ParsedCommand parse_command(const Command& command, const std::vector<std::string>& words) {
  return Parser(command).parse(words);
}

}  // namespace trephine::cli
