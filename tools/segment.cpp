// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::segment_command() {
  return make_stage_command(
      segment_stage(), {"trephine segment head.nrrd --output skull.nrrd",
                        "trephine segment head.nrrd --method brain --skull skull.nrrd --output brain.nrrd",
                        "trephine segment head.nrrd --method ventricles --within brain.nrrd --output ventricles.nrrd"});
}
