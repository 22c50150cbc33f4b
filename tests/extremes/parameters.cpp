// SPDX-License-Identifier: GPL-3.0-or-later
// Every parameter of every stage, at both declared ends and past them. The ends come from the declarations: a new stage
// or parameter is swept without a word here.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/text.h"
#include "outcome.h"
#include "subjects.h"

namespace trephine::extremes {
namespace {

bool declared(double end) { return std::isfinite(end) && std::fabs(end) < 9e18; }

std::string repeated(const Parameter& p, const std::string& item) {
  std::string text = item;
  for (std::size_t n = 1; n < p.count; ++n) text += "," + item;
  return text;
}

// The texts of a parameter's extremes that the parser must take.
std::vector<std::string> ends_of(const Parameter& p) {
  std::vector<std::string> texts;
  const auto add = [&](double end) {
    if (!declared(end)) return;
    texts.push_back(p.kind == ParameterKind::integer ? std::to_string(static_cast<long long>(end))
                                                     : repeated(p, to_text(end)));
  };
  switch (p.kind) {
    case ParameterKind::number:
    case ParameterKind::integer:
    case ParameterKind::numbers:
      add(p.range.min);
      add(p.range.max);
      break;
    case ParameterKind::flag:
      texts = {"false", "true"};
      break;
    case ParameterKind::choice:
      texts = p.choices;
      break;
    case ParameterKind::text:
      texts = {"", "\n", std::string(1000, 'x')};
      break;
    default:
      break;  // leaves are values
  }
  return texts;
}

// Those that it must refuse.
std::vector<std::string> beyond(const Parameter& p) {
  std::vector<std::string> texts;
  switch (p.kind) {
    case ParameterKind::number:
    case ParameterKind::numbers:
      if (declared(p.range.min)) texts.push_back(to_text(std::nextafter(p.range.min, -1e308)));
      if (declared(p.range.max)) texts.push_back(to_text(std::nextafter(p.range.max, 1e308)));
      for (const char* t : {"nan", "-nan", "inf", "-inf", ".inf", "1e400", "-1e400", "0x1", "1,5", " 1", "1 ", "01", "",
                            "one", "1mm", "--1"})
        texts.emplace_back(t);
      if (p.kind == ParameterKind::numbers) {
        for (std::string& t : texts)
          if (t != "1,5") t = repeated(p, t);
        if (p.count == 2) texts.erase(std::find(texts.begin(), texts.end(), "1,5"));      // is what is asked for
        texts.push_back(repeated(p, to_text(p.range.min)) + "," + to_text(p.range.min));  // one too many
      }
      break;
    case ParameterKind::integer:
      if (declared(p.range.min)) texts.push_back(std::to_string(static_cast<long long>(p.range.min) - 1));
      if (declared(p.range.max)) texts.push_back(std::to_string(static_cast<long long>(p.range.max) + 1));
      for (const char* t :
           {"nan", "inf", "99999999999999999999", "-99999999999999999999", "1.5", "0x1", "1,5", " 1", "01", "", "one"})
        texts.emplace_back(t);
      break;
    case ParameterKind::flag:
      texts = {"", "1", "yes", "True", "no"};
      break;
    case ParameterKind::choice:
      texts = {"", "no_such", p.choices.front() + " ", std::string(10000, 'x')};
      break;
    default:
      break;
  }
  return texts;
}

// Ends that the issue names and that no declaration has.
std::vector<std::string> named_extremes(const std::string& stage, const std::string& parameter) {
  if (stage == "decimate" && parameter == "target_triangles_count") return {"1", "4"};
  if (stage == "smooth" && parameter == "iterations_count") return {"10000"};
  return {};
}

std::string shown(const std::string& text) {
  if (text.empty()) return "empty";
  if (text.size() > 60) return grouped_text(static_cast<long long>(text.size())) + " characters";
  return text == "\n" ? "a newline" : text;
}

std::string refusals(const stages::StageType& stage) {
  const AnyParams params = stage.make_params();
  std::size_t texts = 0;
  for (const ParameterLeaf& leaf : leaves_of(params))
    for (const std::string& text : beyond(*leaf.parameter)) {
      const Parameter& p = *leaf.parameter;
      ParameterValue value;
      const std::string fault = parse_parameter(p, items_of(p, text), value);
      if (fault.empty()) return "FAULT: " + leaf.path + " takes " + shown(text);
      if (fault.find('\n') != std::string::npos || fault.size() > 400)
        return "FAULT: " + leaf.path + " is refused in more than a line";
      ++texts;
    }
  return std::to_string(texts) + " texts refused by the parser: 64 as a flag, 78 in a configuration";
}

// Whether the stage ends with that error as it is declared, too.
bool same_refusal(const Subject& subject, const Error& error) {
  try {
    outcome_of_stage(*subject.stage, params_of(subject), inputs_of(subject));
  } catch (const Error& e) {
    return e.code() == error.code() && e.line("") == error.line("");
  }
  return false;
}

std::vector<Case> cases_of(const stages::StageType& stage) {
  std::vector<Case> cases;
  cases.push_back(
      {"all parameters, just beyond both ends; nan, inf, no number, too many", [&] { return refusals(stage); }});
  for (const Subject& subject : subjects_of(stage)) {
    const std::string prefix = subject.label == stage.name ? "" : subject.label.substr(stage.name.size() + 2) + "; ";
    cases.push_back({prefix + "as declared, on " + usual_scene(subject.body).name,
                     [subject] { return outcome_of_stage(*subject.stage, params_of(subject), inputs_of(subject)); }});
    const AnyParams defaults = stage.make_params();
    for (const ParameterLeaf& leaf : leaves_of(defaults)) {
      const Parameter& p = *leaf.parameter;
      if (p.name == "method") continue;  // a subject of its own
      std::vector<std::string> texts = ends_of(p);
      // A hundred million samples take minutes and nothing but time: a hundred thousand stand for them.
      if (p.name == "sample_count" && texts.size() == 2) texts[1] = "100000";
      for (const std::string& more : named_extremes(stage.name, p.name)) texts.push_back(more);
      for (const std::string& text : texts) {
        // Whether a deadline of 0.1 s is met is the machine's affair; that nothing else happens is ours.
        const bool deadline = p.name == "time_limit_s" || p.name == "total_limit_s";
        cases.push_back({prefix + leaf.path + " = " + shown(text),
                         [subject, name = leaf.path, text, deadline] {
                           AnyParams params = params_of(subject);
                           set(params, name, text);
                           if (!deadline) return outcome_of_stage(*subject.stage, params, inputs_of(subject));
                           try {
                             const std::string said = outcome_of_stage(*subject.stage, params, inputs_of(subject));
                             if (said.rfind("FAULT", 0) == 0) return said;
                           } catch (const Error& e) {
                             const bool over =
                                 e.code() == ExitCode::internal && e.line("").find("limit") != std::string::npos;
                             if (!over && !same_refusal(subject, e)) throw;
                           }
                           return std::string("as declared, or exit 70 where the time is over");
                         },
                         is_slow(subject, p.name, text)});
      }
    }
  }
  return cases;
}

}  // namespace

std::vector<Section> parameter_sections() {
  std::vector<Section> sections;
  for (const stages::StageType& stage : all_stages())
    sections.push_back(
        {"parameters_" + stage.name, "Parameters of " + stage.name, "", [&stage] { return cases_of(stage); }});
  return sections;
}

}  // namespace trephine::extremes
