// SPDX-License-Identifier: GPL-3.0-or-later
// Points from 3D Slicer's files.
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "cases/slicer_points.h"
#include "head/head_landmarks.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

std::string markups(const std::string& system, const std::string& points, const std::string& more = "") {
  return R"({"@schema": "https://x/markups-schema-v1.0.3.json#", "markups": [{"type": "Fiducial", "coordinateSystem": ")" +
         system + "\"" + more + R"(, "controlPoints": [)" + points + R"(], "display": {"visibility": true}}]})";
}
std::string point(const std::string& label, const std::string& position, const std::string& status = "defined") {
  return R"({"id": "1", "label": ")" + label + R"(", "position": )" + position +
         R"(, "orientation": [-1, 0, 0, 0, -1, 0, 0, 0, 1], "selected": true, "positionStatus": ")" + status + "\"}";
}

template <class F>
std::string refused(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input) << e.what();
    return e.field() + ": " + e.what();
  }
  return "";
}

TEST(Markups, BothCoordinateSystemsGiveTheSamePlaces) {
  const std::string lps = point("Nasion", "[1.5, -95, 0]") + "," + point("Tragus left", "[70, 0, -3.25]") + "," +
                          point("kocher-Right", "[-30, -40, 110]");
  const std::string ras = point("Nasion", "[-1.5, 95, 0]") + "," + point("Tragus left", "[-70, -0.0, -3.25]") + "," +
                          point("kocher-Right", "[30, 40, 110]");
  const auto a = cases::parse_slicer_markups(markups("LPS", lps)), b = cases::parse_slicer_markups(markups("RAS", ras));
  ASSERT_EQ(a.size(), 3u);
  ASSERT_EQ(b.size(), 3u);
  EXPECT_EQ(a[0].name, "nasion");
  EXPECT_EQ(a[1].name, "tragus_left");
  EXPECT_EQ(a[2].name, "kocher_right");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].position_mm, b[i].position_mm);
    EXPECT_EQ(a[i].source, "given");
    EXPECT_EQ(a[i].confidence, 1);
  }
  EXPECT_EQ(a[0].position_mm, (Vec3{1.5, -95, 0}));
  head::HeadLandmarks one, two;
  one.landmarks = a, two.landmarks = b;
  EXPECT_EQ(head::landmarks_json(one), head::landmarks_json(two));
}

TEST(Markups, UnplacedPointsAreLeftOut) {
  const auto found = cases::parse_slicer_markups(
      markups("LPS", point("a", "[1, 2, 3]") + "," + point("b", "[0, 0, 0]", "undefined") + "," +
                         point("c", "[0, 0, 0]", "preview") + "," + point("d", "[0, 0, 0]", "missing") + "," +
                         R"({"label": "e", "positionStatus": "undefined"}, {"label": "f", "position": [4, 5, 6]})"));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].name, "f");
  EXPECT_EQ(
      cases::parse_slicer_markups(markups("LPS", point("a", "[1, 2, 3]"), R"(, "coordinateUnits": ["mm", "mm", "mm"])"))
          .size(),
      1u);
  EXPECT_EQ(cases::parse_slicer_markups(markups("LPS", point("a", "[1, 2, 3]") + "," + point("A", "[1, 2, 3]"))).size(),
            1u);
}

TEST(Markups, HostileFilesAreRefusedByField) {
  const std::string good = point("a", "[1, 2, 3]");
  const struct {
    std::string text, field;
  } bad[] = {
      {"", "json"},
      {"{", "json"},
      {"[]", ""},
      {"{}", "markups"},
      {R"({"markups": 3})", "markups"},
      {R"({"markups": []})", "markups"},
      {markups("LPS", ""), "markups"},
      {markups("LPS", point("a", "[1, 2, 3]", "undefined")), "markups"},
      {markups("IJK", good), "markups[0].coordinateSystem"},
      {R"({"markups": [{"controlPoints": [)" + good + "]}]}", "markups[0].coordinateSystem"},
      {markups("LPS", good, R"(, "coordinateUnits": "m")"), "markups[0].coordinateUnits"},
      {markups("LPS", point("a", "[1, 2]")), "markups[0].controlPoints[0].position"},
      {markups("LPS", point("a", "[1, 2, null]")), "markups[0].controlPoints[0].position[2]"},
      {markups("LPS", point("a", "[1, 2, NaN]")), "json"},
      {markups("LPS", point("a", "[1, 2, 1e6]")), "markups[0].controlPoints[0].position"},
      {markups("LPS", point("a", "[1, 2, 1e999]")), "json"},
      {markups("LPS", point("", "[1, 2, 3]")), "markups[0].controlPoints[0].label"},
      {markups("LPS", point("a\\u0007b", "[1, 2, 3]")), "markups[0].controlPoints[0].label"},
      {markups("LPS", point(std::string(65, 'a'), "[1, 2, 3]")), "markups[0].controlPoints[0].label"},
      {markups("LPS", point("a", "[1, 2, 3]", "maybe")), "markups[0].controlPoints[0].positionStatus"},
      {markups("LPS", good + "," + point("A", "[1, 2, 4]")), "markups[0].controlPoints[1].position"},
      {std::string(100000, '['), "json"},
  };
  for (const auto& b : bad) {
    const std::string told = refused([&] { cases::parse_slicer_markups(b.text); });
    EXPECT_EQ(told.substr(0, b.field.size() + 1), b.field + ":") << b.text.substr(0, 200) << "\n" << told;
  }
  // Every truncation is refused, none crashes.
  const std::string whole = markups("RAS", good + "," + point("b", "[4, 5, 6]"));
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_NE(refused([&] { cases::parse_slicer_markups(std::string_view(whole).substr(0, n)); }), "");
}

