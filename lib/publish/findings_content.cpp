// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/findings_content.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "findings/findings.h"
#include "picture/slice.h"
#include "publish/scan_findings.h"

namespace trephine::publish {
namespace {

constexpr int cell_px = 640;
constexpr std::size_t max_pictures = 9, max_told = 3;
constexpr double ring_mm = 8, ring_cell_mm = 0.5;

// Positive in the voxels of that label.
grid::Field field_of(const grid::LabelFile& labels, int value) {
  grid::Field field(labels.lattice, -1.f);
  std::visit(
      [&](const auto& samples) {
        for (std::size_t i = 0; i < field.voxels.size(); ++i)
          if (int(samples.voxels[i]) == value) field.voxels[i] = 1;
      },
      labels.samples);
  return field;
}

bool has_voxels(const grid::Field& field) {
  return std::any_of(field.voxels.begin(), field.voxels.end(), [](float v) { return v > 0; });
}

// A ring in the axial plane about a place.
grid::Field ring_at(Vec3 at_mm, const grid::Lattice& like) {
  grid::Lattice l = like;
  const int n = 2 * int(ring_mm / ring_cell_mm) + 9;
  l.size = {n, n, 3};
  l.spacing_mm = {ring_cell_mm, ring_cell_mm, std::max(1.0, like.spacing_mm.z)};
  l.origin_mm = {};
  const Vec3 middle = l.to_world_mm({(n - 1) / 2.0, (n - 1) / 2.0, 1});
  l.origin_mm = at_mm - middle;
  grid::Field field(l);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 from_middle = l.to_world_mm({double(i), double(j), 1}) - at_mm;
        field.at(i, j, k) = float(ring_mm - norm(from_middle));
      }
  return field;
}

}  // namespace

int examination_of(const pipeline::Graph& graph) {
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    if (graph.nodes[i].type->is_check() && graph.nodes[i].output == stages::DataKind::labels) return int(i);
  return -1;
}

std::vector<const cases::CaseFinding*> sure(const std::vector<cases::CaseFinding>& all) {
  std::vector<const cases::CaseFinding*> out;
  for (const cases::CaseFinding& f : all)
    if (f.confidence >= findings::sure_confidence) out.push_back(&f);
  return out;
}

std::vector<stages::CaseParts> parts_of(const pipeline::Graph& graph,
                                        const std::vector<pipeline::NodeResult>& results) {
  std::vector<stages::CaseParts> all(graph.nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    if (graph.nodes[i].type->contribute && !graph.nodes[i].is_early)
      graph.nodes[i].type->contribute(results[i].result, all[i]);
  return all;
}

bool is_in_doubt(const std::vector<cases::CaseFinding>& findings, const std::string& anatomy) {
  const auto all = sure(findings);
  return std::any_of(all.begin(), all.end(), [&](const cases::CaseFinding* f) {
    return std::find(f->concerns.begin(), f->concerns.end(), anatomy) != f->concerns.end();
  });
}

std::string findings_text(const std::vector<cases::CaseFinding>& findings, bool bleeds) {
  std::vector<const cases::CaseFinding*> all = sure(findings);
  const std::string dense = findings::to_text(findings::FindingKind::dense);
  all.erase(std::remove_if(all.begin(), all.end(), [&](const auto* f) { return (f->kind == dense) != bleeds; }),
            all.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), max_told); ++i)
    text += (text.empty() ? "" : "; ") + findings::with_side(all[i]->text, all[i]->kind, all[i]->side);
  if (all.size() > max_told) text += "; and " + std::to_string(all.size() - max_told) + " more";
  return text;
}

std::optional<CasePicture> make_findings_picture(const grid::HuVolume& scan, const grid::LabelFile& labels,
                                                 const std::vector<cases::CaseFinding>& findings,
                                                 const Progress& progress) {
  const grid::Lattice& lattice = grid::lattice_of(scan);
  const auto range = picture::slice_range_mm(lattice, picture::SlicePlane::axial);
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < findings.size() && shown.size() < max_pictures; ++i)
    if (findings[i].kind != other_patient && findings[i].confidence >= findings::sure_confidence &&
        findings[i].position_mm.z >= range[0] && findings[i].position_mm.z <= range[1])
      shown.push_back(i);
  if (shown.empty()) return {};
  std::vector<picture::Image> images(shown.size());
  parallel_for(0, std::int64_t(shown.size()), 1, [&](std::int64_t from, std::int64_t to) {
    for (auto n = from; n < to; ++n) {
      progress.check();
      const std::size_t i = shown[std::size_t(n)];
      const cases::CaseFinding& f = findings[i];
      grid::Field outline = field_of(labels, int(i) + 1);
      if (!has_voxels(outline)) outline = ring_at(f.position_mm, lattice);
      picture::SliceParams params;
      params.longer_side_px = cell_px;
      const bool in_bone = findings::is_seen_in_bone(f.kind);
      params.window_width_hu = in_bone ? 2000 : 120;
      params.window_center_hu = in_bone ? 300 : 40;
      params.position_mm = f.position_mm.z;
      images[std::size_t(n)] = picture::slice_overlay(
          scan, params, {{nullptr, {1, 0.55, 0.1}, std::to_string(i + 1) + " " + f.kind, &outline}});
    }
  });
  return CasePicture{"findings.png", picture::encode_png(picture::contact_sheet(images, 3))};
}

}  // namespace trephine::publish
