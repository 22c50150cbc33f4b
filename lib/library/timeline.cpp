// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/timeline.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/error.h"
#include "base/html_text.h"
#include "base/log.h"
#include "base/text.h"
#include "base/write_file.h"
#include "library/catalogue.h"

namespace trephine::library {
namespace {

using Json = nlohmann::ordered_json;
constexpr double width_px = 1200, left_px = 110, right_px = 20, top_px = 46, lane_px = 18, gap_px = 4;
constexpr double axis_px = 24, legend_px = 18;
constexpr std::size_t max_stages = 9;
const std::vector<std::string> colours = {"#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2",
                                          "#edc948", "#b07aa1", "#9c755f", "#ff9da7"};
constexpr const char *other_colour = "#bab0ac", *failed_colour = "#c00000";

std::string px(double v) { return fixed_text(v, 2); }

std::string text_at(double x, double y, const std::string& text, const char* anchor = "start") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\">" + html_text(text) +
         "</text>\n";
}
std::string box(double x, double y, double w, double h, const std::string& colour, const std::string& title = "") {
  return "<rect x=\"" + px(x) + "\" y=\"" + px(y) + "\" width=\"" + px(std::max(w, 0.5)) + "\" height=\"" + px(h) +
         "\" fill=\"" + colour + "\">" + (title.empty() ? "" : "<title>" + html_text(title) + "</title>") + "</rect>\n";
}

// Steps of 1, 2 or 5 times a power of ten, so that there are about ten.
double axis_step(double span_s) {
  double step = 1e-3;
  for (int i = 0; span_s / step > 12; ++i) step *= i % 3 == 1 ? 2.5 : 2;
  return step;
}

std::string token_of(const std::string& job) { return job.rfind("case.", 0) == 0 ? job.substr(5) : ""; }

class Picture {
 public:
  Picture(std::vector<TimelineItem> items, const StagesOfCases& stages) : items_(std::move(items)), stages_(stages) {
    std::sort(items_.begin(), items_.end(), [](const TimelineItem& a, const TimelineItem& b) {
      return std::tie(a.node, a.begin_s, a.name) < std::tie(b.node, b.begin_s, b.name);
    });
    if (!items_.empty()) begin_s_ = end_s_ = items_.front().begin_s;
    for (const TimelineItem& i : items_) {
      begin_s_ = std::min(begin_s_, i.begin_s);
      end_s_ = std::max(end_s_, i.end_s);
    }
    span_s_ = std::max(end_s_ - begin_s_, 1e-3);
    lay_out();
    choose_stages();
  }

  std::string svg() {
    const double lanes_px = static_cast<double>(lanes_.size()) * (lane_px + gap_px);
    const double rows = static_cast<double>((shown_.size() + 3) / 3);
    const double height = top_px + lanes_px + axis_px + legend_px * (rows + 1);
    std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + px(width_px) + "\" height=\"" +
                      px(height) + "\" viewBox=\"0 0 " + px(width_px) + " " + px(height) +
                      "\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"11\">\n";
    out += box(0, 0, width_px, height, "#ffffff");
    out += text_at(left_px, 18, summary());
    out += axis(lanes_px);
    for (std::size_t i = 0; i < items_.size(); ++i) out += bar(items_[i], lane_of_[i]);
    for (std::size_t k = 0; k < lanes_.size(); ++k)
      out +=
          text_at(left_px - 6, y_of(k) + 13, lanes_[k].empty() ? "place " + std::to_string(k + 1) : lanes_[k], "end");
    return out + legend(top_px + lanes_px + axis_px + legend_px) + "</svg>\n";
  }

 private:
  double x_of(double s) const { return left_px + (width_px - left_px - right_px) * (s - begin_s_) / span_s_; }
  static double y_of(std::size_t lane) { return top_px + static_cast<double>(lane) * (lane_px + gap_px); }

  // Each job takes its node's first lane that is free when it begins.
  void lay_out() {
    std::vector<double> free_from;
    for (const TimelineItem& i : items_) {
      std::size_t k = 0;
      while (k < lanes_.size() && (lanes_[k] != i.node || free_from[k] > i.begin_s + 1e-6)) ++k;
      if (k == lanes_.size()) {
        lanes_.push_back(i.node);
        free_from.push_back(0);
      }
      free_from[k] = i.end_s;
      lane_of_.push_back(k);
    }
  }

