// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/gnuplot.h"

namespace trephine::study {
namespace {

constexpr const char* look =
    "set grid ytics lc rgb '#dddddd'\nset border 3\nset tics nomirror\nset key top right noenhanced\nset style fill "
    "transparent solid 0.35\n";

// 1, 2 or 5 times a power of ten, nearest from above.
double round_width(double width) {
  const double unit = std::pow(10.0, std::floor(std::log10(width)));
  for (const double step : {1.0, 2.0, 5.0})
    if (width <= step * unit * (1 + 1e-9)) return step * unit;
  return 10 * unit;
}

// The samples that are drawn: of many attempts the first, the second and the last.
std::vector<const Sample*> drawn(const Comparison& c) {
  std::vector<const Sample*> out;
  for (std::size_t n = 0; n < c.samples.size(); ++n)
    if (!c.samples[n].values.empty() && (c.by != "attempt" || n < 2 || n + 1 == c.samples.size()))
      out.push_back(&c.samples[n]);
  return out;
}

// A group's name is the table's own; a phase's is put into the language where it has one.
std::string name_of_sample(const Comparison& c, const Sample& s, const PlotWords& words) {
  return words(c.by) + " " + (c.by == "phase" ? words(s.name) : s.name);
}

// Whiskers end at the last value within 1.5 interquartile ranges of the box, as Tukey draws it.
std::pair<double, double> whiskers(const Sample& s) {
  const double reach = 1.5 * (s.summary.upper_quartile - s.summary.lower_quartile);
  double low = s.summary.lower_quartile, high = s.summary.upper_quartile;
  for (const double v : s.values) {
    if (v >= s.summary.lower_quartile - reach) low = std::min(low, v);
    if (v <= s.summary.upper_quartile + reach) high = std::max(high, v);
  }
  return {low, high};
}

std::string box_script(const std::string& measure, const Comparison& c, const PlotWords& words) {
  const std::vector<const Sample*> samples = drawn(c);
  std::string boxes = "$boxes << END\n", points = "$points << END\n", tics;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Summary& s = samples[n]->summary;
    const auto [low, high] = whiskers(*samples[n]);
    boxes += fmt::format("{} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g}\n", n + 1, low, s.lower_quartile, s.median,
                         s.upper_quartile, high, s.mean);
    for (std::size_t k = 0; k < samples[n]->values.size(); ++k) {
      // Points beside each other by the golden ratio, the same at every run.
      const double aside = std::fmod(0.618033988749895 * double(k), 1.0) - 0.5;
      points += fmt::format("{:.4f} {:.10g}\n", double(n + 1) + 0.3 * aside, samples[n]->values[k]);
    }
    tics += fmt::format("{}{} {}", n == 0 ? "" : ", ",
                        gnuplot_text(fmt::format("{}, n = {}", name_of_sample(c, *samples[n], words), s.count)), n + 1);
  }
  return boxes + "END\n" + points + "END\n" + look +
         fmt::format(
             "set ylabel {} noenhanced\nset xrange [0.4:{}.6]\nset xtics noenhanced ({})\nset boxwidth 0.5\nset "
             "offsets 0, 0, graph 0.04, graph "
             "0.04\n"
             "plot $boxes using 1:3:2:6:5 with candlesticks whiskerbars 0.4 lc rgb '{}' lw 1.5 notitle, "
             "$boxes using 1:4:4:4:4 with candlesticks lc rgb '#000000' lw 2 title {}, "
             "$points with points pt 6 ps 0.5 lc rgb '#555555' notitle, "
             "$boxes using 1:7 with points pt 13 ps 1 lc rgb '{}' title {}\n",
             gnuplot_text(words(measure)), samples.size(), tics, gnuplot_colour(0), gnuplot_text(words("median")),
             gnuplot_colour(1), gnuplot_text(words("mean")));
}

std::string histogram_script(const std::string& measure, const Comparison& c, int bins_count, const PlotWords& words) {
  const std::vector<const Sample*> samples = drawn(c);
  std::vector<double> all;
  for (const Sample* s : samples) all.insert(all.end(), s->values.begin(), s->values.end());
  const Bins bins = bins_for(all, bins_count);
  std::string data, plot;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    std::vector<int> counts(std::size_t(bins.count));
    for (const double v : samples[n]->values)
      ++counts[std::size_t(std::clamp(int(std::floor((v - bins.begin) / bins.width)), 0, bins.count - 1))];
    data += fmt::format("$s{} << END\n", n);
    const double width = bins.width / double(samples.size());
    for (int b = 0; b < bins.count; ++b)
      data += fmt::format("{:.10g} {} {:.10g}\n", bins.begin + b * bins.width + (double(n) + 0.5) * width,
                          counts[std::size_t(b)], 0.92 * width);
    data += "END\n";
    plot += fmt::format("{}$s{} using 1:2:3 with boxes lc rgb '{}' fs solid 0.7 title {}", n == 0 ? "plot " : ", ", n,
                        gnuplot_colour(n), gnuplot_text(name_of_sample(c, *samples[n], words)));
  }
  return data + look +
         fmt::format("set xlabel {} noenhanced\nset ylabel {}\nset yrange [0:*]\nset xrange [{:.10g}:{:.10g}]\n",
                     gnuplot_text(words(measure)), gnuplot_text(words("count")), bins.begin - bins.width / 2,
                     bins.begin + (bins.count + 0.5) * bins.width) +
         plot + "\n";
}

