// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/base64.h"
#include "lessons/lesson_guide.h"
#include "lessons/lesson_type.h"
#include "lessons/report_pictures.h"
#include "session/hand_watch.h"

namespace trephine::lessons {
namespace {

using detail::escaped;

constexpr const char* style = R"(
:root { color-scheme: light dark; --faint: #7a8896; --line: #a9b6c3; --way: #ffb000; --expert: #35c46a; --target: #ff4f4f }
body { font: 14px/1.45 system-ui, sans-serif; max-width: 62em; margin: 1em auto; padding: 0 1em }
h1 { font-size: 1.3em; margin: 0 } h2 { font-size: 1em; margin: 1.6em 0 .4em; color: var(--faint) }
table { border-collapse: collapse; width: 100% } td, th { text-align: left; vertical-align: top; padding: .3em .6em .3em 0; border-bottom: 1px solid var(--line) }
.failed { border-left: .4em solid var(--target); padding-left: .6em; font-size: 1.15em }
.signed { border-left: .4em solid var(--expert); padding-left: .6em; font-size: 1.15em }
.score { font-size: 1.3em; white-space: nowrap } td.faint { white-space: nowrap } .faint, figcaption { color: var(--faint); font-size: .85em }
.slices { display: flex; gap: .5em } figure { margin: 0; flex: 1 } svg { width: 100%; background: #000 }
polyline, line { fill: none } circle { fill: none; stroke-width: 1 }
.way { stroke: var(--way); stroke-width: 1.2 } .expert { stroke: var(--expert); stroke-width: .8; stroke-dasharray: 3 2 }
.target { stroke: var(--target) } .hole { stroke: #58a6ff } .tip { stroke: var(--way); fill: var(--way) }
.plot { background: none } .force { stroke: #3d7de0; stroke-width: 1 } .moment { stroke: var(--target); stroke-width: .7 }
.plot text { fill: var(--faint); font-size: 10px }
.slices text { fill: #fff; font: 9px system-ui, sans-serif; stroke: #000; stroke-width: 2px; paint-order: stroke } .scale { stroke: #fff; stroke-width: 1.5 } .t0 { fill: #8886 } .t1 { fill: #d806 } .t2 { fill: #2a66 }
)";

using texts::Language;
using texts::Wording;

constexpr Wording row_heads[] = {{{"row", "Zeile"}},
                                 {{"score", "Punkte"}},
                                 {{"measured", "gemessen"}},
                                 {{"limits", "Grenzen"}},
                                 {{"decided", "entschieden"}}};
constexpr Wording thesis_word{{"thesis", "Dissertation"}}, ours_word{{"ours", "von uns"}};
constexpr Wording force_words{{"force over time", "Kraft über die Zeit"}},
    forces_words{{"Forces over time", "Kräfte über die Zeit"}};
constexpr Wording below_words{{"Below: {}. Red lines: the moments at which rows were decided.",
                               "Unten: {}. Rote Linien: die Zeitpunkte, zu denen Zeilen entschieden wurden."}};
constexpr Wording tool_colours[] = {{{"grey", "grau"}}, {{"orange", "orange"}}, {{"green", "grün"}}};  // t0 to t2
constexpr Wording motion_words{{"How the hand moved", "Wie die Hand sich bewegte"}};
constexpr Wording motion_heads[] = {{{"figure", "Größe"}}, {{"measured", "gemessen"}}, {{"experts", "Erfahrene"}}};
constexpr Wording to_word{{"to", "bis"}};
constexpr Wording motion_note{{"These figures score nothing. docs/how-to/study.md says how they are measured.",
                               "Diese Größen geben keine Punkte. docs/how-to/study.md sagt, wie sie gemessen werden."}};
constexpr Wording decisions_words{{"Questions and answers", "Fragen und Antworten"}};
constexpr Wording decision_heads[] = {{{"question", "Frage"}}, {{"answer", "Antwort"}}, {{"right is", "richtig ist"}}};
constexpr Wording answer_words[] = {{{"not answered", "nicht beantwortet"}},  // AnswerState
                                    {{"right", "richtig"}},
                                    {{"wrong", "falsch"}},
                                    {{"after the cut", "nach dem Schnitt"}}};
constexpr Wording advice_words{{"Next time", "Beim nächsten Mal"}};
constexpr Wording title_words{{"{} in {}: {} of {} points, {}", "{} in {}: {} von {} Punkten, {}"}};
constexpr Wording participant_words{{"participant {} · {} · {:.1f} s · {} · not a medical device",
                                     "Teilnehmer {} · {} · {:.1f} s · {} · kein Medizinprodukt"}};
constexpr Wording measured_words{
    {"participant {} · measured on a CT after the procedure, in the anatomy of the case · {} · not for clinical use",
     "Teilnehmer {} · gemessen auf einem CT nach dem Eingriff, in der Anatomie davor · {} · nicht für die Klinik"}};
constexpr Wording drilled_words{
    {"participant {} · measured on the volume as another program drilled it · {} · not for clinical use",
     "Teilnehmer {} · gemessen am Volumen, wie ein anderes Programm es bohrte · {} · nicht für die Klinik"}};
constexpr Wording task_words{{"Task: ", "Aufgabe: "}};
constexpr Wording trusted_words{
    {"Trusted: the recording was not replayed.", "Geglaubt: die Aufnahme wurde nicht nachgespielt."}};
constexpr Wording signed_words{{"Signed", "Unterschrieben"}}, unsigned_words{{"Not signed", "Nicht unterschrieben"}};
constexpr Wording undone_words{
    {"What was cut was taken back {} times.", "Was geschnitten war, wurde {} mal zurückgenommen."}};
constexpr Wording made_words{{"Made of", "Gemacht aus"}};
constexpr Wording made_of_words{{"recording {} ({}, {})<br>motion {}<br>case {}<br>rubric {}",
                                 "Aufnahme {} ({}, {})<br>Bewegung {}<br>Fall {}<br>Bewertungsbogen {}"}};

// A rubric's reason, in German where its author wrote that too.
template <class Rule>
const std::string& reason_of(const Rule& rule, Language language) {
  return language == Language::german && !rule.why_de.empty() ? rule.why_de : rule.why;
}

// Why the rubric lets each critical error fail the lesson.
std::string critical_html(const LessonScore& score, Language language) {
  if (score.critical.empty()) return "";
  std::string out = "<ul>\n";
  for (const CriticalError& e : score.critical)
    out += fmt::format("<li>{}{}: <span class=\"faint\">{}</span>\n", escaped(lesson_words(language, e.what)),
                       e.at_s ? fmt::format(" ({:.1f} s)", *e.at_s) : "", escaped(reason_of(e.rule, language)));
  return out + "</ul>\n";
}

std::string rows_html(const LessonScore& score, Language language) {
  const auto words = [&](const texts::Phrase& phrase) { return escaped(lesson_words(language, phrase)); };
  std::string out = "<table><tr>";
  for (const Wording& w : row_heads) out += std::string("<th>") + w.of(language);
  out += "</tr>\n";
  for (const ScoreRow& row : score.rows) {
    std::string measured, limits;
    for (const auto& [name, value] : row.measured)
      measured += fmt::format("{} {:.1f} {}<br>", escaped(figure_title(language, name)), value, figure_unit(name));
    for (const auto& [name, l] : row.limits)
      limits += fmt::format("<span title=\"{}\">{} {:g} {} <b>{}</b></span><br>", escaped(reason_of(l, language)),
                            escaped(figure_title(language, name)), l.limit, figure_unit(name),
                            (l.from == lesson::RubricLimit::From::thesis ? thesis_word : ours_word).of(language));
    out += fmt::format("<tr><td><b>{}</b><br>{}<td class=\"score\">{}<td>{}<td class=\"faint\">{}<td>{}</tr>\n",
                       words(row.title), words(row.why),
                       row.score ? fmt::format("{} / 5", *row.score) : words("not judged"), measured, limits,
                       row.decided_s ? fmt::format("{:.1f} s", *row.decided_s) : "");
  }
  return out + "</table>\n";
}

// What was asked, what was answered, and what is right with its reason.
std::string decisions_html(const LessonScore& score, Language language) {
  if (score.decisions.empty()) return "";
  std::string out = std::string("<h2>") + decisions_words.of(language) + "</h2>\n<table><tr>";
  for (const Wording& w : decision_heads) out += std::string("<th>") + w.of(language);
  out += "</tr>\n";
  for (const Decision& d : score.decisions)
    out +=
        fmt::format("<tr><td>{}<td>{}<br><b>{}</b>{}<td>{}<br><span class=\"faint\">{}</span></tr>\n",
                    escaped(d.text.of(language)), escaped(d.given_text.of(language)),
                    answer_words[std::size_t(d.state)].of(language), d.at_s ? fmt::format(" ({:.1f} s)", *d.at_s) : "",
                    escaped(d.right_text.of(language)), escaped(d.why.of(language)));
  return out + "</table>\n";
}

// What to do otherwise, a sentence for each direction that was missed.
std::string advice_html(const LessonScore& score, Language language) {
  if (score.advice.empty()) return "";
  std::string out = std::string("<h2>") + advice_words.of(language) + "</h2>\n<ul>\n";
  for (const Advice& a : score.advice) {
    const ScoreRow* row = score.row(a.row);
    out += fmt::format("<li><b>{}</b>: {}\n", escaped(lesson_words(language, row ? row->title : a.row)),
                       escaped(a.of(language)));
  }
  return out + "</ul>\n";
}

// The size of the force, the largest of each piece of time, with the tool in hand behind it.
std::string forces_html(const LessonScore& score, const haptics::Recording& recording, Language language) {
  constexpr double width = 900, height = 160, left = 30;
  const std::vector<haptics::ServoFrame>& frames = recording.frames;
  const std::vector<std::size_t> in_hand = session::tools_in_hand(recording);
  const double begin = frames.front().time_s, length = std::max(1e-9, frames.back().time_s - begin);
  const double most = recording.header.force.max_force_n;
  const auto x = [&](double time_s) { return left + (width - left) * (time_s - begin) / length; };
  const auto y = [&](double force_n) { return height - 20 - (height - 30) * std::min(1.0, force_n / most); };
  std::string out = fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", width,
                                height, force_words.of(language));
  std::string line;
  double piece = 0;
  std::size_t last = 0, from = 0;
  std::set<std::size_t> used;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const haptics::ServoFrame& f = frames[n];
    piece = std::max(
        piece, std::sqrt(f.force_n[0] * f.force_n[0] + f.force_n[1] * f.force_n[1] + f.force_n[2] * f.force_n[2]));
    if (x(f.time_s) - x(frames[last].time_s) >= 0.75 || n + 1 == frames.size()) {
      line += fmt::format("{:.1f},{:.1f} ", x(f.time_s), y(piece));
      piece = 0;
      last = n;
    }
    if (in_hand[n] != in_hand[from] || n + 1 == frames.size()) {
      const std::size_t tool = in_hand[from];
      const std::string name = tool < recording.header.tools.size() ? recording.header.tools[tool].name : "";
      used.insert(tool);
      out += fmt::format(
          "<rect class=\"t{}\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"8\"><title>{}</title></rect>", tool % 3,
          x(frames[from].time_s), height - 16, x(f.time_s) - x(frames[from].time_s),
          escaped(tool_title(language, name)));
      from = n;
    }
  }
  for (const ScoreRow& row : score.rows)
    if (row.decided_s)
      out += fmt::format(
          "<line class=\"moment\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"8\" y2=\"{1}\"><title>{2}</title></line>",
          x(*row.decided_s), height - 20, escaped(lesson_words(language, row.title)));
  out += fmt::format("<polyline class=\"force\" points=\"{}\"/>", line);
  out += fmt::format("<text x=\"0\" y=\"{:.0f}\">{:g} N</text><text x=\"0\" y=\"{:.0f}\">0</text>", y(most) + 4, most,
                     y(0.0));
  out += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">{:.0f} s</text></svg>\n", width - 40, height, length);
  std::string tools;
  for (const std::size_t n : used)
    if (n < recording.header.tools.size())
      tools += fmt::format("{}{}: {}", tools.empty() ? "" : ", ", tool_colours[n % 3].of(language),
                           escaped(tool_title(language, recording.header.tools[n].name)));
  return out + "<p class=\"faint\">" + fmt::format(fmt::runtime(below_words.of(language)), tools) + "</p>\n";
}

// How the hand moved, beside what experts did where there are any.
std::string motion_html(const ReportHead& head) {
  if (head.motion.empty()) return "";
  const Language language = head.language;
  std::string out = std::string("<h2>") + motion_words.of(language) + "</h2>\n<table><tr>";
  for (const Wording& w : motion_heads) out += std::string("<th>") + w.of(language);
  out += "</tr>\n";
  for (const auto& [name, value] : head.motion) {
    std::string band;
    for (const ExpertBand& b : head.experts)
      if (b.name == name) band = fmt::format("{:.3g} {} {:.3g}", b.low, to_word.of(language), b.high);
    out += fmt::format("<tr><td>{}<td>{} {}<td class=\"faint\">{}</tr>\n", escaped(figure_title(language, name)),
                       std::abs(value) >= 100 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value),
                       figure_unit(name), band);
  }
  out += "</table>\n";
  for (const std::string& sentence : motion_advice(head.motion, head.experts, language))
    out += "<p>" + escaped(sentence) + "</p>\n";
  return out + "<p class=\"faint\">" + motion_note.of(language) + "</p>\n";
}

}  // namespace

std::string report_page(const ReportHead& head, const LessonFacts& facts, const LessonScore& score,
                        const haptics::Recording& recording, const cases::LoadedCase& loaded) {
  const LessonType& module = lesson_type(head.module);
  const Language language = head.language;
  const auto say = [&](const Wording& w) { return w.of(language); };
  const auto words = [&](const texts::Phrase& phrase) { return escaped(lesson_words(language, phrase)); };
  const ScoreSum sum = sum_of(score);
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src '{}'; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Trephine lesson</title>\n"
      "<style>{}</style></head><body>\n",
      language == Language::german ? "de" : "en", policy_hash(style), style);
  out += "<h1>" + fmt::format(fmt::runtime(say(title_words)), escaped(head.module), escaped(head.case_token),
                              sum.points, sum.most, words(name_of(score.outcome())));
  const std::string who = escaped(head.participant), headline = words(module.headline(facts, score));
  out += "</h1>\n<p class=\"faint\">";
  const Wording& measured = facts.from_volume ? drilled_words : measured_words;
  out += facts.from_scan ? fmt::format(fmt::runtime(say(measured)), who, headline)
                         : fmt::format(fmt::runtime(say(participant_words)), who, words(name_of(facts.end)),
                                       facts.procedure_s(), headline);
  out += fmt::format("</p>\n<p class=\"{}\"><b>{}</b>{}</p>\n",
                     score.outcome() == LessonOutcome::failed ? "failed" : "", escaped(headline_of(score, language)),
                     facts.task.empty() ? ""
                                        : std::string("<br>") + say(task_words) +
                                              escaped(aim_of(task_of(module, loaded.manifest, facts.task), language)));
  out += critical_html(score, language);
  if (!head.replayed && !head.measured)
    out += std::string("<p class=\"failed\"><b>") + say(trusted_words) + "</b></p>\n";
  if (head.signature != Signature::not_asked) {
    const bool fits = head.signature == Signature::fits;
    out += fmt::format("<p class=\"{}\"><b>{}</b></p>\n", fits ? "signed" : "failed",
                       say(fits ? signed_words : unsigned_words));
  }
  for (const std::string& note : provenance_notes(head, language)) out += "<p><b>" + escaped(note) + "</b></p>\n";
  if (facts.undone > 0) out += "<p><b>" + fmt::format(fmt::runtime(say(undone_words)), facts.undone) + "</b></p>\n";
  out += rows_html(score, language) + decisions_html(score, language) + advice_html(score, language);
  if (!facts.from_scan) out += steps_html(guide_of(module, facts), language);
  if (!recording.frames.empty())
    out += std::string("<h2>") + say(forces_words) + "</h2>\n" + forces_html(score, recording, language);
  out += motion_html(head);
  out += module.pictures(facts, loaded, language);
  out += std::string("<h2>") + say(made_words) + "</h2>\n<p class=\"faint\">" +
         fmt::format(fmt::runtime(say(made_of_words)), head.recording_sha256, head.checked(),
                     haptics::name_of(head.seal), head.motion_sha256, head.case_sha256, head.rubric_sha256);
  return out + "</p>\n</body></html>\n";
}

}  // namespace trephine::lessons
