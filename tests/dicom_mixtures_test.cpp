// SPDX-License-Identifier: GPL-3.0-or-later
// Series that are not one, values that are no HU, and slices that would vanish: refused, parted, or told of.
#include <gtest/gtest.h>

#include <algorithm>

#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;
using synthetic::file_bytes;

constexpr auto patient_tag = tag(0x10, 0x20), study_tag = tag(0x20, 0x0d), frame_tag = tag(0x20, 0x52),
               acquisition_tag = tag(0x20, 0x12), kernel_tag = tag(0x18, 0x1210), kvp_tag = tag(0x18, 0x60),
               rescale_type_tag = tag(0x28, 0x1054), burned_in_tag = tag(0x28, 0x301), rows_tag = tag(0x28, 0x10);

Scan longer() {
  Scan s = small();
  s.slices = 12;
  return s;
}
/// Slices 0, 2, 4, ... with one text, the others with another.
Scan alternating(std::uint32_t t, const std::string& vr) {
  Scan s = longer();
  s.edit = [=](int k, DataSet& d) { d.text(t, vr, "1.2.33." + std::to_string(k % 2)); };
  return s;
}
std::vector<dicom::SeriesSummary> listed(const Scan& scan) {
  const ScratchFolder folder;
  scan.write(folder);
  return dicom::list_series(folder.path()).series;
}
bool warns(const Report& r, const std::string& what) {
  return std::any_of(r.warnings.begin(), r.warnings.end(),
                     [&](const std::string& w) { return w.find(what) != std::string::npos; });
}

TEST(DicomMixtures, OtherUnitsThanHuAreRefused) {
  for (const char* unit : {"US", "ED", "OD", "Z_EFF", "something of a person"}) {
    Scan s = small();
    s.edit = [=](int k, DataSet& d) {
      if (k == 3) d.text(rescale_type_tag, "LO", unit);
    };
    const Refused o = outcome(s);
    EXPECT_EQ(o.code, 65) << unit;
    EXPECT_NE(o.line.find("RescaleType"), std::string::npos) << o.line;
    EXPECT_EQ(o.line.find("person"), std::string::npos) << o.line;
  }
  Scan s = small();
  s.edit = [](int, DataSet& d) { d.text(rescale_type_tag, "LO", "HU"); };
  EXPECT_EQ(outcome(s).code, 0);
  s.edit = [](int, DataSet& d) { d.text(rescale_type_tag, "LO", "US"); };
  dicom::ImportParams params;
  params.units = dicom::UnitPolicy::any;
  EXPECT_EQ(outcome(s, params).code, 0);
}

TEST(DicomMixtures, WhatIsNotOneSeriesIsParted) {
  for (const auto& [t, vr] : {std::pair<std::uint32_t, const char*>{study_tag, "UI"},
                              {frame_tag, "UI"},
                              {acquisition_tag, "LO"},
                              {kernel_tag, "SH"}}) {
    Scan s = alternating(t, vr);
    if (t == kernel_tag) s.edit = [=](int k, DataSet& d) { d.text(kernel_tag, "SH", k % 2 ? "H31s" : "H70h"); };
    const auto series = listed(s);
    ASSERT_EQ(series.size(), 2u) << std::hex << t;
    EXPECT_EQ(series[0].size[2], 6);
    EXPECT_EQ(series[1].size[2], 6);
    EXPECT_EQ(outcome(s).code, 64) << "a choice is needed";
  }
  // Slabs of several acquisitions one after the other are one series, and so is one whose anonymiser gave every slice a
  // frame of its own.
  Scan slabs = longer();
  slabs.edit = [](int k, DataSet& d) { d.text(acquisition_tag, "IS", std::to_string(k / 4)); };
  EXPECT_EQ(listed(slabs).size(), 1u);
  for (const std::uint32_t t : {frame_tag, study_tag, patient_tag}) {
    Scan own = longer();
    own.edit = [=](int k, DataSet& d) { d.text(t, "UI", "1.2." + std::to_string(k)); };
    EXPECT_EQ(listed(own).size(), 1u);
    const ScratchFolder folder;
    own.write(folder);
    EXPECT_TRUE(warns(dicom::import_series(folder.path(), {}).report(), t == patient_tag
                                                                            ? "PatientID is another one in most slices"
                                                                            : "changes within the series, 12 values"));
  }
}

