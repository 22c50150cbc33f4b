// SPDX-License-Identifier: GPL-3.0-or-later
#include "findings/findings.h"

#include "base/error.h"
#include "stages/cranial_cavity_of.h"
#include "stages/scan_figures_of.h"

namespace trephine::stages {

StageType findings_stage() {
  StageType s;
  s.name = "findings";
  s.version = 15;
  s.typical.base_s = 0.3;
  s.typical.per_million_voxels_s = 0.038;
  s.place = StagePlace::scan;
  s.check.serves = "what of the head a person should look at";
  s.check.min_inputs = 2;
  s.summary = "says what of a head should be looked at: blood, dark tissue, air, shift, gaps of the bone, implants";
  s.description =
      "Measures what speaks against a usual head: tissue as dense as fresh blood in the ventricles, in the brain or "
      "beside it, dark tissue of the brain, air inside the skull, a shift of the midline, wide ventricles, gaps and "
      "round dents in the bone of the vault, metal and tubes. Each has a place, its size in ml, mm or cm2, a "
      "confidence, and the anatomies that may be wrong because of it. Nothing is diagnosed, and a head without "
      "findings is not healthy because of that: it is for a "
      "person to look at. The output has a label for the voxels of each.";
  s.examples = {
      "trephine findings head.nrrd --skull skull.nrrd --brain brain.nrrd --ventricles ventricles.nrrd --landmarks "
      "landmarks.json --output findings.seg.nrrd"};
  s.ports = {
      port("volume", DataKind::volume).help("CT volume in HU"), port("skull", DataKind::field).help("the skull"),
      port("brain", DataKind::field).help("the brain"),
      port("ventricles", DataKind::field)
          .optional()
          .help("the ventricles; without them neither shift nor width is measured"),
      port("landmarks", DataKind::landmarks)
          .where_shown("class_of")
          .optional()
          .help("landmarks and the midsagittal plane; without them left and right are those of the scan's axes")};
  s.output = DataKind::labels;
  s.declares<findings::FindingsParams, findings::FindingsResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    for (const findings::Finding& f : result_as<findings::FindingsResult>(result).list)
      parts.findings.push_back({findings::to_text(f.kind),
                                f.where,
                                f.side,
                                f.position_mm,
                                f.confidence,
                                f.concerns,
                                f.text,
                                {f.figures.begin(), f.figures.end()}});
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    findings::FindingShapes shapes{in.get<grid::Field>("skull"), in.get<grid::Field>("brain"),
                                   in.get<grid::Field>("ventricles"), in.get<head::HeadLandmarks>("landmarks")};
    std::shared_ptr<const CranialCavity> cavity;  // the one of the zones
    try {
      cavity = cranial_cavity_of(in, progress.part(0, 0.1));
      shapes.cavity = &cavity->value;
    } catch (const Error& e) {  // an open skull encloses nothing
      if (e.code() != ExitCode::quality) throw;
    }
    shapes.voxel_noise_hu = scan_figures_of(in, progress.part(0.1, 0.15)).noise_hu;
    return stage_outcome(findings::find_findings(*in.get<grid::HuVolume>("volume"), shapes,
                                                 params.as<findings::FindingsParams>(), progress.part(0.15, 1)));
  };
  return s;
}

}  // namespace trephine::stages
