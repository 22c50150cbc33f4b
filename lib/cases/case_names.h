// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace trephine::cases::detail {

constexpr const char* manifest_name = "case.json";
constexpr std::uint64_t max_manifest_bytes = std::uint64_t{4} << 20;
constexpr const char* damaged_remedy = ": copy the case once more, or make it again with `trephine run`";

/// Relative, at most one folder deep, letters, digits, '-', '_', '.': nothing that leaves the case's folder.
bool is_case_file_name(std::string_view name);
/// A content name: ends in -<16 digits>.<extension>.
bool is_content_name(std::string_view name);
bool is_token(const std::string& text);

}  // namespace trephine::cases::detail