TEST(DicomMixtures, ChangesWithinASeriesAndUnusualValuesAreTold) {
  const auto told = [](const std::function<void(int, DataSet&)>& edit, const std::string& what) {
    const ScratchFolder folder;
    Scan s = longer();
    s.edit = edit;
    s.write(folder);
    const Report r = dicom::import_series(folder.path(), {}).report();
    EXPECT_TRUE(warns(r, what)) << what;
  };
  told([](int k, DataSet& d) { d.text(slope_tag, "DS", k == 3 ? "2" : "1"); },
       "RescaleSlope changes within the series");
  told([](int k, DataSet& d) { d.text(intercept_tag, "DS", k == 3 ? "-1000" : "-1024"); }, "RescaleIntercept changes");
  told([](int k, DataSet& d) { d.text(kernel_tag, "SH", k > 5 ? "H31s" : "H70h"); }, "ConvolutionKernel changes");
  told([](int k, DataSet& d) { d.text(kvp_tag, "DS", k == 3 ? "80" : "120"); }, "KVP changes");
  told([](int k, DataSet& d) { d.text(tag(0x18, 0x10), "LO", k == 3 ? "X" : ""); }, "ContrastBolusAgent changes");
  told([](int k, DataSet& d) { d.text(tag(0x18, 0x5100), "CS", k == 3 ? "FFS" : "HFS"); }, "PatientPosition changes");
  told([](int, DataSet& d) { d.text(slope_tag, "DS", "-1"); }, "bright and dark are exchanged");
  told([](int, DataSet& d) { d.text(intercept_tag, "DS", "5000"); }, "RescaleIntercept is 5000");
  told([](int, DataSet& d) { d.text(tag(8, 8), "CS", "DERIVED\\SECONDARY\\MIP"); }, "projections (MIP)");
  told([](int, DataSet& d) { d.text(slope_tag, "DS", "40"); }, "are these HU?");
  const ScratchFolder folder;
  longer().write(folder);
  EXPECT_TRUE(dicom::import_series(folder.path(), {}).report().warnings.empty());
}

TEST(DicomMixtures, AnOddSliceIsNamedAsWhatItIs) {
  const auto said = [](const std::function<void(DataSet&)>& change, int at = 5) {
    Scan s = longer();
    s.edit = [=](int k, DataSet& d) {
      if (k == at) change(d);
    };
    const Refused o = outcome(s);
    EXPECT_EQ(o.code, at == 5 ? 65 : 0) << o.line;
    EXPECT_EQ(o.line.find("missing"), std::string::npos) << o.line;
    return o.line;
  };
  const auto has = [](const std::string& line, const char* what) { return line.find(what) != std::string::npos; };
  EXPECT_TRUE(has(said([](DataSet& d) { d.number(rows_tag, 15); }), "20 x 15, the others have 20 x 16"));
  EXPECT_TRUE(has(said([](DataSet& d) { d.text(spacing_tag, "DS", "1.4\\1.5"); }), "1.5 x 1.4 mm, the others have"));
  EXPECT_TRUE(has(said([](DataSet& d) { d.text(orientation_tag, "DS", "1\\0\\0\\0\\0.99939\\0.0349"); }), "turned by"));
  EXPECT_TRUE(has(said([](DataSet& d) { d.text(patient_tag, "LO", "CANARY"); }), "of several patients"));
  EXPECT_EQ(said([](DataSet& d) { d.text(patient_tag, "LO", "CANARY"); }).find("CANARY"), std::string::npos);
}

