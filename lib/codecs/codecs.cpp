// SPDX-License-Identifier: GPL-3.0-or-later
#include "codecs/codecs.h"

#include "base/shared_library.h"

namespace trephine::codecs {

const Codecs& codecs() {
  static const Codecs loaded = [] {
    const SharedLibrary library = own_library("dicom_codecs", "trephine_dicom_");
    Codecs c{};
    library.find("decode", c.decode);
    library.find("write", c.write);
    library.find("write_object", c.write_object);
    return c;
  }();
  return loaded;
}

}  // namespace trephine::codecs
