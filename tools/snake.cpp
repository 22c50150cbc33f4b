// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::snake_command() {
  return make_stage_command(
      snake_stage(),
      {"trephine snake speed.nrrd --bubbles-count 4 --within brain.nrrd --output ventricles.nrrd",
       "trephine snake speed.nrrd --bubbles \"-9,-12,55,4; 9,-12,55,4\" --max-volume-ml 100 --output "
       "ventricles.nrrd",
       "trephine snake edges.nrrd --method geodesic --propagation 0.15 --curvature 0.1 --start ventricles.nrrd "
       "--output finer.nrrd"});
}
