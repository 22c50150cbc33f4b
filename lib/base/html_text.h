// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace trephine {

/// The text with what HTML takes for its own (< > & and both quotes) written as entities. Control characters, and those
/// that turn the direction of writing, are replaced by '?' but for ends of lines and tabs: what is read is what is
/// there.
std::string html_text(std::string_view text);

/// JSON that a page holds or asks for, with the same characters of its strings replaced, also where they are written as
/// escapes. Every '<' is written as an escape, so that no text can end the element that it stands in.
std::string html_json(std::string_view json);

}  // namespace trephine
