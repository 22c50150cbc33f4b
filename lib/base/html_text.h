// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace trephine {

/// The text with what HTML takes for its own (< > & and both quotes) written as entities.
std::string html_text(std::string_view text);

}  // namespace trephine
