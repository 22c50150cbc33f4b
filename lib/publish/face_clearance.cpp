// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/face_clearance.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "face/face_belief.h"
#include "face/scan_skin.h"
#include "look/body_part.h"

namespace trephine::publish {
namespace {

constexpr const char* how_to_say =
    "; the scene must say face: {policy: deface}, {policy: crop} or {policy: keep, reason: ...}";

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::privacy, "", field, what);
}

/// A scan that the case reads, as it was read, and what lays it on the CT (-1: it is the CT).
struct ReadScan {
  std::string name = config::first_scan;
  int import = 0, registration = -1;
  face::ScanValues values = face::ScanValues::hu;
};

std::vector<ReadScan> scans_of(const config::CaseConfig& config, const pipeline::Graph& graph) {
  std::vector<ReadScan> all(1);
  for (const auto& [name, node] : graph.scans) {
    const bool is_mr = config.find_scan(name)->modality == config::ScanModality::mr;
    all.push_back({name, graph.nodes[std::size_t(node)].sources.at("moving"), node,
                   is_mr ? face::ScanValues::brightness : face::ScanValues::hu});
  }
  return all;
}

template <class T>
std::shared_ptr<const T> data_of(const FaceSources& sources, int node, const std::string& what) {
  const stages::StageData data = sources.data(node);
  const auto* found = std::get_if<std::shared_ptr<const T>>(&data);
  if (!found || !*found) refuse(what, "is not at hand, so that nothing says whether a face is shown");
  return *found;
}

std::shared_ptr<const grid::HuVolume> volume_of(const FaceSources& sources, const ReadScan& scan) {
  return data_of<grid::HuVolume>(sources, scan.import, "scans." + scan.name);
}

/// In the case's frame: the rigid map of the registration leads from the CT to the scan, so its inverse moves the
/// scan's lattice.
void lay_on_the_ct(grid::Lattice& lattice, const std::vector<double>& map) {
  Mat3 rows;  // the transposed matrix: its columns are the map's rows
  Vec3 offset;
  for (int r = 0; r < 3; ++r) {
    rows.column[r] = {map.at(4 * r), map.at(4 * r + 1), map.at(4 * r + 2)};
    offset[r] = map.at(4 * r + 3);
  }
  lattice.origin_mm = rows * (lattice.origin_mm - offset);
  for (Vec3& column : lattice.direction.column) column = rows * column;
}

std::vector<face::ScanSkin> skins_of(const config::CaseConfig& config, const pipeline::Graph& graph,
                                     const FaceSources& sources, const Progress& progress) {
  std::vector<face::ScanSkin> skins;
  for (const ReadScan& scan : scans_of(config, graph)) {
    auto skin = face::scan_skin(*volume_of(sources, scan), scan.values, progress.silent());
    if (!skin) continue;
    if (scan.registration >= 0) {
      const AnyParams* figures = sources.result(scan.registration);
      if (!figures) refuse("scans." + scan.name, "is not registered, so that nothing says whether its face is shown");
      lay_on_the_ct(*skin, result_as<itk::RegistrationFigures>(*figures).transform);
    }
    skins.push_back({scan.name, std::move(*skin)});
  }
  return skins;
}

/// A check of the scan may have found that out already.
bool is_known_without_head(const pipeline::Graph& graph, const FaceSources& sources) {
  const int check = graph.find_stage<look::BodyPartParams>();
  const AnyParams* result = check >= 0 ? sources.result(check) : nullptr;
  return result && !look::may_be_head(result_as<look::BodyPartResult>(*result).seen);
}

bool may_show_head(const config::CaseConfig& config, const pipeline::Graph& graph, const FaceSources& sources,
                   const Progress& progress) {
  for (const ReadScan& scan : scans_of(config, graph)) {
    if (scan.values != face::ScanValues::hu) continue;  // it lies on a CT of the same place
    if (scan.registration < 0 && is_known_without_head(graph, sources)) continue;
    if (look::may_be_head(look::body_part_of(*volume_of(sources, scan), progress.silent()))) return true;
  }
  return false;
}

std::vector<face::FaceVolume> volumes_of(const FaceShown& shown) {
  std::vector<face::FaceVolume> volumes;
  if (shown.haptic) {
    volumes.push_back(face::face_volume("the haptic volume", *shown.haptic));
    if (shown.haptic->hardness.count() > 0)
      volumes.push_back(face::face_volume("the haptic volume's hardness", shown.haptic->hardness));
  }
  if (shown.scan) volumes.push_back(face::face_volume("the CT", *shown.scan));
  return volumes;
}

std::vector<face::FaceRegion> regions_of(const config::CaseConfig& config, const pipeline::Graph& graph,
                                         const FaceSources& sources) {
  const int gate = graph.find_stage<face::FaceBeliefParams>();
  if (gate < 0) refuse("scene.face", "is " + config.face + ", and the recipe has nothing that finds a face");
  const auto& ports = graph.nodes[std::size_t(gate)].sources;
  const auto landmarks = [&](const char* port) {
    return data_of<head::HeadLandmarks>(sources, ports.at(port), "landmarks");
  };
  const auto known = landmarks("landmarks");
  const auto found = ports.count("found") ? landmarks("found") : nullptr;
  return face::believed_regions(*known, found.get(), config.face_belief);
}

