// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands.h"
#include "stage_command.h"

trephine::Command trephine::labels_command() {
  return make_stage_command(
      labels_stage(),
      {"trephine labels head.nrrd --file totalsegmentator.nii.gz --label 90 --output brain.nrrd",
       "trephine labels head.nrrd --file Segmentation.seg.nrrd --label ventricles --output ventricles.nrrd"});
}
