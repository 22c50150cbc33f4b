// SPDX-License-Identifier: GPL-3.0-or-later
// Further scans of a case, which its configuration names below `scans`.
#include "config/case_scans.h"

#include <algorithm>

#include "config/reading.h"

namespace trephine::config {
namespace {

using Fault = std::function<void(const std::string& where, const std::string& what)>;

std::string fault_of_scan_name(const ConfigReading& r, const std::string& name) {
  if (stages::find_stage(name) || r.out.find_anatomy(name) || name == "haptic" || name == "scene" || name == "original")
    return "is the name of a stage, an anatomy or a part of the case already";
  return is_plain_name(name) ? "" : "must be a name of letters a-z, digits and _";
}

CaseScan scan_of(const std::string& name, const CaseScanParams& said) {
  const bool hu = said.modality != ScanModality::mr;
  CaseScan scan;
  scan.name = name;
  scan.modality = said.modality;
  scan.same_patient_reason = said.same_patient_reason;
  dicom::ImportParams reading = said.import;
  reading.modality = hu ? dicom::ModalityPolicy::ct : dicom::ModalityPolicy::any;
  reading.units = hu ? dicom::UnitPolicy::hu : dicom::UnitPolicy::any;
  reading.volume_values = hu ? dicom::VolumeValues::hu : dicom::VolumeValues::any;
  scan.import = AnyParams::make(reading);
  itk::RegistrationParams registration = said.registration;
  registration.moving = hu ? itk::MovingValues::hu : itk::MovingValues::any;
  scan.registration = AnyParams::make(registration);
  return scan;
}

}  // namespace

const char* to_text(ScanModality modality) {
  switch (modality) {
    case ScanModality::mr:
      return "mr";
    case ScanModality::cta:
      return "cta";
    case ScanModality::ct:
      return "ct";
  }
  return "";
}

const CaseScan* CaseConfig::find_scan(const std::string& name) const {
  for (const CaseScan& s : scans)
    if (s.name == name) return &s;
  return nullptr;
}

template <class P>
bool is_as_declared(const P& params) {
  const AnyParams said = AnyParams::make(params), plain = AnyParams::make<P>();
  for (const Parameter& p : said.set->parameters)
    if (said.get(p) != plain.get(p)) return false;
  return true;
}

void add_scans(ConfigReading& r, const Named<CaseScanParams>& said, const Fault& fault) {
  for (const auto& [name, scan] : said) {
    const std::string where = "scans." + name;
    std::string reported;
    const std::filesystem::path file =
        scan.series.empty() ? std::filesystem::path() : r.in_root(r.file, scan.series, reported);
    if (name == first_scan) {  // another way to say `series`
      if (scan.modality != ScanModality::ct)
        fault(where, "ct is the scan that others are laid on: modality must be ct");
      else if (!is_as_declared(scan.import) || !is_as_declared(scan.registration) || !scan.same_patient_reason.empty())
        fault(where, "ct takes series and modality alone: how it is read stands in `import`");
      else if (!r.out.series.empty() && r.overrides.series.empty())
        fault(where, "is what `series` names, say one of them");
      else if (r.out.series.empty())
        r.out.series = file;
      continue;
    }
    if (const std::string what = fault_of_scan_name(r, name); !what.empty()) fault(where, name + ", " + what);
    r.out.scans.push_back(scan_of(name, scan));
    r.out.scans.back().series = file;
  }
  for (const auto& [name, file] : r.overrides.scans) {
    std::vector<std::string> known;
    for (CaseScan& s : r.out.scans) {
      known.push_back(s.name);
      if (s.name == name) s.series = file;
    }
    if (!r.out.find_scan(name))
      r.faults.add(Error(ExitCode::usage, "", "--scan",
                         name + ", the configuration has no such scan" + did_you_mean(name, known)));
  }
}

void add_scan_values(ConfigReading& r) {
  for (CaseScan& scan : r.out.scans) {
    r.values.add(scan.name + ".import", scan.import);
    r.values.add(scan.name + ".register", scan.registration);
    for (const char* path : {".import.modality", ".import.units", ".import.volume_values", ".register.moving_values"})
      r.values.fix(scan.name + path, "follows scans." + scan.name + ".modality, set that");
    r.values.fix(scan.name + ".register.kind", "scans of one patient are laid rigidly");
  }
}

}  // namespace trephine::config
