// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/refused.h"

#include <algorithm>
#include <memory>

#include "base/hash.h"
#include "base/text.h"
#include "base/write_file.h"
#include "consistency/anatomy_gate.h"
#include "mask/coarse.h"
#include "meshing/contour.h"
#include "publish/case_pictures.h"
#include "publish/face_clearance.h"

namespace trephine::publish {
namespace fs = std::filesystem;
namespace {

template <class T>
using Shared = std::shared_ptr<const T>;

/// The field on cells of about a millimetre: a surface of a scan's voxels takes seconds that a refusal need not.
grid::Field for_a_look(const grid::Field& field) {
  constexpr double cell_mm = 1;
  return mask::coarse_mean(field, mask::coarse_raster(field, cell_mm));
}

/// Finds what stages have made, in memory or else in the cache.
class Made {
 public:
  explicit Made(const RefusedRun& run) : run_(run) {}

  bool is_done(int node) const {
    return node >= 0 && std::size_t(node) < run_.made.size() &&
           run_.made[node].state != pipeline::NodeResult::State::not_needed;
  }

  stages::StageData any(int node) const {
    if (node < 0) return {};
    if (std::size_t(node) < run_.made.size())
      if (auto data = run_.made[node].loaded(); data.index() != 0) return data;
    return run_.cache.load_data(run_.graph.nodes[node].key, run_.graph.nodes[node].output)
        .value_or(stages::StageData());
  }

  template <class T>
  Shared<T> find(int node) const {
    const stages::StageData data = any(node);
    const auto* found = std::get_if<Shared<T>>(&data);
    return found ? *found : Shared<T>();
  }

  /// The newest surface of an anatomy: the published one, an earlier one, or one made now of the newest field.
  Shared<surface::TriMesh> surface_of(const pipeline::Graph::Anatomy& a) const {
    for (const int node : {a.surface, a.finished, a.first_surface})
      if (auto mesh = find<surface::TriMesh>(node)) return mesh;
    const auto field = field_before(a.first_surface, a.name);
    if (!field) return {};
    try {
      return std::make_shared<const surface::TriMesh>(
          meshing::contour(for_a_look(*field), meshing::ContourParams()).value);
    } catch (const Error&) {  // what has no surface has no picture
      return {};
    }
  }

 private:
  /// The newest field of the anatomy that the node would have been made of: a refusal may come before the last ones.
  Shared<grid::Field> field_before(int node, const std::string& anatomy) const {
    for (const auto& [port, source] : run_.graph.nodes[node].sources) {
      const pipeline::Node& of = run_.graph.nodes[source];
      if (of.output != stages::DataKind::field || of.name.rfind(anatomy + ".", 0) != 0) continue;
      if (auto field = find<grid::Field>(source)) return field;
      if (auto field = field_before(source, anatomy)) return field;
    }
    return {};
  }

