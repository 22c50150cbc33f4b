// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <initializer_list>
#include <string>

namespace trephine::codecs {

/// A DICOM decimal string (VR DS): at most 16 characters, as many digits as these hold.
std::string decimal(double v);
/// Several, with backslashes between them.
std::string decimals(std::initializer_list<double> values);

/// A UID 2.25.<a UUID as a decimal number> (PS3.5 B.2), of the first 128 bits of a hash in hexadecimal digits, with the
/// bits of a custom UUID (version 8) set: equal hashes give equal UIDs.
std::string uid_of_hash(const std::string& hex);

}  // namespace trephine::codecs
