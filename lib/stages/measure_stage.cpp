// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/measure.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType measure_stage() {
  StageType s;
  s.name = "measure";
  s.version = 4;
  s.typical.base_s = 0.1;
  s.typical.per_million_triangles_s = 0.65;
  s.place = StagePlace::scene;
  s.check.serves = "what decimation and smoothing did to";
  s.summary = "measures a surface, also against a reference";
  s.description =
      "Measures validity (closed, 2-manifold, oriented, free of self-intersections; of each kind of fault how many "
      "there are and where the first 20 lie), triangles, volume, area, components and genus. Against another surface "
      "it also measures the two-sided deviation: largest, 99th percentile, RMS and mean, in mm.";
  s.examples = {"trephine measure skull.vtp",
                "trephine measure fewer.vtp --reference skull.vtp --report deviation.json",
                "trephine measure fewer.vtp --reference skull.vtp --certify --picture deviation.png",
                "trephine measure skull.vtp --truth head/truth/truth.json --anatomy skull",
                "trephine measure ventricles.nrrd --truth head/truth/truth.json --anatomy ventricles"};
  s.ports = {port("surface", DataKind::mesh).from(From::finished_surface).help("surface to measure"),
             port("reference", DataKind::mesh).from(From::first_surface).optional().help("surface to compare with")};
  s.output = DataKind::nothing;
  s.declares<metrics::MeasureParams, metrics::MeasureResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    metrics::MeasureReference reference;
    if (const surface::TriMesh* mesh = in.get<surface::TriMesh>("reference")) reference = metrics::MeshReference{mesh};
    return stage_outcome(metrics::measure_surface(*in.get<surface::TriMesh>("surface"), reference,
                                                  params.as<metrics::MeasureParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
