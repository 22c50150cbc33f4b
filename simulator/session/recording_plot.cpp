// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/gnuplot.h"
#include "session/force_figures.h"
#include "session/hand_watch.h"
#include "session/recording_text.h"

namespace trephine::session {
namespace {

using haptics::Recording;
using haptics::ServoFrame;

constexpr std::size_t max_pieces = 1200;  // more than there are columns of pixels

double size_of(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
double finite(double v) { return std::isfinite(v) ? v : 0; }

// Which bits are seen, and in which frames: a row of marks each.
std::string events_of(const Recording& r, std::string& tics, int& rows) {
  std::string data = "$events << END\n";
  const auto add = [&](const char* const* names, int count, bool faults) {
    for (int bit = 0; bit < count; ++bit) {
      double last = -1e300;
      bool some = false;
      for (const ServoFrame& f : r.frames) {
        if (!((faults ? f.faults : f.events) & 1u << bit)) continue;
        // Marks nearer than a pixel are one.
        if (some && f.time_s - last < (r.frames.back().time_s - r.frames.front().time_s) / double(max_pieces)) continue;
        if (!some) {
          ++rows;
          tics += fmt::format("{}{} {}", tics.empty() ? "" : ", ",
                              gnuplot_text(std::string(faults ? "fault: " : "") + names[bit]), rows);
        }
        some = true;
        last = f.time_s;
        data += fmt::format("{:.6f} {} {}\n", f.time_s, rows, faults ? 2 : 1);
      }
    }
  };
  add(haptics::haptic_event::names, haptics::haptic_event::count, false);
  add(haptics::haptic_fault::names, haptics::haptic_fault::count, true);
  if (rows == 0) data += fmt::format("{:.6f} 0 1\n", r.frames.front().time_s);
  return data + "END\n";
}

// Where the force is an anomaly, as marks on the path [Rizzi, figures 13 to 16]; marks nearer than a pixel are one.
std::string anomalies_of(const Recording& r, const double* first) {
  std::string data;
  double last = -1e300;
  for (const std::size_t n : force_anomalies(r.frames, force_window(r.frames))) {
    const ServoFrame& f = r.frames[n];
    if (f.time_s - last < (r.frames.back().time_s - r.frames.front().time_s) / double(max_pieces)) continue;
    last = f.time_s;
    data += fmt::format("{:.6f} {:.6g} {:.6g} {:.6g}\n", f.time_s, finite(f.tip_mm[0] - first[0]),
                        finite(f.tip_mm[1] - first[1]), finite(f.tip_mm[2] - first[2]));
  }
  return data;
}

// The tool in hand as bars.
std::string tools_of(const Recording& r, std::string& objects) {
  std::string legend;
  if (r.header.tools.empty()) return legend;
  const std::vector<std::size_t> in_hand = tools_in_hand(r);
  std::size_t from = 0;
  std::vector<std::size_t> seen;
  for (std::size_t n = 1; n <= r.frames.size(); ++n) {
    const std::size_t tool = in_hand[from];
    if (n < r.frames.size() && in_hand[n] == tool) continue;
    objects += fmt::format(
        "set object rectangle from {:.6f}, graph 0.97 to {:.6f}, graph 1 fc rgb '{}' fs solid 1 "
        "noborder\n",
        r.frames[from].time_s, r.frames[n - 1].time_s, gnuplot_colour(tool + 3));
    if (std::find(seen.begin(), seen.end(), tool) == seen.end()) seen.push_back(tool);
    from = n;
  }
  for (const std::size_t tool : seen)
    legend += fmt::format(", NaN with lines lw 6 lc rgb '{}' title {}", gnuplot_colour(tool + 3),
                          gnuplot_text(r.header.tools[tool].name));
  return legend;
}

}  // namespace

std::string recording_plot(const Recording& r) {
  if (r.frames.empty()) return "set title 'the recording holds no frame'\nset yrange [0:1]\nplot NaN notitle\n";
  const std::size_t piece = std::max<std::size_t>(1, r.frames.size() / max_pieces);
  std::string force = "$force << END\n", place = "$place << END\n";
  const double* first = r.frames.front().tip_mm;
  for (std::size_t begin = 0; begin < r.frames.size(); begin += piece) {
    const std::size_t end = std::min(begin + piece, r.frames.size());
    double least = 1e300, most = 0;
    for (std::size_t n = begin; n < end; ++n) {
      least = std::min(least, finite(size_of(r.frames[n].force_n)));
      most = std::max(most, finite(size_of(r.frames[n].force_n)));
    }
    const ServoFrame& f = r.frames[begin];
    force += fmt::format("{:.6f} {:.6g} {:.6g}\n", f.time_s, least, most);
    place += fmt::format("{:.6f} {:.6g} {:.6g} {:.6g}\n", f.time_s, finite(f.tip_mm[0] - first[0]),
                         finite(f.tip_mm[1] - first[1]), finite(f.tip_mm[2] - first[2]));
  }
  std::string tics, objects, marks;
  if (const std::string anomalies = anomalies_of(r, first); !anomalies.empty()) {
    place += "END\n$anomalies << END\n" + anomalies;
    for (int axis = 2; axis <= 4; ++axis)
      marks += fmt::format(", $anomalies using 1:{} with points pt 3 lc rgb '#cc0000' {}", axis,
                           axis == 2 ? "title 'anomaly of the force'" : "notitle");
  }
  int rows = 0;
  const std::string events = events_of(r, tics, rows), tools = tools_of(r, objects);
  return force + "END\n" + place + "END\n" + events +
         fmt::format(
             "set multiplot layout 3,1\nset lmargin 14\nset rmargin 20\nset grid lc rgb '#dddddd'\nset border "
             "3\nset tics nomirror\nset key outside right top noenhanced samplen 1\nset xrange [{:.6f}:{:.6f}]\n",
             r.frames.front().time_s, std::max(r.frames.back().time_s, r.frames.front().time_s + 1e-3)) +
         objects +
         fmt::format(
             "set ylabel 'force, N'\nset yrange [0:*]\n"
             "plot $force using 1:2:3 with filledcurves lc rgb '{0}' fs transparent solid 0.4 notitle, $force "
             "using 1:3 with lines lc rgb '{0}' title 'size'{1}\nunset object\n"
             "set ylabel 'tip from its begin, mm'\nset yrange [*:*]\n"
             "plot $place using 1:2 with lines lc rgb '{0}' title 'to the left', $place using 1:3 with lines lc "
             "rgb '{2}' title 'to the back', $place using 1:4 with lines lc rgb '{3}' title 'to the head'{4}\n",
             gnuplot_colour(0), tools, gnuplot_colour(1), gnuplot_colour(2), marks) +
         fmt::format(
             "set ylabel ''\nset xlabel 'time, s'\nset yrange [0.5:{}.5]\nset ytics noenhanced ({})\nset key "
             "off\nset palette defined (1 '#0072b2', 2 '#d55e00')\nset cbrange [1:2]\nunset colorbox\n"
             "plot $events using 1:2:3 with points pt 2 ps 0.5 lc palette\nunset multiplot\n",
             std::max(1, rows), tics.empty() ? "'none' 1" : tics);
}

}  // namespace trephine::session
