// SPDX-License-Identifier: GPL-3.0-or-later
#include "external/external.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType external_stage() {
  StageType s;
  s.name = "external";
  s.version = 2;
  s.summary = "lets another program label the scan";
  s.description =
      "Runs a program that you name on the scan, as NIfTI in HU, and takes the map of labels that it writes, for the "
      "stage labels of any number of anatomies. The program runs as you, in a folder of its own with an empty home, "
      "with limits on time and memory, without network, without the socket files of this machine's services and "
      "without "
      "the right to write elsewhere where the kernel allows that (Linux 5.13; a warning says where it does not). It "
      "may read what you may read: name only programs that you "
      "trust.\n\n"
      "In a run the program is only started where --allow-external says so. The map is checked before it counts: whole "
      "numbers, the scan's own voxels, at least one label. A case records the command without the folders of its "
      "paths, the first line of the program's version, which must hold `version`, and the SHA-256 of the program's "
      "file and of what it wrote.";
  s.examples = {
      "trephine external head.nrrd --program TotalSegmentator --version 2. --arguments=-i --arguments={input} "
      "--arguments=-o --arguments={output} --arguments=--ml --output labels.nrrd",
      "trephine labels head.nrrd --map labels.nrrd --label 90 --output brain.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU")};
  s.output = DataKind::labels;
  s.runs_program = true;
  s.declares<external::ExternalParams, external::ExternalResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    const auto& r = result_as<external::ExternalResult>(result);
    parts.made_of = {
        {"said_version", r.said_version}, {"program_sha256", r.program_sha256}, {"output_sha256", r.output_sha256}};
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        external::run_external(*in.get<grid::HuVolume>("volume"), params.as<external::ExternalParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
