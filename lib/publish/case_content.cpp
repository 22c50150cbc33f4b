// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_content.h"

#include <algorithm>
#include <cmath>
#include <list>

#include "base/error.h"
#include "base/log.h"
#include "base/refusal.h"
#include "boolean/cut_surface.h"
#include "boolean/cutter_use.h"
#include "cases/glb.h"
#include "grid/nrrd.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/validity.h"
#include "metrics/deviation.h"
#include "metrics/measure.h"
#include "publish/ct_content.h"
#include "publish/findings_content.h"
#include "publish/haptic_content.h"
#include "publish/head_content.h"
#include "publish/scan_findings.h"
#include "publish/scene_limits.h"
#include "publish/verdict.h"
#include "surface/bounds.h"
#include "voxel/mismatch.h"
#include "voxel/shape_field.h"
#include "voxel/voxelize.h"

namespace trephine::publish {
namespace {

constexpr double removed_tolerance = 0.03;

// Everything that a case is made of, step by step.
class Builder {
 public:
  Builder(const config::CaseConfig& config, const pipeline::Graph& graph,
          const std::vector<pipeline::NodeResult>& results)
      : config_(config), graph_(graph), results_(results), parts_(parts_of(graph, results)) {}

  CaseContent build(const std::string& program_version, const std::string& input_sha256, PictureWish pictures,
                    const Progress& progress) {
    const Progress surfaces = progress.part(0, pictures.of == PicturesOf::nothing ? 0.8 : 0.3);
    manifest().center_mm = center();
    add_provenance(program_version, input_sha256);
    manifest().face_policy = config_.face.empty() ? "none" : config_.face;
    manifest().face_reason = config_.face_reason;
    add_landmarks(config_, graph_, results_, manifest());
    add_findings();
    doubt_the_targets(manifest());
    for (const pipeline::NodeResult& r : results_) doubt_landmarks(r.warnings, manifest());
    for (std::size_t i = 0; i < graph_.anatomies.size(); ++i) {
      surfaces.report(double(i) / double(graph_.anatomies.size()));
      add_anatomy(graph_.anatomies[i], config_.scene[i]);
    }
    hold_against_budget();
    add_figures(config_, parts_, manifest());
    add_evidence();
    if (haptic_ >= 0) add_haptic();
    if (config_.ct) add_ct();
    for (const int hole : graph_.results(stages::DataKind::cutters)) add_burr_hole(hole);
    if (pictures.of != PicturesOf::nothing) add_pictures(pictures, progress.part(0.4, 1));
    progress.report(1);
    return std::move(out_);
  }

 private:
  // Those that labels number first.
  void add_findings() {
    auto& all = manifest().findings;
    for (const stages::CaseParts& p : parts_) all.insert(all.end(), p.findings.begin(), p.findings.end());
    for (cases::CaseFinding& f : findings_of_scans(config_, graph_, parts_, manifest().center_mm))
      all.push_back(std::move(f));
  }

  void add_evidence() {
    for (const stages::CaseParts& p : parts_) {
      out_.evidence.insert(out_.evidence.end(), p.evidence.begin(), p.evidence.end());
      out_.remarks.insert(out_.remarks.end(), p.remarks.begin(), p.remarks.end());
    }
    for (std::size_t i = 0; i < results_.size(); ++i)
      if (const pipeline::Node& node = graph_.nodes[i]; !node.is_early)
        for (const Warning& w : results_[i].warnings)
          for (const stages::Evidence& e : evidence_of(w, node.anatomy()))
            for (const std::string& heir : heirs_of(e.anatomy, graph_, config_))
              out_.evidence.push_back({heir, e.cut, e.why});
    for (stages::Evidence& e : evidence_of(manifest().findings)) out_.evidence.push_back(std::move(e));
  }

