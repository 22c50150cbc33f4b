// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/measure_truth.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "metrics/field.h"
#include "surface/bounds.h"

namespace trephine::phantom {
namespace {

// Whether the truth's label is of the anatomy (phantom/head.h).
bool is_of(Anatomy anatomy, std::uint8_t label) {
  switch (anatomy) {
    case Anatomy::skin:
      return label > 0;
    case Anatomy::skull:
      return label == 2;
    case Anatomy::brain:
      return label == 3 || label == 4;
    case Anatomy::ventricles:
      return label == 4;
  }
  return false;
}

constexpr double cap_margin_mm = 3;
constexpr double rounding_mm = 1e-3;

metrics::KnownRegion without_caps(const ScannedRegion& scanned) {
  return [&scanned](Vec3 p) { return scanned.beyond_mm(p) <= -cap_margin_mm; };
}

constexpr std::uint8_t apparatus_label = 7, vertebrae_label = 6;

// How much of what is labelled so the field (positive inside) holds. The raster covers the field's.
double held_ml(const grid::Field& field, const grid::Mask& labels, std::uint8_t label) {
  const Vec3 first = labels.to_index(field.origin_mm);
  const std::array<int, 3> at{int(std::lround(first.x)), int(std::lround(first.y)), int(std::lround(first.z))};
  std::size_t count = 0;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i)
        count += field.at(i, j, k) > 0 && labels.at(i + at[0], j + at[1], k + at[2]) == label;
  return double(count) * field.voxel_volume_mm3() / 1000;
}

// 1 where the truth's label is of the anatomy, as far as the scan reached.
grid::Mask solid_of(const Truth& truth, Anatomy anatomy, grid::Mask solid) {
  const bool skewed = !truth.scanned.faces.empty();
  parallel_for(0, solid.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < solid.size[1]; ++j)
        for (int i = 0; i < solid.size[0]; ++i) {
          std::uint8_t& v = solid.at(i, j, k);
          v = is_of(anatomy, v) &&
              !(skewed && truth.scanned.beyond_mm(solid.to_world_mm({double(i), double(j), double(k)})) > rounding_mm);
        }
  });
  return solid;
}

// The field's raster, over all of it and of the box.
grid::Lattice raster_over(const grid::Field& field, const surface::Bounds& box_mm) {
  const auto [low, high] = surface::index_bounds(field, box_mm);
  grid::Box box{{0, 0, 0}, {0, 0, 0}};
  for (int a = 0; a < 3; ++a) {
    box.begin[a] = std::min(box.begin[a], int(std::ceil(low[a] - 1e-3)));
    box.end[a] = std::max(box.end[a], int(std::floor(high[a] + 1e-3)) + 1);
  }
  grid::Lattice lattice = field;
  lattice.origin_mm = field.to_world_mm({double(box.begin[0]), double(box.begin[1]), double(box.begin[2])});
  for (int a = 0; a < 3; ++a) lattice.size[a] = std::max(box.end[a], field.size[a]) - box.begin[a];
  return lattice;
}

}  // namespace

TruthSurface truth_surface(const Truth& truth, Anatomy anatomy, const Progress& progress) {
  return {&truth, anatomy, truth_mesh(truth.head, anatomy, truth.scanned, 1.0, progress)};
}

Outcome<std::monostate, metrics::MeasureResult> measure_against_truth(const surface::TriMesh& surface,
                                                                      const TruthSurface& known,
                                                                      const metrics::MeasureParams& params,
                                                                      const Progress& progress) {
  const Truth& truth = *known.truth;
  metrics::TruthReference reference;
  reference.distance = [&](Vec3 p) { return truth.head.signed_distance_mm(known.anatomy, p); };
  reference.mesh = &known.mesh;
  reference.within = without_caps(truth.scanned);
  return metrics::measure_surface(surface, reference, params, progress);
}

metrics::FieldMeasures measure_against_truth(const grid::Field& field, const TruthSurface& known, int sample_count,
                                             const Progress& progress) {
  const Truth& truth = *known.truth;
  grid::Mask labels = truth_labels(truth.head, raster_over(field, truth.scanned.box_mm), progress.part(0, 0.4));
  const bool hard = truth.head.params().level == Level::hard;
  const double apparatus = hard ? held_ml(field, labels, apparatus_label) : 0;
  const double vertebrae = hard ? held_ml(field, labels, vertebrae_label) : 0;
  const grid::Mask solid = solid_of(truth, known.anatomy, std::move(labels));
  metrics::FieldTruth reference;
  reference.solid = &solid;
  reference.distance = [&](Vec3 p) { return truth.head.signed_distance_mm(known.anatomy, p); };
  reference.mesh = &known.mesh;
  reference.within = without_caps(truth.scanned);
  if (known.anatomy == Anatomy::skull)
    reference.is_inner = [&](Vec3 p) {  // a point whose nearest surface has the dura's content a millimetre outside
      const Vec3 foot = truth.head.project_mm(known.anatomy, p);
      Vec3 normal;
      truth.head.implicit_mm(known.anatomy, foot, normal);
      return truth.head.label(foot + normalized(normal)) >= 3;
    };
  metrics::FieldMeasures m = metrics::measure_field(field, reference, sample_count, progress.part(0.4, 1));
  if (hard) m.apparatus_ml = apparatus, m.vertebrae_ml = vertebrae;
  return m;
}

}  // namespace trephine::phantom
