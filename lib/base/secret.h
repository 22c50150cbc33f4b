// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace trephine {

/// 32 hexadecimal digits of the system's entropy. Throws Error 70 where it has none.
std::string random_secret();
/// Whether they are equal, in a time that does not depend on where they differ.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace trephine
