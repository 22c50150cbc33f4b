// SPDX-License-Identifier: GPL-3.0-or-later
// List and import agree on which series can be used, and propose one by one rule.
#include <gtest/gtest.h>

#include "dicom/values.h"
#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;

Scan named(int number) {
  Scan s = small();
  s.uid = "1.2.3.4." + std::to_string(number);
  s.slices = 9;
  return s;
}

class Folder {
 public:
  void add(const Scan& s) {
    const int number = ++count_;
    s.write(folder_, [number](int k) { return std::to_string(number) + "/" + std::to_string(k); });
  }
  const std::filesystem::path& path() const { return path_; }
  dicom::SeriesSummary proposed() const {
    std::vector<dicom::SeriesSummary> all;
    for (const auto& s : dicom::list_series(path()).series)
      if (s.proposed) all.push_back(s);
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? dicom::SeriesSummary() : all.front();
  }
  /// How many slices the series has that --series-rule best reads.
  int best() const {
    dicom::ImportParams p;
    p.series_rule = dicom::SeriesRule::best;
    return static_cast<int>(count(dicom::import_series(path(), p).report(), "slices_count"));
  }

 private:
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_.path();
  int count_ = 0;
};

TEST(DicomChoice, WhatTheListRefusesIsNoChoice) {
  Folder folder;
  folder.add(named(1));
  Scan gap = named(2);
  gap.along_mm = {0, 2, 4, 6, 8, 10, 12, 16, 18, 20, 22, 24};
  gap.slices = 12;
  folder.add(gap);
  const auto list = dicom::list_series(folder.path()).series;
  ASSERT_EQ(list.size(), 2u);
  EXPECT_NE(list[0].usable, list[1].usable);
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});
  EXPECT_EQ(count(r.report(), "slices_count"), 9);
  EXPECT_EQ(dicom::hash_of_series_input(folder.path(), {}), r.input_sha256);
  ASSERT_EQ(printed(r.folder).warnings.size(), 1u);
  EXPECT_NE(printed(r.folder).warnings[0].find("not used: s1"), std::string::npos) << printed(r.folder).warnings[0];
  EXPECT_NE(printed(r.folder).warnings[0].find("a slice is missing"), std::string::npos)
      << printed(r.folder).warnings[0];
}

TEST(DicomChoice, WhereTheListRefusesAllImportSaysWhy) {
  Folder folder;
  for (int n = 1; n <= 2; ++n) {
    Scan gap = named(n);
    gap.along_mm = {0, 2, 4, 6, 8, 10, 12, 16, 18, 20, 22, 24};
    gap.slices = 12;
    folder.add(gap);
  }
  const Refused o = outcome(folder.path());
  EXPECT_EQ(o.code, 65);
  EXPECT_NE(o.line.find("a slice is missing"), std::string::npos) << o.line;
}

// Each scan of a pair would win but for the one property that is tried.
TEST(DicomChoice, TheRule) {
  struct Pair {
    const char* what;
    std::function<void(Scan& good, Scan& bad)> make;
  };
  const std::vector<Pair> pairs = {
      {"an axial one before a coronal reformat",
       [](Scan&, Scan& bad) {
         bad.v = {0, 0, -1};
         bad.step_mm = 1;
         bad.slices = 30;
       }},
      {"a whole one before a slab",
       [](Scan&, Scan& bad) {
         bad.step_mm = 0.5;
         bad.slices = 4;
       }},
      {"an original before a derived one",
       [](Scan&, Scan& bad) {
         bad.image_type = "DERIVED\\SECONDARY\\MPR";
         bad.step_mm = 1;
         bad.slices = 18;
       }},
      {"a soft kernel before a sharp one",
       [](Scan&, Scan& bad) {
         bad.kernel = "H60s";
         bad.step_mm = 1;
         bad.slices = 18;
       }},
      {"a thin one before a thick one",
       [](Scan& good, Scan& bad) {
         good.step_mm = bad.step_mm = 1;
         good.slices = 17;
         bad.slices = 20;  // thick slices that overlap
         bad.edit = [](int, DataSet& d) { d.text(tag(0x18, 0x50), "DS", "5"); };
         good.kernel = "H40s";
         bad.kernel = "H20s";
       }},
  };
  for (const Pair& p : pairs)
    for (const bool swapped : {false, true}) {
      Scan good = named(swapped ? 2 : 1), bad = named(swapped ? 1 : 2);
      p.make(good, bad);
      Folder folder;
      folder.add(good);
      folder.add(bad);
      EXPECT_EQ(folder.proposed().size[2], good.slices) << p.what;
      EXPECT_EQ(folder.best(), good.slices) << p.what;
      EXPECT_NE(outcome(folder.path()).line.find("proposed is " + folder.proposed().token + ","), std::string::npos)
          << outcome(folder.path()).line;
    }
}

