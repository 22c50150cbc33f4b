// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/page_files.h"

#include <malloc.h>

#include <cmath>
#include <limits>
#include <map>

#include "base/error.h"
#include "page/case_page.h"
#include "page/page_notes.h"
#include "surface/point_to_mesh.h"

namespace trephine::publish {
namespace {

constexpr double same_surface_mm = 1e-3;  // rounding of a boolean's points; a wall is farther from what it cuts

const surface::TriMesh& mesh_of(const std::vector<pipeline::NodeResult>& results, int node) {
  return *std::get<std::shared_ptr<const surface::TriMesh>>(results[static_cast<std::size_t>(node)].data);
}

// Each point's signed distance to the surface before decimation. The wall of a burr hole was cut afterwards and
// deviates from nothing, so its points get no value.
std::vector<float> deviation_of(const pipeline::Graph::Anatomy& nodes, const std::vector<pipeline::NodeResult>& results,
                                const Progress& cancelled) {
  const surface::TriMesh& surface = mesh_of(results, nodes.surface);
  std::vector<Vec3> world(surface.points_mm.size());
  for (std::size_t i = 0; i < world.size(); ++i) world[i] = surface.world_mm(i);
  const auto signed_mm =
      surface::PointToMesh(mesh_of(results, nodes.first_surface), cancelled).signed_distances_mm(world, cancelled);
  std::vector<float> out(signed_mm.begin(), signed_mm.end());
  if (nodes.surface == nodes.finished) return out;
  const auto from_uncut_mm =
      surface::PointToMesh(mesh_of(results, nodes.finished), cancelled).distances_mm(world, cancelled);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!(from_uncut_mm[i] <= same_surface_mm)) out[i] = std::numeric_limits<float>::quiet_NaN();
  return out;
}

page::PageTrade trade_of(const config::CaseTrade& trade) {
  page::PageTrade out;
  if (trade.rule.empty()) return out;
  std::vector<std::vector<config::TradePoint>> sweeps;
  for (const auto& front : trade.fronts) sweeps.push_back(config::read_trade_front(front).points);
  out.rule = trade.rule.text();
  out.chosen = trade.choice.point.name;
  out.why = trade.choice.why;
  for (const config::TradePoint& p : config::points_of_all(sweeps))
    out.points.push_back({p.name, p.seconds, p.deviation_rms_mm, p.triangles_count, p.refused});
  return out;
}

// The case as a program would load it, from the bytes that will be written.
cases::LoadedCase loaded(const CaseContent& content) {
  std::map<std::string, std::string_view> files;
  const std::string json = cases::to_json(content.manifest);
  files["case.json"] = json;
  for (std::size_t i = 0; i < content.files.size(); ++i) files[content.manifest.files[i].name] = content.files[i].bytes;
  return cases::load_case_through(
      [&](const std::string& name, std::uint64_t) {
        const std::string_view bytes = files.at(name);
        return std::vector<char>(bytes.begin(), bytes.end());
      },
      cases::LoadParts{true});
}

}  // namespace

std::vector<CasePicture> make_page_files(const config::CaseConfig& config, const pipeline::Graph& graph,
                                         const std::vector<pipeline::NodeResult>& results, const CaseContent& content,
                                         const std::vector<stages::GradedWarning>& warnings, const Progress& progress) {
  const Progress cancelled = progress.silent();
  page::PageNotes notes;
  for (const stages::GradedWarning& w : warnings) notes.warnings.push_back({w.text, stages::to_text(w.severity)});
  notes.trade = trade_of(config.trade);
  std::vector<CasePicture> files;
  for (const pipeline::Graph::Anatomy& nodes : graph.anatomies) {
    progress.report(0.7 * double(notes.deviation_mm.size()) / double(graph.anatomies.size()));
    const cases::CaseAnatomy& anatomy = *content.manifest.find_anatomy(nodes.name);
    std::vector<float>& deviation = notes.deviation_mm[nodes.name] = deviation_of(nodes, results, cancelled);
    files.push_back({page::deviation_file_name(content.manifest, anatomy), page::encode_deviation(deviation)});
  }
  files.push_back({page::page_notes_file, page::page_notes_json(notes)});
  progress.report(0.7);
  malloc_trim(0);  // what measuring the deviations took is given back before the page is made
  files.push_back({page::page_file, page::make_case_page(loaded(content), notes, {}, cancelled)});
  progress.report(1);
  return files;
}

bool is_of_report(const std::filesystem::path& file) {
  return file.extension() == ".png" || file.extension() == ".f32" || file.filename() == page::page_file ||
         file.filename() == page::page_notes_file;
}

}  // namespace trephine::publish
