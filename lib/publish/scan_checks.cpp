// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/scan_checks.h"

#include "base/error.h"
#include "base/text.h"
#include "dicom/frame_of_reference.h"
#include "itk/same_place.h"
#include "itk/transform_file.h"

namespace trephine {

std::vector<std::string> names_of_scans(const Graph& graph) {
  std::vector<std::string> names;
  for (const auto& scan : graph.scans) names.push_back(scan.first);
  return names;
}

std::vector<std::string> require_one_patient(const CaseConfig& config, const std::vector<std::string>& scans,
                                             const Progress& progress) {
  std::vector<std::string> warnings;
  for (const std::string& name : scans) {
    const CaseScan& scan = *config.find_scan(name);
    const SeriesChoice ct{config.series, config.import}, other{scan.series, scan.import.as<ImportParams>()};
    const std::string& given = scan.registration.as<RegistrationParams>().given;
    if (scan.modality != ScanModality::mr && !given.empty() && is_identity(read_transform(given))) {
      const auto frame = of_one_frame(ct, other, progress);
      if (!frame)
        warnings.push_back(name + ".register: that it lies in the CT's frame of reference is taken on trust: one of " +
                           "the two does not say which it has");
      else if (!*frame)
        throw Error(
            ExitCode::bad_input, "", "scans." + name + ".register.given",
            "moves nothing, and the scan has another frame of reference than the CT; leave given out, and it is "
            "registered");
    }
    const auto same = of_one_patient(ct, other, progress);
    if (!same)
      warnings.push_back(name + ".import: that it is of the same patient as the CT is taken on trust: " +
                         "one of the two has no PatientID, or both have one that says nothing");
    else if (!*same && trimmed(scan.same_patient_reason).empty())
      throw Error(ExitCode::bad_input, "", "scans." + name,
                  "has another PatientID than the CT; where it is the same patient nevertheless, say why with "
                  "same_patient_reason");
    else if (!*same)
      warnings.push_back(name + ".import: has another PatientID than the CT, and is used for the reason given");
  }
  return warnings;
}

void require_modalities(const CaseConfig& config, const Graph& graph,
                        const std::function<const Report&(int node)>& report_of) {
  for (const CaseScan& scan : config.scans) {
    const int read = graph.find(scan.name + ".import");
    if (read < 0) continue;  // no stage reads it
    const ParameterValue* said = report_of(read).find("modality");
    const std::string is = said ? std::get<std::string>(*said) : "";
    if (is != (scan.modality == ScanModality::mr ? "MR" : "CT") && is != "any")
      throw Error(ExitCode::bad_input, "", "scans." + scan.name + ".modality",
                  std::string("is ") + to_text(scan.modality) + ", and the series is " + is);
  }
}

void require_modalities(const CaseConfig& config, const Graph& graph, const std::vector<NodeResult>& results) {
  require_modalities(config, graph, [&](int node) -> const Report& { return results[std::size_t(node)].report; });
}

}  // namespace trephine
