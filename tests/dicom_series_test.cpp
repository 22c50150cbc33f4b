// SPDX-License-Identifier: GPL-3.0-or-later
// Which files make a series, which series is meant, and what its hash sees: D13 to D15, D18, D22, P1.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "dicom/identity.h"
#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;

TEST(DicomSeries, OrderAndNamesDoNotMatter) {
  Scan s = small();
  s.slices = 30;
  const ScratchFolder a, b, c;
  s.write(a);
  s.write(b, [](int k) { return std::to_string((k * 7919 + 13) % 1009) + (k % 2 ? "/x" : ""); });
  s.drift_per_mm = {0, 0.3, 0};
  s.write(c);
  const dicom::ImportResult first = dicom::import_series(a.path(), {}), second = dicom::import_series(b.path(), {}),
                            tilted = dicom::import_series(c.path(), {});
  EXPECT_TRUE(synthetic::same_volume(first.volume, second.volume));
  EXPECT_EQ(first.report().figures, second.report().figures);
  EXPECT_EQ(first.input_sha256, second.input_sha256);
  EXPECT_EQ(dicom::hash_of_series_input(b.path(), {}), first.input_sha256);
  EXPECT_NE(tilted.input_sha256, first.input_sha256);
  const int before = thread_count();
  set_thread_count(1);
  EXPECT_TRUE(synthetic::same_volume(dicom::import_series(a.path(), {}).volume, first.volume));
  EXPECT_TRUE(synthetic::same_volume(dicom::import_series(c.path(), {}).volume, tilted.volume));
  set_thread_count(before);
}

TEST(DicomSeries, TwoThousandSlices) {
  Scan s = small();
  s.slices = 2000;
  s.step_mm = 0.5;
  const ScratchFolder folder;
  s.write(folder);
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});
  EXPECT_EQ(grid::lattice_of(r.volume).size, (std::array<int, 3>{20, 16, 2000}));
  EXPECT_NEAR(grid::lattice_of(r.volume).spacing_mm.z, 0.5, 1e-9);
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
    return dicom::hash_of_series_input(folder.path(), {});
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

TEST(DicomSeries, OfOnePatientIsSaidWherePatientIdsTellThemApart) {
  const auto of_one = [](const char* first, const char* second) {
    const ScratchFolder folders[2];
    for (int n = 0; n < 2; ++n) {
      Scan s = small();
      const std::string id = n == 0 ? first : second;
      s.edit = [&](int, DataSet& d) {
        if (!id.empty()) d.text(tag(0x10, 0x20), "LO", id);
      };
      s.write(folders[n]);
    }
    const dicom::PatientMatch match = dicom::compare_patients({folders[0].path(), {}}, {folders[1].path(), {}});
    const auto has = [](const std::vector<std::string>& all) {
      return std::find(all.begin(), all.end(), "PatientID") != all.end();
    };
    return has(match.contradicting) ? std::optional<bool>(false)
           : has(match.agreeing)    ? std::optional<bool>(true)
                                    : std::nullopt;
  };
  EXPECT_EQ(of_one("H-4711", "H-4711"), true);
  EXPECT_EQ(of_one("H-4711", "H-4712"), false);
  EXPECT_EQ(of_one("ANONYMOUS", "H-4711"), std::nullopt) << "what is absent is no contradiction; it is told";
  EXPECT_EQ(of_one("", "H-4711"), std::nullopt);
  for (const char* everybody :
       {"ANONYMOUS", "anonymous^", "Anonymized", "DE-IDENTIFIED", "0", "000000", "XXXX", "unknown", "n/a", "-"})
    EXPECT_EQ(of_one(everybody, everybody), std::nullopt) << everybody;
  for (const char* patient : {"ANON-0815", "TEST7", "10", "PATIENT 3"})
    EXPECT_EQ(of_one(patient, patient), true) << patient;
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
  const Refused o = outcome(folder.path());
  EXPECT_EQ(o.code, 64);
  for (const char* part :
       {"s1-20x16x9: CT, 1.5 x 1.5 x 1 mm, kernel other, slice thickness 1 mm, DERIVED/PRIMARY/other, contrast",
        "s2-20x16x6: CT, 1.5 x 1.5 x 2 mm, kernel H31s, slice thickness 2 mm, ORIGINAL/PRIMARY/AXIAL, contrast not "
        "told"})
    EXPECT_NE(o.line.find(part), std::string::npos) << o.line;
  EXPECT_EQ(o.line.find("CANARY"), std::string::npos);
  dicom::ImportParams p;
  p.series = "s2-20x16x6";
  EXPECT_EQ(grid::lattice_of(dicom::import_series(folder.path(), p).volume).size[2], 6);
  p.series = "s1";
  EXPECT_EQ(grid::lattice_of(dicom::import_series(folder.path(), p).volume).size[2], 9);
  p.series = "s3";
  EXPECT_EQ(outcome(folder.path(), p).code, 64);
  const auto list = dicom::list_series(folder.path()).series;
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
    const Refused o = outcome(s);
    EXPECT_EQ(o.code, 65);
    EXPECT_NE(o.line.find(std::string("Modality (0008,0060): ") + modality), std::string::npos) << o.line;
    dicom::ImportParams any;
    any.modality = dicom::ModalityPolicy::any;
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
  const dicom::ImportResult plain = dicom::import_series(folder.path(), {});
  folder.write("again.dcm", synthetic::file_bytes(s.slice(2)));
  folder.write("again2.dcm", synthetic::file_bytes(s.slice(2)));
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});
  EXPECT_TRUE(synthetic::same_volume(r.volume, plain.volume));
  EXPECT_EQ(count(r.report(), "duplicates_dropped_count"), 2);
  DataSet d = s.slice(2);
  d.elements[pixels_tag].bytes[40] ^= 1;
  folder.write("again.dcm", synthetic::file_bytes(d));
  const Refused o = outcome(folder.path());
  EXPECT_EQ(o.code, 65);
  EXPECT_NE(o.line.find("different pixels"), std::string::npos) << o.line;
}

}  // namespace
}  // namespace trephine
