// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of chapter 4, in its form, by gnuplot.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/gnuplot.h"
#include "base/log.h"
#include "base/write_file.h"
#include "peers/comparison.h"

namespace trephine::peers {
namespace {

namespace fs = std::filesystem;

constexpr const char* colours[] = {"#0072b2", "#56b4e9", "#cc79a7", "#d55e00", "#e69f00", "#009e73",
                                   "#8c564b", "#444444", "#7f7f00", "#b2182b", "#542788", "#1b7837"};
constexpr double min_us = 0.1;  // the clock tells no less
constexpr int symbols[] = {7, 6, 9, 5, 4, 13, 11, 3};

struct Figure {
  std::string name, commands;  ///< commands: without terminal and output
};

// One line a block, as gnuplot reads it in a script.
std::string block(const std::string& name, const std::string& lines) {
  return "$" + name + " << END\n" + lines + "END\n";
}

// One series an algorithm over the number of polygons; `value` gives none where there is nothing.
template <class Row>
Figure over_polygons(const std::string& name, const std::string& title, const std::string& axis, const Comparison& c,
                     const std::vector<Row>& rows, const std::function<std::optional<double>(const Row&)>& value,
                     const std::string& more) {
  std::string text, plot;
  int n = 0;
  for (const AlgorithmKind& kind : c.kinds) {
    const int own = n++;
    std::string lines;
    for (const Row& row : rows)
      if (row.algorithm == kind.name && row.triangles > 0)
        if (const auto v = value(row)) lines += fmt::format("{:.6g} {:.6g}\n", double(row.triangles) / 1000, *v);
    if (lines.empty()) continue;
    text += block(kind.name, lines);
    plot += fmt::format("{}${} using 1:2 with linespoints lw 2 pt {} lc rgb '{}' title '{}'",
                        plot.empty() ? "plot " : ", ", kind.name, symbols[own % 8], colours[own % 12], kind.title);
  }
  if (plot.empty()) return {};
  return {name, fmt::format("set title '{}'\nset xlabel 'polygons, thousands'\nset ylabel '{}'\nset logscale x\n",
                            title, axis) +
                    more + text + plot};
}

// The share of ticks by their time, of what feels voxels.
Figure servo_histogram(const Comparison& c) {
  constexpr double low_us = 0.1, ratio = 1.12;
  std::string text, plot;
  int n = 0;
  for (const AlgorithmKind& kind : c.kinds) {
    const int own = n++;
    const ServoRow* row = servo_of(c, kind.name, false);
    if (kind.feels_mesh || !row || row->times.sorted_us.empty()) continue;
    std::vector<double> bins(110, 0);
    for (const double us : row->times.sorted_us) {
      const int bin = us > low_us ? int(std::log(us / low_us) / std::log(ratio)) : 0;
      bins[std::size_t(std::clamp(bin, 0, int(bins.size()) - 1))] += 1 / double(row->times.sorted_us.size());
    }
    std::string lines;
    for (std::size_t b = 0; b < bins.size(); ++b)
      lines += fmt::format("{:.6g} {:.6g}\n", 1e-3 * low_us * std::pow(ratio, double(b) + 0.5), bins[b]);
    text += block(kind.name, lines);
    plot += fmt::format("{}${} using 1:2 with histeps lw 2 lc rgb '{}' title '{}'", plot.empty() ? "plot " : ", ",
                        kind.name, colours[own % 12], kind.title);
  }
  if (plot.empty()) return {};
  return {
      "servo_voxels",
      "set title 'Servo loop: time of a tick, what feels voxels'\nset xlabel 'ms'\nset ylabel 'share of the ticks'\n"
      "set logscale x\nset xrange [1e-4:2]\nset yrange [0:*]\nset arrow from 1, graph 0 to 1, graph 1 nohead lw 3 lc "
      "rgb '#cc0000'\n" +
          text + plot};
}

Figure anomalies(const Comparison& c) {
  std::string coefficient, without, tics;
  double max_coefficient = 0.0005, max_without = 0.01;  // what the axes show at least
  int n = 0;
  for (const AlgorithmKind& kind : c.kinds) {
    const Spread a = spread_of(c, kind.name, true, [](const RunFigures& f) { return f.force.anomaly_ratio; });
    const Spread z = spread_of(c, kind.name, true, [](const RunFigures& f) { return f.force.zero_force_ratio; });
    if (a.runs == 0) continue;
    max_coefficient = std::max(max_coefficient, 1.05 * a.most);
    max_without = std::max(max_without, 1.05 * z.most);
    coefficient += fmt::format("{} {:.6g} {:.6g} {:.6g}\n", n, a.mean, a.least, a.most);
    without += fmt::format("{} {:.6g} {:.6g} {:.6g}\n", n, z.mean, z.least, z.most);
    tics += fmt::format("{}'{}' {}", tics.empty() ? "" : ", ", kind.title, n++);
  }
  if (n == 0) return {};
  const std::string style =
      " using 1:2 with boxes lc rgb '#9ecae1' notitle, $DATA using 1:2:3:4 with yerrorbars lw 2 pt 7 "
      "ps 0.8 lc rgb '#222222' notitle";
  const auto panel = [&](const std::string& data) {
    std::string commands = style;
    commands.replace(commands.find("$DATA"), 5, data);
    return "plot " + data + commands + "\n";
  };
  return {"anomalies", block("coefficient", coefficient) + block("without", without) +
                           fmt::format("set xtics ({}) rotate by -25\nset xrange [-0.6:{}]\nset boxwidth 0.6\n"
                                       "set style fill solid\nset multiplot layout 2,1\n",
                                       tics, n - 0.4) +
                           fmt::format("set yrange [0:{:.6g}]\n", max_coefficient) +
                           "set title 'Force anomaly coefficient: mean, least and most of the runs'\n" +
                           panel("$coefficient") + fmt::format("set yrange [0:{:.6g}]\n", max_without) +
                           "set title 'Frames without force: mean, least and most of the runs'\n" + panel("$without") +
                           "unset multiplot"};
}

// Throws Error 70 where gnuplot fails or is missing.
void draw(const Figure& figure, const fs::path& out, const std::string& ending, const std::string& terminal) {
  write_file(
      out / (figure.name + ending),
      gnuplot_picture(terminal, "set format y '%g'\nset grid lt 1 lc rgb '#dddddd'\nset key outside right top\n" +
                                    figure.commands + "\n"));
}

}  // namespace

std::vector<std::string> plot_comparison(const Comparison& c, const fs::path& out) {
  const std::string limit =
      "set logscale y\nset arrow from graph 0, first 1 to graph 1, first 1 nohead lw 3 lc rgb "
      "'#cc0000'\n";
  const std::vector<Figure> figures = {
      over_polygons<ServoRow>(
          "servo_polygons", "Servo loop: mean time of a tick, what feels polygons", "ms", c, c.servo,
          [](const ServoRow& r) {
            return keeps_contact(r) ? std::optional<double>(1e-3 * std::max(min_us, r.times.mean_us)) : std::nullopt;
          },
          limit + "set yrange [5e-5:3]\n"),
      servo_histogram(c), anomalies(c),
      over_polygons<ClientRow>(
          "client_haptics", "Client thread: haptics", "ms a picture", c, c.client,
          [](const ClientRow& r) { return std::optional<double>(std::max(1e-5, r.haptics_ms)); }, "set logscale y\n"),
      over_polygons<ClientRow>(
          "client_combined", "Client thread: haptics and graphics", "ms a picture", c, c.client,
          [](const ClientRow& r) {
            return r.graphics_ms ? std::optional<double>(r.haptics_ms + *r.graphics_ms) : std::nullopt;
          },
          "set yrange [0:*]\n")};
  std::vector<std::string> names;
  try {
    for (const Figure& figure : figures) {
      if (figure.name.empty()) continue;
      draw(figure, out, ".png", gnuplot_png(1100, 700));
      draw(figure, out, ".svg", gnuplot_svg(1100, 700));
      names.push_back(figure.name + ".png");
    }
  } catch (const Error& e) {
    if (e.code() != ExitCode::internal) throw;
    log_warning("the plots are left out: " + e.file() + ": " + e.what());
    return {};
  }
  return names;
}

}  // namespace trephine::peers
