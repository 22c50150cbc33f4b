// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace trephine::pacs {

/// What an anatomy of our recipes is in SNOMED CT: the one table of it. Codes and meanings are those of DICOM's own
/// context groups (PS3.16), so that other programs know them.
struct AnatomyCode {
  const char* anatomy;  ///< its name in a recipe
  const char* code;     ///< of scheme SCT
  const char* meaning;
};
const std::vector<AnatomyCode>& anatomy_codes();
/// The anatomy's; that of any anatomical structure where the table has none.
const AnatomyCode& code_of(const std::string& anatomy);

/// The category of all of them: an anatomical structure.
extern const AnatomyCode any_anatomy_category;

}  // namespace trephine::pacs