void require_skin_hidden(const std::vector<face::ScanSkin>& skins, const FaceShown& shown, bool holds_scan,
                         const Progress& progress) {
  for (const face::ScanSkin& s : skins) {
    const auto require = [&](const std::string& name, double cm2) {
      if (cm2 >= face::skin_is_shown_cm2)
        refuse(name,
               fmt::format("shows {:.0f} cm2 of the skin of a head, as the scan {} has it{}", cm2, s.scan, how_to_say));
    };
    for (const face::FaceSurface& f : shown.surfaces) require(f.name, face::skin_shown_cm2(s.skin, *f.mesh, progress));
    if (shown.haptic) require("the haptic volume", face::skin_shown_cm2(s.skin, *shown.haptic, progress));
    if (holds_scan && shown.scan) require("the CT", face::skin_shown_cm2(s.skin, *shown.scan, progress));
  }
}

bool depends_on(const pipeline::Graph& graph, int node, int source) {
  const std::vector<int> needs = graph.needs_of(node);
  return node == source || std::find(needs.begin(), needs.end(), source) != needs.end();
}

}  // namespace

FaceSources face_sources(const std::vector<pipeline::NodeResult>& results) {
  using State = pipeline::NodeResult::State;
  return {[&results](int node) { return results.at(std::size_t(node)).loaded(); },
          [&results](int node) {
            const pipeline::NodeResult& r = results.at(std::size_t(node));
            return r.state == State::not_needed ? nullptr : &r.result;
          }};
}

void add_face_nodes(const config::CaseConfig& config, const pipeline::Graph& graph, std::vector<int>& wanted) {
  if (config.face == "keep") return;
  const bool is_told = !config.takes_face_away() && graph.find_stage<look::BodyPartParams>() >= 0;
  for (const ReadScan& scan : scans_of(config, graph))
    if (scan.registration >= 0 || !is_told) wanted.push_back(scan.import);
  const int gate = config.takes_face_away() ? graph.find_stage<face::FaceBeliefParams>() : -1;
  for (const char* port : {"landmarks", "found"})
    if (gate >= 0 && graph.nodes[std::size_t(gate)].sources.count(port))
      wanted.push_back(graph.nodes[std::size_t(gate)].sources.at(port));
}

FaceClearance require_no_face(const config::CaseConfig& config, const pipeline::Graph& graph,
                              const FaceSources& sources, const FaceShown& shown, const Progress& progress) {
  if (config.face == "keep") return {};
  if (config.takes_face_away()) {
    const auto regions = regions_of(config, graph, sources);
    face::check_face_removed(skins_of(config, graph, sources, progress), regions, shown.surfaces, volumes_of(shown),
                             progress);
    return {};
  }
  if (!may_show_head(config, graph, sources, progress)) return {};
  require_skin_hidden(skins_of(config, graph, sources, progress), shown, config.ct.has_value(), progress);
  return {false};
}

FaceClearance require_no_face(const config::CaseConfig& config, const pipeline::Graph& graph,
                              const std::vector<pipeline::NodeResult>& results, bool pictures,
                              const Progress& progress) {
  if (config.face == "keep") return {};
  const FaceSources sources = face_sources(results);
  std::vector<std::shared_ptr<const surface::TriMesh>> meshes;
  FaceShown shown;
  for (const pipeline::Graph::Anatomy& a : graph.anatomies) {
    meshes.push_back(data_of<surface::TriMesh>(sources, a.surface, a.name));
    shown.surfaces.push_back({a.name, meshes.back().get()});
  }
  std::shared_ptr<const voxel::HapticVolume> haptic;
  if (const int node = graph.result(stages::DataKind::haptic); node >= 0)
    haptic = data_of<voxel::HapticVolume>(sources, node, "the haptic volume");
  std::shared_ptr<const grid::HuVolume> scan;
  if (config.ct || pictures) scan = data_of<grid::HuVolume>(sources, graph.scan, "the CT");
  shown.haptic = haptic.get();
  shown.scan = scan.get();
  return require_no_face(config, graph, sources, shown, progress);
}

bool shows_no_skin(const config::CaseConfig& config, const pipeline::Graph& graph, const FaceSources& sources,
                   const surface::TriMesh& mesh, const Progress& progress) {
  try {
    for (const face::ScanSkin& s : skins_of(config, graph, sources, progress))
      if (face::skin_shown_cm2(s.skin, mesh, progress) >= face::skin_is_shown_cm2) return false;
    return true;
  } catch (const Error& e) {
    if (e.code() != ExitCode::privacy) throw;
    return false;
  }
}

void require_made_without_face(const config::CaseConfig& config, const pipeline::Graph& graph, int node) {
  if (!config.takes_face_away()) return;
  const pipeline::Node& of = graph.nodes[std::size_t(node)];
  if (of.output != stages::DataKind::landmarks && !depends_on(graph, node, graph.scan))
    refuse("--stage", of.name + " is made before the face is taken away, which the scene demands");
  for (const auto& [name, scan] : graph.scans)
    if (depends_on(graph, node, scan))
      refuse("--stage", of.name + " reads the scan " + name +
                            ", whose face is not taken away; run the case, whose gate checks what is published");
}

std::string how_to_take_face_off(const std::vector<cases::CaseLandmark>& landmarks) {
  const std::string setting = "`--set scene.face.policy=deface` takes it off";
  const bool looked_for =
      std::any_of(landmarks.begin(), landmarks.end(), [](const cases::CaseLandmark& l) { return l.source != "given"; });
  try {
    if (looked_for) face::face_region({{}, landmarks});
    return setting;
  } catch (const Error& e) {
    return setting + " once the landmarks of the face are given in the case's configuration, mm, LPS: by " + e.field() +
           " as it was found nobody knows where the face is";
  }
}

}  // namespace trephine::publish
