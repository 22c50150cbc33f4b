// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/base64.h"
#include "base/html_text.h"
#include "study/plots.h"
#include "study/words.h"

namespace trephine::study {
namespace {

constexpr const char* style = R"(
:root { color-scheme: light dark; --faint: #75828f; --line: #a9b6c3 }
body { font: 14px/1.45 system-ui, sans-serif; max-width: 74em; margin: 1em auto; padding: 0 1em }
h1 { font-size: 1.4em; margin: 0 } h2 { font-size: 1.15em; margin: 2em 0 .3em; border-bottom: 2px solid var(--line) }
h3 { font-size: 1em; margin: 1.2em 0 .3em } .faint, figcaption { color: var(--faint); font-size: .9em }
table { border-collapse: collapse; margin: .4em 0 } td, th { text-align: left; vertical-align: top; padding: .25em .9em .25em 0; border-bottom: 1px solid var(--line) }
td.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums } .wide { overflow-x: auto }
.plots { display: flex; flex-wrap: wrap; gap: 1em } figure { margin: 0; flex: 1 1 26em; max-width: 40em } img { width: 100%; background: #fff }
.note::before { content: "note: "; color: var(--faint) } .note { margin: .2em 0 } .small { font-weight: bold }
)";

std::string notes_html(const std::vector<std::string>& notes) {
  std::string out;
  for (const std::string& note : notes) out += "<p class=\"note\">" + html_text(note) + "</p>\n";
  return out;
}

std::string number_cell(const std::string& text) { return "<td class=\"n\">" + html_text(text); }

std::string samples_html(const Comparison& c) {
  std::string out = "<div class=\"wide\"><table><tr><th>" + c.by +
                    "<th>n<th>mean<th>interval of the mean<th>sd<th>median<th>quartiles<th>least<th>most</tr>\n";
  for (const Sample& s : c.samples) {
    const Summary& m = s.summary;
    out += "<tr><td>" + html_text(s.name) + number_cell(std::to_string(m.count));
    if (m.count > 0)
      out += number_cell(figure(m.mean)) + number_cell(m.mean_interval ? figures(*m.mean_interval) : "") +
             number_cell(m.sd ? figure(*m.sd) : "") + number_cell(figure(m.median)) +
             number_cell(figure(m.lower_quartile) + " to " + figure(m.upper_quartile)) + number_cell(figure(m.least)) +
             number_cell(figure(m.most));
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string estimate_text(const std::optional<Estimate>& e) {
  if (!e) return "";
  return figure(e->value) + (e->interval ? " " + figures(*e->interval) : "");
}

std::string test_row(const std::string& of, const NamedTest& t) {
  const TestResult& r = t.result;
  std::string out = "<tr><td>" + html_text(of) + "<td>" + html_text(t.name);
  if (!r.tested()) return out + "<td colspan=\"7\">not tested: " + html_text(r.why_not) + "</tr>\n";
  const auto p_cell = [](double p) {
    return fmt::format("<td class=\"n{}\">{}", p < 0.05 ? " small" : "",
                       html_text(p < 0.0001 ? "< 0.0001" : fmt::format("{:.4f}", p)));
  };
  out += number_cell(figure(r.statistic)) + number_cell(r.degrees ? figure(*r.degrees) : "") + p_cell(r.p);
  out += t.corrected_p ? p_cell(*t.corrected_p) : std::string("<td>");
  out += number_cell(estimate_text(r.difference)) +
         number_cell(r.effect ? effect_name(t.name) + " " + estimate_text(r.effect) : "");
  return out + "<td class=\"faint\">" + html_text(r.note) + "</tr>\n";
}

std::string tests_html(const Comparison& c) {
  std::string out =
      "<div class=\"wide\"><table><tr><th>of<th>test<th>statistic<th>degrees<th>p<th>corrected<th>difference<th>effect "
      "size<th></tr>\n";
  if (c.all) out += test_row("all", *c.all);
  for (const PairTests& p : c.pairs)
    for (std::size_t n = 0; n < p.tests.size(); ++n) out += test_row(n == 0 ? pair_title(c, p) : "", p.tests[n]);
  return out + "</table></div>\n";
}

}  // namespace

std::string study_page(const Study& study, const std::vector<std::pair<StudyPlot, std::string>>& pictures) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src '{}'; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Trephine study</title>\n"
      "<style>{}</style></head><body>\n",
      policy_hash(style), style);
  out += fmt::format(
      "<h1>Study: {} rows{}</h1>\n<p class=\"faint\">intervals of {:g} %; p values of pairs corrected by "
      "{}; not a medical device</p>\n",
      study.rows_count, study.participants_count ? fmt::format(" of {} participants", study.participants_count) : "",
      100 * study.params.confidence_ratio,
      study.params.correction == Correction::holm         ? "Holm"
      : study.params.correction == Correction::bonferroni ? "Bonferroni"
                                                          : "nothing");
  out += notes_html(study.notes);
  if (!study.acceptable.empty()) {
    out += "<h2>Acceptable results</h2>\n<div class=\"wide\"><table><tr>";
    for (const std::string& head : acceptable_head()) out += "<th>" + head;
    out += "</tr>\n";
    for (const AcceptableRow& row : study.acceptable) {
      out += "<tr>";
      for (const std::string& text : acceptable_cells(row)) out += "<td>" + html_text(text);
      out += "</tr>\n";
    }
    out += "</table></div>\n";
    for (const AcceptableChange& change : study.acceptable_changes)
      out += "<p>" + html_text(sentence(change)) + "</p>\n";
  }
  for (const MeasureStudy& m : study.measures) {
    out += "<h2>" + html_text(m.name) + "</h2>\n" + notes_html(m.notes) + "<div class=\"plots\">\n";
    for (const auto& [plot, svg] : pictures)
      if (plot.measure == m.name)
        out += "<figure><img alt=\"" + html_text(plot.title) + "\" src=\"data:image/svg+xml;base64," + base64(svg) +
               "\"><figcaption>" + html_text(plot.title) + "</figcaption></figure>\n";
    out += "</div>\n";
    for (const Comparison& c : m.comparisons)
      out += "<h3>By " + c.by + (c.phase.empty() ? "" : ", " + html_text(c.within())) +
             (c.paired ? ", within participants" : "") + "</h3>\n" + samples_html(c) + notes_html(c.notes) +
             tests_html(c);
    if (m.curve) {
      out += "<h3>Learning curve</h3>\n" + notes_html(m.curve->notes) + "<p>" +
             html_text(sentence({"slope for each doubling of the attempt", m.curve->slope, {}})) + "</p>\n";
    }
  }
  return out + "</body></html>\n";
}

}  // namespace trephine::study
