// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/face_belief.h"
#include "face/face_gate.h"

#include "stages/stage.h"

namespace trephine::stages {
namespace {

StageOutcome run_gate(const AnyParams& params, const StageInputs& in, const Progress& progress) {
  std::vector<face::FaceSurface> surfaces;
  for (const auto& [name, mesh] : in.all<surface::TriMesh>("surface")) surfaces.push_back({name, mesh});
  std::vector<face::FaceVolume> volumes;
  if (const auto* haptic = in.get<voxel::HapticVolume>("haptic")) {
    volumes.push_back(face::face_volume("the haptic volume", *haptic));
    if (haptic->hardness.count() > 0)
      volumes.push_back(face::face_volume("the haptic volume's hardness", haptic->hardness));
  }
  if (const auto* ct = in.get<grid::HuVolume>("ct")) volumes.push_back(face::face_volume("the CT", *ct));
  const grid::Field& skin = *in.get<grid::Field>("skin");
  const auto regions =
      face::face_regions(*in.get<head::HeadLandmarks>("landmarks"), in.get<head::HeadLandmarks>("found"), skin,
                         params.as<face::FaceBeliefParams>());
  return {{}, AnyParams::make(face::check_face_removed(skin, regions, surfaces, volumes, progress)), {}};
}

}  // namespace

/// Acceptance case P4, applied to everything that a case is about to publish. The report says how near it comes to the
/// face.
StageType face_gate_stage() {
  StageType s;
  s.name = "face_gate";
  s.version = 3;
  s.typical.base_s = 2;
  s.place = StagePlace::scene;
  s.case_name = "face";
  s.check.serves = "the check that no face is published";
  s.contribute = [](const AnyParams& result, CaseParts& parts) { parts.checks = figures_named("face.", result); };
  s.summary = "refuses what still shows the face";
  s.description = "Compares every surface and volume that is about to be published with the original skin.";
  s.examples = {"trephine face-gate skin.nrrd --landmarks landmarks.json --surface skin=skin.vtp"};
  s.ports = {port("skin", DataKind::field).help("the skin of the original scan"),
             port("landmarks", DataKind::landmarks)
                 .from(From::original_landmarks)
                 .help("landmarks nasion, tragus_left and tragus_right"),
             port("found", DataKind::landmarks)
                 .from(From::found_landmarks)
                 .optional()
                 .help("the same landmarks, found without any that a person gave"),
             port("surface.*", DataKind::mesh).from(From::surfaces).optional().help("surfaces that are published"),
             port("haptic", DataKind::haptic).optional().help("the haptic volume that is published"),
             port("ct", DataKind::volume).from(From::published_ct).optional().help("the CT that is published")};
  s.output = DataKind::nothing;
  s.declares<face::FaceBeliefParams, face::FaceGateResult>();
  s.run = run_gate;
  return s;
}

}  // namespace trephine::stages