TEST(DicomMixtures, ASliceAtTheEndThatVanishesIsToldOf) {
  const auto folder_report = [](const std::function<std::string(std::string)>& change,
                                const std::function<void(DataSet&)>& edit = nullptr) {
    const ScratchFolder folder;
    Scan s = longer();
    s.edit = [&](int k, DataSet& d) {
      if (k == 11 && edit) edit(d);
    };
    s.write(folder);
    if (change) folder.write("slice1011.dcm", change(file_bytes(s.slice(11))));
    return printed(dicom::import_series(folder.path(), {}).folder);
  };
  EXPECT_TRUE(folder_report(nullptr).warnings.empty());
  EXPECT_TRUE(warns(folder_report([](std::string b) { return b.substr(0, 140) + std::string(200, 'x'); }),
                    "file 12 of 12 (by name) is DICOM and was left out"));
  EXPECT_TRUE(warns(folder_report([](std::string b) { return std::string(400, 'x') + b.substr(300); }),
                    "file 12 of 12 (by name) is DICOM and was left out"))
      << "it holds the series' UID";
  EXPECT_TRUE(
      warns(folder_report([](const std::string&) { return std::string(); }), "1 empty file, the first is number 12"));
  for (const std::size_t size : {1, 100, 127, 131, 132})
    EXPECT_TRUE(warns(folder_report([&](const std::string& b) { return b.substr(0, size); }),
                      "file 12 of 12 (by name) is DICOM and was left out"))
        << "an end slice of which " << size << " bytes are left";
  EXPECT_TRUE(warns(folder_report([](const std::string& b) { return std::string(b.size(), 'x'); }),
                    "file 12 of 12 (by name) is DICOM and was left out"))
      << "nothing is left of it but its name";
  EXPECT_TRUE(warns(folder_report(nullptr, [](DataSet& d) { d.text(tag(8, 0x60), "CS", "MR"); }), "beyond an end"));
  EXPECT_TRUE(warns(folder_report(nullptr, [](DataSet& d) { d.number(rows_tag, 15); }), "20 x 15"));
}

TEST(DicomMixtures, WhatFollowsThePixelsMayNotContradict) {
  const auto code = [](const std::function<std::string(std::string)>& change) {
    const ScratchFolder folder;
    const Scan s = longer();
    s.write(folder);
    folder.write("slice1005.dcm", change(file_bytes(s.slice(5))));
    return outcome(folder.path());
  };
  DataSet rows, padding, pixels;
  rows.number(rows_tag, 16);
  padding.elements[tag(0xfffc, 0xfffc)] = {"OB", std::string(20, 'p'), {}};
  pixels.elements[pixels_tag] = {"OW", std::string(20 * 16 * 2, 'p'), {}};
  const std::string own = file_bytes(longer().slice(5));
  EXPECT_EQ(code([](const std::string& b) { return b; }).code, 0);
  EXPECT_EQ(code([&](const std::string& b) { return b + padding.bytes(); }).code, 0);
  EXPECT_EQ(code([](const std::string& b) { return b + std::string(1000, '\0'); }).code, 0) << "padded to a block";
  for (const std::string& more :
       {rows.bytes(), padding.bytes() + rows.bytes(), pixels.bytes(), own, padding.bytes() + own}) {
    const Refused o = code([&](const std::string& b) { return b + more; });
    EXPECT_EQ(o.code, 65) << o.line;
    EXPECT_NE(o.line.find("scan: file 6 of 12 ("), std::string::npos) << o.line;
  }
}

TEST(DicomMixtures, PixelsThatHoldTextNeedAReason) {
  const ScratchFolder folder;
  Scan s = small();
  s.edit = [](int k, DataSet& d) { d.text(burned_in_tag, "CS", k == 2 ? "YES" : "NO"); };
  s.write(folder);
  const Refused o = outcome(folder.path());
  EXPECT_EQ(o.code, 81);
  EXPECT_NE(o.line.find("BurnedInAnnotation"), std::string::npos) << o.line;
  EXPECT_NE(dicom::list_series(folder.path()).series.at(0).verdict.find("refused: BurnedInAnnotation"),
            std::string::npos);
  dicom::ImportParams params;
  params.burned_in_reason = "only the scanner's logo";
  const Report r = dicom::import_series(folder.path(), params).report();
  ASSERT_TRUE(r.find("burned_in_reason"));
  EXPECT_EQ(std::get<std::string>(*r.find("burned_in_reason")), "only the scanner's logo");
}

}  // namespace
}  // namespace trephine
