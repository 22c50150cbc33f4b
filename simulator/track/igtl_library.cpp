// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/igtl_library.h"

#include "base/shared_library.h"

namespace trephine::track {

const IgtlFunctions& igtl() {
  static const IgtlFunctions loaded = [] {
    const SharedLibrary library = own_library("igtl_messages", "trephine_igtl_");
    IgtlFunctions f{};
    library.find("header", f.header);
    library.find("content", f.content);
    library.find("ask", f.ask);
    return f;
  }();
  return loaded;
}

}  // namespace trephine::track
