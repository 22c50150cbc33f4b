// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/anatomy_codes.h"

namespace trephine::pacs {

const AnatomyCode any_anatomy_category{"", "123037004", "Anatomical Structure"};

const std::vector<AnatomyCode>& anatomy_codes() {
  static const std::vector<AnatomyCode> codes{
      {"artery", "51114001", "Artery"},
      {"bone", "272673000", "Bone"},
      {"brain", "12738006", "Brain"},
      {"brainstem", "119238007", "Brain stem"},
      {"canal", "61853006", "Vertebral canal"},
      {"clavicle", "51299004", "Clavicle"},
      {"cortex", "40146001", "Cerebral cortex"},
      {"cortical_veins", "29092000", "Vein"},
      {"dura", "18545000", "Dura mater"},
      {"lung", "39607008", "Lung"},
      {"other_bone", "272673000", "Bone"},
      {"pleura", "3120008", "Pleura"},
      {"sagittal_sinus", "59820001", "Blood vessel"},  // PS3.16 has no code of its own for it
      {"simple_brain", "12738006", "Brain"},
      {"skin", "39937001", "Skin"},
      {"skull", "89546000", "Skull"},
      {"third_ventricle", "49841001", "Third ventricle"},
      {"vein", "29092000", "Vein"},
      {"ventricles", "35764002", "Brain ventricle"},
      {"vertebrae", "51282000", "Vertebra"},
      {"vessels", "59820001", "Blood vessel"},
  };
  return codes;
}

const AnatomyCode& code_of(const std::string& anatomy) {
  static const AnatomyCode any{"", "91723000", "Anatomical Structure"};
  for (const AnatomyCode& c : anatomy_codes())
    if (anatomy == c.anatomy) return c;
  return any;
}

}  // namespace trephine::pacs
