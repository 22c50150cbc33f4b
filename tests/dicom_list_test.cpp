// SPDX-License-Identifier: GPL-3.0-or-later
// The list's verdict is what import then does, for every series, and nothing of the patient is in it (P1).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "base/error.h"
#include "dicom/import.h"
#include "dicom_import_samples.h"

namespace trephine {
namespace {

using synthetic::DataSet;
using synthetic::Scan;
using synthetic::tag;

/// Imports every series that the list names and compares. Returns how many there were.
int expect_agreement(const std::filesystem::path& folder, dicom::ImportParams params = {}) {
  dicom::SeriesList list;
  try {
    list = dicom::list_series(folder, params);
  } catch (const Error& e) {
    try {
      dicom::import_series(folder, params);
      ADD_FAILURE() << folder << " was not listed but read";
    } catch (const Error& f) {
      EXPECT_EQ(e.line(""), f.line(""));
    }
    return 0;
  }
  for (const dicom::SeriesSummary& s : list.series) {
    params.series = s.token;
    try {
      const dicom::ImportResult r = dicom::import_series(folder, params);
      EXPECT_TRUE(s.usable) << folder << " " << s.token << ": " << s.verdict << ", but it was read";
      EXPECT_EQ(std::get<bool>(*r.report().find("resampled")), !s.rectified_for.empty());
      // A slab that was scanned again is read where its token is given, and says of which series it is a part.
      const std::string verdict = s.rectified_for.empty() ? "usable" : "usable, rectified: " + s.rectified_for;
      EXPECT_EQ(s.verdict.substr(0, s.verdict.find(", but scans only a part of ")), verdict);
      if (!s.rectified_for.empty()) {
        EXPECT_EQ(std::get<std::string>(*r.report().find("resampled_for")), s.rectified_for);
      }
      EXPECT_EQ(std::get<double>(*r.report().find("tilt_deg")), s.tilt_deg);
      EXPECT_EQ(std::get<double>(*r.report().find("largest_gap_mm")), s.largest_gap_mm);
    } catch (const Error& e) {
      EXPECT_FALSE(s.usable) << folder << " " << s.token << ": " << e.line("import");
      EXPECT_EQ(s.verdict, "refused: " + e.field() + ": " + e.what()) << folder;
    }
  }
  return static_cast<int>(list.series.size());
}

Scan scan() {
  Scan s;
  s.columns = 24;
  s.rows = 20;
  s.slices = 12;
  s.blobs = synthetic::four_blobs(8, 3);
  return s;
}

std::string verdict_of(const Scan& s, const dicom::ImportParams& params = {}) {
  const ScratchFolder folder;
  s.write(folder);
  expect_agreement(folder.path(), params);
  return dicom::list_series(folder.path(), params).series.at(0).verdict;
}

TEST(DicomList, VerdictsOfEveryKind) {
  Scan s = scan();
  EXPECT_EQ(verdict_of(s), "usable");
  s.drift_per_mm = s.v * std::tan(18.5 * M_PI / 180);
  EXPECT_EQ(verdict_of(s), "usable, rectified: tilt");
  s = scan();
  s.along_mm = {0, 2, 4, 6, 8, 12, 14, 16, 18};
  EXPECT_NE(verdict_of(s).find("a gap of 4.000 mm"), std::string::npos);
  dicom::ImportParams interpolate;
  interpolate.gaps = dicom::GapPolicy::interpolate;
  EXPECT_EQ(verdict_of(s, interpolate), "usable, rectified: missing slices");
  s.along_mm = {0, 2, 4, 6, 8, 8, 10, 12, 14};
  s.stored = [](int i, int j, int k) -> std::optional<std::int64_t> { return k == 4 || k == 5 ? i + j : 7; };
  EXPECT_EQ(verdict_of(s), "usable");
  s.stored = [](int i, int j, int k) -> std::optional<std::int64_t> { return k == 5 ? i + j : 7; };
  EXPECT_NE(verdict_of(s).find("refused: ImagePositionPatient (0020,0032): two slices at one position"),
            std::string::npos);
  s = scan();
  s.slices = 2;
  EXPECT_NE(verdict_of(s).find("at least 3"), std::string::npos);
  s = scan();
  s.modality = "MR";
  s.sop_class = "1.2.840.10008.5.1.4.1.1.4";
  EXPECT_NE(verdict_of(s).find("Modality"), std::string::npos);
  s = scan();
  s.edit = [](int k, DataSet& d) {
    if (k == 3) d.text(tag(0x0028, 0x1053), "DS", "0");
  };
  EXPECT_NE(verdict_of(s).find("RescaleSlope"), std::string::npos);
}

// Compressed streams are looked at without decoding: their size, their end, RLE counts.
TEST(DicomList, CompressedStreams) {
  for (int damage = 0; damage < 4; ++damage) {
    Scan s = scan();
    s.syntax = "1.2.840.10008.1.2.5";
    s.edit = [&](int k, DataSet& d) {
      auto& pixels = d.elements[tag(0x7fe0, 0x0010)];
      const std::size_t count = pixels.bytes.size();
      std::string stream = synthetic::rle_stream(pixels.bytes);
      if (k == 5 && damage == 1) stream.resize(stream.size() - count / 2);
      if (k == 5 && damage == 2) stream[0] = 3;
      if (k == 5 && damage == 3) stream += std::string((1 << 20) + 4 * count, '\0');
      pixels = synthetic::encapsulated(stream);
    };
    const std::string verdict = verdict_of(s);
    if (damage == 0)
      EXPECT_EQ(verdict, "usable");
    else
      EXPECT_EQ(verdict.find("refused: PixelData (7FE0,0010): "), 0u) << damage << ": " << verdict;
  }
}

TEST(DicomList, WhatIsMeasured) {
  Scan s = scan();
  s.u = {0, 1, 0};
  s.v = {0, 0, -1};
  const ScratchFolder folder;
  s.write(folder);
  const dicom::SeriesSummary a = dicom::list_series(folder.path()).series.at(0);
  EXPECT_EQ(a.orientation, "sagittal HFS");
  EXPECT_EQ(a.size, (std::array<int, 3>{24, 20, 12}));
  EXPECT_EQ(a.kernel, "H31s");
  EXPECT_EQ(a.transfer_syntax, "explicit VR little endian");
  Scan t = scan();
  t.drift_per_mm = t.v * std::tan(-25 * M_PI / 180);
  const ScratchFolder tilted;
  t.write(tilted);
  const dicom::SeriesSummary b = dicom::list_series(tilted.path()).series.at(0);
  EXPECT_NEAR(b.tilt_deg, -25, 1e-6);
  EXPECT_EQ(b.orientation, "axial HFS");
}

// P1: canaries in every text that a file of ours can hold, in private tags and in names, are in no list.
TEST(DicomList, SaysNothingOfThePatient) {
  Scan s = scan();
  s.uid = "1.2.826.77777";
  s.kernel = "CANARYKERNEL";
  s.image_type = "ORIGINAL\\CANARYTYPE";
  s.edit = [](int k, DataSet& d) {
    for (const auto& [t, vr] : {std::pair{tag(0x0008, 0x0080), "LO"},
                                {tag(0x0008, 0x1030), "LO"},
                                {tag(0x0008, 0x103e), "LO"},
                                {tag(0x0010, 0x0020), "LO"},
                                {tag(0x0018, 0x0010), "LO"},
                                {tag(0x0020, 0x4000), "LT"},
                                {tag(0x0009, 0x1001), "LO"},
                                {tag(0x0018, 0x0060), "DS"},
                                {tag(0x0018, 0x5100), "CS"}})
      d.text(t, vr, "CANARY");
    if (k == 3) d.text(tag(0x0028, 0x0030), "DS", "CANARY");
  };
  const ScratchFolder folder;
  s.write(folder, [](int k) { return "CANARY^NAME/CANARY" + std::to_string(k); });
  folder.write("CANARY^NAME/CANARY.txt", "CANARY");
  const dicom::SeriesList list = dicom::list_series(folder.path());
  EXPECT_FALSE(list.series.at(0).usable);
  for (const std::string& text : {dicom::list_text(list), dicom::list_json(list)}) {
    EXPECT_EQ(text.find("CANARY"), std::string::npos) << text;
    EXPECT_EQ(text.find("77777"), std::string::npos) << text;
    EXPECT_NE(text.find("PixelSpacing"), std::string::npos) << text;
  }
}

// A tag that is absent, or empty, is no "no": a scan with contrast agent may lack it.
TEST(DicomList, ContrastThatIsNotToldIsNoNo) {
  using Row = std::tuple<const char*, const char*, const char*>;
  for (const auto& [agent, said, as_json] : {Row{nullptr, "not told", "null"},
                                             {"", "not told", "null"},
                                             {"UNKNOWN", "not told", "null"},
                                             {"APPLIED", "yes", "true"},
                                             {"CANARY 300 ml", "yes", "true"},
                                             {"-", "not told", "null"},
                                             {"NONE", "no", "false"},
                                             {"W/O", "no", "false"},
                                             {"ohne KM", "no", "false"},
                                             {"no contrast", "no", "false"}}) {
    Scan s = import_samples::small();
    if (agent) s.edit = [agent = agent](int, DataSet& d) { d.text(tag(0x18, 0x10), "LO", agent); };
    const ScratchFolder folder;
    s.write(folder);
    const dicom::SeriesList list = dicom::list_series(folder.path());
    const std::string text = dicom::list_text(list), json = dicom::list_json(list);
    EXPECT_NE(text.find(said), std::string::npos) << (agent ? agent : "absent") << ": " << text;
    EXPECT_EQ(text.find("not told") != std::string::npos, said == std::string("not told")) << text;
    EXPECT_NE(json.find("\"contrast\": " + std::string(as_json) + ","), std::string::npos) << json;
    const Report report = dicom::import_series(folder.path(), {}).report();
    EXPECT_EQ(std::get<std::string>(*report.find("contrast")), said) << (agent ? agent : "absent");
  }
}

std::filesystem::path data() {
  const char *own = std::getenv("TREPHINE_DATA"), *home = std::getenv("HOME");
  return own ? own : std::string(home ? home : "") + "/.cache/trephine-data";
}

// Every folder of the real data that holds files: list and import agree on every series.
TEST(DicomList, AgreesWithImportOnRealScans) {
  if (!std::filesystem::exists(data())) GTEST_SKIP() << "no real data at " << data();
  std::vector<std::filesystem::path> folders;
  for (std::filesystem::recursive_directory_iterator it(data()), end; it != end; ++it) {
    if (it->path().filename() == "bad_meshes") it.disable_recursion_pending();
    if (!it->is_directory()) continue;
    const std::filesystem::directory_iterator files(it->path());
    if (std::any_of(begin(files), std::filesystem::directory_iterator(),
                    [](const auto& e) { return e.is_regular_file(); }))
      folders.push_back(it->path());
  }
  int series = 0;
  for (const auto& folder : folders) series += expect_agreement(folder);
  EXPECT_GE(series, 20);
}

}  // namespace
}  // namespace trephine
