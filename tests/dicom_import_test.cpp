// SPDX-License-Identifier: GPL-3.0-or-later
// Choice of the series, HU, and what is refused: D1 to D6, D9 to D15, D18, D20, D22, P1 for what import says.
#include "dicom/import.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "base/parallel.h"
#include "dicom_synthetic.h"

namespace trephine {
namespace {

using synthetic::DataSet;
using synthetic::Scan;
using synthetic::tag;

constexpr auto position_tag = tag(0x20, 0x32), orientation_tag = tag(0x20, 0x37), spacing_tag = tag(0x28, 0x30),
               slope_tag = tag(0x28, 0x1053), intercept_tag = tag(0x28, 0x1052), pixels_tag = tag(0x7fe0, 0x10);

Scan small() {
  Scan s;
  s.columns = 20;
  s.rows = 16;
  s.slices = 6;
  s.blobs = synthetic::four_blobs(6, 3);
  return s;
}

std::int64_t count(const Report& r, const std::string& name) {
  const ParameterValue* v = r.find(name);
  return v ? std::get<std::int64_t>(*v) : -1;
}

struct Outcome {
  int code = 0;
  std::string line;
};
Outcome outcome(const std::filesystem::path& path, const ImportParams& params = {}) {
  try {
    import_series(path, params);
  } catch (const Error& e) {
    return {static_cast<int>(e.code()), e.line("import")};
  }
  return {};
}
Outcome outcome(const Scan& scan, const ImportParams& params = {}) {
  const ScratchFolder folder;
  scan.write(folder);
  return outcome(folder.path(), params);
}

/// The scan with one tag of slice 3 set to a text, or removed.
Scan with_text(std::uint32_t t, const std::string& vr, const std::optional<std::string>& value) {
  Scan s = small();
  s.edit = [=](int k, DataSet& d) {
    if (k != 3) return;
    if (value)
      d.text(t, vr, *value);
    else
      d.elements.erase(t);
  };
  return s;
}
Scan with_number(std::uint32_t t, unsigned value) {
  Scan s = small();
  s.edit = [=](int k, DataSet& d) {
    if (k == 3) d.number(t, value);
  };
  return s;
}

void expect_refused(const Scan& s, const std::string& field) {
  const Outcome o = outcome(s);
  EXPECT_EQ(o.code, 65) << o.line;
  EXPECT_NE(o.line.find(field), std::string::npos) << o.line;
  EXPECT_NE(o.line.find("slice1003.dcm"), std::string::npos) << o.line;
  EXPECT_EQ(o.line.find("CANARY"), std::string::npos) << o.line;
}

TEST(DicomValues, BadTagsAreRefusedByName) {
  for (const char* v : {"0", "nan", "abc", "1e10", "inf", "", "1\\2", "1,5", "0x1"})
    expect_refused(with_text(slope_tag, "DS", v), "RescaleSlope");
  expect_refused(with_text(slope_tag, "DS", std::nullopt), "RescaleSlope");
  for (const char* v : {"1e10", "nan", "-"}) expect_refused(with_text(intercept_tag, "DS", v), "RescaleIntercept");
  for (const char* v : {"0\\0", "-1.5\\1.5", "1.5", "1.5\\nan", "", "1\\2\\3"})
    expect_refused(with_text(spacing_tag, "DS", v), "PixelSpacing");
  expect_refused(with_text(spacing_tag, "DS", std::nullopt), "PixelSpacing");
  for (const char* v : {"0\\0\\0\\0\\0\\0", "1\\0\\0\\1\\0\\0", "1\\0\\0\\0.1\\0.995\\0", "2\\0\\0\\0\\1\\0", "1\\0\\0",
                        "1\\0\\0\\0\\1\\nan"})
    expect_refused(with_text(orientation_tag, "DS", v), "ImageOrientationPatient");
  expect_refused(with_text(orientation_tag, "DS", std::nullopt), "ImageOrientationPatient");
  for (const char* v : {"1\\2\\nan", "1\\2", "1\\2\\1e9", "x\\y\\z"})
    expect_refused(with_text(position_tag, "DS", v), "ImagePositionPatient");
  expect_refused(with_text(position_tag, "DS", std::nullopt), "ImagePositionPatient");
}

TEST(DicomValues, BadShapesAreRefusedByName) {
  expect_refused(with_number(tag(0x28, 0x100), 12), "BitsAllocated");
  expect_refused(with_number(tag(0x28, 0x101), 17), "BitsStored");
  expect_refused(with_number(tag(0x28, 0x101), 0), "BitsStored");
  expect_refused(with_number(tag(0x28, 0x102), 11), "HighBit");
  expect_refused(with_number(tag(0x28, 0x103), 2), "PixelRepresentation");
  expect_refused(with_number(tag(0x28, 0x2), 3), "SamplesPerPixel");
  expect_refused(with_number(tag(0x28, 0x10), 0), "Rows");
  Scan s = small();
  s.edit = [](int, DataSet& d) {
    d.number(tag(0x28, 0x10), 65535);
    d.number(tag(0x28, 0x11), 65535);
    d.text(tag(0x28, 0x8), "IS", "2147483647");
  };
  EXPECT_EQ(outcome(s).code, 65);
}

TEST(DicomValues, OddButRightDecimalsAreRead) {
  Scan s = small();
  s.dx_mm = s.dy_mm = 0.4785156;
  s.edit = [](int, DataSet& d) {
    d.text(spacing_tag, "DS", " 004.785156E-01\\+0.4785156 ");
    d.text(slope_tag, "DS", "+01.000");
    d.text(intercept_tag, "DS", "-1.024E+3");
  };
  const ScratchFolder folder;
  s.write(folder);
  const Lattice l = lattice_of(import_series(folder.path(), {}).volume);
  EXPECT_DOUBLE_EQ(l.spacing_mm.x, 0.4785156);
  EXPECT_DOUBLE_EQ(l.spacing_mm.y, 0.4785156);
}

TEST(DicomPixels, CutShortIsNeverFilledUp) {
  for (const std::size_t missing : {1u, 300u}) {
    for (const bool honest : {true, false}) {  // the element says so, or the file just ends
      const ScratchFolder folder;
      const Scan s = small();
      s.write(folder);
      DataSet d = s.slice(3);
      std::string& pixels = d.elements[pixels_tag].bytes;
      if (!honest) d.elements[pixels_tag].claimed_length = static_cast<std::uint32_t>(pixels.size());
      pixels.resize(pixels.size() - missing);
      folder.write("slice1003.dcm", synthetic::file_bytes(d));
      const Outcome o = outcome(folder.path());
      EXPECT_EQ(o.code, 65);
      EXPECT_NE(o.line.find("slice1003.dcm: PixelData"), std::string::npos) << o.line;
    }
  }
}

TEST(DicomPixels, HugeClaimsAllocateNothing) {
  Scan s = small();
  s.edit = [](int k, DataSet& d) {
    if (k == 3) d.elements[pixels_tag].claimed_length = 0xfffffff0u;
  };
  expect_refused(s, "PixelData");
  s.edit = [](int k, DataSet& d) {
    if (k == 3) d.elements[tag(0x0029, 0x1010)] = {"UN", "x", 0xfffffff0u};
  };
  EXPECT_EQ(outcome(s).code, 65);  // left out as broken: then a slice is missing
}

TEST(DicomFiles, NoDicomAtAll) {
  const ScratchFolder folder;
  EXPECT_EQ(outcome(folder.path() / "nowhere").code, 66);
  EXPECT_EQ(outcome(folder.path()).code, 65);
  const std::string good = synthetic::file_bytes(small().slice(0));
  for (const std::string& bytes : {std::string(), std::string("just text\n"), std::string(5000, '\x7f'),
                                   good.substr(0, 131), good.substr(0, 140), good.substr(0, 300)}) {
    const ScratchFolder one;
    const auto file = one.write("a.dcm", bytes);
    for (const auto& path : {one.path(), file}) {
      const Outcome o = outcome(path);
      EXPECT_EQ(o.code, 65);
      EXPECT_NE(o.line.find("a.dcm"), std::string::npos) << o.line;
    }
  }
}

TEST(DicomFiles, EveryPlaceToCutAHeader) {
  const std::string good = synthetic::file_bytes(small().slice(0));
  const ScratchFolder folder;
  for (std::size_t n = 0; n < 900; n += 7) {
    const auto file = folder.write("a.dcm", good.substr(0, n));
    EXPECT_EQ(outcome(file).code, 65) << n;
  }
}

TEST(DicomFiles, NestingIsBounded) {
  for (const int depth : {10, 17, 200000}) {
    std::string nested;
    for (int i = 0; i < depth; ++i) {
      nested += synthetic::little(0x10090040, 4).substr(0, 0);
      nested += synthetic::little(0x0040, 2) + synthetic::little(0xa730, 2) + "SQ" + std::string(2, '\0') +
                synthetic::little(0xffffffff, 4);
      nested += synthetic::little(0xfffe, 2) + synthetic::little(0xe000, 2) + synthetic::little(0xffffffff, 4);
    }
    for (int i = 0; i < depth; ++i)
      nested += synthetic::little(0xfffe, 2) + synthetic::little(0xe00d, 2) + synthetic::little(0, 4) +
                synthetic::little(0xfffe, 2) + synthetic::little(0xe0dd, 2) + synthetic::little(0, 4);
    const ScratchFolder folder;
    const Scan s = small();
    for (int k = 0; k < s.slices; ++k) {
      const DataSet d = s.slice(k);
      const std::string head = synthetic::file_bytes(d).substr(0, 132);
      DataSet meta;
      meta.text(tag(2, 0x10), "UI", "1.2.840.10008.1.2.1");
      folder.write(std::to_string(k), head + meta.bytes() + d.bytes(true, 0, tag(0x0028, 0xffff)) + nested +
                                          d.bytes(true, tag(0x0040, 0), 0xffffffff));
    }
    const Outcome o = outcome(folder.path());
    if (depth < 16) {
      EXPECT_EQ(o.code, 0) << o.line;
    } else {
      EXPECT_EQ(o.code, 65);
      EXPECT_NE(outcome(folder.path() / "3").line.find("nested"), std::string::npos)
          << outcome(folder.path() / "3").line;
    }
  }
}

TEST(DicomFiles, OtherFilesAreSkippedAndCounted) {
  const ScratchFolder folder;
  const Scan s = small();
  s.write(folder, [](int k) { return "a/b/" + std::to_string(k); });
  const ImportResult plain = import_series(folder.path(), {});
  const std::string good = synthetic::file_bytes(s.slice(0));
  folder.write("readme.txt", "hello");
  folder.write("empty", "");
  folder.write("random", std::string(3000, '\x55'));
  folder.write("cut", good.substr(0, 301));
  folder.write("cut_between_elements", good.substr(0, good.find(std::string("\xe0\x7f\x10\x00", 4))));
  folder.write(".hidden", good);
  Scan scout = s;
  scout.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
  scout.slices = 2;
  scout.u = {0, 1, 0};
  scout.v = {0, 0, -1};
  scout.write(folder, [](int k) { return "scout" + std::to_string(k); });
  Scan dose = s;
  dose.modality = "SR";
  dose.sop_class = "1.2.840.10008.5.1.4.1.1.88.67";
  dose.slices = 1;
  dose.edit = [](int, DataSet& d) { d.elements.erase(pixels_tag); };
  dose.write(folder, [](int) { return "dose"; });
  const ImportResult r = import_series(folder.path(), {});
  EXPECT_TRUE(synthetic::same_volume(r.volume, plain.volume));
  EXPECT_EQ(r.input_sha256, plain.input_sha256);
  EXPECT_EQ(r.report.figures, plain.report.figures);
  EXPECT_EQ(count(r.folder, "skipped_not_dicom_count"), 3);
  EXPECT_EQ(count(r.folder, "skipped_broken_count"), 2);
  EXPECT_EQ(count(r.folder, "skipped_hidden_count"), 1);
  EXPECT_EQ(count(r.folder, "localizers_count"), 2);
  EXPECT_EQ(count(r.folder, "other_series_count"), 1);
}

TEST(DicomFiles, UnsupportedSyntaxesByName) {
  for (const auto& [uid, name] :
       {std::pair{"1.2.840.10008.1.2.2", "big endian"}, std::pair{"1.2.840.10008.1.2.1.99", "deflated"},
        std::pair{"1.2.840.10008.1.2.4.201", "high-throughput"}}) {
    Scan s = small();
    s.syntax = uid;
    const Outcome o = outcome(s);
    EXPECT_EQ(o.code, 65);
    EXPECT_NE(o.line.find(name), std::string::npos) << o.line;
    EXPECT_NE(o.line.find("TransferSyntaxUID"), std::string::npos) << o.line;
  }
}

TEST(DicomFiles, ImplicitVrIsReadAlike) {
  Scan s = small();
  const ScratchFolder a, b;
  s.write(a);
  s.syntax = "1.2.840.10008.1.2";
  s.write(b);
  EXPECT_TRUE(synthetic::same_volume(import_series(a.path(), {}).volume, import_series(b.path(), {}).volume));
}

TEST(DicomSeries, OrderAndNamesDoNotMatter) {
  Scan s = small();
  s.slices = 30;
  const ScratchFolder a, b, c;
  s.write(a);
  s.write(b, [](int k) { return std::to_string((k * 7919 + 13) % 1009) + (k % 2 ? "/x" : ""); });
  s.drift_per_mm = {0, 0.3, 0};
  s.write(c);
  const ImportResult first = import_series(a.path(), {}), second = import_series(b.path(), {}),
                     tilted = import_series(c.path(), {});
  EXPECT_TRUE(synthetic::same_volume(first.volume, second.volume));
  EXPECT_EQ(first.report.figures, second.report.figures);
  EXPECT_EQ(first.input_sha256, second.input_sha256);
  EXPECT_EQ(hash_of_series_input(b.path(), {}), first.input_sha256);
  EXPECT_NE(tilted.input_sha256, first.input_sha256);
  const int before = thread_count();
  set_thread_count(1);
  EXPECT_TRUE(synthetic::same_volume(import_series(a.path(), {}).volume, first.volume));
  EXPECT_TRUE(synthetic::same_volume(import_series(c.path(), {}).volume, tilted.volume));
  set_thread_count(before);
}

TEST(DicomSeries, TwoThousandSlices) {
  Scan s = small();
  s.slices = 2000;
  s.step_mm = 0.5;
  const ScratchFolder folder;
  s.write(folder);
  const ImportResult r = import_series(folder.path(), {});
  EXPECT_EQ(lattice_of(r.volume).size, (std::array<int, 3>{20, 16, 2000}));
  EXPECT_NEAR(lattice_of(r.volume).spacing_mm.z, 0.5, 1e-9);
  for (const int slices : {1, 2}) {
    s.slices = slices;
    EXPECT_EQ(outcome(s).code, 65) << slices;
  }
}

TEST(DicomSeries, TheHashSeesPixelsAndGeometryButNoNames) {
  const Scan s = small();
  const auto hash = [](const Scan& scan) {
    const ScratchFolder folder;
    scan.write(folder);
    return hash_of_series_input(folder.path(), {});
  };
  const std::string first = hash(s);
  Scan other = s;
  other.uid = "9.8.7";
  other.edit = [](int, DataSet& d) { d.text(tag(0x10, 0x10), "PN", "SOMEBODY^ELSE"); };
  EXPECT_EQ(hash(other), first);
  other.edit = [](int k, DataSet& d) {
    if (k == 2) d.elements[pixels_tag].bytes[17] ^= 1;
  };
  EXPECT_NE(hash(other), first);
  other.edit = [](int k, DataSet& d) {
    if (k == 2) d.text(slope_tag, "DS", "1.5");
  };
  EXPECT_NE(hash(other), first);
}

TEST(DicomSeries, AChoiceIsAskedFor) {
  const ScratchFolder folder;
  Scan a = small(), b = small();
  a.write(folder, [](int k) { return "z" + std::to_string(k); });
  b.uid = "1.2.3.4.6";
  b.slices = 9;
  b.step_mm = 1;
  b.kernel = "CANARY";
  b.image_type = "DERIVED\\PRIMARY\\CANARY";
  b.edit = [](int, DataSet& d) { d.text(tag(0x18, 0x10), "LO", "CANARY"); };
  b.write(folder, [](int k) { return "a" + std::to_string(k); });
  const Outcome o = outcome(folder.path());
  EXPECT_EQ(o.code, 64);
  for (const char* part :
       {"s1-20x16x9: CT, 1.5 x 1.5 x 1 mm, kernel other, slice thickness 1 mm, DERIVED/PRIMARY/other, contrast",
        "s2-20x16x6: CT, 1.5 x 1.5 x 2 mm, kernel H31s, slice thickness 2 mm, ORIGINAL/PRIMARY/AXIAL, no contrast"})
    EXPECT_NE(o.line.find(part), std::string::npos) << o.line;
  EXPECT_EQ(o.line.find("CANARY"), std::string::npos);
  ImportParams p;
  p.series = "s2-20x16x6";
  EXPECT_EQ(lattice_of(import_series(folder.path(), p).volume).size[2], 6);
  p.series = "s1";
  EXPECT_EQ(lattice_of(import_series(folder.path(), p).volume).size[2], 9);
  p.series = "s3";
  EXPECT_EQ(outcome(folder.path(), p).code, 64);
  const auto list = list_series(folder.path()).series;
  ASSERT_EQ(list.size(), 2u);
  EXPECT_TRUE(list[0].usable && list[1].usable);
}

TEST(DicomSeries, OtherModalities) {
  for (const auto& [modality, sop] :
       {std::pair{"MR", "1.2.840.10008.5.1.4.1.1.4"}, std::pair{"CR", "1.2.840.10008.5.1.4.1.1.1"},
        std::pair{"CT", "1.2.840.10008.5.1.4.1.1.7"}}) {
    Scan s = small();
    s.modality = modality;
    s.sop_class = sop;
    const Outcome o = outcome(s);
    EXPECT_EQ(o.code, 65);
    EXPECT_NE(o.line.find(std::string("Modality (0008,0060): ") + modality), std::string::npos) << o.line;
    ImportParams any;
    any.modality = ModalityPolicy::any;
    EXPECT_EQ(outcome(s, any).code, 0);
  }
  Scan structures = small();
  structures.modality = "RTSTRUCT";
  structures.sop_class = "1.2.840.10008.5.1.4.1.1.481.3";
  structures.slices = 1;
  structures.edit = [](int, DataSet& d) { d.elements.erase(pixels_tag); };
  EXPECT_NE(outcome(structures).line.find("RTSTRUCT"), std::string::npos);
}

TEST(DicomSeries, DuplicatePositions) {
  Scan s = small();
  const ScratchFolder folder;
  s.write(folder);
  const ImportResult plain = import_series(folder.path(), {});
  folder.write("again.dcm", synthetic::file_bytes(s.slice(2)));
  folder.write("again2.dcm", synthetic::file_bytes(s.slice(2)));
  const ImportResult r = import_series(folder.path(), {});
  EXPECT_TRUE(synthetic::same_volume(r.volume, plain.volume));
  EXPECT_EQ(count(r.report, "duplicates_dropped_count"), 2);
  DataSet d = s.slice(2);
  d.elements[pixels_tag].bytes[40] ^= 1;
  folder.write("again.dcm", synthetic::file_bytes(d));
  const Outcome o = outcome(folder.path());
  EXPECT_EQ(o.code, 65);
  EXPECT_NE(o.line.find("different pixels"), std::string::npos) << o.line;
}

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
    const ImportResult r = import_series(folder.path(), {});
    EXPECT_EQ(std::holds_alternative<Grid<std::int16_t>>(r.volume), c.int16) << c.intercept << " " << c.high;
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
  const auto g = std::get<Grid<std::int16_t>>(import_series(folder.path(), {}).volume);
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
    const ImportResult r = import_series(folder.path(), {});
    EXPECT_EQ(count(r.report, "padding_voxels_count"), 4 * s.rows * s.slices);
    const auto& g = std::get<Grid<std::int16_t>>(r.volume);
    EXPECT_EQ(g.at(2, 5, 1), -1000);
    EXPECT_EQ(count(r.report, "below_air_voxels_count"), 0);
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
    const ImportResult kept = import_series(folder.path(), {});
    EXPECT_EQ(std::get<Grid<std::int16_t>>(kept.volume).at(5, 5, 2), metal);
    EXPECT_EQ(count(kept.report, "clamped_voxels_count"), 0);
    ImportParams p;
    p.clamp_high_hu = 3000;
    const ImportResult clamped = import_series(folder.path(), p);
    EXPECT_EQ(std::get<Grid<std::int16_t>>(clamped.volume).at(5, 5, 2), 3000);
    EXPECT_EQ(count(clamped.report, "clamped_voxels_count"), s.slices);
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
  EXPECT_TRUE(synthetic::same_volume(import_series(a.path(), {}).volume, import_series(b.path(), {}).volume));
}

TEST(DicomParams, AreDeclared) {
  const ParameterSet& set = parameters_of<ImportParams>();
  EXPECT_EQ(set.names(),
            (std::vector<std::string>{"series", "modality", "gaps", "max_gap_mm", "clamp_low_hu", "clamp_high_hu"}));
}

TEST(DicomCancel, IsHeard) {
  const ScratchFolder folder;
  small().write(folder);
  std::atomic<bool> cancel{true};
  EXPECT_THROW(import_series(folder.path(), {}, Progress(nullptr, &cancel)), Cancelled);
}

}  // namespace
}  // namespace trephine
