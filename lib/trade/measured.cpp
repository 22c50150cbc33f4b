// SPDX-License-Identifier: GPL-3.0-or-later
#include "trade/measured.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"
#include "stages/data_files.h"

namespace trephine::trade {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr const char* record_ending = ".json";

// Sets the kernel's high-water mark of this process back to what it holds now. Some containers do not allow that: then
// the mark is that of an earlier stage, and the memory counts as unknown.
bool reset_peak() {
  malloc_trim(0);  // memory that the last stage freed must not count for this one
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

double peak_mb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "VmHWM:") {
      double kb = 0;
      status >> kb;
      return kb / 1024;
    }
  return 0;
}

std::string to_json(const Measurement& m) {
  Json json;
  json["values"] = m.values;
  json["seconds"] = m.seconds;
  json["peak_memory_mb"] = m.peak_memory_mb;
  json["refused"] = m.refused;
  return json.dump();
}

}  // namespace

double Measurement::median_s() const {
  if (seconds.empty()) return 0;
  std::vector<double> sorted = seconds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return n % 2 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}

double Measurement::spread_s() const {
  if (seconds.empty()) return 0;
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  return *most - *least;
}

MeasurementStore::MeasurementStore(fs::path folder) : folder_(std::move(folder)) {
  make_output_folder(folder_);
  remove_stale_temporaries(folder_);
}

const Measurement* MeasurementStore::find(const std::string& key) {
  if (const auto known = known_.find(key); known != known_.end()) return &known->second;
  if (absent_.count(key)) return nullptr;
  const fs::path file = folder_ / (key + record_ending);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return absent_.insert(key), nullptr;
  try {
    const std::vector<char> bytes = read_file(file, 1 << 24);
    const Json json = Json::parse(bytes.begin(), bytes.end());
    Measurement m;
    m.values = json.at("values").get<std::string>();
    m.seconds = json.at("seconds").get<std::vector<double>>();
    m.peak_memory_mb = json.at("peak_memory_mb").get<double>();
    m.refused = json.at("refused").get<std::string>();
    return &(known_[key] = std::move(m));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return absent_.insert(key), nullptr;
  }
}

const Measurement& MeasurementStore::keep(const std::string& key, Measurement measurement) {
  write_file(folder_ / (key + record_ending), to_json(measurement));
  absent_.erase(key);
  return known_[key] = std::move(measurement);
}

int MeasurementStore::remove_unused() {
  int removed = 0;
  std::error_code ignored;
  std::vector<fs::path> unused;
  for (const auto& entry : fs::directory_iterator(folder_, ignored))
    if (entry.path().extension() == record_ending && !known_.count(entry.path().stem().string()))
      unused.push_back(entry.path());
  for (const fs::path& f : unused) removed += fs::remove(f, ignored);
  return removed;
}

bool Repeats::suffice(const Measurement& m) const {
  if (!m.refused.empty()) return true;
  double total_s = 0;
  for (const double s : m.seconds) total_s += s;
  return m.seconds.size() >= static_cast<std::size_t>(std::max(1, count)) || (!m.seconds.empty() && total_s >= max_s);
}

Measurement measure_work(const Repeats& repeats, const std::function<std::string()>& work, const std::string& stage) {
  Measurement m;
  try {
    for (int i = 0; !repeats.suffice(m); ++i) {
      const bool known = reset_peak();
      const auto start = Clock::now();
      std::string values = work();
      m.seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
      if (known) m.peak_memory_mb = std::max(m.peak_memory_mb, peak_mb());
      if (i == 0) m.values = std::move(values);
    }
  } catch (const Error& e) {
    if (e.code() != ExitCode::quality) throw;
    m.seconds.clear();
    m.refused = (e.field().empty() ? "" : e.field() + ": ") + e.message().text(stage);
  }
  return m;
}

Progress TimedStages::progress_of(const std::string& node) const {
  return Progress(
      [this, node](double f) {
        if (options_.progress) options_.progress(node, f);
      },
      options_.cancel);
}

stages::StageInputs TimedStages::inputs(const pipeline::Graph& graph, int node) {
  stages::StageInputs in;
  for (const auto& [port, source] : graph.nodes[static_cast<std::size_t>(node)].sources)
    in.by_port[port] = data(graph, source);
  return in;
}

stages::StageData TimedStages::data(const pipeline::Graph& graph, int node) {
  const pipeline::Node& n = graph.nodes[static_cast<std::size_t>(node)];
  if (const auto held = held_.find(n.key); held != held_.end()) return held->second;
  stages::StageData data;
  if (options_.cache)
    if (auto cached = options_.cache->load_data(n.key, n.output)) data = std::move(*cached);
  if (std::holds_alternative<std::monostate>(data) && n.output != stages::DataKind::nothing) {
    data = pipeline::compute_node(n, inputs(graph, node), progress_of(n.name)).data;
  }
  return held_[n.key] = std::move(data);
}

std::optional<TimedStages::Refusal> TimedStages::measure(const pipeline::Graph& graph) {
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const pipeline::Node& node = graph.nodes[i];
    const Measurement* known = store_.find(node.key);
    if (known && options_.repeats.suffice(*known)) {
      if (!known->refused.empty()) return Refusal{node.name, known->refused};
      continue;
    }
    // Only the stage's inputs are in memory while it runs, because anything else would count as its memory.
    std::set<std::string> wanted;
    for (const auto& [port, source] : node.sources) wanted.insert(graph.nodes[static_cast<std::size_t>(source)].key);
    for (auto held = held_.begin(); held != held_.end();)
      held = wanted.count(held->first) ? std::next(held) : held_.erase(held);
    const stages::StageInputs in = inputs(graph, static_cast<int>(i));
    for (auto held = held_.begin(); held != held_.end();)
      held = wanted.count(held->first) ? std::next(held) : held_.erase(held);
    stages::StageOutcome made;
    ++measured_;
    const Measurement measured = measure_work(
        options_.repeats,
        [&] {
          made = {};
          made = pipeline::compute_node(node, in, progress_of(node.name));
          return stages::outcome_json(made);
        },
        node.name);
    if (measured.refused.empty() && options_.cache && node.output != stages::DataKind::nothing)
      options_.cache->store(node.key, node.output, made, measured.median_s());
    held_[node.key] = std::move(made.data);
    const Measurement& kept = store_.keep(node.key, measured);
    if (!kept.refused.empty()) return Refusal{node.name, kept.refused};
  }
  return {};
}

}  // namespace trephine::trade