// What a wrong token is answered with is what the list proposes, and none that the list refuses.
TEST(DicomChoice, AWrongTokenIsAnsweredWithTheProposedOne) {
  Folder folder;
  Scan gap = named(1);
  gap.along_mm = {0, 2, 4, 6, 8, 10, 12, 16, 18, 20, 22, 24};
  gap.slices = 12;
  Scan coronal = named(2);
  coronal.v = {0, 0, -1};
  coronal.slices = 11;
  for (const Scan& s : {gap, coronal, named(3)}) folder.add(s);
  const std::string token = folder.proposed().token, number = token.substr(0, token.find('-'));
  EXPECT_EQ(number, "s3");
  dicom::ImportParams wrong;
  wrong.series = "s9";
  const Refused o = outcome(folder.path(), wrong);
  EXPECT_EQ(o.code, 64);
  EXPECT_NE(o.line.find("proposed is " + token + ", --series s3 takes it"), std::string::npos) << o.line;
  EXPECT_EQ(o.line.find("s1"), std::string::npos) << "the list refuses it: " << o.line;
}

// A folder of two patients says so, where it is listed and where a choice is asked for.
TEST(DicomChoice, TwoPatientsInAFolderAreSaid) {
  Folder folder;
  Scan own = named(1), other = named(2);
  own.edit = [](int, DataSet& d) { d.text(tag(0x10, 0x10), "PN", "ONE^A"); };
  other.edit = [](int, DataSet& d) { d.text(tag(0x10, 0x10), "PN", "TWO^B"); };
  folder.add(own);
  EXPECT_FALSE(dicom::list_series(folder.path()).folder.result.series_of_other_patients_count);
  folder.add(other);
  EXPECT_EQ(dicom::list_series(folder.path()).folder.result.series_of_other_patients_count, 1);
  EXPECT_NE(outcome(folder.path()).line.find("takes it; of another patient: 1 of the others"), std::string::npos)
      << outcome(folder.path()).line;
}

TEST(DicomChoice, ManySeriesAreNoLine) {
  Folder folder;
  for (int n = 1; n <= 47; ++n) folder.add(named(n));
  const Refused o = outcome(folder.path());
  EXPECT_EQ(o.code, 64);
  EXPECT_NE(o.line.find("47 usable series"), std::string::npos) << o.line;
  EXPECT_NE(o.line.find("import --list"), std::string::npos) << o.line;
  EXPECT_LT(o.line.size(), 300u) << o.line;
  const std::string text = dicom::list_text(dicom::list_series(folder.path()));
  EXPECT_GE(std::count(text.begin(), text.end(), '\n'), 48);
}

TEST(DicomChoice, KernelsBySharpness) {
  for (const char* soft : {"H31s", "J40s", "Hr38s", "STANDARD", "SOFT", "FC21", "FC68", "UB", "B30f", "59.10.AH40"})
    EXPECT_LT(dicom::kernel_sharpness(soft), 46) << soft;
  for (const char* sharp : {"H60s", "J70h", "BONE", "BONEPLUS", "EDGE", "FC30", "FC81", "D", "B70f"})
    EXPECT_GE(dicom::kernel_sharpness(sharp), 56) << sharp;
  for (const char* unknown : {"", "other", "22", "7", "YC"}) EXPECT_EQ(dicom::kernel_sharpness(unknown), 50) << unknown;
}

}  // namespace
}  // namespace trephine