  cases::CaseManifest& manifest() { return out_.manifest; }
  const pipeline::NodeResult& at(int node) const { return results_[static_cast<std::size_t>(node)]; }
  const surface::TriMesh& mesh(int node) const {
    return *std::get<std::shared_ptr<const surface::TriMesh>>(at(node).data);
  }
  const voxel::HapticVolume& haptic() const {
    return *std::get<std::shared_ptr<const voxel::HapticVolume>>(at(haptic_).data);
  }
  // The typed result of a node that the case has.
  template <class R>
  const R& result(int node) const {
    return result_as<R>(at(node).result);
  }

  // The centre of the surfaces' bounds, rounded to whole mm: it is exact in float32, as the surfaces' own origins are.
  Vec3 center() const {
    surface::Bounds all;
    for (const pipeline::Graph::Anatomy& a : graph_.anatomies)
      surface::include(all, surface::bounds_of(mesh(a.surface)));
    const Vec3 c = (all.min_mm + all.max_mm) / 2;
    return {std::round(c.x), std::round(c.y), std::round(c.z)};
  }

  void add_provenance(const std::string& program_version, const std::string& input_sha256) {
    cases::CaseManifest& m = manifest();
    m.case_token = config_.case_token;
    m.program_version = program_version;
    m.input_sha256 = input_sha256;
    // Only the stages by which the case was made: parameters that the scene does not need change no byte.
    // A check that is made early is made again with the whole case, by parameters of its own.
    for (const pipeline::Node& node : graph_.nodes) {
      if (node.is_early) continue;
      for (const auto& [name, value] : node.recorded()) m.parameters.emplace_back(node.name + "." + name, value);
    }
    for (const auto& [name, node] : graph_.scans) {
      const config::CaseScan& scan = *config_.find_scan(name);
      m.parameters.emplace_back("scans." + name + ".modality",
                                ParameterValue(std::string(config::to_text(scan.modality))));
      if (!scan.same_patient_reason.empty())
        m.parameters.emplace_back("scans." + name + ".same_patient_reason", ParameterValue(scan.same_patient_reason));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i)
      for (const auto& [name, value] : parts_[i].made_of)
        m.parameters.emplace_back(graph_.nodes[i].name + "." + name, value);
  }

  void add_file(const std::string& stem, const std::string& extension, std::string bytes, std::string& name) {
    const cases::CaseFile file = cases::describe_case_file(stem, extension, bytes);
    name = file.name;
    manifest().files.push_back(file);
    out_.files.push_back({stem, extension, std::move(bytes)});
  }

  // Adds up the bounds that were given to the stages which moved the surface, and what these stages used of them.
  void add_budget(const config::RecipeAnatomy& recipe, cases::CaseAnatomy& out) const {
    for (const config::RecipeStep& step : recipe.steps) {
      for (const char* bound : {"max_deviation_mm", "max_displacement_mm"})
        if (const Parameter* p = step.params.set->find(bound))
          out.budget_asked_mm += std::get<double>(step.params.get(*p));
      const int node = graph_.find(recipe.name + "." + step.type->name);
      out.budget_used_mm += parts_.at(std::size_t(node)).moved_mm.value_or(0);
    }
  }

  void add_stage_figures(int node, cases::CaseAnatomy& out, AnatomyResult& result) const {
    if (node < 0) return;
    result.seconds += at(node).seconds;
    const std::string& stage = graph_.nodes[std::size_t(node)].type->name;
    for (auto& figure : stages::figures_named(stage + ".", at(node).result)) out.figures.push_back(std::move(figure));
  }

