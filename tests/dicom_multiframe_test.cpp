// SPDX-License-Identifier: GPL-3.0-or-later
// Enhanced multi-frame CT against the same scan as single frames (D21), and headers with random damage.
#include <gtest/gtest.h>

#include "base/error.h"
#include "dicom/header.h"
#include "dicom/import.h"
#include "dicom_synthetic.h"

namespace trephine {
namespace {

using synthetic::DataSet;
using synthetic::Scan;
using synthetic::tag;

std::string item(const std::string& content, bool defined) {
  const std::string head = synthetic::little(0xfffe, 2) + synthetic::little(0xe000, 2);
  if (defined) return head + synthetic::little(content.size(), 4) + content;
  return head + synthetic::little(0xffffffff, 4) + content + synthetic::little(0xfffe, 2) +
         synthetic::little(0xe00d, 2) + synthetic::little(0, 4);
}

void sequence(DataSet& d, std::uint32_t t, const std::vector<std::string>& items, bool defined) {
  std::string content;
  for (const std::string& i : items) content += item(i, defined);
  if (!defined) content += synthetic::little(0xfffe, 2) + synthetic::little(0xe0dd, 2) + synthetic::little(0, 4);
  d.elements[t] = {"SQ", content, {}};
  if (!defined) d.elements[t].claimed_length = 0xffffffff;
}

/// The scan's slices as frames of one file, in the order given.
DataSet enhanced(const Scan& s, const std::vector<int>& order, bool defined_lengths, bool explicit_vr = true) {
  DataSet d = s.slice(0);
  std::string pixels;
  std::vector<std::string> frames;
  for (const int k : order) {
    DataSet slice = s.slice(k);
    pixels += slice.elements[tag(0x7fe0, 0x10)].bytes;
    DataSet position, groups, hu;
    position.elements[tag(0x20, 0x32)] = slice.elements[tag(0x20, 0x32)];
    hu.elements[tag(0x28, 0x1052)] = slice.elements[tag(0x28, 0x1052)];
    hu.elements[tag(0x28, 0x1053)] = slice.elements[tag(0x28, 0x1053)];
    sequence(groups, tag(0x20, 0x9113), {position.bytes(explicit_vr)}, defined_lengths);
    sequence(groups, tag(0x28, 0x9145), {hu.bytes(explicit_vr)}, defined_lengths);
    frames.push_back(groups.bytes(explicit_vr));
  }
  DataSet orientation, measures, shared;
  orientation.elements[tag(0x20, 0x37)] = d.elements[tag(0x20, 0x37)];
  measures.elements[tag(0x18, 0x50)] = d.elements[tag(0x18, 0x50)];
  measures.elements[tag(0x28, 0x30)] = d.elements[tag(0x28, 0x30)];
  sequence(shared, tag(0x20, 0x9116), {orientation.bytes(explicit_vr)}, defined_lengths);
  sequence(shared, tag(0x28, 0x9110), {measures.bytes(explicit_vr)}, defined_lengths);
  for (const auto t :
       {tag(0x20, 0x32), tag(0x20, 0x37), tag(0x28, 0x30), tag(0x28, 0x1052), tag(0x28, 0x1053), tag(0x18, 0x50)})
    d.elements.erase(t);
  d.text(tag(0x8, 0x16), "UI", "1.2.840.10008.5.1.4.1.1.2.1");
  d.text(tag(0x28, 0x8), "IS", std::to_string(order.size()));
  sequence(d, tag(0x5200, 0x9229), {shared.bytes(explicit_vr)}, defined_lengths);
  sequence(d, tag(0x5200, 0x9230), frames, defined_lengths);
  d.elements[tag(0x7fe0, 0x10)] = {"OW", pixels, {}};
  return d;
}

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
  const ImportResult truth = import_series(single.path(), {});
  for (const bool defined : {true, false})
    for (const char* syntax : {"1.2.840.10008.1.2.1", "1.2.840.10008.1.2"}) {
      const ScratchFolder folder;
      const auto file = folder.write(
          "multi",
          synthetic::file_bytes(enhanced(s, {3, 0, 6, 1, 2, 5, 4}, defined, std::string(syntax) != "1.2.840.10008.1.2"),
                                syntax));
      const ImportResult r = import_series(file, {});
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
    import_series(file, {});
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
