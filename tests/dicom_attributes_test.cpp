// SPDX-License-Identifier: GPL-3.0-or-later
// Every attribute that says what pixels mean or where they lie, changed in one slice (first, middle, last) and in all:
// a series is refused, or read as it was, or told of (dicom/attributes.h).
#include "dicom/attributes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "dicom/header_tags.h"
#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using dicom::Attribute;
using dicom::AttributeRule;
using synthetic::DataSet;

constexpr int slices = 12;

Scan plain() {
  Scan s = small();
  s.slices = slices;
  s.background_hu = -6;
  return s;
}

void set_value(DataSet& d, std::uint32_t t, const std::string& vr, const std::string& value) {
  if (vr == "US" || vr == "SS")
    d.elements[t] = {vr, synthetic::little(static_cast<std::uint64_t>(std::stoll(value)), 2), {}};
  else if (vr == "FD" || vr == "FL")
    d.elements[t] = {vr, std::string(vr == "FD" ? 8 : 4, value[0]), {}};
  else
    d.text(t, vr == "UR" ? "UT" : vr, value);
}

/// Values that are well-formed, and not what the series has.
std::vector<std::string> values_of(const Attribute& a) {
  switch (a.tag) {
    case dicom::t_image_type:
      return {"DERIVED\\SECONDARY\\AXIAL", "ORIGINAL\\PRIMARY\\LOCALIZER", "DERIVED\\PRIMARY\\MPR"};
    case dicom::t_sop_class:
      return {"1.2.840.10008.5.1.4.1.1.4", "1.2.840.10008.5.1.4.1.1.7", "1.2.3.4"};
    case dicom::t_modality:
      return {"MR", "PT"};
    case dicom::t_position:
      return {"0\\0\\0", "-14.25\\-11.25\\500"};
    case dicom::t_orientation:
      return {"0\\1\\0\\1\\0\\0", "1\\0\\0\\0\\-1\\0"};
    case dicom::t_spacing:
      return {"1.5\\1.4", "3\\3"};
    case dicom::t_aspect:
      return {"2\\1"};
    case dicom::t_rows:
      return {"15"};
    case dicom::t_columns:
      return {"19"};
    case dicom::t_samples:
      return {"3"};
    case dicom::t_photometric:
      return {"MONOCHROME1", "PALETTE COLOR"};
    case dicom::t_allocated:
      return {"8"};
    case dicom::t_stored:
      return {"12"};
    case dicom::t_high_bit:
      return {"11"};
    case dicom::t_representation:
      return {"1"};
    case dicom::t_padding:
    case dicom::t_padding_limit:
      return {"1018", "0"};
    case dicom::t_burned_in:
    case dicom::t_quality:
      return {"YES"};
    case dicom::t_lossy:
      return {"01"};
    case dicom::t_slope:
      return {"2", "-1"};
    case dicom::t_intercept:
      return {"-1000", "0"};
    case dicom::t_rescale_type:
      return {"HU", "US"};
    case dicom::t_patient_position:
      return {"FFS", "HFP"};
    default:
      if (std::string(a.vr) == "DS" || std::string(a.vr) == "IS") return {"3", "77.5"};
      if (std::string(a.vr) == "US" || std::string(a.vr) == "SS") return {"3"};
      if (std::string(a.vr) == "DA") return {"20200203"};
      return {"CANARY", "1.2.3.9"};
  }
}

struct Read {
  Refused outcome;
  std::optional<grid::HuVolume> volume;
  std::string told;
};
Read read(const Scan& scan) {
  const ScratchFolder folder;
  scan.write(folder);
  Read r;
  try {
    dicom::ImportResult result = dicom::import_series(folder.path(), {});
    r.volume = std::move(result.volume);
    for (const Warnings* all : {&result.warnings, &result.folder.warnings})
      for (const Warning& w : *all) r.told += to_text(w) + "\n";
  } catch (const Error& e) {
    r.outcome = {static_cast<int>(e.code()), e.line("import")};
  }
  return r;
}

