// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::resample_command() {
  return make_stage_command(resample_stage(), {"trephine resample head.nrrd --spacing-mm 1 1 1 --output coarse.nrrd"});
}
