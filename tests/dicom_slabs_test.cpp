// SPDX-License-Identifier: GPL-3.0-or-later
// Slabs of several acquisitions: which follow one another, which scan a part again. And HU without their offset.
#include <gtest/gtest.h>

#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;

constexpr auto acquisition_tag = tag(0x20, 0x12);

/// Slices of several acquisitions: pairs of a position and a number.
Scan of_acquisitions(const std::vector<std::pair<double, int>>& slices) {
  Scan s = small();
  for (const auto& slice : slices) s.along_mm.push_back(slice.first);
  s.slices = int(slices.size());
  s.edit = [slices](int k, DataSet& d) {
    d.text(acquisition_tag, "IS", std::to_string(slices[std::size_t(k)].second));
  };
  return s;
}

/// Step-and-shoot: a slab of four slices each, every 2 mm.
std::vector<std::pair<double, int>> stepped(int slabs) {
  std::vector<std::pair<double, int>> all;
  for (int k = 0; k < 4 * slabs; ++k) all.emplace_back(2.0 * k, 1 + k / 4);
  return all;
}

// What one rescanned slab of four slices did to a head of 184: 47 series of one slab each.
TEST(DicomSlabs, ARescannedSlabDoesNotPartTheScan) {
  auto slices = stepped(12);
  for (int k = 0; k < 4; ++k) slices.emplace_back(5.3 + 2 * k, 13);
  const ScratchFolder folder;
  of_acquisitions(slices).write(folder);
  const auto list = dicom::list_series(folder.path()).series;
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].size[2], 48);
  EXPECT_TRUE(list[0].proposed);
  EXPECT_EQ(list[1].size[2], 4);
  EXPECT_NE(list[1].verdict.find("scans only a part of s1"), std::string::npos) << list[1].verdict;
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});  // no choice is asked for
  EXPECT_EQ(count(r.report(), "slices_count"), 48);
  ASSERT_EQ(printed(r.folder).warnings.size(), 1u);
  EXPECT_NE(printed(r.folder).warnings[0].find("4 slices scan a part of the series again"), std::string::npos);
  dicom::ImportParams slab;
  slab.series = "s2";
  EXPECT_EQ(count(dicom::import_series(folder.path(), slab).report(), "slices_count"), 4);
}

TEST(DicomSlabs, SlabsThatOverlapAtTheSamePositionsAreOneScan) {
  std::vector<std::pair<double, int>> slices;
  for (int slab = 0; slab < 5; ++slab)
    for (int k = 0; k < 6; ++k)
      slices.emplace_back(2.0 * (5 * slab + k), slab + 1);  // the last is the next one's first
  Scan s = of_acquisitions(slices);
  s.stored = [](int i, int, int k) -> std::optional<std::int64_t> { return 900 + 20 * i + k; };  // each with its noise
  const ScratchFolder folder;
  s.write(folder);
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});
  EXPECT_EQ(count(r.report(), "slices_count"), 26);
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(r.volume).at(0, 0, 5), 900 - 1024 + 5);  // the lower slab's slice
}

TEST(DicomSlabs, TheScanAfterContrastIsAChoice) {
  std::vector<std::pair<double, int>> slices;
  for (int k = 0; k < 12; ++k) slices.emplace_back(2.0 * k, 1), slices.emplace_back(2.0 * k + 0.7, 2);
  EXPECT_EQ(outcome(of_acquisitions(slices)).code, 64);
}

/// A body of soft tissue with bone, in air, whose stored values are HU + 1024.
Scan without_offset() {
  Scan s = small();
  s.intercept = 0;
  s.stored = [](int i, int j, int) -> std::optional<std::int64_t> {
    const double r = std::hypot(i - 9.5, j - 7.5);
    return r < 4 ? 1060 : r < 6 ? 1045 : r < 6.6 ? 2100 : 20 + (i * 7 + j * 3) % 9;
  };
  return s;
}

TEST(DicomOffset, ACtWithoutItIsNamedAndTheRemedyWorks) {
  const Refused o = outcome(without_offset());
  EXPECT_EQ(o.code, 65);
  EXPECT_NE(o.line.find("RescaleIntercept"), std::string::npos) << o.line;
  EXPECT_NE(o.line.find("--offset-hu -1024"), std::string::npos) << o.line;
  dicom::ImportParams said;
  said.offset_hu = -1024;
  const ScratchFolder folder;
  without_offset().write(folder);
  const dicom::ImportResult r = dicom::import_series(folder.path(), said);
  EXPECT_EQ(std::get<double>(*r.report().find("hu_min")), -1004);
  EXPECT_EQ(std::get<double>(*r.report().find("hu_max")), 1076);
  Scan right = without_offset();
  right.intercept = -1024;
  EXPECT_EQ(outcome(right).code, 0);
}

}  // namespace
}  // namespace trephine
