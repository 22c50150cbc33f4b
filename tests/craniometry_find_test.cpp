// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks of the analytic head against its own, whole and cut, straight and turned.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "craniometry_found.h"
#include "head/landmarks_parts.h"

namespace trephine {
namespace {

using namespace craniometry_test;

ExitCode code_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.code();
  }
  return ExitCode::ok;
}

double off_plane_mm(const head::HeadLandmarks& l, Vec3 p) {
  return std::abs(dot(l.midsagittal.normal, p - l.midsagittal.point_mm));
}
const char* const with_truth[] = {"nasion",      "inion",        "tragus_left", "tragus_right",
                                  "kocher_left", "kocher_right", "monro_left",  "monro_right"};

TEST(LandmarksFind, AllOfAPhantomWithinTwoMillimetres) {
  Report report;
  const head::HeadLandmarks found = find(scene(), report);
  for (const char* name : with_truth) {
    ASSERT_TRUE(found.find(name)) << name;
    EXPECT_LT(norm(found.find(name)->position_mm - scene().head.landmark(name)), 2.2) << name;
    // The foramina are seen by 20 HU of fluid against brain: the noise of a usual scan allows them less than bone and
    // skin.
    EXPECT_GT(found.find(name)->confidence, std::string(name).rfind("monro", 0) == 0 ? 0.65 : 0.8) << name;
    EXPECT_EQ(found.find(name)->source, "found");
  }
  EXPECT_LT(off_plane_mm(found, scene().head.landmark("nasion")), 0.8);
  EXPECT_LT(off_plane_mm(found, scene().head.landmark("inion")), 0.8);
  EXPECT_GT(found.midsagittal.normal.x, 0.99);
  EXPECT_GT(found.midsagittal.confidence, 0.9);
  ASSERT_TRUE(found.find("vertex") && found.find("bregma"));
  EXPECT_EQ(found.find("bregma")->source, "found");
  EXPECT_LT(std::get<double>(*report.find("symmetry_residual_mm")), 1);
  EXPECT_TRUE(report.warnings.empty());
}

TEST(LandmarksFind, TurnedHeadsGiveTheSamePlaces) {
  const head::HeadLandmarks straight = find(scene());
  for (const Vec3 deg : {Vec3{18, 0, 0}, Vec3{-15, 8, -8}, Vec3{5, -15, 15}}) {
    const Mat3 m = turn_deg(deg.x, deg.y, deg.z);
    const Vec3 move{31, -47, 120};
    Report report;
    const head::HeadLandmarks found = find(turned(scene(), m, move), report);
    for (const char* name : with_truth) {
      ASSERT_TRUE(found.find(name)) << name << " " << deg.x
                                    << (report.warnings.empty() ? "" : ": " + report.warnings[0]);
      EXPECT_LT(norm(found.find(name)->position_mm - (m * scene().head.landmark(name) + move)), 3.0)
          << name << " " << deg.x << " " << deg.y << " " << deg.z;
    }
    EXPECT_LT(norm(m * straight.midsagittal.normal - found.midsagittal.normal), 0.01);
    EXPECT_LT(norm(found.find("vertex")->position_mm - (m * straight.find("vertex")->position_mm + move)), 6);
  }
}

