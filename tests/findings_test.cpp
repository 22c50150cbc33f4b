// SPDX-License-Identifier: GPL-3.0-or-later
// What is to be looked at in heads of which the truth is known.
#include "findings/findings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "findings_scene.h"

namespace trephine {
namespace {

bool concerns(const Finding& f, const std::string& what) {
  return std::find(f.concerns.begin(), f.concerns.end(), what) != f.concerns.end();
}

TEST(Findings, AHealthyHeadHasNone) {
  const Scene s({});
  for (const Finding& f : s.found) ADD_FAILURE() << to_text(f.kind) << ": " << f.text << " " << f.confidence;
  EXPECT_EQ(s.result.findings_count, 0);
}

/// The blood is measured, its place is said, and it is sure.
void expect_blood(phantom::Blood blood, phantom::Variant variant, const std::string& where, const char* concerned) {
  phantom::HardParams hard;
  hard.blood = blood;
  const Scene s(hard, variant);
  ASSERT_GT(s.blood_ml, 3);
  double ml = 0;
  for (const Finding& f : s.of(FindingKind::dense)) {
    EXPECT_EQ(f.where, where);
    EXPECT_GE(f.confidence, 0.5);
    EXPECT_TRUE(concerns(f, concerned));
    ml += Scene::figure(f, "volume_ml");
  }
  EXPECT_NEAR(ml, s.blood_ml, 0.4 * s.blood_ml);
}

TEST(Findings, BloodInTheBrainIsMeasured) {
  expect_blood(phantom::Blood::intracerebral, phantom::Variant::normal, "in the brain", "brain");
}

TEST(Findings, BloodBesideTheBrainIsMeasured) {
  expect_blood(phantom::Blood::subdural, phantom::Variant::normal, "beside the brain", "brain");
}

TEST(Findings, BloodInTheVentriclesIsMeasured) {
  expect_blood(phantom::Blood::intraventricular, phantom::Variant::hydrocephalic, "in or at the ventricles",
               "ventricles");
}

/// What a healthy head has where a box in its brain, there where others of its seed bleed, is as dense as blood.
std::vector<Finding> brightened(Vec3 half_mm) {
  phantom::HeadParams who;
  who.level = phantom::Level::hard;
  who.seed = 5;
  who.hard.blood = phantom::Blood::intracerebral;
  Vec3 at;
  for (const auto& [name, place] : phantom::Head(who).things_mm())
    if (name == "blood") at = place;
  const Scene s({}, phantom::Variant::normal, 2, 5,
                [&](Scene& scene, const phantom::Head&) { scene.brighten(at, half_mm, 40); });
  return s.of(FindingKind::dense);
}

TEST(Findings, AStreakThatKeepsToItsSlicesIsDoubtful) {
  const std::vector<Finding> dense = brightened({12, 40, 3});
  ASSERT_FALSE(dense.empty());
  for (const Finding& f : dense) {
    EXPECT_LT(f.confidence, 0.5) << f.text;
    EXPECT_LT(Scene::figure(f, "flat_ratio"), 0.35) << f.text;
  }
}

TEST(Findings, WhatIsAsHighAsItIsWideIsNoStreak) {
  const std::vector<Finding> dense = brightened({10, 10, 10});
  ASSERT_EQ(dense.size(), 1u);
  EXPECT_GE(dense[0].confidence, 0.5) << dense[0].text;
}

// Contrast medium hides no bleed that lies apart from its vessels; what hangs on one may be its rim.
TEST(Findings, ABleedIsSureBesideContrastMediumAndAVesselsRimIsNot) {
  phantom::HardParams hard;
  hard.blood = phantom::Blood::intracerebral;
  const auto with_vessels = [&](double beside_mm) {
    return Scene(hard, phantom::Variant::normal, 2, 5, [&](Scene& scene, const phantom::Head&) {
      for (int n = 0; n < 3; ++n)
        scene.brighten(scene.blood_mm + Vec3{0, -beside_mm - (beside_mm > 0 ? 10 : 4) * n, 10}, {25, 3, 3}, 170);
    });
  };
  const Scene apart = with_vessels(24), within = with_vessels(0);
  for (const Scene* s : {&apart, &within}) {
    EXPECT_GT(s->result.contrast_ml, 0.65);
    EXPECT_TRUE(std::any_of(s->warnings.begin(), s->warnings.end(),
                            [](const Warning& w) { return w.id == "contrast_medium"; }));
    ASSERT_FALSE(s->of(FindingKind::dense).empty());
  }
  const std::vector<Finding> told = apart.of(FindingKind::dense);
  std::string all;
  for (const Finding& f : told) all += f.text + ": " + std::to_string(f.confidence) + "\n";
  EXPECT_TRUE(std::any_of(told.begin(), told.end(), [](const Finding& f) { return f.confidence >= 0.5; })) << all;
  for (const Finding& f : within.of(FindingKind::dense)) EXPECT_LT(f.confidence, 0.5) << f.text;
}

TEST(Findings, AirInsideTheSkullIsSaid) {
  const auto air = [](Vec3 at) {
    return Scene({}, phantom::Variant::normal, 2, 5,
                 [&](Scene& scene, const phantom::Head&) {
                   scene.brighten(at, {10, 10, 8}, -1030);
                 })
        .of(FindingKind::dark);
  };
  const auto said = air({-25, -30, 90});
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NEAR(Scene::figure(said[0], "volume_ml"), 6.4, 2);
  EXPECT_GE(said[0].confidence, findings::sure_confidence);
  EXPECT_TRUE(concerns(said[0], "brain"));
  EXPECT_NE(said[0].text.find("of air lie inside the skull"), std::string::npos);
}

TEST(Findings, AGapOfTheVaultIsMeasured) {
  phantom::HardParams hard;
  hard.craniectomy = true;
  const Scene s(hard);
  const auto gaps = s.of(FindingKind::bone_gap);
  ASSERT_FALSE(gaps.empty());
  EXPECT_GT(Scene::figure(gaps[0], "area_cm2"), 25);
  EXPECT_LT(Scene::figure(gaps[0], "area_cm2"), 90);
  EXPECT_EQ(gaps[0].side, "left");
  EXPECT_GE(gaps[0].confidence, 0.5);
  EXPECT_TRUE(concerns(gaps[0], "brain"));
}

// Between the inion and the foramen magnum the bone is seen through the muscles of the nape, from the cerebellum. A
// whole one is none, and a plate of bone that grew over the gap closes it.
TEST(Findings, AGapOfTheOccipitalBoneIsMeasured) {
  const auto opened = [](double radius_mm) {
    return [radius_mm](Scene& scene, const phantom::Head& head) {
      const Vec3 inion = head.landmark("inion");
      auto& v = std::get<grid::Grid<std::int16_t>>(scene.volume);
      for (int k = 0; k < v.size[2]; ++k)
        for (int j = 0; j < v.size[1]; ++j)
          for (int i = 0; i < v.size[0]; ++i) {
            const Vec3 d = v.to_world_mm({double(i), double(j), double(k)}) - inion;
            if (std::hypot(d.x, d.z + 24) > radius_mm || d.y < -45 || !(scene.skull.at(i, j, k) > 0)) continue;
            scene.skull.at(i, j, k) = -1;
            v.at(i, j, k) = 40;
          }
    };
  };
  const auto gaps_of = [&](double radius_mm) {
    return Scene({}, phantom::Variant::normal, 2, 5, opened(radius_mm)).of(FindingKind::bone_gap);
  };
  EXPECT_TRUE(gaps_of(0).empty());
  const auto gaps = gaps_of(13);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].where, "in the occipital bone");
  EXPECT_EQ(gaps[0].side, "middle");
  EXPECT_GE(gaps[0].confidence, findings::sure_confidence);
  // Of 5.3 cm2 of bone what the cerebellum sees through 10 mm of it, as large as it is on the brain.
  EXPECT_GT(Scene::figure(gaps[0], "area_cm2"), 1);
  EXPECT_LT(Scene::figure(gaps[0], "area_cm2"), 5.3);
}