TEST(DicomAttributes, TheTableOfTheDocsIsTheOneOfTheCode) {
  std::ifstream file(std::string(TREPHINE_SOURCE_DIR) + "/docs/reference/dicom.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find(dicom::attributes_table()), std::string::npos)
      << "docs/reference/dicom.md must hold this table:\n"
      << dicom::attributes_table();
}

TEST(DicomAttributes, OneSliceThatSaysOtherwiseIsNeverReadInSilence) {
  const Read good = read(plain());
  ASSERT_TRUE(good.volume) << good.outcome.line;
  ASSERT_EQ(good.told, "");
  int tries = 0;
  for (const Attribute& a : dicom::attributes())
    for (const std::string& value : values_of(a)) {
      if (std::string(a.vr) == "SQ") continue;  // below
      for (const int at : {0, slices / 2, slices - 1, -1}) {
        Scan s = plain();
        s.edit = [&](int k, DataSet& d) {
          if (at == -1 || at == k) set_value(d, a.tag, a.vr, value);
        };
        const Read r = read(s);
        ++tries;
        const std::string what = std::string(a.keyword) + " = " + value + " in slice " + std::to_string(at);
        EXPECT_EQ((r.outcome.line + r.told).find("CANARY"), std::string::npos) << what;
        if (!r.volume) {
          EXPECT_TRUE(r.outcome.code == 64 || r.outcome.code == 65 || r.outcome.code == 81) << what << r.outcome.line;
          EXPECT_TRUE(a.rule != AttributeRule::told || a.tag == dicom::t_rescale_type || value.find("LOCALIZER") < 99)
              << what << ": " << r.outcome.line;
          continue;
        }
        if (at == -1) continue;  // all slices say the same: it is what they are, or refused
        const bool same = synthetic::same_volume(*r.volume, *good.volume);
        if (a.rule == AttributeRule::own && a.tag != dicom::t_position) {
          EXPECT_TRUE(same && r.told.empty()) << what << ": " << r.told;
        } else {
          EXPECT_NE(r.told, "") << what << (same ? ", read as before" : ", another volume") << ", and nothing is told";
        }
      }
    }
  EXPECT_GT(tries, 300);
}

TEST(DicomAttributes, WhatCannotBeReadAlikeIsRefusedAndTheRemedyWorks) {
  // Seven bits do not hold what the slice has.
  for (const auto& [t, value] : {std::pair<std::uint32_t, unsigned>{dicom::t_representation, 1}, {dicom::t_stored, 7}})
    for (const int at : {0, slices / 2, slices - 1}) {
      const ScratchFolder folder;
      Scan s = plain();
      s.edit = [&, tag = t, to = value](int k, DataSet& d) {
        if (k != at) return;
        d.number(tag, to);
        if (tag == dicom::t_stored) d.number(dicom::t_high_bit, to - 1);
      };
      s.write(folder);
      const Refused o = outcome(folder.path());
      EXPECT_EQ(o.code, 65);
      const bool of_bits = t == dicom::t_stored;
      EXPECT_NE(o.line.find(of_bits ? "pixels have more bits" : "this one in 1 of 12 slices"), std::string::npos)
          << o.line;
      dicom::ImportParams params;
      EXPECT_EQ(dicom::list_series(folder.path()).series.at(0).usable, of_bits);  // no list reads pixels
      // The remedy to the letter: the file taken out, and the gap, where one is left, interpolated.
      std::filesystem::remove(folder.path() / ("slice" + std::to_string(1000 + at) + ".dcm"));
      if (at == slices / 2) params.gaps = dicom::GapPolicy::interpolate;
      EXPECT_EQ(outcome(folder.path(), params).code, 0) << outcome(folder.path(), params).line;
    }
}

// CERR stores 12 bits a pixel, and 13 in slices with metal.
TEST(DicomAttributes, BitsThatAreStoredMayDifferWhereTheyChangeNoPixel) {
  Scan s = plain();
  const Read alike = read(s);
  s.edit = [](int k, DataSet& d) {
    if (k % 5 != 2) return;
    d.number(dicom::t_stored, 13);
    d.number(dicom::t_high_bit, 12);
  };
  const Read differing = read(s);
  ASSERT_TRUE(alike.volume && differing.volume) << differing.outcome.line;
  EXPECT_NE(differing.told.find("BitsStored changes within the series, 2 values"), std::string::npos) << differing.told;
  EXPECT_TRUE(synthetic::same_volume(*alike.volume, *differing.volume));
}

TEST(DicomAttributes, AModalityLutIsRefused) {
  for (const bool whole : {true, false}) {
    Scan s = plain();
    s.edit = [&](int k, DataSet& d) {
      DataSet lut;
      lut.number(tag(0x28, 0x3002), 7);
      const std::string inner = lut.bytes();
      if (k == 3 || whole)
        d.elements[tag(0x28, 0x3000)] = {
            "SQ", synthetic::little(0xe000fffe, 4) + synthetic::little(inner.size(), 4) + inner, {}};
    };
    const Refused o = outcome(s);
    EXPECT_EQ(o.code, 65);
    EXPECT_NE(o.line.find("ModalityLUTSequence"), std::string::npos) << o.line;
  }
}

}  // namespace
}  // namespace trephine