  void choose_stages() {
    std::map<std::string, double> sums;
    for (const TimelineItem& i : items_)
      if (const auto found = stages_.find(token_of(i.name)); found != stages_.end())
        for (const auto& [stage, s] : found->second) sums[stage] += s;
    std::vector<std::pair<double, std::string>> order;
    for (const auto& [stage, s] : sums) order.emplace_back(-s, stage);
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k < max_stages)
        shown_.emplace_back(order[k].second, -order[k].first);
      else
        others_s_ -= order[k].first;
    }
  }
  std::string colour_of(const std::string& stage) const {
    for (std::size_t k = 0; k < shown_.size(); ++k)
      if (shown_[k].first == stage) return colours[k];
    return other_colour;
  }

  std::string summary() const {
    double busy_s = 0, cpu_s = 0;
    int failed = 0;
    for (const TimelineItem& i : items_) {
      busy_s += i.end_s - i.begin_s;
      cpu_s += i.cpu_s;
      failed += i.code != 0;
    }
    const double places = static_cast<double>(std::max<std::size_t>(lanes_.size(), 1));
    return std::to_string(items_.size()) + " jobs in " + fixed_text(span_s_, 1) + " s, " + fixed_text(cpu_s, 1) +
           " s of CPU; " + std::to_string(lanes_.size()) + " places, in use " +
           fixed_text(100 * busy_s / (places * span_s_), 0) + " % of the time; " + std::to_string(failed) + " failed";
  }

  std::string axis(double lanes_px) const {
    std::string out;
    const double step = axis_step(span_s_);
    for (int n = 0; n * step <= span_s_ * (1 + 1e-9); ++n) {
      const double x = x_of(begin_s_ + n * step);
      out += "<line x1=\"" + px(x) + "\" y1=\"" + px(top_px - 6) + "\" x2=\"" + px(x) + "\" y2=\"" +
             px(top_px + lanes_px) + "\" stroke=\"#dddddd\"/>\n";
      out += text_at(x, top_px + lanes_px + 14, to_text(n * step) + " s", "middle");
    }
    return out;
  }

  std::string bar(const TimelineItem& i, std::size_t lane) const {
    const double y = y_of(lane), x = x_of(i.begin_s), w = x_of(i.end_s) - x;
    const std::string title = i.name + ": " + fixed_text(i.end_s - i.begin_s, 2) + " s from " +
                              fixed_text(i.begin_s - begin_s_, 2) + " s" +
                              (i.code ? ", failed with " + std::to_string(i.code) : "");
    std::string out = box(x, y, w, lane_px, i.code ? failed_colour : other_colour, title);
    const auto found = stages_.find(token_of(i.name));
    if (i.code != 0 || found == stages_.end()) return out;
    // A run's stages follow each other; where threads overlap them they are drawn shorter, so that they fit.
    double sum = 0, at = x;
    for (const auto& [stage, s] : found->second) sum += s;
    const double scale = w / std::max(sum, i.end_s - i.begin_s);
    for (const auto& [stage, s] : found->second) {
      const double part = scale * s;
      if (part >= 0.05)
        out += box(at, y, part, lane_px, colour_of(stage), title + "; " + stage + " " + fixed_text(s, 2) + " s");
      at += part;
    }
    return out + "<rect x=\"" + px(x) + "\" y=\"" + px(y) + "\" width=\"" + px(std::max(w, 0.5)) + "\" height=\"" +
           px(lane_px) + "\" fill=\"none\" stroke=\"#444444\" stroke-width=\"0.5\"/>\n";
  }

  std::string legend(double y) const {
    std::string out;
    std::size_t n = 0;
    const auto entry = [&](const std::string& colour, const std::string& text) {
      const double x = left_px + static_cast<double>(n % 3) * 360, at = y + static_cast<double>(n / 3) * legend_px;
      out += box(x, at - 9, 10, 10, colour) + text_at(x + 15, at, text);
      ++n;
    };
    for (const auto& [stage, s] : shown_) entry(colour_of(stage), stage + "  " + fixed_text(s, 1) + " s");
    entry(other_colour, others_s_ > 0 ? "other stages " + fixed_text(others_s_, 1) + " s; start, reading, publishing"
                                      : "start, reading, publishing");
    return out;
  }

  std::vector<TimelineItem> items_;
  const StagesOfCases& stages_;
  double begin_s_ = 0, end_s_ = 0, span_s_ = 1, others_s_ = 0;
  std::vector<std::string> lanes_;  // the node of each
  std::vector<std::size_t> lane_of_;
  std::vector<std::pair<std::string, double>> shown_;
};

}  // namespace

void keep_timeline(const LibraryState& state, const std::vector<TimelineItem>& items) {
  if (items.empty()) return;
  Json all = Json::array();
  for (const TimelineItem& i : items)
    all.push_back({{"name", i.name},
                   {"node", i.node},
                   {"begin_s", i.begin_s},
                   {"end_s", i.end_s},
                   {"cpu_s", i.cpu_s},
                   {"code", i.code}});
  try {
    write_file(state.timeline_file(), all.dump(0, ' ', false, Json::error_handler_t::replace) + "\n");
  } catch (const Error& e) {
    log_warning(std::string("the build's times cannot be kept: ") + e.what());
  }
}

std::vector<TimelineItem> timeline_of(const Batch& batch) {
  std::vector<TimelineItem> items;
  for (const BatchJob& j : batch.jobs)
    if (const auto r = read_task(batch.folder, task_ended, j.name); r && r->begin_s > 0)
      items.push_back({j.name, r->node, r->begin_s, r->end_s, r->result.cpu_s, r->result.code});
  return items;
}

std::vector<TimelineItem> read_timeline(const LibraryState& state) {
  const std::vector<char> bytes = read_file(state.timeline_file(), std::uint64_t{1} << 28);
  std::vector<TimelineItem> items;
  try {
    for (const Json& j : Json::parse(bytes.begin(), bytes.end()))
      items.push_back({j.at("name"), j.at("node"), j.at("begin_s"), j.at("end_s"), j.at("cpu_s"), j.at("code")});
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::bad_input, state.timeline_file().string(), "", "is damaged; the next build writes it anew");
  }
  return items;
}

std::string timeline_svg(std::vector<TimelineItem> items, const StagesOfCases& stages) {
  return Picture(std::move(items), stages).svg();
}

}  // namespace trephine::library
