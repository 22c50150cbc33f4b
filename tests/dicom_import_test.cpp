// SPDX-License-Identifier: GPL-3.0-or-later
// What an import refuses and what it passes over: D1 to D6, D9, D10, D20, P1 for messages.
#include <gtest/gtest.h>

#include <atomic>

#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;

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
  const Refused o = outcome(s);
  EXPECT_EQ(o.code, 65) << o.line;
  EXPECT_NE(o.line.find(field), std::string::npos) << o.line;
  EXPECT_NE(o.line.find("scan: file 4 of 6 ("), std::string::npos) << o.line;
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
  const grid::Lattice l = grid::lattice_of(dicom::import_series(folder.path(), {}).volume);
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
      const Refused o = outcome(folder.path());
      EXPECT_EQ(o.code, 65);
      EXPECT_TRUE(o.line.find("scan: file 4 of 6 (") < o.line.find("): PixelData")) << o.line;
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
      const Refused o = outcome(path);
      EXPECT_EQ(o.code, 65);
      EXPECT_NE(o.line.find("scan ("), std::string::npos) << o.line;
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
    const Refused o = outcome(folder.path());
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
  const dicom::ImportResult plain = dicom::import_series(folder.path(), {});
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
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});
  EXPECT_TRUE(synthetic::same_volume(r.volume, plain.volume));
  EXPECT_EQ(r.input_sha256, plain.input_sha256);
  EXPECT_EQ(r.report().figures, plain.report().figures);
  EXPECT_EQ(count(printed(r.folder), "skipped_not_dicom_count"), 3);
  EXPECT_EQ(count(printed(r.folder), "skipped_broken_count"), 2);
  EXPECT_EQ(count(printed(r.folder), "skipped_hidden_count"), 1);
  EXPECT_EQ(count(printed(r.folder), "localizers_count"), 2);
  EXPECT_EQ(count(printed(r.folder), "other_series_count"), 1);
}

TEST(DicomFiles, UnsupportedSyntaxesByName) {
  for (const auto& [uid, name] :
       {std::pair{"1.2.840.10008.1.2.2", "big endian"}, std::pair{"1.2.840.10008.1.2.1.99", "deflated"},
        std::pair{"1.2.840.10008.1.2.4.201", "high-throughput"}}) {
    Scan s = small();
    s.syntax = uid;
    const Refused o = outcome(s);
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
  EXPECT_TRUE(
      synthetic::same_volume(dicom::import_series(a.path(), {}).volume, dicom::import_series(b.path(), {}).volume));
}

TEST(DicomParams, AreDeclared) {
  const ParameterSet& set = parameters_of<dicom::ImportParams>();
  EXPECT_EQ(set.names(),
            (std::vector<std::string>{"series", "series_rule", "modality", "units", "volume_values", "gaps",
                                      "max_gap_mm", "offset_hu", "axes", "orientation_reason", "clamp_low_hu",
                                      "clamp_high_hu", "burned_in_reason", "same_patient_reason"}));
}

TEST(DicomCancel, IsHeard) {
  const ScratchFolder folder;
  small().write(folder);
  std::atomic<bool> cancel{true};
  EXPECT_THROW(dicom::import_series(folder.path(), {}, Progress(nullptr, &cancel)), Cancelled);
}

}  // namespace
}  // namespace trephine
