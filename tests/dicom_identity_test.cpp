// SPDX-License-Identifier: GPL-3.0-or-later
// Slices and series of several patients: every attribute of identity is compared, and none is told.
#include "dicom/identity.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "dicom/input_files.h"
#include "dicom_import_samples.h"

namespace trephine {
namespace {

using namespace import_samples;
using synthetic::DataSet;

struct Said {
  std::uint32_t tag;
  const char* vr;
  const char* keyword;
  const char *one, *other;
};
const Said kinds[] = {{tag(0x10, 0x20), "LO", "PatientID", "H-4711", "H-0815"},
                      {tag(0x10, 0x21), "LO", "IssuerOfPatientID", "North", "South"},
                      {tag(0x10, 0x10), "PN", "PatientName", "CANARY^ONE", "CANARY^TWO"},
                      {tag(0x10, 0x30), "DA", "PatientBirthDate", "19610203", "19340511"},
                      {tag(0x10, 0x32), "TM", "PatientBirthTime", "1203", "0540"},
                      {tag(0x10, 0x40), "CS", "PatientSex", "M", "F"},
                      {tag(0x10, 0x1005), "PN", "PatientBirthName", "CANARY^A", "CANARY^B"},
                      {tag(0x10, 0x1060), "PN", "PatientMotherBirthName", "CANARY^C", "CANARY^D"}};

Scan twelve(std::uint32_t t, const std::string& vr, const std::function<std::string(int)>& value) {
  Scan s = small();
  s.slices = 12;
  s.edit = [=](int k, DataSet& d) {
    d.elements.erase(tag(0x10, 0x10));
    if (const std::string v = value(k); !v.empty()) d.text(t, vr, v);
  };
  return s;
}

dicom::ImportResult imported(const Scan& scan, const dicom::ImportParams& params = {}) {
  const ScratchFolder folder;
  scan.write(folder);
  return dicom::import_series(folder.path(), params);
}

bool warns(const Report& r, const std::string& what) {
  return std::any_of(r.warnings.begin(), r.warnings.end(),
                     [&](const std::string& w) { return w.find(what) != std::string::npos; });
}

TEST(DicomIdentity, SlicesOfTwoPatientsAreRefusedUnlessAReasonIsGiven) {
  for (const Said& kind : kinds)
    for (const int how :
         {0, 1, 2, 3, 4}) {  // the first slice, a middle one, the last, every other one, the second half
      const Scan s = twelve(kind.tag, kind.vr, [&](int k) {
        const bool other = how == 0 ? k == 0 : how == 1 ? k == 5 : how == 2 ? k == 11 : how == 3 ? k % 2 : k > 5;
        return other ? kind.other : kind.one;
      });
      const Refused o = outcome(s);
      EXPECT_EQ(o.code, 65) << kind.keyword << how << o.line;
      EXPECT_NE(o.line.find(kind.keyword), std::string::npos) << o.line;
      EXPECT_NE(o.line.find("same_patient_reason"), std::string::npos) << o.line;
      for (const char* value : {kind.one, kind.other})
        EXPECT_EQ(o.line.find(std::string(" ") + value), std::string::npos);
      dicom::ImportParams params;
      params.same_patient_reason = "a slip of the pen at the desk";
      const Report r = imported(s, params).report();
      EXPECT_TRUE(warns(r, std::string(kind.keyword) + " has 2 values within the series")) << kind.keyword;
      ASSERT_TRUE(r.find("same_patient_reason"));
      const ScratchFolder folder;
      s.write(folder);
      EXPECT_THROW(dicom::hash_of_series_input(folder.path(), {}), Error)
          << "a result that is stored must not be taken";
    }
}

TEST(DicomIdentity, WritingsOfOneNameAndWhatAnonymisersWriteAreNoContradiction) {
  const auto code = [](int which, const char* a, const char* b) {
    const Scan s = twelve(kinds[which].tag, kinds[which].vr, [&](int k) { return std::string(k < 6 ? a : b); });
    return outcome(s).code;
  };
  EXPECT_EQ(code(2, "Doe^John", "DOE^JOHN^^"), 0);
  EXPECT_EQ(code(2, "Doe^John", "Doe, John"), 0);
  EXPECT_EQ(code(2, "Doe^John", "Doe^Jane"), 65);
  EXPECT_EQ(code(2, "\xe5\xb1\xb1\xe7\x94\xb0", "\xe9\x88\xb4\xe6\x9c\xa8"), 65)
      << "names in other alphabets are names";
  EXPECT_EQ(code(3, "19610203", "19610101"), 0) << "an anonymiser kept the year";
  EXPECT_EQ(code(3, "19610203", "19620101"), 65);
  EXPECT_EQ(code(3, "19610203", "19000101"), 0);
  EXPECT_EQ(code(5, "F", "O"), 0);
  EXPECT_EQ(code(0, "H-4711", "ANONYMOUS"), 65) << "some slices say whose they are, and others do not";
  EXPECT_EQ(code(0, "H-4711", ""), 65);
  EXPECT_EQ(code(3, "19610203", ""), 0);
}

TEST(DicomIdentity, WhatIsAbsentIsTold) {
  const dicom::ImportResult none = imported(twelve(kinds[0].tag, "LO", [](int) { return ""; }));
  EXPECT_EQ(std::get<std::string>(*printed(none.folder).find("patient_said_by")), "nothing");
  const dicom::ImportResult id = imported(twelve(kinds[0].tag, "LO", [](int) { return "H-4711"; }));
  EXPECT_EQ(std::get<std::string>(*printed(id.folder).find("patient_said_by")), "PatientID");
  EXPECT_TRUE(warns(imported(twelve(kinds[3].tag, "DA", [](int k) { return k < 9 ? "19610203" : ""; })).report(),
                    "PatientBirthDate is given by 9 of 12 slices"));
}

TEST(DicomIdentity, TwoSeriesAreComparedByEveryAttribute) {
  for (const Said& kind : kinds) {
    const ScratchFolder a, b, c;
    twelve(kind.tag, kind.vr, [&](int) { return kind.one; }).write(a);
    twelve(kind.tag, kind.vr, [&](int) { return kind.other; }).write(b);
    twelve(kind.tag, kind.vr, [&](int) { return ""; }).write(c);
    const dicom::PatientMatch apart = dicom::compare_patients({a.path(), {}}, {b.path(), {}});
    EXPECT_EQ(apart.contradicting, std::vector<std::string>{kind.keyword});
    EXPECT_EQ(dicom::compare_patients({a.path(), {}}, {a.path(), {}}).agreeing, std::vector<std::string>{kind.keyword});
    const dicom::PatientMatch unsaid = dicom::compare_patients({a.path(), {}}, {c.path(), {}});
    EXPECT_TRUE(unsaid.contradicting.empty() && unsaid.agreeing.empty());
  }
}

TEST(DicomIdentity, NoFileOrFolderIsNamedByItsName) {
  const ScratchFolder folder;
  const std::filesystem::path patient = folder.path() / "CANARYDOE_JOHN";
  std::filesystem::create_directories(patient / "CANARYSCANS");
  Scan s = small();
  for (int k = 0; k < s.slices; ++k) {
    DataSet d = s.slice(k);
    if (k == 4) d.number(tag(0x28, 0x101), 17);
    folder.write("CANARYDOE_JOHN/CANARYSCANS/CANARY" + std::to_string(k) + ".dcm", synthetic::file_bytes(d));
  }
  for (const auto& path : {patient, patient / "CANARYSCANS" / "CANARY4.dcm", patient / "CANARYNOWHERE"}) {
    const Refused o = outcome(path);
    EXPECT_NE(o.code, 0);
    EXPECT_EQ(o.line.find("CANARY"), std::string::npos) << o.line;
    EXPECT_EQ(o.line.find("import: scan"), 0u) << o.line;
  }
  // The remedy: the map says which file it was.
  const std::string line = outcome(patient).line;
  const std::size_t at = line.find("file 5 of 6 (");
  ASSERT_NE(at, std::string::npos) << line;
  const std::string digest = line.substr(at + 13, 8), map = dicom::scan_file_map(patient);
  EXPECT_NE(map.find("5\t" + digest + "\tCANARYSCANS/CANARY4.dcm\n"), std::string::npos) << map;
}

TEST(DicomIdentity, AnotherPatientsSeriesInTheFolderIsToldOf) {
  const ScratchFolder folder;
  Scan one = twelve(kinds[2].tag, "PN", [](int) { return "CANARY^ONE"; });
  Scan two = twelve(kinds[2].tag, "PN", [](int) { return "CANARY^TWO"; });
  two.uid = "1.2.3.4.6";
  two.slices = 8;
  one.write(folder);
  two.write(folder, [](int k) { return "z" + std::to_string(k); });
  dicom::ImportParams params;
  params.series = "s1";
  EXPECT_TRUE(warns(printed(dicom::import_series(folder.path(), params).folder),
                    "1 other series of the folder is of another patient"));
}

}  // namespace
}  // namespace trephine