TEST(LandmarksFind, WhatWasNotScannedIsLeftOut) {
  const auto absent = [](const head::HeadLandmarks& found, std::initializer_list<const char*> names, const char* why) {
    for (const char* name : names) EXPECT_LT(confidence(found, name), 0.3) << name << ": " << why;
  };
  const auto there = [](const head::HeadLandmarks& found, std::initializer_list<const char*> names, const char* why) {
    for (const char* name : names) {
      ASSERT_TRUE(found.find(name)) << name << ": " << why;
      EXPECT_LT(norm(found.find(name)->position_mm - scene().head.landmark(name)), 3.0) << name << ": " << why;
    }
  };
  const double all = 1e4;
  head::HeadLandmarks found = find(cut(scene(), {-all, -all, -all}, {all, all, 90}));
  absent(found, {"vertex", "kocher_left", "kocher_right", "bregma"}, "no vertex scanned");
  there(found, {"nasion", "inion", "tragus_left", "tragus_right", "monro_left", "monro_right"}, "no vertex scanned");

  found = find(cut(scene(), {-all, -all, 22}, {all, all, all}));
  absent(found, {"inion", "tragus_left", "tragus_right"}, "no base scanned");
  there(found, {"nasion", "kocher_left", "kocher_right"}, "no base scanned");

  found = find(cut(scene(), {-all, -70, -all}, {all, all, all}));
  absent(found, {"nasion", "kocher_left", "kocher_right", "bregma"}, "no face scanned");
  there(found, {"inion", "tragus_left", "tragus_right"}, "no face scanned");

  found = find(cut(scene(), {-60, -all, -all}, {all, all, all}));
  absent(found, {"tragus_right"}, "no right side scanned");
  there(found, {"nasion", "inion", "tragus_left"}, "no right side scanned");
  for (const cases::CaseLandmark& l : found.landmarks)
    EXPECT_GE(grid::lattice_of(cut(scene(), {-60, -all, -all}, {all, all, all}).volume).to_index(l.position_mm).x, 0);
}

TEST(LandmarksFind, AHeadWithoutAFaceHasNoNasion) {
  // Everything in front of a plane from the brow down is taken away, as defacing programs do.
  LandmarkScene s = scene();
  for (grid::Field* f : {&s.skin, &s.skull})
    for (int k = 0; k < f->size[2]; ++k)
      for (int j = 0; j < f->size[1]; ++j)
        for (int i = 0; i < f->size[0]; ++i) {
          const Vec3 p = f->to_world_mm({double(i), double(j), double(k)});
          if (p.z < 60 && p.y + 0.35 * (p.z - 60) < -82) f->at(i, j, k) = -100;
        }
  const head::HeadLandmarks found = find(s);
  EXPECT_LT(confidence(found, "nasion"), 0.3);
  EXPECT_LT(confidence(found, "kocher_right"), 0.3);
  ASSERT_TRUE(found.find("inion"));
  EXPECT_LT(norm(found.find("inion")->position_mm - scene().head.landmark("inion")), 2.5);
}

TEST(LandmarksFind, AMassAndAMissingFlapDoNotPullThePlane) {
  LandmarkScene s = scene();
  const Vec3 mass = {-38, -66, 88};
  for (grid::Field* f : {&s.skin, &s.skull})
    for (int k = 0; k < f->size[2]; ++k)
      for (int j = 0; j < f->size[1]; ++j)
        for (int i = 0; i < f->size[0]; ++i) {
          const double d = norm(f->to_world_mm({double(i), double(j), double(k)}) - mass);
          if (f == &s.skin && d < 32) f->at(i, j, k) = std::max(f->at(i, j, k), float(20 * (32 - d)));
          if (f == &s.skull && d < 30) f->at(i, j, k) = -100;
        }
  const head::HeadLandmarks found = find(s);
  EXPECT_LT(off_plane_mm(found, scene().head.landmark("nasion")), 1.0);
  EXPECT_LT(off_plane_mm(found, scene().head.landmark("inion")), 1.0);
  EXPECT_LT(norm(found.find("nasion")->position_mm - scene().head.landmark("nasion")), 2.5);
  EXPECT_LT(norm(found.find("kocher_left")->position_mm - scene().head.landmark("kocher_left")), 2.5);
}

