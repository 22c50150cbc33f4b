// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/labels.h"

#include "base/error.h"
#include "pacs/label_objects.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType labels_stage() {
  StageType s;
  s.name = "labels";
  s.version = 3;
  s.summary = "takes one anatomy from labels that another program made";
  s.description =
      "Reads a label map or segmentation (NRRD, .seg.nrrd of 3D Slicer, NIfTI of ITK-SNAP or TotalSegmentator, a "
      "binary "
      "DICOM SEG, the closed contours of an RT structure set), takes "
      "one label of it and gives what segment gives: a field on the volume's voxels, positive inside. Labels on the "
      "volume's own voxels stay as they are, with their steps smoothed. Other labels are resampled so that they keep "
      "their volume. A label that lies outside of the volume or in air is refused.";
  s.examples = {"trephine labels head.nrrd --file totalsegmentator.nii.gz --label 90 --output brain.nrrd",
                "trephine labels head.nrrd --file Segmentation.seg.nrrd --label ventricles --output ventricles.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("map", DataKind::labels).optional().help("Labels that external gave, instead of file")};
  s.output = DataKind::field;
  s.declares<segmentation::LabelParams, segmentation::LabelResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const auto& p = params.as<segmentation::LabelParams>();
    if (const auto* map = in.get<grid::LabelFile>("map")) {
      if (!p.file.empty()) throw Error(ExitCode::usage, "", "file", "and map are given, must be one of them");
      return stage_outcome(segmentation::label_field(*in.get<grid::HuVolume>("volume"), *map, p, progress));
    }
    if (p.file.empty()) throw Error(ExitCode::usage, "", "file", "is needed: the labels to read");
    return stage_outcome(with_file(p.file, [&] {
      return segmentation::label_field(*in.get<grid::HuVolume>("volume"), pacs::read_label_file(p.file), p, progress);
    }));
  };
  return s;
}

}  // namespace trephine::stages