  void add_anatomy(const pipeline::Graph::Anatomy& nodes, const config::SceneAnatomy& limit) {
    const config::RecipeAnatomy& recipe = *config_.find_anatomy(nodes.name);
    const surface::TriMesh& surface = mesh(nodes.surface);

    cases::GlbParams glb;
    glb.center_mm = manifest().center_mm;
    glb.name = nodes.name;
    glb.colour_rgb = recipe.colour_rgb;
    glb.opacity = recipe.opacity_ratio;
    std::string bytes = cases::make_glb(surface, glb);
    // The published coordinates are float32 about the case's centre, so validity is checked on these and not on our
    // doubles.
    try {
      meshing::require_valid(cases::read_glb(std::string_view(bytes)).mesh);
    } catch (Error& e) {
      e.in_field(nodes.name).finds_fault_with({nodes.name}).because(Cause::refused_output);
      throw;
    }

    cases::CaseAnatomy out;
    out.name = nodes.name;
    out.colour_rgb = recipe.colour_rgb;
    out.opacity = recipe.opacity_ratio;
    out.triangles = surface.triangles.size();
    out.points = surface.points_mm.size();
    out.volume_ml = surface::volume_mm3(surface) / 1000;
    out.area_cm2 = surface::area_mm2(surface) / 100;
    const metrics::DeviationStats deviation =
        result<metrics::MeasureResult>(graph_.find_stage<metrics::MeasureParams>(nodes.name)).deviation.value().both;
    out.deviation = {deviation.max_mm, deviation.p99_mm, deviation.rms_mm};
    add_budget(recipe, out);
    if (!limit.touched_as.empty()) out.touched_as = limit.material;

    AnatomyResult result;
    result.name = nodes.name;
    result.triangles_before =
        static_cast<std::int64_t>(this->result<meshing::ContourResult>(nodes.first_surface).triangles_count);
    result.triangles_after = static_cast<std::int64_t>(out.triangles);
    result.bytes_after = bytes.size();
    // A GLB needs 24 bytes for a vertex (position, normal) and 12 for a triangle; a closed surface has half as many
    // points as triangles.
    result.bytes_before = static_cast<std::uint64_t>(result.triangles_before) * 24;
    result.deviation_max_mm = out.deviation.max_mm;
    result.deviation_p99_mm = out.deviation.p99_mm;
    result.deviation_rms_mm = out.deviation.rms_mm;
    result.volume_ml = out.volume_ml;
    if (recipe.params_of<meshing::DecimateParams>())
      result.stopped_by =
          this->result<meshing::DecimateResult>(graph_.find_stage<meshing::DecimateParams>(nodes.name)).stopped_by;
    for (const config::RecipeStep& step : recipe.steps)
      add_stage_figures(graph_.find(nodes.name + "." + step.type->name), out, result);
    if (nodes.surface != nodes.finished) add_stage_figures(nodes.surface, out, result);
    hold_against_limits(limit, result);
    tell_wider_than_asked(config_, recipe, limit, result.deviation_max_mm);

    add_file("meshes/" + nodes.name, ".glb", std::move(bytes), out.file);
    manifest().anatomies.push_back(std::move(out));
    out_.anatomies.push_back(result);
  }

  void hold_against_budget() const {
    const std::int64_t most = config_.trade.rule.triangles_count;
    std::int64_t triangles = 0;
    for (const AnatomyResult& a : out_.anatomies) triangles += a.triangles_after;
    if (most > 0 && triangles > most)
      throw refusal("budget.triangles",
                    std::to_string(triangles) + " triangles, the budget is " + std::to_string(most) + "; point " +
                        config_.trade.choice.point.name + " of " + config_.trade.front_names() +
                        " kept it on the case that it was measured on",
                    {"raise `budget`, or measure a front on this series with `trade`"});
  }

  void add_haptic() {
    static const voxel::MismatchResult none;
    const int mismatch = graph_.find_stage<voxel::MismatchParams>();
    HapticContent made = make_haptic_content(config_, haptic(), result<voxel::VoxelizeResult>(haptic_),
                                             mismatch < 0 ? none : result<voxel::MismatchResult>(mismatch));
    add_file("haptic", ".nrrd", std::move(made.bytes), made.manifest.file);
    if (!made.hardness_bytes.empty())
      add_file("hardness", ".nrrd", std::move(made.hardness_bytes), made.manifest.hardness_file);
    // A shape that has no surface of its own is displayed from the haptic volume.
    for (cases::CaseAnatomy& anatomy : made.anatomies) manifest().anatomies.push_back(std::move(anatomy));
    manifest().haptic = std::move(made.manifest);
  }

