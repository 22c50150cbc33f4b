// SPDX-License-Identifier: GPL-3.0-or-later
#include "consistency/anatomy_gate.h"
#include "consistency/anatomy_gate_gap.h"
#include "stages/scan_figures_of.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType anatomy_stage() {
  StageType s;
  s.name = "anatomy";
  s.version = 8;
  s.typical.base_s = 0.15;
  s.typical.per_million_voxels_s = 0.022;
  s.place = StagePlace::scan;
  s.check.serves = "the consistency check of the anatomies that the scene shows";
  s.check.min_inputs = 2;
  s.check.refuses_early_by = {"skin", "skull"};  // a scan's field that cuts them, apparatus that is taken for them
  s.summary = "checks a head's anatomies against each other and measures them";
  s.description =
      "Checks the given ones of skin, skull, brain and ventricles against each other (consistency check): the "
      "ventricles lie inside the brain, the brain lies inside the cranial cavity and apart from the bone, the skull "
      "lies inside the skin, their surfaces keep apart, and the brain is one connected piece. Exit code 80 says what "
      "is wrong, by how much and where. It also measures volumes, Evans' index and midline shift, and classes the case "
      "as normal, hydrocephalic, shifted or small, or as uncertain, with the reasons, where the ventricles cannot be "
      "whole.";
  s.examples = {
      "trephine anatomy --skin skin.nrrd --skull skull.nrrd --brain brain.nrrd --ventricles ventricles.nrrd "
      "--landmarks landmarks.json",
      "trephine anatomy --brain brain.nrrd --ventricles ventricles.nrrd --volume head.nrrd --picture "
      "fault.png"};
  s.ports = {port("skin", DataKind::field).optional().help("the skin"),
             port("skull", DataKind::field).optional().help("the skull"),
             port("brain", DataKind::field).optional().help("the brain"),
             port("ventricles", DataKind::field).optional().help("the ventricles"),
             port("landmarks", DataKind::landmarks)
                 .where_shown("class_of")
                 .optional()
                 .help("landmarks and the midsagittal plane"),
             port("volume", DataKind::volume)
                 .optional()
                 .help("CT volume, for its noise, where its field ends, and a picture of what is wrong")};
  s.output = DataKind::nothing;
  s.declares<consistency::AnatomyGateParams, consistency::AnatomyResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    parts.head = result_as<consistency::AnatomyResult>(result);
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const auto* volume = in.get<grid::HuVolume>("volume");
    mask::ScanFigures scan;
    if (volume) scan = scan_figures_of(in, progress);
    const head::HeadFields fields{in.get<grid::Field>("skin"), in.get<grid::Field>("skull"),
                                  in.get<grid::Field>("brain"), in.get<grid::Field>("ventricles"),
                                  volume ? &scan : nullptr};
    consistency::AnatomyFindings findings = consistency::examine_anatomy(
        fields, in.get<head::HeadLandmarks>("landmarks"), params.as<consistency::AnatomyGateParams>(), progress,
        [&](const std::string& what, const std::vector<std::string>& of,
            const std::function<consistency::Clearance()>& measure) {
          return *in.once<consistency::Clearance>(
              what, of, progress, [&] { return std::make_shared<const consistency::Clearance>(measure()); });
        },
        volume);
    try {
      consistency::require_anatomy(findings);
    } catch (consistency::AnatomyError& e) {
      if (volume) e.picture_png = consistency::anatomy_picture(*volume, fields, e.faults().front());
      throw;
    }
    return StageOutcome{{}, AnyParams::make(std::move(findings.result)), std::move(findings.warnings)};
  };
  return s;
}

}  // namespace trephine::stages