// A burr hole over which bone has grown: its inner table is whole, and a dent is left of it.
TEST(Findings, AHoleThatBoneHasClosedIsADent) {
  const auto dented = [](double radius_mm, double deep_mm) {
    return Scene({}, phantom::Variant::normal, 2, 5, [&](Scene& scene, const phantom::Head& head) {
      const Vec3 on_skin = head.landmark("kocher_right"), in = normalized(Vec3{0, 0, 60} - on_skin);
      double bone_mm = 0;
      while (head.implicit_mm(phantom::Anatomy::skull, on_skin + in * bone_mm) > 0) bone_mm += 0.2;
      auto& v = std::get<grid::Grid<std::int16_t>>(scene.volume);
      for (int k = 0; k < v.size[2]; ++k)
        for (int j = 0; j < v.size[1]; ++j)
          for (int i = 0; i < v.size[0]; ++i) {
            const Vec3 d = v.to_world_mm({double(i), double(j), double(k)}) - on_skin;
            const double along = dot(d, in);
            if (norm(d - in * along) > radius_mm || along > bone_mm + deep_mm || along < -5) continue;
            if (!(scene.skull.at(i, j, k) > 0)) continue;
            scene.skull.at(i, j, k) = -1;
            v.at(i, j, k) = 40;
          }
    });
  };
  const Scene hole = dented(7, 3.5), shallow = dented(7, 0.5);
  const auto dents = hole.of(FindingKind::bone_gap);
  ASSERT_EQ(dents.size(), 1u);
  EXPECT_NEAR(Scene::figure(dents[0], "depth_mm"), 3.5, 1.5);
  EXPECT_GE(dents[0].confidence, findings::sure_confidence);
  EXPECT_EQ(dents[0].side, "right");
  EXPECT_TRUE(shallow.of(FindingKind::bone_gap).empty());
}

