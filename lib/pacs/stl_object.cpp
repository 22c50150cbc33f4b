// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/anatomy_codes.h"
#include "pacs/object.h"
#include "pacs/tags.h"

namespace trephine::pacs {

ObjectFile encode_stl_object(const CaseIdentity& identity, const std::string& anatomy, const std::string& stl) {
  const AnatomyCode& code = code_of(anatomy);
  Elements e = described(identity, "M3D", 4, "Surfaces of the case");
  e.text(t_content_date, "DA")
      .text(t_content_time, "TM")
      .text(t_acquisition_datetime, "DT")
      .text(t_instance_number, "IS", "1")
      .text(t_burned_in, "CS", "NO")
      .code(t_units, "mm", "UCUM", "mm")
      .code(t_concept, code.code, "SCT", code.meaning)
      .text(t_document_title, "ST", anatomy)
      .text(t_document_type, "LO", "model/stl")
      .longs(t_document_length, {std::uint32_t(stl.size())})
      .text(t_model_modification, "CS", "YES")
      .text(t_model_mirroring, "CS", "NO")
      .bytes(t_document, "OB", stl);
  return encode_object(std::move(e), class_stl);
}

}  // namespace trephine::pacs
