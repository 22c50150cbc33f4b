// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/denoise.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType denoise_stage() {
  StageType s;
  s.name = "denoise";
  s.version = 1;
  s.summary = "takes noise off a CT volume, or off the part of it that an anatomy lies in";
  s.description =
      "Curvature anisotropic diffusion, the bilateral filter, the median or a Gaussian, by ITK, or non-local means. In "
      "a recipe it stands "
      "before the stage that reads its output, so that nothing else does. It helps where noise is what is wrong, and "
      "moves edges where it is not: docs/how-to/noisy-scan.md says what was measured.";
  s.examples = {"trephine denoise head.nrrd --sigma-mm 1 --edge-hu 80 --output calm.nrrd",
                "trephine denoise head.nrrd --method median --within brain.nrrd --output calm.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("within", DataKind::field).optional().help("an anatomy: only the box about it is filtered")};
  s.output = DataKind::volume;
  s.declares<itk::DenoiseParams, itk::DenoiseResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(itk::denoise(*in.get<grid::HuVolume>("volume"), in.get<grid::Field>("within"),
                                      params.as<itk::DenoiseParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