TEST(Findings, InNoiseThatLeavesNoTissueToMeasureItAllButMetalIsDoubtful) {
  phantom::HardParams hard;
  hard.craniectomy = true;
  const Scene s(hard, phantom::Variant::normal, 2, 5, [](Scene& scene, const phantom::Head&) {
    std::uint32_t state = 1;
    for (std::int16_t& v : std::get<grid::Grid<std::int16_t>>(scene.volume).voxels) {
      state = 1664525u * state + 1013904223u;
      v = std::int16_t(v + int(state >> 16) % 1201 - 600);
    }
  });
  EXPECT_EQ(s.result.tissue_noise_hu, 0);
  EXPECT_FALSE(s.of(FindingKind::bone_gap).empty());
  for (const Finding& f : s.found)
    if (f.kind != FindingKind::metal) EXPECT_LT(f.confidence, findings::sure_confidence) << f.text;
  ASSERT_FALSE(s.warnings.empty());
  EXPECT_NE(to_text(s.warnings[0]).find("cannot be measured"), std::string::npos) << to_text(s.warnings[0]);
  // Where the scan's noise is known to be far less than what bone stands out by, its gaps are seen all the same.
  for (const double noise_hu : {45.0, 195.0}) {
    findings::FindingShapes shapes{&s.skull, &s.brain, &s.ventricles, nullptr};
    shapes.voxel_noise_hu = noise_hu;
    double surest = 0;
    for (const Finding& f : findings::find_findings(s.volume, shapes, {}).result.list)
      if (f.kind == FindingKind::bone_gap) surest = std::max(surest, f.confidence);
    EXPECT_EQ(surest >= findings::sure_confidence, noise_hu < 90) << noise_hu;
  }
}

TEST(Findings, ShiftAndWidthAreThoseOfTheFigures) {
  const Scene shifted({}, phantom::Variant::shifted), wide({}, phantom::Variant::hydrocephalic);
  const auto shift = shifted.of(FindingKind::shift);
  ASSERT_EQ(shift.size(), 1u);
  EXPECT_NE(shift[0].text.find("to the right"), std::string::npos) << shift[0].text;
  EXPECT_GT(Scene::figure(shift[0], "shift_mm"), 5);
  EXPECT_EQ(wide.of(FindingKind::wide_ventricles).size(), 1u);
  EXPECT_TRUE(shifted.of(FindingKind::wide_ventricles).empty());
}

