// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/shared_library.h"
#include "dataset/hdf5/hdf5_file.h"

namespace trephine::dataset {

const Hdf5Functions& hdf5() {
  static const Hdf5Functions loaded = [] {
    const SharedLibrary library = own_library("hdf5_writer", "trephine_hdf5_");
    Hdf5Functions f{};
    library.find("create", f.create);
    library.find("group", f.group);
    library.find("text", f.text);
    library.find("texts", f.texts);
    library.find("numbers", f.numbers);
    library.find("row", f.row);
    library.find("attribute", f.attribute);
    library.find("close", f.close);
    library.find("forget", f.forget);
    return f;
  }();
  return loaded;
}

}  // namespace trephine::dataset
