// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::presegment_command() {
  return make_stage_command(
      presegment_stage(),
      {"trephine presegment head.nrrd --lower-hu -40 --upper-hu 8 --smoothing-sigma-mm 0.7 --within brain.nrrd "
       "--output speed.nrrd",
       "trephine presegment head.nrrd --method edges --edge-kappa-hu-per-mm 4 --within brain.nrrd --output "
       "edges.nrrd"});
}
