// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace trephine {

std::string base64(std::string_view bytes);

/// The name by which a content security policy knows a script or a style: "sha256-" and the hash in base64.
std::string policy_hash(std::string_view text);

}  // namespace trephine
