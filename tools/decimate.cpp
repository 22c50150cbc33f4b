// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::decimate_command() {
  return make_stage_command(decimate_stage(),
                            {"trephine decimate skull.vtp --target-triangles-count 80000 --output fewer.vtp",
                             "trephine decimate skull.vtp --max-deviation-mm 0.2 --output fewer.vtp"});
}