TEST(Fcsv, ReadsTheTableOfEveryVersion) {
  const std::string rows =
      "vtkMRMLMarkupsFiducialNode_0,1,2,3,0,0,0,1,1,1,0,Nasion,,\r\n"
      "\r\n"
      "1,-4.5,5e0,6,0,0,0,1,1,1,0,\"Tragus left\",\"a, \"\"b\"\"\",vtkMRMLScalarVolumeNode1,2,0\n"
      "2,7,8,9,0,0,0,1,1,1,0,unplaced,,,0,0\n";
  const std::string columns = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  for (const char* system : {"0", "RAS"}) {
    const auto found = cases::parse_slicer_fcsv(
        "# Markups fiducial file version = 4.10\n# CoordinateSystem = " + std::string(system) + "\n" + columns + rows);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].position_mm, (Vec3{-1, -2, 3}));
    EXPECT_EQ(found[1].name, "tragus_left");
    EXPECT_EQ(found[1].position_mm, (Vec3{4.5, -5, 6}));
    EXPECT_EQ(found[1].source, "given");
  }
  for (const char* system : {"1", "LPS"})
    EXPECT_EQ(cases::parse_slicer_fcsv("# CoordinateSystem = " + std::string(system) + "\n" + rows)[0].position_mm,
              (Vec3{1, 2, 3}));
  // Columns in another order.
  EXPECT_EQ(cases::parse_slicer_fcsv("# CoordinateSystem = LPS\n# columns = label,z,y,x\nInion,3,2,1")[0].position_mm,
            (Vec3{1, 2, 3}));
}

TEST(Fcsv, HostileTablesAreRefused) {
  const std::string head = "# CoordinateSystem = LPS\n";
  for (const std::string& text :
       {std::string(), head, std::string("1,1,2,3,0,0,0,1,1,1,0,a,,\n"), head + "1,1,2\n",
        head + "1,1,2,nan,0,0,0,1,1,1,0,a,,\n", head + "1,1,2,1e7,0,0,0,1,1,1,0,a,,\n",
        head + "1,1,2,0x3,0,0,0,1,1,1,0,a,,\n", head + "1,1,2,3,0,0,0,1,1,1,0,,,\n",
        head + "1,1,2,3,0,0,0,1,1,1,0,\"a,,\n", std::string("# CoordinateSystem = 2\n1,1,2,3,0,0,0,1,1,1,0,a,,\n"),
        head + "# columns = id,x,y\n1,1,2,3,0,0,0,1,1,1,0,a,,\n", head + std::string(10000, ',') + "\n",
        head + "1,1,2,3,0,0,0,1,1,1,0,a,,\n2,1,2,4,0,0,0,1,1,1,0,A,,\n"})
    EXPECT_NE(refused([&] { cases::parse_slicer_fcsv(text); }), "") << text.substr(0, 80);
}

TEST(LandmarkFiles, AreToldByTheirEnding) {
  const ScratchFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() / name, std::ios::binary) << text;
    return folder.path() / name;
  };
  EXPECT_EQ(head::read_landmark_file(write("a.mrk.json", markups("RAS", point("a", "[1, 2, 3]"))))[0].position_mm,
            (Vec3{-1, -2, 3}));
  EXPECT_EQ(
      head::read_landmark_file(write("a.fcsv", "# CoordinateSystem = LPS\n1,1,2,3,0,0,0,1,1,1,0,a"))[0].position_mm,
      (Vec3{1, 2, 3}));
  head::HeadLandmarks ours;
  ours.landmarks = {{"inion", {3, 2, 1}, 0.5, "found"}};
  const auto read = head::read_landmark_file(write("ours.json", head::landmarks_json(ours)));
  EXPECT_EQ(read[0].position_mm, (Vec3{3, 2, 1}));
  EXPECT_EQ(refused([&] { head::read_landmark_file(write("b.mrk.json", "{}")); }).substr(0, 8), "markups:");
  EXPECT_THROW(head::read_landmark_file(write("a.txt", "x")), Error);
  try {
    head::read_landmark_file(folder.path() / "none.fcsv");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::no_input);
  }
}

}  // namespace
}  // namespace trephine
