// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::contour_command() {
  return make_stage_command(contour_stage(), {"trephine contour skull.nrrd --output skull.vtp",
                                              "trephine contour head.nrrd --isovalue-hu 300 --output bone.vtp"});
}
