// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

namespace trephine {

Command deface_command() {
  return make_stage_command(
      deface_stage(), {"trephine deface head.nrrd --skin skin.nrrd --landmarks landmarks.json --output defaced.nrrd",
                       "trephine deface head.nrrd --skin skin.nrrd --landmarks landmarks.json --policy crop "
                       "--output cropped.nrrd"});
}

}  // namespace trephine
