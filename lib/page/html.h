// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trephine::page {

/// Named binary data of a page, compressed.
struct PageBlock {
  std::string id;         ///< a-z, 0-9 and '-'
  std::size_t bytes = 0;  ///< before compression
  std::string gzip;

  std::size_t bytes_in_page() const { return (gzip.size() + 2) / 3 * 4; }
};
/// `noise`: nothing in the bytes repeats but runs.
PageBlock page_block(std::string id, const std::string& bytes, bool noise = false);

/// One HTML file that needs nothing beside it: a template of web/ with its style, script and data in the places
/// @STYLE@,
/// @SCRIPT@, @DATA@ and @BLOCKS@, which are filled in one pass, so that nothing in the data can name a place.
/// @STYLE_HASH@ and @SCRIPT_HASH@ become their hashes for the page's content security policy. `json` becomes the text
/// of a script element that no browser executes, as html_json (base/html_text.h) writes it. The blocks stand in base64.
/// The same input gives the same bytes. Throws Error 70 where style or script would end their own element, or the
/// template names another place.
std::string html_page(std::string_view html, std::string_view style, std::string_view script, const std::string& json,
                      const std::vector<PageBlock>& blocks);

}  // namespace trephine::page
