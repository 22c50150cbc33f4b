// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "base/params.h"
#include "dicom/import.h"
#include "itk/registration.h"

namespace trephine::config {

/// What a scan of a case shows, from which follows how its values are read.
enum class ScanModality { mr, cta, ct };

/// A further scan of the patient as a case's configuration names it, below `scans`.
struct CaseScanParams {
  ScanModality modality = ScanModality::mr;
  std::string series, same_patient_reason;
  dicom::ImportParams import;
  itk::RegistrationParams registration;
  template <class V>
  static void describe(V& v) {
    using P = CaseScanParams;
    v.choice(&P::modality, "modality", {{"mr", ScanModality::mr}, {"cta", ScanModality::cta}, {"ct", ScanModality::ct}},
             "What it is: MR, whose values mean nothing by themselves, CT angiography, or another CT (both in HU).")
        .is_required();
    v.text(&P::series, "series", "Folder, ZIP archive or volume file with it; `run --scan NAME=PATH` overrides this.")
        .names("file");
    v.text(&P::same_patient_reason, "same_patient_reason",
           "Why it is the same patient although its PatientID is another one (two hospitals, a pseudonym). The reason "
           "is recorded.");
    v.group(&P::import, "import", "How it is read.");
    v.group(&P::registration, "register", "How it is laid on the CT.");
  }
  std::string fault() const {
    if (import.modality != dicom::ModalityPolicy::ct || import.volume_values != dicom::VolumeValues::unsaid ||
        import.units != dicom::UnitPolicy::hu)
      return "import: modality, units and volume_values follow from the scan's modality, leave them out";
    if (registration.moving != itk::MovingValues::any)
      return "register: moving_values follows from the scan's modality, leave it out";
    return registration.kind == itk::RegistrationKind::rigid ? ""
                                                             : "register.kind: scans of one patient are laid rigidly";
  }
};

/// A further scan of the case. Its stages are NAME.import and NAME.register; the latter gives it on the CT's voxels.
struct CaseScan {
  std::string name;
  ScanModality modality = ScanModality::mr;
  std::filesystem::path series;  ///< empty: none given
  std::string same_patient_reason;
  AnyParams import = AnyParams::make<dicom::ImportParams>();
  AnyParams registration = AnyParams::make<itk::RegistrationParams>();
};
const char* to_text(ScanModality modality);

/// The name by which a recipe's step says that it reads the CT, as it does without saying.
constexpr const char* first_scan = "ct";

}  // namespace trephine::config
