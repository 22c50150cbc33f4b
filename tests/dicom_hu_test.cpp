// SPDX-License-Identifier: GPL-3.0-or-later
// The HU that an import makes of stored values: D10 to D12.
#include <gtest/gtest.h>

#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;

TEST(DicomHu, SignedUnsignedAndWide) {
  struct Case {
    bool is_signed;
    int bits;
    double slope, intercept;
    std::int64_t low, high;
    bool int16;
  };
  for (const Case& c : {Case{false, 16, 1, -1024, 0, 4095, true}, Case{true, 16, 1, 0, -1024, 3071, true},
                        Case{false, 12, 1, -1000, 0, 4095, true}, Case{true, 12, 1, 0, -2048, 2047, true},
                        Case{true, 16, 1, 32768, -32768, 32767, false}, Case{true, 16, 1, 32768, -32768, -30000, true},
                        Case{false, 16, 1, -1024, 0, 65535, false}, Case{false, 16, 1, -1024, 0, 31024, true},
                        Case{false, 16, 0.5, -1024, 0, 4095, false}, Case{false, 16, 1, -1024.5, 0, 4095, false},
                        Case{false, 8, 4, -200, 0, 255, true}, Case{true, 32, 1, -5, -70000, 70000, false}}) {
    Scan s = small();
    s.is_signed = c.is_signed;
    s.bits_stored = c.bits;
    s.bits_allocated = c.bits <= 8 ? 8 : c.bits <= 16 ? 16 : 32;
    s.slope = c.slope;
    s.intercept = c.intercept;
    const auto word = [&](int i, int j, int k) {
      return c.low + (c.high - c.low) * ((i * 7 + j * 31 + k * 5) % 53) / 52;
    };
    s.stored = word;
    const ScratchFolder folder;
    s.write(folder);
    const dicom::ImportResult r = dicom::import_series(folder.path(), {});
    EXPECT_EQ(std::holds_alternative<grid::Grid<std::int16_t>>(r.volume), c.int16) << c.intercept << " " << c.high;
    std::visit(
        [&](const auto& g) {
          for (int k = 0; k < s.slices; ++k)
            for (int j = 0; j < s.rows; ++j)
              for (int i = 0; i < s.columns; ++i)
                ASSERT_EQ(g.at(i, j, k), static_cast<double>(word(i, j, k)) * c.slope + c.intercept);
        },
        r.volume);
  }
}

TEST(DicomHu, SlopeAndInterceptOfEachSlice) {
  Scan s = small();
  s.stored = [](int i, int j, int k) { return 100 * k + i + j; };
  s.edit = [](int k, DataSet& d) {
    d.text(slope_tag, "DS", k % 2 ? "2" : "1");
    d.text(intercept_tag, "DS", std::to_string(-1000 - k));
  };
  const ScratchFolder folder;
  s.write(folder);
  const auto g = std::get<grid::Grid<std::int16_t>>(dicom::import_series(folder.path(), {}).volume);
  for (int k = 0; k < s.slices; ++k) EXPECT_EQ(g.at(3, 4, k), (100 * k + 7) * (k % 2 ? 2 : 1) - 1000 - k);
}

TEST(DicomHu, PaddingBecomesAirAndIsCounted) {
  struct Case {
    std::int64_t padding;
    std::optional<std::int64_t> limit;
    std::int64_t in_file;
    bool is_signed;
    double intercept;
  };
  for (const Case& c :
       {Case{-2000, {}, -2000, true, 0}, Case{-32768, {}, -32768, true, 0}, Case{63536, {}, 63536, false, -1024},
        Case{-2000, {}, -2000, true, -1024}, Case{-3000, -1500, -2222, true, 0}, Case{-1500, -3000, -2222, true, 0}}) {
    Scan s = small();
    s.is_signed = c.is_signed;
    s.intercept = c.intercept;
    s.stored = [&](int i, int, int) -> std::optional<std::int64_t> {
      if (i < 4) return c.in_file;
      return std::nullopt;
    };
    s.edit = [&](int, DataSet& d) {
      d.elements[tag(0x28, 0x120)] = {
          c.is_signed ? "SS" : "US", synthetic::little(static_cast<std::uint64_t>(c.padding), 2), {}};
      if (c.limit)
        d.elements[tag(0x28, 0x121)] = {"SS", synthetic::little(static_cast<std::uint64_t>(*c.limit), 2), {}};
    };
    const ScratchFolder folder;
    s.write(folder);
    const dicom::ImportResult r = dicom::import_series(folder.path(), {});
    EXPECT_EQ(count(r.report(), "padding_voxels_count"), 4 * s.rows * s.slices);
    const auto& g = std::get<grid::Grid<std::int16_t>>(r.volume);
    EXPECT_EQ(g.at(2, 5, 1), -1000);
    EXPECT_EQ(count(r.report(), "below_air_voxels_count"), 0);
  }
}

TEST(DicomHu, MetalIsKeptOrClampedAndCounted) {
  for (const int metal : {3071, 30000}) {
    Scan s = small();
    s.stored = [metal](int i, int j, int) -> std::optional<std::int64_t> {
      if (i == 5 && j == 5) return metal + 1024;
      return std::nullopt;
    };
    const ScratchFolder folder;
    s.write(folder);
    const dicom::ImportResult kept = dicom::import_series(folder.path(), {});
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(kept.volume).at(5, 5, 2), metal);
    EXPECT_EQ(count(kept.report(), "clamped_voxels_count"), 0);
    dicom::ImportParams p;
    p.clamp_high_hu = 3000;
    const dicom::ImportResult clamped = dicom::import_series(folder.path(), p);
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(clamped.volume).at(5, 5, 2), 3000);
    EXPECT_EQ(count(clamped.report(), "clamped_voxels_count"), s.slices);
  }
}

TEST(DicomHu, BitsAboveTheStoredOnesAreNoValue) {
  Scan s = small();
  s.bits_stored = 12;
  s.edit = [](int, DataSet& d) {
    for (std::size_t i = 1; i < d.elements[pixels_tag].bytes.size(); i += 4)
      d.elements[pixels_tag].bytes[i] |= '\x80';  // an overlay
  };
  const ScratchFolder a, b;
  s.write(a);
  s.edit = nullptr;
  s.write(b);
  EXPECT_TRUE(
      synthetic::same_volume(dicom::import_series(a.path(), {}).volume, dicom::import_series(b.path(), {}).volume));
}

}  // namespace
}  // namespace trephine