TEST(Findings, BloodInThickSlicesThatLiesLevelInBothHornsIsSure) {
  phantom::HardParams hard;
  hard.blood = phantom::Blood::intraventricular;
  const Scene s(hard, phantom::Variant::hydrocephalic, 5, 3103, [](Scene& scene, const phantom::Head& head) {
    // The straight sinus and the falx behind it lie between the horns and join their blood into one piece.
    const mask::BitMask blood = mask::make_mask(scene.brain, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < scene.brain.size[0]; ++i)
        row[i] = head.thing(scene.brain.to_world_mm({double(i), double(j), double(k)})) == phantom::Thing::blood;
    });
    scene.brighten(blood.centre_mm(), {28, 3, 4}, 38);
  });
  double ml = 0;
  for (const Finding& f : s.of(FindingKind::dense)) {
    EXPECT_EQ(f.where, "in or at the ventricles");
    EXPECT_LT(Scene::figure(f, "flat_ratio"), 0.35) << f.text;
    EXPECT_GE(f.confidence, findings::sure_confidence) << f.text;
    ml += Scene::figure(f, "volume_ml");
  }
  EXPECT_NEAR(ml, s.blood_ml, 0.4 * s.blood_ml);
}

TEST(Findings, ACraniectomyAndTheBloodUnderItAreSureInSlicesOfSixMillimetres) {
  phantom::HardParams hard;
  hard.blood = phantom::Blood::subdural;
  hard.craniectomy = true;
  const Scene s(hard, phantom::Variant::shifted, 6, 3108);
  const auto gaps = s.of(FindingKind::bone_gap), dense = s.of(FindingKind::dense);
  ASSERT_FALSE(gaps.empty());
  ASSERT_FALSE(dense.empty());
  EXPECT_GT(Scene::figure(gaps[0], "area_cm2"), 25);
  EXPECT_GE(gaps[0].confidence, findings::sure_confidence);
  EXPECT_EQ(dense[0].where, "beside the brain");
  EXPECT_GE(dense[0].confidence, findings::sure_confidence) << dense[0].text;
}

TEST(LongFindings, ABurrHoleIsSeenInThickSlices) {
  for (const double slice_mm : {2.0, 6.0}) {
    phantom::HardParams hard;
    hard.burr_hole = true;
    const Scene s(hard, phantom::Variant::normal, slice_mm, 3109);
    const auto gaps = s.of(FindingKind::bone_gap);
    ASSERT_EQ(gaps.size(), 1u) << slice_mm;
    EXPECT_GE(gaps[0].confidence, findings::sure_confidence) << slice_mm;
    EXPECT_EQ(gaps[0].side, "right");
    EXPECT_NEAR(Scene::figure(gaps[0], "area_cm2"), 1.5, 0.75) << slice_mm;  // 14 mm wide
  }
}

TEST(LongFindings, AShuntIsSeenInThickSlices) {
  for (const double slice_mm : {2.0, 5.0}) {
    phantom::HardParams hard;
    hard.shunt = true;
    const Scene s(hard, phantom::Variant::hydrocephalic, slice_mm, 3103);
    const auto tubes = s.of(FindingKind::tube);
    ASSERT_FALSE(tubes.empty()) << slice_mm;
    EXPECT_GT(Scene::figure(tubes[0], "longest_mm"), 40) << slice_mm;
    EXPECT_GE(tubes[0].confidence, findings::sure_confidence) << slice_mm;
  }
}

// A streak of metal is as thin, straight and long as a catheter, but keeps to the slices of the metal.
TEST(Findings, AStreakInAFewSlicesIsNoSureTube) {
  for (const bool lies : {true, false}) {
    const Scene s({}, phantom::Variant::normal, 2, 5, [&](Scene& scene, const phantom::Head&) {
      scene.brighten({-27, 8, 72}, lies ? Vec3{1.2, 17, 2.1} : Vec3{1.2, 1.2, 17}, 250);
    });
    const auto tubes = s.of(FindingKind::tube);
    ASSERT_EQ(tubes.size(), 1u) << lies;
    EXPECT_GT(Scene::figure(tubes[0], "longest_mm"), 25) << lies;
    EXPECT_EQ(tubes[0].confidence >= findings::sure_confidence, !lies) << tubes[0].confidence;
  }
}

