// SPDX-License-Identifier: GPL-3.0-or-later
// Enhanced multi-frame CT against the same scan as single frames (D21), and headers with random damage.
#include <gtest/gtest.h>

#include "base/error.h"
#include "dicom/header.h"
#include "dicom/import.h"
#include "dicom_enhanced.h"

namespace trephine {
namespace {

using synthetic::DataSet;
using synthetic::enhanced;
using synthetic::Scan;
using synthetic::tag;

Scan scan() {
  Scan s;
  s.columns = 22;
  s.rows = 18;
  s.slices = 7;
  s.blobs = synthetic::four_blobs(7, 3);
  s.edit = [](int k, DataSet& d) { d.text(tag(0x28, 0x1052), "DS", std::to_string(-1024 + k)); };
  return s;
}

TEST(DicomMultiFrame, LikeTheSameScanInSingleFrames) {
  const Scan s = scan();
  const ScratchFolder single;
  s.write(single);
  const dicom::ImportResult truth = dicom::import_series(single.path(), {});
  for (const bool defined : {true, false})
    for (const char* syntax : {"1.2.840.10008.1.2.1", "1.2.840.10008.1.2"}) {
      const ScratchFolder folder;
      const auto file = folder.write(
          "multi",
          synthetic::file_bytes(enhanced(s, {3, 0, 6, 1, 2, 5, 4}, defined, std::string(syntax) != "1.2.840.10008.1.2"),
                                syntax));
      const dicom::ImportResult r = dicom::import_series(file, {});
      EXPECT_TRUE(synthetic::same_volume(r.volume, truth.volume)) << defined << syntax;
    }
}

TEST(DicomMultiFrame, FramesWithoutGeometryAreRefused) {
  const Scan s = scan();
  const ScratchFolder folder;
  DataSet d = enhanced(s, {0, 1, 2}, true);
  d.elements.erase(tag(0x5200, 0x9230));
  const auto file = folder.write("multi", synthetic::file_bytes(d));
  try {
    dicom::import_series(file, {});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_NE(e.field().find("NumberOfFrames"), std::string::npos) << e.line("");
  }
}

TEST(DicomMutants, HeadersWithRandomDamage) {
  const std::string seeds[] = {synthetic::file_bytes(scan().slice(2)),
                               synthetic::file_bytes(scan().slice(2), "1.2.840.10008.1.2"),
                               synthetic::file_bytes(enhanced(scan(), {0, 1, 2, 3}, false))};
  const ScratchFolder folder;
  unsigned state = 1;
  const auto next = [&state](unsigned below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
  };
  int broken = 0, faulty = 0;
  for (int n = 0; n < 3000; ++n) {
    std::string bytes = seeds[n % 3];
    const auto header = static_cast<unsigned>(std::min<std::size_t>(bytes.size(), 1800));
    for (unsigned hits = 1 + next(3); hits > 0; --hits) {
      const unsigned at = 128 + next(header - 128);
      bytes[at] = next(4) == 0 ? '\xff' : static_cast<char>(next(256));
    }
    try {
      const dicom::FileHeader h = dicom::read_header(folder.write("mutant", bytes));
      faulty += !h.faults.empty();
      if (!h.faults.empty()) continue;
      EXPECT_EQ(static_cast<int>(h.frames.size()), h.frame_count);
      EXPECT_LE(h.pixels.offset + h.frame_bytes() * static_cast<std::uint64_t>(h.frame_count), bytes.size());
    } catch (const dicom::WalkFault&) {
      ++broken;
    }
  }
  EXPECT_GT(broken, 100);
  EXPECT_GT(faulty, 100);
}

}  // namespace
}  // namespace trephine
