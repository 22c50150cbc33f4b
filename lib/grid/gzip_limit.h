// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>

namespace trephine::grid {

/// How much compressed voxels may grow to: `free_bytes`, and beyond them 200 times what is compressed. Zeros grow to
/// 1,032 times: a scan, which has noise, to 2 to 20; labels, where one value follows the other, to several hundred.
struct GzipLimit {
  std::uint64_t free_bytes;
  std::uint64_t bytes(std::uint64_t compressed) const { return std::max(free_bytes, 200 * compressed); }
};
constexpr GzipLimit scan_limit{std::uint64_t{256} << 20}, labels_limit{std::uint64_t{2} << 30};

}  // namespace trephine::grid
