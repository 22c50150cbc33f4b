// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/joined.h"
#include "lessons/lesson_type.h"
#include "lessons/lesson_words.h"

namespace trephine::lessons {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ScoreRow& row) {
  Json measured = Json::object(), limits = Json::object();
  for (const auto& [name, value] : row.measured) measured[name] = value;
  for (const auto& [name, l] : row.limits)
    limits[name] = {
        {"limit", l.limit}, {"from", l.from == lesson::RubricLimit::From::thesis ? "thesis" : "ours"}, {"why", l.why}};
  return {{"name", row.name},
          {"title", row.title},
          {"score", row.score ? Json(*row.score) : Json("not judged")},
          {"why", row.why.english()},
          {"measured", measured},
          {"decided_s", row.decided_s ? Json(*row.decided_s) : Json(nullptr)},
          {"limits", limits},
          {"beside", row.beside}};
}

Json json_of(const CriticalError& e) {
  return {{"error", e.rule.error},
          {"what", e.what.english()},
          {"at_s", e.at_s ? Json(*e.at_s) : Json(nullptr)},
          {"limit", e.rule.limit},
          {"from", e.rule.from == lesson::RubricLimit::From::thesis ? "thesis" : "ours"},
          {"why", e.rule.why}};
}

Json json_of(const Decision& d) {
  return {{"question", d.question},
          {"when", d.when},
          {"answer", d.given.empty() ? Json(nullptr) : Json(d.given)},
          {"state", name_of(d.state)},
          {"at_s", d.at_s ? Json(*d.at_s) : Json(nullptr)}};
}

// What every lesson has, and the module's own.
Json json_of(const LessonType& module, const LessonFacts& f) {
  Json out = {{"end", name_of(f.end)},
              {"begin_s", f.begin_s},
              {"end_s", f.end_s},
              {"procedure_s", f.procedure_s()},
              {"paused_s", f.paused_s},
              {"pauses", f.pauses},
              {"undone", f.undone},
              {"max_bone_c", f.max_bone_c},
              {"heat_dose_min", f.heat_dose_min},
              {"most_force_n", f.most_force_n},
              {"fastest_mm_per_s", f.fastest_mm_per_s},
              {"fastest_s", f.fastest_s}};
  if (f.second)
    out["second_hand"] = {{"tool", f.second->tool},
                          {"switch_s", f.second->switch_s},
                          {"most_force_n", f.second->most_force_n},
                          {"most_force_s", f.second->most_force_s},
                          {"entered_s", f.second->entered_s < 0 ? Json(nullptr) : Json(f.second->entered_s)},
                          {"lost_s", f.second->lost_s < 0 ? Json(nullptr) : Json(f.second->lost_s)},
                          {"suctions", f.second->suctions.size()}};
  out["from_scan"] = f.from_scan;
  if (f.from_volume) out["from_volume"] = true;
  if (f.from_scan)  // nothing of these was seen
    for (const char* name : {"begin_s", "end_s", "procedure_s", "paused_s", "pauses", "undone", "max_bone_c",
                             "heat_dose_min", "most_force_n", "fastest_mm_per_s", "fastest_s"})
      out[name] = nullptr;
  out.update(module.facts_json(f));
  return out;
}

// Of what the points are, where that is not what one would think.
constexpr texts::Wording announced_words{
    {"The recording names another rubric than the one that gives these points.",
     "Die Aufnahme nennt einen anderen Bewertungsbogen als den, der diese Punkte gibt."}},
    unsigned_points_words{
        {"The recording is signed, and these points are not: it does not name the rubric that gives them.",
         "Die Aufnahme ist unterschrieben, diese Punkte sind es nicht: sie nennt den Bewertungsbogen "
         "nicht, der sie gibt."}},
    unasked_words{{"The rubric's questions were not asked: no time-out is judged.",
                   "Die Fragen des Bewertungsbogens wurden nicht gestellt: kein Time-out wird bewertet."}},
    tracked_words{{"A tracker saw the tool: where the procedure aims it may have been {:.1f} mm off (expected error).",
                   "Ein Trackingsystem sah das Instrument: am Ziel kann es um {:.1f} mm abgewichen sein (erwarteter "
                   "Fehler)."}};