  const RefusedRun& run_;
};

/// What the face gate finds of what was made; where it is not there, the gate refuses.
FaceSources sources_of(const RefusedRun& run, const Made& made) {
  return {[&](int node) { return made.any(node); },
          [&](int node) { return made.is_done(node) ? &run.made[std::size_t(node)].result : nullptr; }};
}

/// Whether the scan and all surfaces may be seen: as a run asks it of what it publishes, after its own stage did.
bool passes_gate(const RefusedRun& run, const Made& made, const FaceSources& sources, const FaceShown& shown) {
  if (run.config.takes_face_away() && !made.is_done(run.graph.find_stage<face::FaceBeliefParams>())) return false;
  try {
    return require_no_face(run.config, run.graph, sources, shown).scan_may_be_seen;
  } catch (const Error& e) {
    if (e.code() != ExitCode::privacy) throw;
    return false;
  }
}

std::vector<CasePicture> pictures_of(const RefusedRun& run, const Error& refusal) {
  const Made made(run);
  const FaceSources sources = sources_of(run, made);
  std::vector<Shared<surface::TriMesh>> surfaces;
  FaceShown all;
  for (const pipeline::Graph::Anatomy& a : run.graph.anatomies)
    if (auto mesh = made.surface_of(a); mesh && !mesh->triangles.empty()) {
      all.surfaces.push_back({a.name, mesh.get()});
      surfaces.push_back(std::move(mesh));
    }
  const auto seen = made.find<grid::HuVolume>(run.graph.scan);
  all.scan = seen.get();
  const bool whole = passes_gate(run, made, sources, all);
  std::vector<PictureAnatomy> shown;
  for (const face::FaceSurface& s : all.surfaces) {
    const config::RecipeAnatomy& recipe = *run.config.find_anatomy(s.name);
    if (whole || shows_no_skin(run.config, run.graph, sources, *s.mesh))
      shown.push_back({s.name, s.mesh, recipe.colour_rgb, recipe.opacity_ratio});
  }
  const auto marks = made.find<head::HeadLandmarks>(run.graph.result(stages::DataKind::landmarks));
  const std::vector<cases::CaseLandmark> landmarks =
      marks && whole ? marks->landmarks : std::vector<cases::CaseLandmark>();
  std::vector<CasePicture> pictures = make_case_pictures(whole ? seen.get() : nullptr, shown, landmarks);
  for (CasePicture& p : make_side_pictures(shown)) pictures.push_back(std::move(p));
  if (const auto* anatomy = dynamic_cast<const consistency::AnatomyError*>(&refusal); anatomy && whole)
    if (!anatomy->picture_png.empty()) pictures.push_back({"fault.png", anatomy->picture_png});
  return pictures;
}

constexpr const char* message_file = "message.txt";

/// What the folder's content is made of: series, parameters and the policy for faces. Pictures of other runs must not
/// stay.
std::string stamp_of(const RefusedRun& run) {
  Sha256 sha;
  sha.text(run.config.face);
  for (const pipeline::Node& node : run.graph.nodes) sha.text(node.name).text(node.key);
  return "made of " + sha.hex() + "\n";
}

std::string message_of(const RefusedRun& run, const Error& refusal) {
  std::string text = run.config.case_token + ": ";
  if (!refusal.field().empty()) text += printable(refusal.field()) + ": ";
  text += printable(refusal.what()) + "\n";
  if (!run.warnings.empty()) text += "\nWarnings:\n";
  for (const stages::GradedWarning& w : run.warnings) text += printable(w.text) + "\n";
  return text + "\n" + stamp_of(run);
}

bool has_stamp(const fs::path& file, const std::string& stamp) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  try {
    const std::vector<char> text = read_file(file, 1 << 20);
    return text.size() >= stamp.size() &&
           std::equal(stamp.begin(), stamp.end(), text.end() - std::ptrdiff_t(stamp.size()));
  } catch (const Error&) {
    return false;
  }
}

bool holds_picture(const fs::path& folder) {
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().extension() == ".png") return true;
  return false;
}

fs::path half_made(const fs::path& folder) { return folder.parent_path() / ("." + folder.filename().string()); }

}  // namespace

fs::path refused_folder(const fs::path& library, const std::string& case_token) {
  return library / (case_token + ".refused");
}

bool keep_refused(const fs::path& folder, const RefusedRun& run, const Error& refusal, const Error& told) {
  const std::string message = message_of(run, told);
  std::error_code error;
  // The same again, from the cache: what is there shows it already.
  if (run.made.empty() && refusal.code() == ExitCode::quality && has_stamp(folder / message_file, stamp_of(run)))
    return holds_picture(folder);
  const fs::path fresh = half_made(folder);
  fs::remove_all(fresh, error);
  make_output_folder(fresh);
  fs::permissions(fresh, fs::perms::owner_all, error);
  if (error) throw Error(ExitCode::cannot_create, fresh.string(), "", "cannot be closed to others: " + error.message());
  write_file(fresh / message_file, message);
  if (refusal.code() == ExitCode::quality)
    for (const CasePicture& p : pictures_of(run, refusal)) write_file(fresh / p.name, p.png);
  fs::remove_all(folder, error);
  fs::rename(fresh, folder, error);
  if (error) throw Error(ExitCode::cannot_create, folder.string(), "", error.message());
  return holds_picture(folder);
}

void remove_refused(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::remove_all(half_made(folder), ignored);
}

}  // namespace trephine::publish