std::string curve_script(const std::string& measure, const LearningCurve& curve, const PlotWords& words) {
  std::string lines = "$lines << END\n", means = "$means << END\n";
  for (const auto& line : curve.lines) {
    for (const auto& [attempt, value] : line) lines += fmt::format("{} {:.10g}\n", attempt, value);
    lines += "\n";
  }
  for (const CurvePoint& p : curve.points) {
    const Interval i = p.summary.mean_interval.value_or(Interval{p.summary.mean, p.summary.mean});
    means += fmt::format("{} {:.10g} {:.10g} {:.10g}\n", p.attempt, p.summary.mean, i.low, i.high);
  }
  return lines + "END\n" + means + "END\n" + look +
         fmt::format(
             "set xlabel {}\nset ylabel {} noenhanced\nset xrange [{}:{}]\nset xtics {}\n"
             "plot $lines with lines lc rgb '#c4c4c4' title {}, "
             "$means using 1:2:3:4 with yerrorbars pt 7 lw 1.5 lc rgb '{}' title {}, "
             "$means using 1:2 with lines lw 2 lc rgb '{}' notitle\n",
             gnuplot_text(words("attempt")), gnuplot_text(words(measure)), double(curve.points.front().attempt) - 0.5,
             double(curve.points.back().attempt) + 0.5,
             std::max(1, (curve.points.back().attempt - curve.points.front().attempt) / 12),
             gnuplot_text(words("participants")), gnuplot_colour(0), gnuplot_text(words("mean, interval")),
             gnuplot_colour(0));
}

}  // namespace

Bins bins_for(const std::vector<double>& values, int count) {
  if (values.empty()) return {};
  const Summary s = summarised(values, 0.95);
  const double range = s.most - s.least;
  if (range <= 0) return {s.least - 0.5, 1, 1};
  if (count > 0) return {s.least, range / count, count};
  if (range <= 30 && std::all_of(values.begin(), values.end(), [](double v) { return v == std::floor(v); }))
    return {s.least - 0.5, 1, int(range) + 1};
  const double n = double(values.size());
  const double spread = s.upper_quartile - s.lower_quartile;
  const double wanted = spread > 0 ? 2 * spread / std::cbrt(n) : range / (std::log2(n) + 1);
  const double width = round_width(std::max(wanted, range / 60));
  const double begin = std::floor(s.least / width) * width;
  return {begin, width, int(std::floor((s.most - begin) / width)) + 1};
}

std::vector<StudyPlot> plots_of(const Study& study, const PlotWords& words) {
  std::vector<StudyPlot> plots;
  for (const MeasureStudy& m : study.measures) {
    int groups = 0;
    for (const Comparison& c : m.comparisons) {
      if (drawn(c).empty()) continue;
      std::string base = m.name + "-" + c.by;
      if (!c.phase.empty()) base += "-" + std::to_string(++groups);  // a phase's name is free text
      const texts::Phrase what = c.phase.empty()
                                     ? texts::Phrase("{} by {}", {m.name, c.by})
                                     : texts::Phrase("{} by {}, {}", {m.name, c.by, {"phase {}", {c.phase}}});
      plots.push_back({m.name, base + "-box", words(what), box_script(m.name, c, words)});
      plots.push_back({m.name, base + "-histogram", words({"{}: distribution", {what}}),
                       histogram_script(m.name, c, study.params.bins_count, words)});
    }
    if (m.curve && !m.curve->points.empty())
      plots.push_back(
          {m.name, m.name + "-curve", words({"{} over attempts", {m.name}}), curve_script(m.name, *m.curve, words)});
  }
  return plots;
}

}  // namespace trephine::study
