// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string_view>

namespace trephine::detail {

constexpr const char* manifest_name = "case.json";
constexpr std::uint64_t most_manifest_bytes = std::uint64_t{4} << 20;
constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 34;

/// Relative, at most one folder deep, letters, digits, '-', '_', '.': nothing that leaves the case's folder.
bool is_case_file_name(std::string_view name);
/// A content name: ends in -<16 digits>.<extension>.
bool is_content_name(std::string_view name);
/// 64 lower-case hexadecimal digits.
bool is_sha256(std::string_view text);

}  // namespace trephine::detail