  // The scan as the anatomies are made of it, so after the face policy.
  void add_ct() {
    surface::Bounds shown;
    for (const pipeline::Graph::Anatomy& a : graph_.anatomies)
      surface::include(shown, surface::bounds_of(mesh(a.surface)));
    if (haptic_ >= 0) surface::include(shown, bounds_of_lattice(haptic().voxels));
    const grid::Grid<std::int16_t> ct = published_ct(*volume(graph_.scan), shown, config_.ct->margin_mm);
    cases::CaseCt& out = manifest().ct;
    out.size = ct.size;
    out.spacing_mm = ct.spacing_mm;
    add_file("ct", ".nrrd", grid::encode_nrrd(grid::HuVolume(ct), {}, grid::NrrdEncoding::gzip), out.file);
  }

  void add_burr_hole(int node) {
    const std::string& name = graph_.nodes[static_cast<std::size_t>(node)].name;
    const auto& cutters = *std::get<std::shared_ptr<const std::vector<boolean::Cutter>>>(at(node).data);
    const boolean::Cutter& cutter = cutters.at(0);
    cases::CaseBurrHole hole;
    hole.name = name;
    hole.position_mm = cutter.position_mm;
    hole.direction = cutter.direction;
    hole.diameter_mm = 2 * cutter.radius_mm;
    for (const auto& f : figures_of(at(node).result))
      if (!std::holds_alternative<std::vector<double>>(f.second)) hole.figures.push_back(f);
    const std::string& bone = config_.roles.burr_holes.bone;
    std::optional<double> seen_mm3, felt_mm3;
    for (const config::SceneDrill& drilled : config_.drilled) {
      hole.cut.push_back(drilled.anatomy);
      const int cut = graph_.find_stage<boolean::CutSurfaceParams>(drilled.anatomy);
      if (cut >= 0) {
        const double mm3 = part_of(result<boolean::CutSurfaceResult>(cut).cutters, name).removed_mm3;
        hole.figures.emplace_back("mesh." + drilled.anatomy + ".removed_mm3", mm3);
        if (drilled.anatomy == bone) seen_mm3 = mm3;
      }
      if (drilled.anatomy == bone) require_free(drilled, cutter, name);
    }
    if (haptic_ >= 0)
      for (const auto& [shape, drill] : config_.haptic.params.as<stages::VoxelizeStageParams>().drill) {
        const voxel::CutVolumeResult& removed = part_of(result<voxel::VoxelizeResult>(haptic_).cutters, name);
        const double mm3 = part_of(removed.shapes, shape).removed_mm3;
        hole.figures.emplace_back("haptic." + shape + ".removed_mm3", mm3);
        if (shape == bone) felt_mm3 = mm3;
      }
    compare_removed(hole, bone, seen_mm3, felt_mm3);
    manifest().burr_holes.push_back(std::move(hole));
  }

  // Compares the bone that the displayed surface lost with the bone that the haptic volume lost.
  void compare_removed(cases::CaseBurrHole& hole, const std::string& bone, std::optional<double> seen_mm3,
                       std::optional<double> felt_mm3) const {
    if (seen_mm3 == 0.0 || felt_mm3 == 0.0)
      throw refusal(hole.name, "removes nothing from the " + bone,
                    {"move it by `position_mm`, or aim it by `direction` or `toward`"});
    if (!seen_mm3 || !felt_mm3) return;
    const double difference = std::abs(*felt_mm3 / *seen_mm3 - 1);
    hole.figures.emplace_back(bone + ".removed_difference_ratio", difference);
    if (difference > removed_tolerance)
      log_warning(config_.case_token + ": " + hole.name + ": mesh and haptic volume differ by " +
                  to_text(ParameterValue(std::round(1000 * difference) / 10)) +
                  " % in the bone removed; a smaller haptic.spacing_mm brings them together");
  }

