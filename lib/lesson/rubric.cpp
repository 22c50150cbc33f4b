// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/rubric.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/text.h"
#include "json/declared_json.h"

namespace trephine::lesson {
namespace {

constexpr int compiled_version = 2;

// The rubric as it lies in the compiled file: what it declares beside the rubric itself hangs on the module.
struct CompiledFile {
  int trephine_rubric = 0;
  std::string sha256;
  AnyParams rubric;
  template <class V>
  static void describe(V& v) {
    using P = CompiledFile;
    v.integer(&P::trephine_rubric, "trephine_rubric", Range{1, compiled_version}, "The version of the format: 1 or 2.")
        .is_required();
    v.text(&P::sha256, "sha256", "SHA-256 of the rubric's JSON without blanks.").is_required();
  }
};

ParameterSet file_set(const ParameterSet& rubric) {
  ParameterSet set = parameters_of<CompiledFile>();
  Parameter p;
  p.name = "rubric";
  p.help = "The rubric.";
  p.kind = ParameterKind::group;
  p.required = true;
  p.item_set = [&rubric]() -> const ParameterSet& { return rubric; };
  const auto object = [](void* file) { return static_cast<CompiledFile*>(file)->rubric.object.get(); };
  p.items = [object](void* file) { return std::vector<ParameterItem>{{"", object(file), nullptr}}; };
  p.add = [object](void* file, const std::string&) -> void* { return object(file); };
  p.clear = [](void*) {};  // it is read once, into an object that is new
  set.parameters.push_back(std::move(p));
  return set;
}

std::string digest_of(const AnyParams& rubric) { return sha256_of_bytes(json::declared_json(rubric, -1)); }

const RubricType& find_type(const std::vector<RubricType>& types, const std::string& module) {
  for (const RubricType& t : types)
    if (t.module == module) return t;
  throw Error(ExitCode::bad_input, "", "module",
              printable(module) + ": there is no rubric of it; known are " + joined(types, ", ", &RubricType::module));
}

// An error that is not known, or is listed twice.
std::string critical_fault(const std::vector<CriticalRule>& rules, const std::vector<std::string>& known) {
  for (std::size_t n = 0; n < rules.size(); ++n) {
    const std::string& name = rules[n].error;
    if (std::find(known.begin(), known.end(), name) == known.end())
      return "critical: " + printable(name) + " is no critical error of this lesson; known are " + joined(known);
    for (std::size_t m = 0; m < n; ++m)
      if (rules[m].error == name) return "critical: " + name + " is listed twice";
    if (rules[n].why.find_first_not_of(" \t\r\n") == std::string::npos) return "critical: " + name + ": why is blank";
  }
  return "";
}

}  // namespace

std::string descending_limit(const std::vector<std::pair<const char*, double>>& limits) {
  for (std::size_t n = 1; n < limits.size(); ++n)
    if (limits[n].second < limits[n - 1].second)
      return std::string(limits[n].first) + ".limit: is below " + limits[n - 1].first;
  return "";
}

std::string LessonRubric::fault(const std::vector<std::string>& known) const {
  if (const std::string fault = critical_fault(critical_errors, known); !fault.empty()) return fault;
  std::vector<std::string> errors;
  for (const CriticalRule& rule : critical_errors) errors.push_back(rule.error);
  if (!questions.empty() && !wrong_answers_count) return "wrong_answers_count: is missing beside the questions";
  return questions_fault(questions, errors);
}

std::string TimeRubric::fault() const {
  return descending_limit({{"ideal_s", ideal_s.limit},
                           {"good_s", good_s.limit},
                           {"acceptable_s", acceptable_s.limit},
                           {"allotted_s", allotted_s.limit}});
}

std::string compile_rubric(const AnyParams& rubric) {
  const ParameterSet set = file_set(*rubric.set);
  const auto file = std::make_shared<CompiledFile>(CompiledFile{compiled_version, digest_of(rubric), rubric});
  return json::declared_json({&set, file}) + "\n";
}

CompiledRubric read_rubric(std::string_view json, const std::vector<RubricType>& known) {
  const RubricType& type = find_type(known, json::declared_text(json, {"rubric", "module"}));
  CompiledFile file;
  file.rubric = type.make();
  json::read_declared_json(json, file_set(*file.rubric.set), &file);
  // Of the text itself: an older rubric does not say what was declared since.
  const auto text = nlohmann::ordered_json::parse(json.begin(), json.end());
  if (sha256_of_bytes(text.at("rubric").dump()) != file.sha256)
    throw Error(ExitCode::bad_input, "", "sha256", "the rubric was changed after `trephine rubric` compiled it");
  return {type.module, file.rubric, file.sha256, &type.common(file.rubric)};
}

}  // namespace trephine::lesson
