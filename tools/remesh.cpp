// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::remesh_command() {
  return make_stage_command(remesh_stage(), {"trephine remesh skull.vtp --edge-mm 1.5 --output even.vtp"});
}
