// SPDX-License-Identifier: GPL-3.0-or-later
#include "texts/language.h"

namespace trephine::texts {

const std::vector<std::pair<std::string, Language>>& languages() {
  static const std::vector<std::pair<std::string, Language>> all = {{"en", Language::english},
                                                                    {"de", Language::german}};
  return all;
}

}  // namespace trephine::texts
