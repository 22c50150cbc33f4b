// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::simplify_command() {
  return make_stage_command(simplify_stage(),
                            {"trephine simplify skull.nrrd --close-handles-mm 2 --output display.nrrd"});
}