// A foramen that noise closed is where the wall is thinnest, or the other one's mirror image, and little is made of it.
TEST(LandmarksFind, AClosedForamenIsFoundAndDoubtful) {
  for (const double closed_mm : {2.5, 4.0}) {
    LandmarkScene s = scene();
    const Vec3 right = s.head.landmark("monro_right");
    grid::Field& field = s.ventricles;
    for (int k = 0; k < field.size[2]; ++k)
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i) {
          const double off_mm = norm(field.to_world_mm({double(i), double(j), double(k)}) - right);
          if (off_mm < closed_mm + 2) field.at(i, j, k) = std::min(field.at(i, j, k), float(off_mm - closed_mm));
        }
    const head::HeadLandmarks found = find(s);
    ASSERT_TRUE(found.find("monro_right") && found.find("monro_left")) << closed_mm;
    EXPECT_LT(norm(found.find("monro_right")->position_mm - right), 3) << closed_mm;
    EXPECT_GE(confidence(found, "monro_left"), 0.5) << closed_mm;
    EXPECT_LT(confidence(found, "monro_right"), 0.5) << closed_mm;
  }
}

// The segmentation opened the foramen 4 mm behind its place, where the scan shows tissue.
TEST(LandmarksFind, AForamenIsPulledToWhereTheScanIsDark) {
  LandmarkScene s = scene();
  const Vec3 right = s.head.landmark("monro_right"), behind = right + Vec3{0, 4, 0}, along{-0.4, 0, 0.9};
  grid::Field& field = s.ventricles;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        const Vec3 p = field.to_world_mm({double(i), double(j), double(k)});
        float& f = field.at(i, j, k);
        if (norm(p - right) < 5) f = std::min(f, float(norm(p - right) - 3));
        const Vec3 off = p - behind - along * std::clamp(dot(p - behind, along), -4.0, 4.0);
        if (norm(off) < 3) f = std::max(f, float(1.6 - norm(off)));
      }
  const head::HeadLandmarks found = find(s);
  ASSERT_TRUE(found.find("monro_right"));
  EXPECT_LT(norm(found.find("monro_right")->position_mm - right), 3);
}

TEST(LandmarksFind, TheSameBytesWithOneTwoAndEightThreads) {
  std::string first;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    const std::string json = head::landmarks_json(find(scene()));
    if (first.empty()) first = json;
    EXPECT_EQ(json, first) << threads;
  }
  set_thread_count(0);
}

grid::Field ball(const grid::Lattice& l, Vec3 centre, double radius_mm, double inner_mm) {
  grid::Field f(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const double r = norm(l.to_world_mm({double(i), double(j), double(k)}) - centre);
        f.at(i, j, k) = float(std::min(radius_mm - r, r - inner_mm));
      }
  return f;
}

TEST(LandmarksFind, WhatIsNoHeadIsRefused) {
  grid::Lattice l;
  l.size = {90, 90, 90};
  l.spacing_mm = {2.5, 2.5, 2.5};
  l.origin_mm = {-111, -111, -111};
  grid::Grid<std::int16_t> spot(l);
  spot.at(45, 45, 45) = 30;
  const grid::HuVolume volume = spot;
  const grid::Field skin = ball(l, {0, 0, 0}, 90, -1), skull = ball(l, {0, 0, 0}, 80, 72);
  head::LandmarkInputs in;
  const auto run = [&] { head::find_landmarks(volume, in, {}); };
  EXPECT_EQ(code_of(run), ExitCode::usage);
  in.skin = &skin;
  EXPECT_EQ(code_of(run), ExitCode::usage);
  in.skull = &skull;
  // Every plane is one of symmetry of a ball: none is the midsagittal one.
  try {
    run();
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("give nasion"), std::string::npos) << e.what();
  }
  // Lopsided rubbish.
  grid::Field rubbish = ball(l, {0, 0, 0}, 80, 72);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (i > 20 + j / 2 && k > 70 - j / 3 - i / 4) rubbish.at(i, j, k) = -1;
  in.skull = &rubbish;
  EXPECT_EQ(code_of(run), ExitCode::quality);
  const grid::Field empty(l, -1.f);
  in.skull = &empty;
  EXPECT_EQ(code_of(run), ExitCode::quality);
  grid::Lattice other = l;
  other.spacing_mm = {2, 2, 2};
  const grid::Field elsewhere(other, -1.f);
  in.skull = &elsewhere;
  EXPECT_EQ(code_of(run), ExitCode::bad_input);
  in.skull = &skull;
  in.given = {{"nasion", {0, NAN, 0}, 1, "given"}};
  EXPECT_EQ(code_of(run), ExitCode::bad_input);
  in.given = {{"nasion", {0, 0, 0}, 1, "given"}, {"nasion", {0, 0, 0}, 1, "given"}};
  EXPECT_EQ(code_of(run), ExitCode::bad_input);
}

