// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>

#include "base/text.h"
#include "base/text_table.h"
#include "study/study.h"
#include "study/words.h"

namespace trephine::study {
namespace {

std::string summary_table(const Comparison& c) {
  std::vector<std::vector<std::string>> rows = {
      {"  " + c.by, "n", "mean", "interval", "sd", "median", "quartiles", "least", "most"}};
  for (const Sample& s : c.samples) {
    const Summary& m = s.summary;
    if (m.count == 0) {
      rows.push_back({"  " + s.name, "0", "", "", "", "", "", "", ""});
      continue;
    }
    rows.push_back({"  " + s.name, std::to_string(m.count), figure(m.mean),
                    m.mean_interval ? figures(*m.mean_interval) : "", m.sd ? figure(*m.sd) : "", figure(m.median),
                    figure(m.lower_quartile) + " to " + figure(m.upper_quartile), figure(m.least), figure(m.most)});
  }
  return text_table(rows, "lrrlrrlrr");
}

std::string notes_text(const std::vector<std::string>& notes, const char* indent) {
  std::string out;
  for (const std::string& note : notes) out += indent + ("note: " + note) + "\n";
  return out;
}

}  // namespace

std::string study_text(const Study& study) {
  std::string out =
      fmt::format("{} rows{}\n", study.rows_count,
                  study.participants_count == 0 ? "" : fmt::format(" of {} participants", study.participants_count));
  out += notes_text(study.notes, "");
  for (const MeasureStudy& m : study.measures) {
    out += fmt::format("\n{}: {} values\n", m.name, m.values_count) + notes_text(m.notes, "  ");
    for (const Comparison& c : m.comparisons) {
      out += fmt::format("  by {}{}{}\n", c.by, c.phase.empty() ? "" : ", " + c.within(),
                         c.paired ? ", within participants" : "");
      out += summary_table(c) + notes_text(c.notes, "    ");
      if (c.all) out += "    " + sentence(*c.all) + "\n";
      for (const PairTests& p : c.pairs) {
        out += "    " + pair_title(c, p) + "\n";
        for (const NamedTest& t : p.tests) out += "      " + sentence(t) + "\n";
      }
    }
    if (m.curve) {
      out += "  learning curve, by the slope over log2 of the attempt\n" + notes_text(m.curve->notes, "    ");
      out += "    " + sentence({"slope for each doubling", m.curve->slope, {}}) + "\n";
    }
  }
  if (!study.acceptable.empty()) {
    out += "\nacceptable results\n";
    std::vector<std::vector<std::string>> rows = {acceptable_head()};
    for (const AcceptableRow& r : study.acceptable) rows.push_back(acceptable_cells(r));
    out += text_table(rows, "lrrllrrr");
    for (const AcceptableChange& c : study.acceptable_changes) out += "  " + sentence(c) + "\n";
  }
  return out;
}

// Words and figures that text and page share.

std::string figure(double v) { return std::abs(v) < 1e-9 ? "0" : fmt::format("{:.4g}", v); }
std::string figures(const Interval& i) { return "[" + figure(i.low) + ", " + figure(i.high) + "]"; }
std::string p_text(double p) { return p < 0.0001 ? "p < 0.0001" : fmt::format("p = {:.4f}", p); }

std::string sentence(const NamedTest& t) {
  const TestResult& r = t.result;
  if (!r.tested()) return t.name + ": not tested: " + r.why_not;
  std::string out = fmt::format("{}: {}", t.name, figure(r.statistic));
  if (r.degrees) out += " (" + figure(*r.degrees) + " degrees)";
  out += ", " + p_text(r.p);
  if (t.corrected_p && *t.corrected_p != r.p) out += ", corrected " + p_text(*t.corrected_p);
  if (r.difference)
    out += ", difference " + figure(r.difference->value) +
           (r.difference->interval ? " " + figures(*r.difference->interval) : "");
  if (r.effect)
    out += fmt::format(", {} {}{}", effect_name(t.name), figure(r.effect->value),
                       r.effect->interval ? " " + figures(*r.effect->interval) : "");
  if (!r.note.empty()) out += " (" + r.note + ")";
  return out;
}

std::string effect_name(const std::string& test) {
  return test == "Mann-Whitney"     ? "Cliff's delta"
         : test == "Kruskal-Wallis" ? "epsilon squared"
         : test == "signed rank"    ? "rank correlation"
                                    : "Cohen's d";
}

std::string pair_title(const Comparison& c, const PairTests& p) {
  std::string out = c.samples[p.first].name + " to " + c.samples[p.second].name;
  if (c.paired) out += fmt::format(", {} pair{}", p.pairs_count, p.pairs_count == 1 ? "" : "s");
  if (p.change_ratio) out += fmt::format(", mean {:+.1f} %", 100 * *p.change_ratio);
  return out;
}

std::vector<std::string> acceptable_head() {
  return {"group", "acceptable", "not acceptable", "share, interval", "relative change", "by Fisher", "corrected", "n"};
}
std::vector<std::string> acceptable_cells(const AcceptableRow& r) {
  const double share = 100 * r.share();
  return {r.name,
          fmt::format("{} ({:.1f} %)", r.acceptable, share),
          fmt::format("{} ({:.1f} %)", r.all - r.acceptable, 100 - share),
          fmt::format("[{:.1f}, {:.1f}] %", 100 * r.interval.low, 100 * r.interval.high),
          fmt::format("{:.1f} points{}", r.more_points_percent,
                      r.relative_ratio ? fmt::format(", {:+.1f} %", 100 * *r.relative_ratio) : ""),
          r.fisher_p ? p_text(*r.fisher_p) : "",
          r.corrected_p ? p_text(*r.corrected_p) : "",
          std::to_string(r.all)};
}

std::string sentence(const AcceptableChange& c) {
  std::string out =
      fmt::format("{} to {}, {} pair{}: {} became acceptable, {} no more, {} as before; McNemar: ", c.from, c.to,
                  c.pairs_count, c.pairs_count == 1 ? "" : "s", c.gained, c.lost, c.pairs_count - c.gained - c.lost);
  out += c.mcnemar_p ? p_text(*c.mcnemar_p) : "not tested: nobody changed";
  if (c.corrected_p && *c.corrected_p != *c.mcnemar_p) out += ", corrected " + p_text(*c.corrected_p);
  if (c.several > 0)
    out += fmt::format(" ({} participant{} with several results in a phase {} left out)", c.several,
                       c.several == 1 ? "" : "s", c.several == 1 ? "is" : "are");
  return out;
}

}  // namespace trephine::study