// What the table in the terminal says beside the rows.
constexpr texts::Wording at_words{{", at {:.1f} s", ", bei {:.1f} s"}}, critical_words{{"CRITICAL", "SCHWERER FEHLER"}},
    decision_words{{"QUESTION: {} {}; right is: {}", "FRAGE: {} {}; richtig ist: {}"}},
    heat_words{{"bone at most {:.1f} degrees, as {:.2g} minutes at 43",
                "Knochen höchstens {:.1f} Grad, wie {:.2g} Minuten bei 43"}},
    undone_words{{"TAKEN BACK: {} times what was cut", "ZURÜCKGENOMMEN: {} mal, was geschnitten war"}},
    trusted_words{{"TRUSTED: the recording was not replayed", "GEGLAUBT: die Aufnahme wurde nicht nachgespielt"}},
    measured_words{{"MEASURED on a CT after the procedure, in the case's anatomy; not for clinical use",
                    "GEMESSEN auf einem CT nach dem Eingriff, in der Anatomie davor; nicht für die Klinik"}},
    drilled_words{{"MEASURED on the volume as another program drilled it; not for clinical use",
                   "GEMESSEN am Volumen, wie ein anderes Programm es bohrte; nicht für die Klinik"}},
    unsealed_words{{"NOT SEALED: made into a pipe or by an older program",
                    "OHNE SIEGEL: in eine Pipe oder von einem älteren Programm gemacht"}},
    broken_words{{"BROKEN SEAL: the recording was changed after it was written",
                  "SIEGEL GEBROCHEN: die Aufnahme wurde nachträglich verändert"}},
    points_words{{"{} of {} points{}, {}; {}, {}", "{} von {} Punkten{}, {}; {}, {}"}},
    table_words{{" ({} of {} by the table)", " ({} von {} nach der Tabelle)"}};

}  // namespace

std::vector<std::string> provenance_notes(const ReportHead& head, texts::Language language) {
  std::vector<std::string> all;
  if (head.other_rubric()) all.push_back(announced_words.of(language));
  if (head.signature == Signature::of_another_rubric) all.push_back(unsigned_points_words.of(language));
  if (head.unasked) all.push_back(unasked_words.of(language));
  if (head.place_error_mm > 0)
    all.push_back(fmt::format(fmt::runtime(tracked_words.of(language)), head.place_error_mm));
  return all;
}

ScoreSum sum_of(const LessonScore& score) {
  ScoreSum sum;
  for (const ScoreRow& row : score.rows)
    if (row.score) {
      sum.points += *row.score;
      sum.most += 5;
      sum.of_table += row.beside ? 0 : *row.score;
      sum.max_of_table += row.beside ? 0 : 5;
      sum.beside = sum.beside || row.beside;
    }
  return sum;
}

std::string headline_of(const LessonScore& score, texts::Language language) {
  const std::string reason =
      joined(score.reasons(), "; ", [&](const texts::Phrase& r) { return lesson_words(language, r); });
  return lesson_words(language, name_of(score.outcome())) + (reason.empty() ? "" : ": " + reason);
}

std::string score_json(const ReportHead& head, const LessonFacts& facts, const LessonScore& score) {
  Json rows = Json::array();
  for (const ScoreRow& row : score.rows) rows.push_back(json_of(row));
  Json figures = Json::object();
  for (const LessonFigure& f : score.figures)
    std::visit(
        [&](const auto& value) {
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>)
            figures[f.name] = nullptr;
          else
            figures[f.name] = value;
        },
        f.value);
  const ScoreSum sum = sum_of(score);
  Json critical = Json::array();
  for (const CriticalError& e : score.critical) critical.push_back(json_of(e));
  Json motion = Json::object(), experts = Json::object();
  for (const auto& [name, value] : head.motion) motion[name] = value;
  for (const ExpertBand& b : head.experts)
    experts[b.name] = {{"low", b.low}, {"high", b.high}, {"recordings", b.count}};
  Json out = {{"trephine_score", 2},
              {"module", head.module},
              {"case", head.case_token},
              {"participant", head.participant},
              {"recording_sha256", head.recording_sha256},
              {"motion_sha256", head.motion_sha256},
              {"checked", head.checked()},
              {"seal", haptics::name_of(head.seal)},
              {"signature", head.signature == Signature::not_asked ? Json(nullptr) : Json(name_of(head.signature))},
              {"case_sha256", head.case_sha256},
              {"rubric_sha256", head.rubric_sha256},
              {"task", facts.task},
              {"outcome", name_of(score.outcome())},
              {"reason", score.reason()},
              {"critical", critical},
              {"points", sum.points},
              {"most_points", sum.most},
              {"table_points", sum.of_table},
              {"most_table_points", sum.max_of_table},
              {"rows", rows},
              {"figures", figures},
              {"facts", json_of(lesson_type(head.module), facts)}};
  out["motion"] = motion;
  if (head.place_error_mm > 0) out["place_error_mm"] = head.place_error_mm;
  out["announced_rubric_sha256"] = head.announced_rubric_sha256;
  Json decisions = Json::array();
  for (const Decision& d : score.decisions) decisions.push_back(json_of(d));
  out["decisions"] = decisions;
  Json notes = Json::array();
  for (const std::string& note : provenance_notes(head, texts::Language::english)) notes.push_back(note);
  out["provenance"] = notes;
  Json feedback = Json::array();
  for (const Advice& a : score.advice)
    feedback.push_back({{"row", a.row}, {"en", a.of(texts::Language::english)}, {"de", a.of(texts::Language::german)}});
  out["feedback"] = feedback;
  if (!head.experts.empty()) {
    out["experts"] = experts;
    out["advice"] = motion_advice(head.motion, head.experts);
  }
  return out.dump(1) + "\n";
}

