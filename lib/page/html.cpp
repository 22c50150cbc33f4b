// SPDX-License-Identifier: GPL-3.0-or-later
#include "page/html.h"

#include <algorithm>

#include "base/base64.h"
#include "base/error.h"
#include "base/html_text.h"
#include "grid/nrrd_header.h"

namespace trephine::page {
namespace {

constexpr int compression_level = 6;  // surfaces and slices: 20 % smaller than at 1, and pages travel

void require_harmless(std::string_view text, const char* what) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const char* end : {"</script", "</style", "<!--"})
    if (lower.find(end) != std::string::npos)
      throw Error(ExitCode::internal, "", what, std::string("holds ") + end + ", which ends its element");
}

std::string blocks_html(const std::vector<PageBlock>& blocks) {
  std::string out;
  for (const PageBlock& b : blocks) {
    out += "<script type=\"application/octet-stream\" id=\"" + b.id + "\">";
    out += base64(b.gzip);
    out += "</script>\n";
  }
  return out;
}

}  // namespace

PageBlock page_block(std::string id, const std::string& bytes, bool noise) {
  const auto search = noise ? grid::detail::GzipSearch::runs : grid::detail::GzipSearch::strings;
  return {std::move(id), bytes.size(), grid::detail::gzip_compress(bytes, compression_level, search)};
}

std::string html_page(std::string_view html, std::string_view style, std::string_view script, const std::string& json,
                      const std::vector<PageBlock>& blocks) {
  require_harmless(style, "style");
  require_harmless(script, "script");
  std::string out;
  std::size_t from = 0;
  for (std::size_t at; (at = html.find('@', from)) != std::string_view::npos;) {
    out += html.substr(from, at - from);
    std::size_t end = at + 1;
    while (end < html.size() && ((html[end] >= 'A' && html[end] <= 'Z') || html[end] == '_')) ++end;
    if (end >= html.size() || html[end] != '@' || end == at + 1) {  // no place: an at sign of the text
      out += '@';
      from = at + 1;
      continue;
    }
    const std::string_view place = html.substr(at + 1, end - at - 1);
    if (place == "STYLE")
      out += style;
    else if (place == "SCRIPT")
      out += script;
    else if (place == "STYLE_HASH")
      out += policy_hash(style);
    else if (place == "SCRIPT_HASH")
      out += policy_hash(script);
    else if (place == "DATA")
      out += html_json(json);
    else if (place == "BLOCKS")
      out += blocks_html(blocks);
    else
      throw Error(ExitCode::internal, "", "template", "names the place " + std::string(place));
    from = end + 1;
  }
  out += html.substr(from);
  return out;
}

}  // namespace trephine::page
