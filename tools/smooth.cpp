// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::smooth_command() {
  return make_stage_command(smooth_stage(),
                            {"trephine smooth skull.vtp --max-displacement-mm 0.1 --output smooth.vtp"});
}
