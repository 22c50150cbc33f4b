// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/base64.h"
#include "base/html_text.h"
#include "group/group_view.h"
#include "group/group_words.h"
#include "lessons/lesson_type.h"
#include "lessons/lesson_words.h"
#include "study/words.h"

namespace trephine::group {
namespace {

constexpr const char* style = R"(
:root { color-scheme: light dark; --faint: #75828f; --line: #a9b6c3; --bad: #d55e00; --good: #009e73 }
body { font: 14px/1.45 system-ui, sans-serif; max-width: 78em; margin: 1em auto; padding: 0 1em }
h1 { font-size: 1.4em; margin: 0 } h2 { font-size: 1.2em; margin: 2em 0 .3em; border-bottom: 2px solid var(--line) }
h3 { font-size: 1em; margin: 1.4em 0 .3em } .faint, figcaption { color: var(--faint); font-size: .9em }
table { border-collapse: collapse; margin: .4em 0 } td, th { text-align: left; vertical-align: top; padding: .25em .9em .25em 0; border-bottom: 1px solid var(--line) }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums } .wide { overflow-x: auto }
.plots { display: flex; flex-wrap: wrap; gap: 1em } figure { margin: 0; flex: 1 1 26em; max-width: 40em } img { width: 100%; background: #fff }
.note { margin: .2em 0 } .note::before { content: "note: "; color: var(--faint) } :lang(de) .note::before { content: "Hinweis: " } .bad { color: var(--bad); font-weight: bold } .good { color: var(--good) } .large { font-size: 1.3em; font-weight: bold }
)";

// Of a pass mark, after "By".
constexpr texts::Wording of_phase{{"phase {}", "der Phase {}"}};

std::string cell(const std::string& text, const char* kind = "n") {
  return fmt::format("<td class=\"{}\">{}", kind, html_text(text));
}
std::string percent(double ratio) { return fmt::format("{:.0f} %", 100 * ratio); }

std::string title_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// ", mm"; empty for a ratio or a count.
std::string unit_of(const std::string& figure) {
  const std::string unit = lessons::figure_unit(figure);
  return unit.empty() ? "" : ", " + unit;
}

std::string table_begin(const std::vector<std::string>& heads, std::size_t texts) {
  std::string out = "<div class=\"wide\"><table><tr>";
  for (std::size_t n = 0; n < heads.size(); ++n)
    out += fmt::format("<th{}>{}", n < texts ? "" : " class=\"n\"", html_text(heads[n]));
  return out + "</tr>\n";
}
constexpr const char* table_end = "</table></div>\n";

std::vector<std::string> shown_phases(const ModuleView& m) {
  return m.phases.empty() ? std::vector<std::string>{""} : m.phases;
}
std::string phase_title(const std::string& phase, texts::Language l) {
  return group_word(l, phase.empty() ? "all" : phase);
}

bool signature_asked(const ModuleView& m) {
  return std::any_of(m.attempts.begin(), m.attempts.end(),
                     [](const auto& a) { return a.signature != lessons::Signature::not_asked; });
}

// Whether a teacher signed what the points come from, in large letters.
std::string signed_html(const ModuleView& m, texts::Language l) {
  if (!signature_asked(m))
    return std::string("<p class=\"faint\">") + group_word(l, "Signatures were not asked for.") + "</p>\n";
  const auto count = std::size_t(std::count_if(m.attempts.begin(), m.attempts.end(),
                                               [](const auto& a) { return a.signature == lessons::Signature::fits; }));
  if (count == m.attempts.size())
    return std::string("<p class=\"large good\">") + group_word(l, "Signed: every attempt.") + "</p>\n";
  return std::string("<p class=\"large bad\">") +
         fmt::format(fmt::runtime(group_word(l, "Not signed: {} of {} attempts.")), m.attempts.size() - count,
                     m.attempts.size()) +
         "</p>\n";
}

std::string participants_html(const ModuleView& m, texts::Language l) {
  std::vector<std::string> heads;
  for (const char* head : {"participant", "group", "level", "done of planned", "completed", "failed"})
    heads.push_back(group_word(l, head));
  const bool asked = signature_asked(m);
  if (asked) heads.push_back(group_word(l, "signed"));
  for (const std::string& phase : shown_phases(m)) heads.push_back(phase_title(phase, l));
  heads.insert(heads.end(), {group_word(l, "first"), group_word(l, "last"), group_word(l, "kept")});
  std::string out = table_begin(heads, 3);
  for (const ParticipantView& p : m.participants) {
    out += "<tr><td>" + html_text(p.participant) + "<td>" + html_text(p.group) + "<td>" + html_text(p.level);
    out += cell(p.planned > 0 ? fmt::format(fmt::runtime(group_word(l, "{} of {}")), p.done, p.planned)
                              : std::to_string(p.done),
                p.done < p.planned ? "n faint" : "n");
    out += cell(std::to_string(p.completed)) + cell(std::to_string(p.failed), p.failed > 0 ? "n bad" : "n");
    if (asked)
      out += cell(fmt::format(fmt::runtime(group_word(l, "{} of {}")), p.signed_count, p.done),
                  p.signed_count < p.done ? "n bad" : "n");
    for (const std::string& phase : shown_phases(m)) {
      const auto at = p.share_by_phase.find(phase);
      out += cell(at == p.share_by_phase.end() ? "" : percent(at->second));
    }
    out += cell(p.done > 0 ? percent(p.first_share) : "") + cell(p.done > 0 ? percent(p.last_share) : "");
    out += cell(p.retained_ratio ? percent(*p.retained_ratio) : "") + "</tr>\n";
  }
  return out + table_end + "<p class=\"faint\">" +
         group_word(
             l,
             "Shares of the points that could be had, as means over attempts. Kept: (retention - before) / (after - "
             "before), where there was a gain.") +
         "</p>\n";
}

std::string rows_html(const ModuleView& m, texts::Language l) {
  std::vector<std::string> heads = {group_word(l, "row")};
  for (const std::string& phase : shown_phases(m)) heads.push_back(phase_title(phase, l));
  std::string out = std::string("<h3>") +
                    group_word(l, "Rows of the score: mean of 1 to 5, and how often it was judged") + "</h3>\n" +
                    table_begin(heads, 1);
  for (const RowView& row : m.rows) {
    out += "<tr><td>" + html_text(lessons::lesson_words(l, row.title));
    for (const std::string& phase : shown_phases(m)) {
      const auto at = row.by_phase.find(phase);
      out += cell(at == row.by_phase.end() ? group_word(l, "not judged")
                                           : fmt::format("{:.1f} ({})", at->second.first, at->second.second));
    }
    out += "</tr>\n";
  }
  return out + table_end;
}

std::string failures_html(const ModuleView& m, texts::Language l) {
  std::string out = std::string("<h3>") + group_word(l, "Critical errors") + "</h3>\n";
  if (m.failures.empty()) return out + "<p>" + group_word(l, "None happened.") + "</p>\n";
  out += table_begin({group_word(l, "error"), group_word(l, "by whom"), group_word(l, "how often")}, 2);
  for (const auto& [error, by] : m.failures) {
    std::string who;
    std::size_t count = 0;
    for (const auto& [participant, times] : by) {
      who += (who.empty() ? "" : ", ") + participant + (times > 1 ? fmt::format(" ({})", times) : "");
      count += times;
    }
    out += "<tr><td>" + html_text(lessons::lesson_words(l, title_of(error))) + "<td>" + html_text(who) +
           cell(std::to_string(count)) + "</tr>\n";
  }
  return out + table_end;
}

std::string pass_mark_html(const ModuleView& m, texts::Language l) {
  if (!m.pass_mark) return "";
  const PassMark& p = *m.pass_mark;
  std::string out = std::string("<h3>") + group_word(l, "Pass mark, by contrasting groups") + "</h3>\n";
  if (!p.why_not.empty())
    return out + "<p class=\"note\">" + fmt::format(fmt::runtime(group_word(l, "not set: {}")), html_text(p.why_not)) +
           "</p>\n";
  const std::string of = p.of.rfind("phase ", 0) == 0
                             ? fmt::format(fmt::runtime(of_phase.of(l)), phase_title(p.of.substr(6), l))
                             : group_word(l, p.of);
  out +=
      "<p>" +
      fmt::format(fmt::runtime(group_word(
                      l,
                      "By {}: <b>{:.1f} %</b> of the points, where the normal densities of {} ({} participants, mean "
                      "{:.1f} %, sd {:.1f}) and {} ({}, mean {:.1f} %, sd {:.1f}) cross. Who failed by a critical "
                      "error or did not finish has not passed, whatever the points.")),
                  html_text(of), 100 * p.mark_ratio, html_text(p.less), p.less_summary.count, 100 * p.less_summary.mean,
                  100 * *p.less_summary.sd, html_text(p.more), p.more_summary.count, 100 * p.more_summary.mean,
                  100 * *p.more_summary.sd) +
      "</p>\n";
  out += "<p class=\"faint\">" +
         fmt::format(
             fmt::runtime(group_word(l,
                                     "{} of {} pass and {} of {} fail (expected of normal distributions: {:.1f} and "
                                     "{:.1f} %). A mark from few participants is uncertain.")),
             percent(p.less_pass_ratio), html_text(p.less), percent(p.more_fail_ratio), html_text(p.more),
             100 * p.less_pass_expected_ratio, 100 * p.more_fail_expected_ratio) +
         "</p>\n";
  std::string passed, not_passed;
  for (const auto& [participant, pass] : p.passed) {
    std::string& list = pass ? passed : not_passed;
    list += (list.empty() ? "" : ", ") + participant;
  }
  const auto shown = [&](const std::string& list) { return list.empty() ? group_word(l, "nobody") : html_text(list); };
  return out + "<p><span class=\"good\">" + group_word(l, "Passed:") + "</span> " + shown(passed) +
         "<br><span class=\"bad\">" + group_word(l, "Not passed:") + "</span> " + shown(not_passed) + "</p>\n";
}

// The last attempt of each participant beside what experts do.
std::string motion_html(const ModuleView& m, texts::Language l) {
  if (m.bands.empty()) return "";
  std::vector<std::string> heads = {group_word(l, "figure of the hand's motion"), group_word(l, "experts")};
  std::vector<const lessons::AttemptResult*> last;
  for (const ParticipantView& p : m.participants) {
    const lessons::AttemptResult* found = nullptr;
    for (const lessons::AttemptResult& r : m.attempts)
      if (r.participant == p.participant) found = &r;
    if (!found || found->motion.empty()) continue;
    last.push_back(found);
    heads.push_back(p.participant);
  }
  std::string out =
      "<h3>" +
      fmt::format(fmt::runtime(group_word(l, "Motion in the last attempt, beside {} recordings of experts")),
                  m.bands.front().count) +
      "</h3>\n" + table_begin(heads, 1);
  for (const lessons::ExpertBand& band : m.bands) {
    out += "<tr><td>" + html_text(lessons::figure_title(l, band.name) + unit_of(band.name)) +
           cell(fmt::format(fmt::runtime(group_word(l, "{} to {}")), fmt::format("{:.4g}", band.low),
                            fmt::format("{:.4g}", band.high)));
    for (const lessons::AttemptResult* r : last) {
      const std::optional<double> value = r->figure(band.name);
      const bool within = value && *value >= band.low && *value <= band.high;
      out += cell(value ? fmt::format("{:.4g}", *value) : "", !value || within ? "n" : "n bad");
    }
    out += "</tr>\n";
  }
  return out + table_end + "<p class=\"faint\">" + group_word(l, "Coloured: outside of the experts' band.") + "</p>\n";
}

// Each question by phase: the mean answer, how many gave one, and whether it changed in those who answered twice.
std::string answers_html(const study::Study& answers, texts::Language l) {
  std::string out = std::string("<h2>") + group_word(l, "Questionnaire") + "</h2>\n";
  for (const std::string& note : answers.notes) out += "<p class=\"note\">" + html_text(note) + "</p>\n";
  std::vector<std::string> heads;
  for (const char* head : {"question", "phase", "answers", "mean", "median", "change in those who answered in both"})
    heads.push_back(group_word(l, head));
  out += table_begin(heads, 2);
  for (const study::MeasureStudy& m : answers.measures)
    for (const study::Comparison& c : m.comparisons) {
      if (c.by != "phase") continue;
      for (std::size_t n = 0; n < c.samples.size(); ++n) {
        const study::Summary& s = c.samples[n].summary;
        std::string change;
        for (const study::PairTests& pair : c.pairs)
          for (const study::NamedTest& test : pair.tests)
            if (pair.first == 0 && pair.second == n && test.name == "signed rank") change = study::sentence(test);
        out += "<tr><td>" + html_text(n == 0 ? title_of(m.name) : "") + "<td>" +
               html_text(phase_title(c.samples[n].name, l)) + cell(std::to_string(s.count)) +
               cell(s.count > 0 ? study::figure(s.mean) : "") + cell(s.count > 0 ? study::figure(s.median) : "") +
               cell(change) + "</tr>\n";
      }
    }
  return out + table_end;
}

}  // namespace

std::string group_page(const GroupView& view, const GroupPageParts& parts, texts::Language l) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src '{}'; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>{}</title>\n"
      "<style>{}</style></head><body>\n",
      l == texts::Language::german ? "de" : "en", policy_hash(style), group_word(l, "Trephine: a group"), style);
  std::size_t attempts = 0;
  std::map<std::string, bool> participants;
  for (const ModuleView& m : view.modules) {
    attempts += m.attempts.size();
    for (const ParticipantView& p : m.participants) participants[p.participant] = true;
  }
  out += "<h1>" +
         fmt::format(fmt::runtime(group_word(l, "A group of {} participants, {} attempts")), participants.size(),
                     attempts) +
         "</h1>\n<p class=\"faint\">" + group_word(l, "not a medical device") + "</p>\n";
  for (const texts::Phrase& note : view.notes) out += "<p class=\"note\">" + html_text(group_words(l, note)) + "</p>\n";
  for (const ModuleView& m : view.modules) {
    out += "<h2>" + html_text(lessons::lesson_title(m.module, l)) + "</h2>\n" + signed_html(m, l) +
           participants_html(m, l);
    if (const auto at = parts.pictures.find(m.module); at != parts.pictures.end()) {
      out += "<div class=\"plots\">\n";
      for (const auto& [title, svg] : at->second)
        out += "<figure><img alt=\"" + html_text(title) + "\" src=\"data:image/svg+xml;base64," + base64(svg) +
               "\"><figcaption>" + html_text(title) + "</figcaption></figure>\n";
      out += "</div>\n";
    }
    out += rows_html(m, l) + failures_html(m, l) + pass_mark_html(m, l) + motion_html(m, l);
  }
  if (parts.answers) out += answers_html(*parts.answers, l);
  return out + "</body></html>\n";
}

}  // namespace trephine::group
