// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::clavicle_command() {
  return make_stage_command(clavicle_stage(),
                            {"trephine clavicle volume.nrrd --bone bone.nrrd --output clavicle.nrrd"});
}
