// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace trephine::page::web {

/// The files of web/, as they were when the program was built.
extern const std::string_view template_html, style_css, viewer_js;  ///< of a case's page
extern const std::string_view index_html, index_css, index_js;      ///< of a library's page

}  // namespace trephine::page::web
