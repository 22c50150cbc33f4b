// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "phantom/scan.h"

namespace trephine::phantom {

enum class Encoding { none, rle, jpeg_ls, jpeg_2000 };
enum class Pixels { unsigned_12, unsigned_16, signed_16 };

struct SeriesParams {
  Encoding encoding = Encoding::jpeg_ls;
  Pixels pixels = Pixels::unsigned_12;
  std::int64_t intercept_hu = -1024;

  template <class V>
  static void describe(V& v) {
    using P = SeriesParams;
    v.choice(&P::encoding, "encoding",
             {{"none", Encoding::none},
              {"rle", Encoding::rle},
              {"jpeg_ls", Encoding::jpeg_ls},
              {"jpeg_2000", Encoding::jpeg_2000}},
             "Transfer syntax of the files, all lossless: explicit little endian, or compressed.");
    v.choice(
        &P::pixels, "pixels",
        {{"unsigned_12", Pixels::unsigned_12}, {"unsigned_16", Pixels::unsigned_16}, {"signed_16", Pixels::signed_16}},
        "How a pixel is stored: 12 bits, or 16 without or with a sign.");
    v.integer(&P::intercept_hu, "intercept_hu", Range{-32768, 32767},
              "HU of a stored 0 (RescaleIntercept; the slope is 1).");
  }
};

/// Which of a study's series is written: its number, and how its files' names begin.
struct SeriesNames {
  int number = 1;
  std::string file = "slice";
};

/// Writes one CT Image Storage file a slice into `folder` (made where missing), slice_0001.dcm on, in the order of
/// acquisition, and removes slice files of an earlier, longer series. All attributes of types 1 and 2; a synthetic
/// patient without identity (PatientIdentityRemoved YES); a fixed date; UIDs 2.25.<number> derived from `identity`, a
/// text that says which phantom and scan this is: equal texts give equal files.
///
/// Returns the bytes written. Throws Error 64 where a value does not fit the pixels, 73 and 74 as FileWriter,
/// Cancelled.
std::uint64_t write_series(const std::filesystem::path& folder, const Scan& scan, const ScanParams& scan_params,
                           const SeriesParams& params, const std::string& identity, const Progress& progress = {},
                           const SeriesNames& names = {});

/// Removes the files of an earlier series of these names.
void remove_series(const std::filesystem::path& folder, const SeriesNames& names);

}  // namespace trephine::phantom
