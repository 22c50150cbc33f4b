// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::presegment_command() {
  return make_stage_command(
      presegment_stage(),
      {"trephine presegment head.nrrd --lower-hu 0 --upper-hu 18 --within brain.nrrd --output speed.nrrd",
       "trephine presegment head.nrrd --method edges --edge-sigma-mm 1 --output speed.nrrd"});
}