std::string score_text(const ReportHead& head, const LessonFacts& facts, const LessonScore& score) {
  const texts::Language language = head.language;
  const auto say = [&](const texts::Wording& w) { return w.of(language); };
  const auto words = [&](const texts::Phrase& phrase) { return lesson_words(language, phrase); };
  std::string text;
  for (const ScoreRow& row : score.rows) {
    text += fmt::format("{:<33} {:>13}  {}", words(row.title),
                        row.score ? std::to_string(*row.score) : words("not judged"), words(row.why));
    std::string figures;
    for (const auto& [name, value] : row.measured)
      figures += fmt::format("{}{} {:.1f}", figures.empty() ? "" : ", ", name, value);
    if (!figures.empty()) text += " (" + figures + ")";
    if (row.decided_s) text += fmt::format(fmt::runtime(say(at_words)), *row.decided_s);
    text += "\n";
  }
  const ScoreSum sum = sum_of(score);
  for (const CriticalError& e : score.critical)
    text += fmt::format("{}: {}{}\n", say(critical_words), words(e.what),
                        e.at_s ? fmt::format(fmt::runtime(say(at_words)), *e.at_s) : "");
  for (const Decision& d : score.decisions)
    if (d.state != AnswerState::right)
      text += fmt::format(fmt::runtime(say(decision_words)), d.text.of(language), words(name_of(d.state)),
                          d.right_text.of(language)) +
              "\n";
  if (facts.max_bone_c > 0)
    text += fmt::format(fmt::runtime(say(heat_words)), facts.max_bone_c, facts.heat_dose_min) + "\n";
  if (facts.undone > 0) text += fmt::format(fmt::runtime(say(undone_words)), facts.undone) + "\n";
  if (head.measured) text += std::string(say(facts.from_volume ? drilled_words : measured_words)) + "\n";
  if (!head.measured && !head.replayed) text += std::string(say(trusted_words)) + "\n";
  if (!head.measured && head.seal == haptics::Seal::absent) text += std::string(say(unsealed_words)) + "\n";
  if (head.seal == haptics::Seal::broken) text += std::string(say(broken_words)) + "\n";
  if (head.signature != Signature::not_asked) text += std::string(name_of(head.signature)) + "\n";
  for (const std::string& note : provenance_notes(head, language)) text += note + "\n";
  for (const Advice& a : score.advice) text += a.of(language) + "\n";
  for (const std::string& sentence : motion_advice(head.motion, head.experts, language)) text += sentence + "\n";
  text += headline_of(score, language) + "\n";
  text += fmt::format(fmt::runtime(say(points_words)), sum.points, sum.most,
                      sum.beside ? fmt::format(fmt::runtime(say(table_words)), sum.of_table, sum.max_of_table) : "",
                      words(name_of(score.outcome())), facts.from_scan ? head.checked() : words(name_of(facts.end)),
                      words(lesson_type(head.module).outcome(facts, score)));
  return text + "\n";
}

}  // namespace trephine::lessons
