// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/base64.h"
#include "lessons/lesson_guide.h"
#include "lessons/lesson_type.h"
#include "lessons/report_pictures.h"

namespace trephine::lessons {
namespace {

using detail::escaped;

constexpr const char* style = R"(
:root { color-scheme: light dark; --faint: #7a8896; --line: #a9b6c3; --way: #ffb000; --expert: #35c46a; --target: #ff4f4f }
body { font: 14px/1.45 system-ui, sans-serif; max-width: 62em; margin: 1em auto; padding: 0 1em }
h1 { font-size: 1.3em; margin: 0 } h2 { font-size: 1em; margin: 1.6em 0 .4em; color: var(--faint) }
table { border-collapse: collapse; width: 100% } td, th { text-align: left; vertical-align: top; padding: .3em .6em .3em 0; border-bottom: 1px solid var(--line) }
.failed { border-left: .4em solid var(--target); padding-left: .6em; font-size: 1.15em }
.score { font-size: 1.3em; white-space: nowrap } .faint, figcaption { color: var(--faint); font-size: .85em }
.slices { display: flex; gap: .5em } figure { margin: 0; flex: 1 } svg { width: 100%; background: #000 }
polyline, line { fill: none } circle { fill: none; stroke-width: 1 }
.way { stroke: var(--way); stroke-width: 1.2 } .expert { stroke: var(--expert); stroke-width: .8; stroke-dasharray: 3 2 }
.target { stroke: var(--target) } .hole { stroke: #58a6ff } .tip { stroke: var(--way); fill: var(--way) }
.plot { background: none } .force { stroke: #3d7de0; stroke-width: 1 } .moment { stroke: var(--target); stroke-width: .7 }
.plot text { fill: var(--faint); font-size: 10px } .t0 { fill: #8886 } .t1 { fill: #d806 } .t2 { fill: #2a66 }
)";

std::string title_of(const std::string& measured) {
  std::string text = measured;
  const std::size_t unit = text.rfind('_');
  std::replace(text.begin(), text.end(), '_', ' ');
  return unit == std::string::npos ? text : text.substr(0, unit);
}
std::string unit_of(const std::string& measured) {
  const std::size_t unit = measured.rfind('_');
  const std::string name = unit == std::string::npos ? "" : measured.substr(unit + 1);
  return name == "mm3" ? "mm³" : name == "ratio" || name == "count" ? "" : name == "deg" ? "°" : name;
}

std::string rows_html(const LessonScore& score) {
  std::string out = "<table><tr><th>row<th>score<th>measured<th>limits<th>decided</tr>\n";
  for (const ScoreRow& row : score.rows) {
    std::string measured, limits;
    for (const auto& [name, value] : row.measured)
      measured += fmt::format("{} {:.1f} {}<br>", escaped(title_of(name)), value, unit_of(name));
    for (const auto& [name, l] : row.limits)
      limits +=
          fmt::format("<span title=\"{}\">{} {:g} {} <b>{}</b></span><br>", escaped(l.why), escaped(title_of(name)),
                      l.limit, unit_of(name), l.from == lesson::RubricLimit::From::thesis ? "thesis" : "ours");
    out +=
        fmt::format("<tr><td><b>{}</b><br>{}<td class=\"score\">{}<td>{}<td class=\"faint\">{}<td>{}</tr>\n",
                    escaped(row.title), escaped(row.why), row.score ? fmt::format("{} / 5", *row.score) : "not judged",
                    measured, limits, row.decided_s ? fmt::format("{:.1f} s", *row.decided_s) : "");
  }
  return out + "</table>\n";
}

// The size of the force, the largest of each piece of time, with the tool in hand behind it.
std::string forces_html(const LessonScore& score, const haptics::Recording& recording) {
  constexpr double width = 900, height = 160, left = 30;
  const std::vector<haptics::ServoFrame>& frames = recording.frames;
  const double begin = frames.front().time_s, length = std::max(1e-9, frames.back().time_s - begin);
  const double most = recording.header.force.max_force_n;
  const auto x = [&](double time_s) { return left + (width - left) * (time_s - begin) / length; };
  const auto y = [&](double force_n) { return height - 20 - (height - 30) * std::min(1.0, force_n / most); };
  std::string out = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"force over time\">", width, height);
  std::string line;
  double piece = 0;
  std::size_t last = 0, from = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const haptics::ServoFrame& f = frames[n];
    piece = std::max(
        piece, std::sqrt(f.force_n[0] * f.force_n[0] + f.force_n[1] * f.force_n[1] + f.force_n[2] * f.force_n[2]));
    if (x(f.time_s) - x(frames[last].time_s) >= 0.75 || n + 1 == frames.size()) {
      line += fmt::format("{:.1f},{:.1f} ", x(f.time_s), y(piece));
      piece = 0;
      last = n;
    }
    const bool other = haptics::belt_button::tool(f.buttons) != haptics::belt_button::tool(frames[from].buttons);
    if (other || n + 1 == frames.size()) {
      const int tool = haptics::belt_button::tool(frames[from].buttons);
      const std::string name =
          std::size_t(tool) < recording.header.tools.size() ? recording.header.tools[std::size_t(tool)].name : "";
      out += fmt::format(
          "<rect class=\"t{}\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"8\"><title>{}</title></rect>", tool % 3,
          x(frames[from].time_s), height - 16, x(f.time_s) - x(frames[from].time_s), escaped(name));
      from = n;
    }
  }
  for (const ScoreRow& row : score.rows)
    if (row.decided_s)
      out += fmt::format(
          "<line class=\"moment\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"8\" y2=\"{1}\"><title>{2}</title></line>",
          x(*row.decided_s), height - 20, escaped(row.title));
  out += fmt::format("<polyline class=\"force\" points=\"{}\"/>", line);
  out += fmt::format("<text x=\"0\" y=\"{:.0f}\">{:g} N</text><text x=\"0\" y=\"{:.0f}\">0</text>", y(most) + 4, most,
                     y(0.0));
  out += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">{:.0f} s</text></svg>\n", width - 40, height, length);
  constexpr const char* colours[] = {"grey", "orange", "green"};  // of the classes t0 to t2
  std::string tools;
  for (std::size_t n = 0; n < recording.header.tools.size(); ++n)
    tools += fmt::format("{}{} the {}", n == 0 ? "" : ", ", colours[n % 3], escaped(recording.header.tools[n].name));
  return out + "<p class=\"faint\">Below: " + tools + ". Red lines: the moments at which rows were decided.</p>\n";
}

// How the hand moved, beside what experts did where there are any.
std::string motion_html(const ReportHead& head) {
  if (head.motion.empty()) return "";
  std::string out = "<h2>How the hand moved</h2>\n<table><tr><th>figure<th>measured<th>experts</tr>\n";
  for (const auto& [name, value] : head.motion) {
    std::string band;
    for (const ExpertBand& b : head.experts)
      if (b.name == name) band = fmt::format("{:.3g} to {:.3g}", b.low, b.high);
    out += fmt::format("<tr><td>{}<td>{:.3g} {}<td class=\"faint\">{}</tr>\n", escaped(title_of(name)), value,
                       unit_of(name), band);
  }
  out += "</table>\n";
  for (const std::string& sentence : motion_advice(head.motion, head.experts))
    out += "<p>" + escaped(sentence) + "</p>\n";
  return out + "<p class=\"faint\">These figures score nothing. docs/study.md says how they are measured.</p>\n";
}

}  // namespace

std::string report_page(const ReportHead& head, const LessonFacts& facts, const LessonScore& score,
                        const haptics::Recording& recording, const cases::LoadedCase& loaded) {
  const LessonType& module = lesson_type(head.module);
  const ScoreSum sum = sum_of(score);
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src '{}'; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Trephine lesson</title>\n"
      "<style>{}</style></head><body>\n",
      policy_hash(style), style);
  out += fmt::format(
      "<h1>{} in {}: {} of {} points</h1>\n<p class=\"faint\">participant {} · {} · {:.1f} s · {} · not a medical "
      "device</p>\n",
      escaped(head.module), escaped(head.case_token), sum.points, sum.most, escaped(head.participant),
      name_of(facts.end), facts.procedure_s(), module.headline(facts, score));
  out +=
      fmt::format("<p class=\"{}\"><b>{}</b>{}</p>\n", score.outcome() == LessonOutcome::failed ? "failed" : "",
                  escaped(headline_of(score)),
                  facts.task.empty() ? "" : "<br>Task: " + escaped(task_of(module, loaded.manifest, facts.task).aim));
  if (!head.replayed) out += "<p class=\"failed\"><b>Trusted: the recording was not replayed.</b></p>\n";
  if (facts.undone > 0) out += fmt::format("<p><b>What was cut was taken back {} times.</b></p>\n", facts.undone);
  out += rows_html(score);
  out += steps_html(guide_of(module, facts), texts::Language::english);
  if (!recording.frames.empty()) out += "<h2>Forces over time</h2>\n" + forces_html(score, recording);
  out += motion_html(head);
  out += module.pictures(facts, loaded);
  out += fmt::format(
      "<h2>Made of</h2>\n<p class=\"faint\">recording {} ({}, {})<br>motion {}<br>haptic volume {}<br>rubric "
      "{}</p>\n</body></html>\n",
      head.recording_sha256, head.checked(), haptics::name_of(head.seal), head.motion_sha256, head.case_sha256,
      head.rubric_sha256);
  return out;
}

}  // namespace trephine::lessons