TEST(LandmarksFind, AVolumeOfOneValueShowsNoHead) {
  const grid::HuVolume constant = grid::Grid<std::int16_t>(grid::lattice_of(scene().volume), 40);
  EXPECT_EQ(code_of([&] { head::find_landmarks(constant, scene().inputs(), {}); }), ExitCode::quality);
}

TEST(LandmarksFind, Cancels) {
  const std::atomic<bool> stop{true};
  EXPECT_THROW(head::find_landmarks(scene().volume, scene().inputs(), {}, Progress({}, &stop)), Cancelled);
}

TEST(LongLandmarksPhantom, ALibraryOfVariants) {
  using phantom::Variant;
  std::vector<double> errors;
  int n = 0;
  for (const Variant variant : {Variant::normal, Variant::hydrocephalic, Variant::shifted, Variant::small})
    for (const double thickness : {1.5, 3.0}) {
      phantom::HeadParams who;
      who.variant = variant;
      who.seed = 40 + n;
      who.level = phantom::Level::clinical;
      phantom::ScanParams how;
      how.slices_count = int(192 / thickness);
      how.slice_step_mm = how.slice_thickness_mm = thickness;
      how.noise_hu = 8 + 4 * (n % 4);
      const LandmarkScene s = make_scene(who, how);
      const head::HeadLandmarks found = find(s);
      for (const char* name : with_truth) {
        if (!found.find(name) || found.find(name)->confidence < 0.5) {
          // Foramina that the scan does not resolve, and Kocher's points where the bregma is no surer.
          EXPECT_TRUE(name[0] == 'm' || name[0] == 'k') << name << " " << n;
          continue;
        }
        errors.push_back(norm(found.find(name)->position_mm - s.head.landmark(name)));
        EXPECT_LT(errors.back(), 4) << name << " " << n;
      }
      ++n;
    }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 2);
  EXPECT_GT(errors.size(), 50u);
}

}  // namespace
// Where the lateral ventricles meet at their floor and the third one is not seen, a short piece lies below a pair.
TEST(LandmarksFind, AShortPieceBelowThePairIsNoThirdVentricle) {
  LandmarkScene s = scene();
  const Vec3 monro = (s.head.landmark("monro_left") + s.head.landmark("monro_right")) * 0.5;
  grid::Field& f = s.ventricles;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        const Vec3 p = f.to_world_mm({double(i), double(j), double(k)}) - monro;
        if (p.z < -1 && std::abs(p.x) < 8 && (p.y < -2 || p.y > 5)) f.at(i, j, k) = std::min(f.at(i, j, k), -2.f);
      }
  Report report;
  const head::HeadLandmarks found = find(s, report);
  for (const char* name : {"monro_left", "monro_right"}) EXPECT_LT(confidence(found, name), 0.3) << name;
}

// One of two estimates of the vertex is off by half of what lies between them: 18 mm apart were told as sure.
TEST(LandmarksFind, TwoEstimatesOfTheVertexThatLieApartAreDoubtful) {
  for (const double apart_mm : {0.0, 6.0}) EXPECT_EQ(head::confidence_of_vertices_apart(apart_mm), 1);
  EXPECT_NEAR(head::confidence_of_vertices_apart(10.5), 0.725, 1e-9);
  for (const double apart_mm : {15.0, 18.0, 100.0}) EXPECT_LT(head::confidence_of_vertices_apart(apart_mm), 0.5);
}

}  // namespace trephine
