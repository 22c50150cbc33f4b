// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iostream>

#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "config/declared.h"
#include "config/said.h"
#include "config/yaml_document.h"
#include "lesson/approval.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

struct Question {
  std::string question, en, de;
  double least = 1, most = 5;
  bool whole = true;
  template <class V>
  static void describe(V& v) {
    using P = Question;
    v.text(&P::question, "question", "Its name, a column of the table: a-z, 0-9 and _.").is_required();
    v.text(&P::en, "en", "How it is asked in English.").is_required();
    v.text(&P::de, "de", "How it is asked in German.");
    v.number(&P::least, "least", Range{-1e6, 1e6}, "The least answer: 1 of a scale from 1 to 5, 0 for no.");
    v.number(&P::most, "most", Range{-1e6, 1e6}, "The largest answer.");
    v.flag(&P::whole, "whole", "Answers are whole numbers.");
  }
  std::string fault() const {
    if (!config::is_plain_name(question)) return "question: must be 1 to 32 characters of a-z, 0-9 and _";
    if (question == "participant" || question == "phase" || question == "questionnaire")
      return "question: " + question + " is a column of its own";
    return least < most ? "" : "most: must be above least";
  }
};

struct Questionnaire : config::VersionParams {
  std::string questionnaire;
  std::vector<Question> questions;
  template <class V>
  static void describe(V& v) {
    using P = Questionnaire;
    v.template all_of<config::VersionParams>();
    v.text(&P::questionnaire, "questionnaire", "Its name.").is_required();
    v.list(&P::questions, "questions", "What is asked; no answer is free text, so none can hold a name.").is_required();
  }
};

struct Answer {
  double value = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&Answer::value, "", Range{-1e6, 1e6}, "The answer.");
  }
};

struct Answers {
  std::string questionnaire, participant, phase;
  Named<Answer> answers;
  template <class V>
  static void describe(V& v) {
    using P = Answers;
    v.text(&P::questionnaire, "questionnaire", "Which questionnaire.").is_required();
    v.text(&P::participant, "participant", "Anonymous token of who answers.").is_required();
    v.text(&P::phase, "phase", "before, after, or another token.").is_required();
    v.map(&P::answers, "answers", "The answers by question; one that was not given is left out.");
  }
};

template <class P>
P read_yaml_as(const fs::path& file,
               const std::function<void(const P&, config::ConfigFaults&, const config::YamlNode&)>& check) {
  P out;
  config::ConfigFaults faults;
  const config::YamlNode tree = config::read_yaml(file);
  config::read_declared({file, faults, {}, {}}, tree, parameters_of<P>(), &out);
  faults.raise();
  check(out, faults, tree);
  faults.raise();
  return out;
}

const Question* find(const Questionnaire& all, const std::string& name) {
  const auto at =
      std::find_if(all.questions.begin(), all.questions.end(), [&](const Question& q) { return q.question == name; });
  return at == all.questions.end() ? nullptr : &*at;
}

Questionnaire read_questionnaire(const fs::path& file) {
  return read_yaml_as<Questionnaire>(
      file, [&](const Questionnaire& q, config::ConfigFaults& faults, const config::YamlNode& tree) {
        if (q.questions.empty()) faults.add(file, tree, "questions", "there is none");
        for (const Question& one : q.questions)
          if (find(q, one.question) != &one) faults.add(file, tree, "questions", one.question + " is asked twice");
      });
}

Answers read_answers(const fs::path& file, const Questionnaire& q) {
  return read_yaml_as<Answers>(file, [&](const Answers& a, config::ConfigFaults& faults, const config::YamlNode& tree) {
    const auto fault = [&](const std::string& key, const std::string& what) { faults.add(file, tree, key, what); };
    if (a.questionnaire != q.questionnaire) fault("questionnaire", "is not " + q.questionnaire);
    for (const auto& [key, token] : {std::pair{"participant", a.participant}, std::pair{"phase", a.phase}}) {
      try {
        lesson::validate_token(token, key);
      } catch (const Error&) {
        fault(key, "must be 1 to 32 characters of a-z, 0-9, _ and -: a token, never a name");
      }
    }
    for (const auto& [name, answer] : a.answers) {
      const Question* question = find(q, name);
      if (!question)
        fault("answers", printable(name) + " is not asked");
      else if (!(answer.value >= question->least && answer.value <= question->most))
        fault("answers." + name,
              to_text(answer.value) + ", must lie from " + to_text(question->least) + " to " + to_text(question->most));
      else if (question->whole && answer.value != double((long long)answer.value))
        fault("answers." + name, to_text(answer.value) + ", must be a whole number");
    }
  });
}

std::string answers_csv(const Questionnaire& q, const std::vector<Answers>& all) {
  std::string text = "participant,phase";
  for (const Question& one : q.questions) text += "," + one.question;
  text += "\n";
  for (const Answers& a : all) {
    text += a.participant + "," + a.phase;
    for (const Question& one : q.questions) {
      const Answer* answer = find_item(a.answers, one.question);
      text += "," + (answer ? to_text(answer->value) : std::string());
    }
    text += "\n";
  }
  return text;
}

ExitCode run_questionnaire(const cli::ParsedCommand& parsed) {
  const Questionnaire q = read_questionnaire(parsed.path("config"));
  if (!parsed.has("answers")) {
    std::cout << q.questionnaire << ": " << q.questions.size() << " questions\n";
    for (const Question& one : q.questions)
      std::cout << "  " << one.question << " (" << to_text(one.least) << " to " << to_text(one.most)
                << "): " << printable(one.en) << "\n";
    return ExitCode::ok;
  }
  if (!parsed.has("output")) throw Error(ExitCode::usage, "", "--output", "is needed with --answers");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(parsed.path("answers")))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw Error(ExitCode::no_input, parsed.text("answers"), "", "holds no answers (.yaml)");
  std::vector<Answers> all;
  for (const fs::path& file : files) {
    all.push_back(read_answers(file, q));
    for (std::size_t n = 0; n + 1 < all.size(); ++n)
      if (all[n].participant == all.back().participant && all[n].phase == all.back().phase)
        throw Error(ExitCode::bad_input, file.string(), "participant",
                    all.back().participant + " has answered in phase " + all.back().phase + " in " +
                        files[n].filename().string());
  }
  write_file(parsed.path("output"), answers_csv(q, all));
  if (!parsed.quiet) std::cout << all.size() << " answers to " << q.questions.size() << " questions\n";
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand questionnaire_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "questionnaire";
  c.summary = "checks a questionnaire and its answers, and writes them as a table for `trephine-sim study`";
  c.description =
      "A questionnaire (YAML) lists questions whose answers are numbers within limits; an answer's file (YAML) has a "
      "participant's token, a phase such as before or after, and the answers by question. Nothing is free text, so "
      "nothing can hold a name. The table has a row for each file and an empty cell where an answer was not given; "
      "`trephine-sim study` compares the phases, and `trephine-sim group --answers` shows them to a teacher.";
  c.arguments = {cli::positional_argument("config", Kind::in_file, "The questionnaire (.yaml)."),
                 cli::argument("answers", Kind::in_folder, "Folder of answers, a file (.yaml) for each."),
                 cli::argument("output", Kind::out_file, "Write the table of answers to this file (.csv).")};
  c.examples = {"trephine questionnaire examples/study/questionnaire.yaml",
                "trephine questionnaire examples/study/questionnaire.yaml --answers answers --output answers.csv"};
  c.run = run_questionnaire;
  return c;
});

}  // namespace trephine::tools
