// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "cases/case.h"

namespace trephine::page {

/// What a page shows of a case beside the case package. `run` leaves it in the case's report folder, outside the
/// checksummed bytes, so that `trephine page` can make the same page again.

/// The front from which the case's settings were chosen; without points: none was asked for.
struct PageTrade {
  struct Point {
    std::string name;
    double seconds = 0, deviation_rms_mm = 0;
    std::int64_t triangles_count = 0;
    std::string refused;  ///< why it makes no case
  };
  std::vector<Point> points;
  std::string chosen, rule, why;
};

struct PageWarning {
  std::string text, severity;  ///< "wrong", "look" or "note"
};

struct PageNotes {
  std::vector<PageWarning> warnings;  ///< of the stages, as run logged them; not those about the machine's speed
  PageTrade trade;
  /// By anatomy: for each point of its GLB the signed distance to the surface before decimation, mm, positive outside;
  /// NaN where none is known, as on the wall of a burr hole.
  std::map<std::string, std::vector<float>> deviation_mm;
};

constexpr const char *page_file = "view.html", *page_notes_file = "view.json";  ///< in the case's report folder

/// The name of an anatomy's deviations: it holds the hash of the GLB, so that those of an older surface are never
/// taken.
std::string deviation_file_name(const cases::CaseManifest& manifest, const cases::CaseAnatomy& anatomy);
/// Its bytes: "trephine deviation 1\n", the SHA-256 of what follows and a line feed, and a float32 (little endian) a
/// point.
std::string encode_deviation(const std::vector<float>& deviation_mm);
/// Throws Error 65 where the bytes are damaged or are not `points` values.
std::vector<float> decode_deviation(std::string_view bytes, std::uint64_t points);

/// The text of view.json: warnings and trade.
std::string page_notes_json(const PageNotes& notes);
/// Reads what is there of view.json and the deviations; a missing file leaves its part empty (without view.json the
/// warnings are those of run.json). Throws Error 65 naming the file where one is damaged.
PageNotes read_page_notes(const std::filesystem::path& case_folder, const cases::CaseManifest& manifest);

}  // namespace trephine::page
