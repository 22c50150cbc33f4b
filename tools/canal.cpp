// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::canal_command() {
  return make_stage_command(canal_stage(), {"trephine canal volume.nrrd --bone bone.nrrd --output canal.nrrd"});
}
