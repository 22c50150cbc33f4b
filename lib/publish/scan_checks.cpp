// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/scan_checks.h"

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "dicom/identity.h"
#include "itk/same_place.h"
#include "itk/transform_file.h"
#include "stages/import.h"

namespace trephine::publish {
namespace {

/// Whether these attributes of identity are of few people: a sex or a date of birth alone are shared by many.
bool identifies(const std::vector<std::string>& agreeing) {
  for (const std::string& keyword : agreeing)
    if (keyword == "PatientID" || keyword == "PatientName") return true;
  return false;
}

}  // namespace

std::vector<std::string> names_of_scans(const pipeline::Graph& graph) {
  std::vector<std::string> names;
  for (const auto& scan : graph.scans) names.push_back(scan.first);
  return names;
}

std::vector<std::string> require_one_patient(const config::CaseConfig& config, const std::vector<std::string>& scans,
                                             const Progress& progress) {
  std::vector<std::string> warnings;
  const auto compare_with = [&](const std::string& whose, const dicom::SeriesChoice& first,
                                const config::CaseScan& scan, const dicom::SeriesChoice& second) {
    const dicom::PatientMatch match = dicom::compare_patients(first, second, progress);
    const bool reason = !trimmed(scan.same_patient_reason).empty();
    if (!match.contradicting.empty() && !reason)
      throw Error(ExitCode::bad_input, "", "scans." + scan.name,
                  "has another " + joined(match.contradicting) + " than " + whose +
                      "; where it is the same patient nevertheless, say why with same_patient_reason");
    if (!match.contradicting.empty())
      warnings.push_back(scan.name + ".import: has another " + joined(match.contradicting) + " than " + whose +
                         ", and is used for the reason given");
    else if (!identifies(match.agreeing))
      warnings.push_back(scan.name + ".import: that it is of the same patient as " + whose + " is taken on trust: " +
                         (match.agreeing.empty()
                              ? "one of the two does not say who it is, or both say what anybody's says"
                              : "only " + joined(match.agreeing) + " can be compared, and agrees"));
  };
  for (const std::string& name : scans) {
    const config::CaseScan& scan = *config.find_scan(name);
    const dicom::SeriesChoice ct{config.series, config.import},
        other{scan.series, scan.import.as<dicom::ImportParams>()};
    const std::string& given = scan.registration.as<itk::RegistrationParams>().given;
    if (scan.modality != config::ScanModality::mr && !given.empty() && itk::is_identity(itk::read_transform(given))) {
      const auto frame = dicom::of_one_frame(ct, other, progress);
      if (!frame)
        warnings.push_back(name + ".register: that it lies in the CT's frame of reference is taken on trust: one of " +
                           "the two does not say which it has");
      else if (!*frame)
        throw Error(
            ExitCode::bad_input, "", "scans." + name + ".register.given",
            "moves nothing, and the scan has another frame of reference than the CT; leave given out, and it is "
            "registered");
    }
    compare_with("the CT", ct, scan, other);
    for (const std::string& earlier : scans) {
      if (earlier == name) break;
      const config::CaseScan& one = *config.find_scan(earlier);
      compare_with("scans." + earlier, {one.series, one.import.as<dicom::ImportParams>()}, scan, other);
    }
  }
  return warnings;
}

void require_modalities(const config::CaseConfig& config, const pipeline::Graph& graph,
                        const std::vector<pipeline::NodeResult>& results) {
  for (const config::CaseScan& scan : config.scans) {
    const int read = graph.find_stage<stages::ImportStageParams>(scan.name);
    if (read < 0) continue;  // no stage reads it
    const std::string& is = result_as<stages::ImportStageResult>(results[std::size_t(read)].result).scan.modality;
    if (is != (scan.modality == config::ScanModality::mr ? "MR" : "CT") && is != "any")
      throw Error(ExitCode::bad_input, "", "scans." + scan.name + ".modality",
                  std::string("is ") + config::to_text(scan.modality) + ", and the series is " + is);
  }
}

}  // namespace trephine::publish