TEST(Findings, ATubeStandsOutOfTheScansNoise) {
  const Scene s({}, phantom::Variant::normal, 2, 5, [&](Scene& scene, const phantom::Head&) {
    scene.brighten({-27, 8, 72}, {1.2, 1.2, 17}, 250);
  });
  for (const double noise_hu : {40.0, 100.0}) {
    findings::FindingShapes shapes{&s.skull, &s.brain, &s.ventricles, nullptr};
    shapes.voxel_noise_hu = noise_hu;
    int count = 0;
    for (const Finding& f : findings::find_findings(s.volume, shapes, {}).result.list)
      count += f.kind == FindingKind::tube;
    EXPECT_EQ(count, noise_hu < 70 ? 1 : 0) << noise_hu;
  }
}

TEST(LongFindings, AShiftThatIsMeasuredInAPieceOfTheVentriclesIsDoubtful) {
  const auto shift_with = [](bool in_pieces) {
    const Scene s({}, phantom::Variant::shifted);
    const Vec3 middle = mask::positive(s.ventricles, s.ventricles).centre_mm();
    head::HeadLandmarks landmarks;
    landmarks.midsagittal.point_mm = {0, middle.y, middle.z};
    landmarks.midsagittal.normal = {1, 0, 0};
    landmarks.midsagittal.confidence = 1;
    grid::Field ventricles = s.ventricles;
    if (in_pieces)  // a plate beside the midline, such as a lateral ventricle's body leaves
      for (int k = 0; k < ventricles.size[2]; ++k)
        for (int j = 0; j < ventricles.size[1]; ++j)
          for (int i = 0; i < ventricles.size[0]; ++i) {
            const Vec3 d = ventricles.to_world_mm({double(i), double(j), double(k)}) - middle;
            ventricles.at(i, j, k) =
                float(std::min({3.5 - std::abs(d.x + middle.x - 16), 30 - std::abs(d.y), 8 - std::abs(d.z)}));
          }
    for (const Finding& f :
         findings::find_findings(s.volume, {&s.skull, &s.brain, &ventricles, &landmarks}, {}).result.list)
      if (f.kind == FindingKind::shift) return f;
    return Finding{};
  };
  const Finding whole = shift_with(false), piece = shift_with(true);
  EXPECT_GE(whole.confidence, findings::sure_confidence) << whole.text;
  EXPECT_GT(Scene::figure(piece, "shift_mm"), 10) << piece.text;
  EXPECT_LT(piece.confidence, findings::sure_confidence) << piece.text;
}

TEST(Findings, TheReportListsThemAndTheLabelsOutlineThem) {
  phantom::HardParams hard;
  hard.blood = phantom::Blood::intracerebral;
  const Scene s(hard, phantom::Variant::normal, 5);
  ASSERT_FALSE(s.found.empty());
  const Report report = printed(figures_of(s.result), {});
  ASSERT_TRUE(report.find("1.kind"));
  EXPECT_EQ(std::get<std::string>(*report.find("1.kind")), "dense_tissue");
  ASSERT_TRUE(report.find("1.volume_ml"));
  const double ml = std::get<double>(*report.find("1.volume_ml"));
  const auto& map = std::get<grid::Mask>(s.labels.samples);
  const auto voxels = std::count(map.voxels.begin(), map.voxels.end(), std::uint8_t{1});
  EXPECT_NEAR(double(voxels) * map.voxel_volume_mm3() / 1000, ml, 1e-6);
  EXPECT_LT(norm(s.found[0].position_mm - s.blood_mm), 8);
  EXPECT_EQ(s.warnings.size(), s.found.size());
}

TEST(Findings, WhatIsNotThereIsRefused) {
  grid::Lattice l;
  l.size = {20, 20, 20};
  const grid::HuVolume volume = grid::Grid<std::int16_t>(l, std::int16_t{30});
  const grid::Field none(l, -1.f);
  const auto code_of = [&](const findings::FindingShapes& shapes) {
    try {
      findings::find_findings(volume, shapes, {});
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of({nullptr, &none, nullptr, nullptr}), ExitCode::usage);
  EXPECT_EQ(code_of({&none, nullptr, nullptr, nullptr}), ExitCode::usage);
  EXPECT_EQ(code_of({&none, &none, nullptr, nullptr}), ExitCode::quality);
}

}  // namespace
}  // namespace trephine
