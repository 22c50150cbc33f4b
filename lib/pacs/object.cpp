// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/object.h"

#include "codecs/element_text.h"
#include "pacs/tags.h"

namespace trephine::pacs {

CaseIdentity identity_of_case(const std::string& case_token, const std::string& input_sha256,
                              const std::string& program_version) {
  return {case_token, uid_of({"study", case_token, input_sha256}), uid_of({"frame of reference", input_sha256}),
          program_version};
}

Elements described(const CaseIdentity& identity, const char* modality, int series_number, const char* description) {
  Elements e;
  e.text(t_charset, "CS", "ISO_IR 192")
      .text(t_study_date, "DA")
      .text(t_study_time, "TM")
      .text(t_accession, "SH")
      .text(t_modality, "CS", modality)
      .text(t_manufacturer, "LO", "Trephine")
      .text(t_referring, "PN")
      .text(t_series_description, "LO", description)
      .text(t_model, "LO", "trephine export")
      .text(t_patient_name, "PN", "Trephine^" + identity.case_token)
      .text(t_patient_id, "LO", identity.case_token)
      .text(t_birth_date, "DA")
      .text(t_sex, "CS")
      .text(t_identity_removed, "CS", "YES")
      .text(t_removal_method, "LO", "made of a case: no attribute of the source's patient is copied")
      .text(t_serial, "LO", "none")
      .text(t_software, "LO", identity.program_version)
      .text(t_study, "UI", identity.study_uid)
      .text(t_study_id, "SH")
      .text(t_series_number, "IS", std::to_string(series_number))
      .text(t_frame_uid, "UI", identity.frame_uid)
      .text(t_position_reference, "LO");
  return e;
}

std::string vector_text(const SliceSet& s) { return codecs::decimals({s.u.x, s.u.y, s.u.z, s.v.x, s.v.y, s.v.z}); }
std::string place_text(Vec3 p) { return codecs::decimals({p.x, p.y, p.z}); }

}  // namespace trephine::pacs
