// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/gnuplot.h"
#include "base/log.h"
#include "base/write_file.h"
#include "trade/trade.h"

namespace trephine::trade {
namespace fs = std::filesystem;
namespace {

struct Axis {
  config::TradeCost cost;
  const char* file;
  const char* label;
  double unit;
};
constexpr Axis axes[] = {{config::TradeCost::seconds, "error_seconds", "seconds, all stages", 1},
                         {config::TradeCost::triangles, "error_triangles", "triangles, thousands", 1e3},
                         {config::TradeCost::bytes, "error_bytes", "case, MB", 1e6}};

bool is_plotted(const PointTrade& p) { return p.total.refused.empty() && p.total.deviation_rms_mm > 0; }

double truth_rms_mm(const PointTrade& p) {
  double worst = 0;
  for (const AnatomyTrade& a : p.anatomies)
    if (a.to_truth) worst = std::max(worst, a.to_truth->rms_mm);
  return worst;
}

// The script for gnuplot, with the data in it: one series for each sweep, points beyond the scene's limits hollow, and
// the front as a line.
std::string script_of(const TradeResult& result, const Axis& axis) {
  std::string text =
      "set logscale xy\nset grid xtics ytics mxtics mytics lc rgb '#dddddd', lc rgb '#eeeeee'\n"
      "set key outside right top\nset xlabel '" +
      std::string(axis.label) + "'\nset ylabel 'RMS deviation of the worst anatomy, mm'\nset pointsize 1.1\n";
  std::vector<std::string> sweeps;
  for (const PointTrade& p : result.points)
    if (is_plotted(p) && std::find(sweeps.begin(), sweeps.end(), p.planned.sweep) == sweeps.end())
      sweeps.push_back(p.planned.sweep);
  std::string plot;
  const auto block = [&](const std::string& name, const std::vector<std::pair<double, double>>& points,
                         const std::string& style) {
    if (points.empty()) return;
    text += "$" + name + " << END\n";
    for (const auto& [x, y] : points) text += fmt::format("{:.6g} {:.6g}\n", x, y);
    text += "END\n";
    plot += (plot.empty() ? "plot " : ", ") + ("$" + name) + " using 1:2 " + style;
  };
  const auto choosable = result.choosable();
  std::vector<std::pair<double, double>> front, truth;
  for (const std::size_t i : config::pareto_front(choosable, axis.cost, config::TradeError::rms)) {
    if (choosable[i].deviation_rms_mm <= 0) continue;
    front.emplace_back(config::cost_of(choosable[i], axis.cost) / axis.unit, choosable[i].deviation_rms_mm);
    for (const PointTrade& p : result.points)
      if (p.total == choosable[i] && truth_rms_mm(p) > 0)
        truth.emplace_back(config::cost_of(p.total, axis.cost) / axis.unit, truth_rms_mm(p));
  }
  block("front", front, "with lines lw 2 lc rgb '#444444' title 'Pareto front'");
  block("truth", truth, "with linespoints lw 1.5 dt 2 pt 2 lc rgb '#888888' title 'front, to the truth'");
  const int filled[] = {7, 5, 9, 13, 11, 7, 5, 9}, hollow[] = {6, 4, 8, 12, 10, 6, 4, 8};
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    std::vector<std::pair<double, double>> within, beyond;
    for (const PointTrade& p : result.points)
      if (is_plotted(p) && p.planned.sweep == sweeps[s])
        (p.beyond_scene.empty() ? within : beyond)
            .emplace_back(config::cost_of(p.total, axis.cost) / axis.unit, p.total.deviation_rms_mm);
    const std::string n = std::to_string(s), colour = gnuplot_colour(s);
    block("within" + n, within,
          fmt::format("with points pt {} lc rgb '{}' title '{}'", filled[s % 8], colour, sweeps[s]));
    block("beyond" + n, beyond,
          fmt::format("with points pt {} lc rgb '{}' title '{}, beyond the scene'", hollow[s % 8], colour, sweeps[s]));
  }
  return plot.empty() ? "" : text + plot + "\n";
}

bool holds(const fs::path& file, const std::string& bytes) {
  std::error_code ignored;
  if (!fs::exists(file, ignored) || fs::file_size(file, ignored) != bytes.size()) return false;
  const std::vector<char> now = read_file(file);
  return std::equal(now.begin(), now.end(), bytes.begin(), bytes.end());
}

void write_if_new(const fs::path& file, const std::string& bytes) {
  if (!holds(file, bytes)) write_file(file, bytes);
}

// The script stays beside the measurements, because it tells whether the picture shows these data.
void plot(const TradeResult& result, const Axis& axis, const fs::path& out, const char* ending,
          const std::string& terminal) {
  const fs::path picture = out / (axis.file + std::string(ending));
  const fs::path script = out / ".trade" / (axis.file + std::string(ending) + ".gp");
  const std::string drawing = script_of(result, axis), text = terminal + "\n" + drawing;
  std::error_code ignored;
  if (drawing.empty() || (holds(script, text) && fs::exists(picture, ignored))) return;
  fs::remove(script, ignored);
  write_file(picture, gnuplot_picture(terminal, drawing));
  write_file(script, text);
}

}  // namespace

void write_trade(const TradeResult& result, const fs::path& out, const std::string& program_version) {
  write_if_new(out / "trade.csv", trade_csv(result));
  write_if_new(out / "trade.json", trade_json(result, program_version));
  try {
    for (const Axis& axis : axes) {
      plot(result, axis, out, ".png", gnuplot_png(1100, 700));
      plot(result, axis, out, ".svg", gnuplot_svg(1100, 700));
    }
  } catch (const Error& e) {
    if (e.code() != ExitCode::internal) throw;
    log_warning("the plots are left out: " + e.file() + ": " + e.what());
  }
}

}  // namespace trephine::trade
