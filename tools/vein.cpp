// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::vein_command() {
  return make_stage_command(vein_stage(), {"trephine vein volume.nrrd --bone bone.nrrd --output vein.nrrd"});
}
