// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/run_json.h"

#include <stdlib.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "stages/data_files.h"

namespace trephine::publish {
namespace {

using Json = nlohmann::ordered_json;

double peak_memory_mb(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return double(usage.ru_maxrss) / 1024;
}

}  // namespace

std::string run_json(const pipeline::Graph& graph, const std::vector<pipeline::NodeResult>& results,
                     const Report& folder, const std::vector<AnatomyResult>& anatomies,
                     const std::vector<stages::GradedWarning>& warnings, double wall_s) {
  Json json;
  json["wall_s"] = wall_s;
  json["peak_memory_mb"] = peak_memory_mb(RUSAGE_SELF);
  json["peak_memory_largest_child_mb"] = peak_memory_mb(RUSAGE_CHILDREN);
  json["threads"] = thread_count();
  double load[3] = {0, 0, 0};
  if (getloadavg(load, 3) == 3) json["load_average"] = {load[0], load[1], load[2]};
  for (const AnatomyResult& a : anatomies)
    json["anatomies"][a.name] = {{"triangles_before", a.triangles_before},
                                 {"triangles_after", a.triangles_after},
                                 {"bytes_before", a.bytes_before},
                                 {"bytes_after", a.bytes_after},
                                 {"deviation_max_mm", a.deviation_max_mm},
                                 {"deviation_p99_mm", a.deviation_p99_mm},
                                 {"deviation_rms_mm", a.deviation_rms_mm},
                                 {"volume_ml", a.volume_ml},
                                 {"seconds", a.seconds},
                                 {"stopped_by", a.stopped_by}};
  json["folder"] = Json::parse(stages::report_json(folder));
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    Json& stage = json["stages"][graph.nodes[i].name];
    stage["state"] = pipeline::name_of(results[i].state);
    stage["seconds"] = results[i].seconds;
    if (results[i].state == pipeline::NodeResult::State::computed) stage["kept"] = results[i].kept;
    stage["report"] = Json::parse(stages::report_json(results[i].report()));
  }
  json["warnings"] = json["severities"] = Json::array();
  for (const stages::GradedWarning& w : warnings) {
    json["warnings"].push_back(w.text);
    json["severities"].push_back(stages::to_text(w.severity));
  }
  return json.dump(2) + "\n";
}

}  // namespace trephine::publish
