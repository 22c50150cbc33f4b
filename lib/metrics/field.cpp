// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/field.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/contour.h"
#include "metrics/overlap.h"

namespace trephine::metrics {
namespace {

grid::Mask inside_of(const grid::Field& field, const grid::Lattice& lattice) {
  const grid::Box box = grid::place_in(field, lattice);
  grid::Mask mask(lattice);
  for (int k = std::max(0, box.begin[2]); k < std::min(lattice.size[2], box.end[2]); ++k)
    for (int j = std::max(0, box.begin[1]); j < std::min(lattice.size[1], box.end[1]); ++j)
      for (int i = std::max(0, box.begin[0]); i < std::min(lattice.size[0], box.end[0]); ++i)
        mask.at(i, j, k) = field.at(i - box.begin[0], j - box.begin[1], k - box.begin[2]) > 0;
  return mask;
}

std::optional<ShellFigures> shell_of(const surface::TriMesh& surface, const FieldTruth& truth, int sample_count,
                                     const Progress& progress) {
  const std::vector<Vec3> points = points_on_surface(surface, std::size_t(sample_count));
  std::vector<double> distance(points.size());
  std::vector<char> side(points.size(), 2);
  parallel_for(0, std::int64_t(points.size()), 1024, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t i = from; i < to; ++i) {
      if (truth.within && !truth.within(points[i])) continue;
      distance[i] = truth.distance(points[i]);
      side[i] = truth.is_inner(points[i]) ? 0 : 1;
    }
  });
  double sum[2] = {0, 0};
  std::size_t count[2] = {0, 0};
  for (std::size_t i = 0; i < points.size(); ++i)
    if (side[i] < 2) sum[int(side[i])] += distance[i], ++count[int(side[i])];
  if (count[0] == 0 || count[1] == 0) return {};
  const double inner = sum[0] / double(count[0]), outer = sum[1] / double(count[1]);
  return ShellFigures{inner, outer, inner + outer};
}

}  // namespace

FieldMeasures measure_field(const grid::Field& field, const FieldTruth& truth, int sample_count,
                            const Progress& progress) {
  const grid::Mask found = inside_of(field, *truth.solid);
  const double volume = volume_mm3(found), reference = volume_mm3(*truth.solid);
  if (!(reference > 0)) throw Error(ExitCode::bad_input, "", "truth", "nothing of it lies in the field's volume");
  FieldMeasures m;
  m.dice_ratio = dice(found, *truth.solid);
  m.volume_ml = volume / 1000;
  m.reference_volume_ml = reference / 1000;
  m.volume_difference_ratio = volume / reference - 1;
  progress.report(0.1);

  meshing::ContourParams all;
  all.min_component_mm3 = 0;
  all.keep_cavities = true;
  const surface::TriMesh surface = meshing::contour(field, all, progress.part(0.1, 0.3)).value;
  DeviationParams samples;
  samples.sample_count = sample_count;
  samples.at_vertices = false;
  m.deviation =
      measure_deviation_to_truth(surface, truth.distance, *truth.mesh, samples, truth.within, progress.part(0.3, 0.9));
  if (truth.is_inner) m.shell = shell_of(surface, truth, sample_count, progress.part(0.9, 1));
  return m;
}

}  // namespace trephine::metrics
