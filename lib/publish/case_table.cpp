// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "base/text_table.h"

namespace trephine::publish {
std::string case_table(const std::vector<AnatomyResult>& anatomies) {
  std::vector<std::vector<std::string>> rows = {{"anatomy", "triangles", "after", "reduction", "MB", "after", "max mm",
                                                 "p99 mm", "RMS mm", "ml", "s", "stopped by"}};
  for (const AnatomyResult& a : anatomies) {
    const double kept = a.triangles_before ? double(a.triangles_after) / double(a.triangles_before) : 1;
    rows.push_back({a.name, grouped_text(a.triangles_before), grouped_text(a.triangles_after),
                    fmt::format("{:.1f} %", 100 * (1 - kept)), fmt::format("{:.1f}", double(a.bytes_before) / 1e6),
                    fmt::format("{:.2f}", double(a.bytes_after) / 1e6), fmt::format("{:.3f}", a.deviation_max_mm),
                    fmt::format("{:.3f}", a.deviation_p99_mm), fmt::format("{:.3f}", a.deviation_rms_mm),
                    fmt::format("{:.1f}", a.volume_ml), fmt::format("{:.1f}", a.seconds), a.stopped_by});
  }
  return text_table(rows, "lrrrrrrrrrrl");
}

}  // namespace trephine::publish
