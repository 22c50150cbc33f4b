// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::normals_command() {
  return make_stage_command(normals_stage(), {"trephine normals smooth.vtp --output skull.vtp"});
}