  // A drill of the hole's own size, less some clearance, must pass through the displayed bone and through the felt
  // bone.
  void require_free(const config::SceneDrill& drilled, const boolean::Cutter& cutter, const std::string& name) const {
    const boolean::Cutter own = boolean::widened(cutter, drilled.widen_mm);
    for (const pipeline::Graph::Anatomy& a : graph_.anatomies)
      if (a.name == drilled.anatomy &&
          boolean::free_radius_mm(mesh(a.surface), own) < own.radius_mm - voxel::hole_play_mm)
        throw refusal(name, "is not free in the surface of " + a.name,
                      {"lower `max_deviation_mm` of `decimate`, or raise `widen_mm`"});
    const voxel::Bore bore{own.position_mm, own.direction, own.radius_mm, own.above_mm, own.depth_mm};
    if (haptic_ >= 0 && haptic().find_shape(drilled.anatomy) && !voxel::hole_is_free(haptic(), drilled.anatomy, bore))
      throw refusal(name, "is not free in the haptic volume of " + drilled.anatomy,
                    {"set a smaller `spacing_mm`, or raise `widen_mm`"});
  }

  // Perhaps read back from disk, so it is held no longer than it is used.
  std::shared_ptr<const grid::HuVolume> volume(int node) const {
    return std::get<std::shared_ptr<const grid::HuVolume>>(at(node).loaded());
  }

  void add_pictures(PictureWish pictures, const Progress& progress) {
    std::vector<PictureAnatomy> shown;
    for (const pipeline::Graph::Anatomy& a : graph_.anatomies) {
      const config::RecipeAnatomy& recipe = *config_.find_anatomy(a.name);
      shown.push_back({a.name, &mesh(a.surface), recipe.colour_rgb, recipe.opacity_ratio});
    }
    std::list<surface::TriMesh> felt;
    if (haptic_ >= 0) show_felt(manifest(), haptic(), felt, shown, progress);
    if (pictures.all_sides) out_.pictures = make_side_pictures(shown, progress.silent());
    const auto add = [&](std::vector<CasePicture> more) {
      std::move(more.begin(), more.end(), std::back_inserter(out_.pictures));
    };
    if (pictures.of == PicturesOf::surfaces)
      return add(make_case_pictures(nullptr, shown, manifest().landmarks, progress));
    std::optional<CasePicture> found;
    {
      const auto scan = volume(graph_.scan);
      add(make_case_pictures(scan.get(), shown, manifest().landmarks, progress));
      if (examination_ >= 0)
        found = make_findings_picture(*scan, *std::get<std::shared_ptr<const grid::LabelFile>>(at(examination_).data),
                                      manifest().findings, progress.silent());
    }
    for (const pipeline::Graph::Removal& r : graph_.removals)
      if (auto picture = make_removed_picture([&] { return volume(r.before); }, [&] { return volume(r.after); },
                                              graph_.nodes[r.after].name, progress))
        out_.pictures.push_back(std::move(*picture));
    if (found) out_.pictures.push_back(std::move(*found));
  }

  const config::CaseConfig& config_;
  const pipeline::Graph& graph_;
  const std::vector<pipeline::NodeResult>& results_;
  const std::vector<stages::CaseParts> parts_;
  const int haptic_ = graph_.result(stages::DataKind::haptic);
  const int examination_ = examination_of(graph_);
  CaseContent out_;
};

}  // namespace

std::vector<int> wanted_nodes(const pipeline::Graph& graph, bool pictures, bool page) {
  std::vector<int> wanted;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    if (graph.nodes[i].wanted) wanted.push_back(int(i));
  if (pictures) wanted.push_back(graph.scan);
  for (std::size_t r = 0; pictures && r < graph.removals.size(); ++r)
    wanted.insert(wanted.end(), {graph.removals[r].before, graph.removals[r].after});
  for (std::size_t a = 0; page && a < graph.anatomies.size(); ++a)
    wanted.insert(wanted.end(), {graph.anatomies[a].first_surface, graph.anatomies[a].finished});
  return wanted;
}

CaseContent make_case_content(const config::CaseConfig& config, const pipeline::Graph& graph,
                              const std::vector<pipeline::NodeResult>& results, const std::string& program_version,
                              const std::string& input_sha256, PictureWish pictures, const Progress& progress) {
  return Builder(config, graph, results).build(program_version, input_sha256, pictures, progress);
}

}  // namespace trephine::publish
