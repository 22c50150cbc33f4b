// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/landmarks.h"

#include "stages/scan_figures_of.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType landmarks_stage() {
  StageType s;
  s.name = "landmarks";
  s.version = 14;
  s.typical.base_s = 0.5;
  s.typical.per_million_voxels_s = 0.008;
  s.place = StagePlace::scan;
  s.summary = "finds the landmarks of a head";
  s.description =
      "Finds the midsagittal plane by symmetry; nasion, inion, tragi and vertex from the skin and the bone below it; "
      "Kocher's points by arcs over the skin; bregma from the coronal suture in the bone, or where that is not seen as "
      "an "
      "estimate; and the foramina of Monro where the ventricles are known. Landmarks are judged together. Each has a "
      "confidence from 0 to 1, and one below 0.5 is warned of, with the reason. A landmark that the scan does not show "
      "is left out, with the reason. A given landmark replaces the found one, and everything measured from it "
      "follows.";
  s.examples = {
      "trephine landmarks volume.nrrd --skin skin.nrrd --skull skull.nrrd --ventricles ventricles.nrrd --output "
      "landmarks.json",
      "trephine landmarks volume.nrrd --skin skin.nrrd --skull skull.nrrd --given points.mrk.json --output "
      "landmarks.json"};
  s.ports = {port("volume", DataKind::volume).from(From::original_scan).help("CT volume in HU"),
             port("as_read", DataKind::volume)
                 .from(From::import)
                 .where([](const AnyParams&) {
                   return false;
                 })  // of cases: on coarse scans it takes skin for what was taken off
                 .optional()
                 .help("the scan as it was read, before anything was taken off it: what lay on the skin makes "
                       "landmarks there doubtful"),
             port("skin", DataKind::field).help("the head's skin"),
             port("skull", DataKind::field).help("the head's skull"),
             port("brain", DataKind::field).optional().help("the head's brain"),
             port("ventricles", DataKind::field).optional().help("the head's ventricles, for the foramina of Monro"),
             port("given", DataKind::landmarks)
                 .from(From::given_landmarks)
                 .optional()
                 .help("landmarks that a person placed; they replace found ones")};
  // A landmark on the midline is best seen in a sagittal slice, the foramina of Monro in an axial one.
  s.points = {{"nasion", picture::SlicePlane::sagittal},     {"inion", picture::SlicePlane::sagittal},
              {"vertex", picture::SlicePlane::sagittal},     {"bregma", picture::SlicePlane::sagittal},
              {"tragus_left", picture::SlicePlane::coronal}, {"tragus_right", picture::SlicePlane::coronal},
              {"monro_left", picture::SlicePlane::axial},    {"monro_right", picture::SlicePlane::axial},
              {"kocher_left", picture::SlicePlane::coronal}, {"kocher_right", picture::SlicePlane::coronal}};
  s.output = DataKind::landmarks;
  s.declares<head::LandmarkParams, head::LandmarksResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    head::LandmarkInputs inputs;
    inputs.as_read = in.get<grid::HuVolume>("as_read");
    inputs.skin = in.get<grid::Field>("skin");
    inputs.skull = in.get<grid::Field>("skull");
    inputs.brain = in.get<grid::Field>("brain");
    inputs.ventricles = in.get<grid::Field>("ventricles");
    if (const auto* given = in.get<head::HeadLandmarks>("given")) inputs.given = given->landmarks;
    inputs.scan_figures = [&in](const Progress& rest) { return scan_figures_of(in, rest); };
    return stage_outcome(
        head::find_landmarks(*in.get<grid::HuVolume>("volume"), inputs, params.as<head::LandmarkParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
