// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType snake_stage() {
  StageType s;
  s.name = "snake";
  s.version = 2;
  s.typical.base_s = 10;
  s.summary = "evolves a surface over a speed image (active contour)";
  s.description =
      "Grows balls, or another field, over the speed image of presegment until the surface rests, by region "
      "competition or as a geodesic active contour. Gives a field like that of segment, in mm near the surface. Begin "
      "with bubbles, bubbles_count or start. The stage warns of what looks like a leak: much of the inside has a "
      "negative speed, or much of the surface rests on within, without or the region's edge. With max_volume_ml a leak "
      "is refused. Balls placed in another structure of the same HU are not seen as a leak: in small or noisy "
      "ventricles look where they lie (bubbles and pieces_count of the report), or give them.";
  s.examples = {
      "trephine snake speed.nrrd --bubbles-count 4 --within brain.nrrd --output ventricles.nrrd",
      "trephine snake speed.nrrd --bubbles \"-9,-12,55,4; 9,-12,55,4\" --max-volume-ml 100 --output "
      "ventricles.nrrd",
      "trephine snake edges.nrrd --method geodesic --propagation 0.15 --curvature 0.1 --start ventricles.nrrd "
      "--output finer.nrrd"};
  s.ports = {port("speed", DataKind::field).help("speed image from -1 to 1"),
             port("start", DataKind::field).optional().help("a field whose surface is the starting surface"),
             port("within", DataKind::field).optional().help("an anatomy to stay inside of"),
             port("without", DataKind::field).optional().help("an anatomy to stay outside of")};
  s.output = DataKind::field;
  s.declares<segmentation::SnakeParams, segmentation::SnakeResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const segmentation::SnakeMasks masks{in.get<grid::Field>("start"), in.get<grid::Field>("within"),
                                         in.get<grid::Field>("without")};
    return stage_outcome(
        segmentation::snake(*in.get<grid::Field>("speed"), masks, params.as<segmentation::SnakeParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
