// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace trephine::desk::web {

/// The files of web/desk/, as they were when the program was built.
extern const std::string_view desk_html, desk_css, desk_js;

}  // namespace trephine::desk::web
