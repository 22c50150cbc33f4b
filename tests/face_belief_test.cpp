// SPDX-License-Identifier: GPL-3.0-or-later
// Wrong landmarks publish no face: what is removed and what is checked rest on given and found ones together.
#include "face/face_belief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "face/face_gate.h"
#include "head_recipe.h"
#include "phantom_heads.h"
#include "report_of.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

struct Scanned {
  phantom::Head head;
  grid::HuVolume volume;
  grid::Field skin;
};

Scanned scanned(int seed, phantom::Variant variant, int pixels, int slices) {
  Scanned s{phantom_heads::head_of(phantom::Level::simple, seed, variant), {}, {}};
  s.volume = phantom::volume_of(phantom::scan(s.head, phantom_heads::scan_of(pixels, slices, 12)));
  s.skin = segmentation::segment(s.volume, {}, head_recipe::skin()).value;
  return s;
}

const Scanned& small_head() {
  static const Scanned s = scanned(7, phantom::Variant::normal, 120, 64);
  return s;
}

head::HeadLandmarks landmarks_of(const phantom::Head& head, const char* source) {
  return phantom_heads::face_landmarks(head, 0.9, source);
}

std::string refusal(const head::HeadLandmarks& known, const head::HeadLandmarks* found, const grid::Field& skin,
                    const face::FaceBeliefParams& params = {}) {
  try {
    face::face_regions(known, found, skin, params);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::privacy);
    return e.line("");
  }
  return "";
}
bool has(const std::string& line, const char* what) { return line.find(what) != std::string::npos; }

TEST(LongFaceBelief, GivenLandmarksAreComparedWithFoundOnes) {
  const Scanned& s = small_head();
  const head::HeadLandmarks found = landmarks_of(s.head, "found");
  EXPECT_EQ(face::face_regions(found, nullptr, s.skin, {}).size(), 1u) << "nothing is given";
  head::HeadLandmarks given = landmarks_of(s.head, "given");
  EXPECT_EQ(face::face_regions(given, &found, s.skin, {}).size(), 1u) << "the same place";
  given.landmarks[0].position_mm.z += 10;
  const auto both = face::face_regions(given, &found, s.skin, {});
  ASSERT_EQ(both.size(), 2u);
  EXPECT_NEAR(norm(both[0].nasion_mm - both[1].nasion_mm), 10, 1e-9);
  given.landmarks[0].position_mm.z += 17;
  EXPECT_TRUE(has(refusal(given, &found, s.skin), "landmarks.nasion: as given lies 27 mm from where it is found"))
      << refusal(given, &found, s.skin);
  EXPECT_TRUE(has(refusal(given, nullptr, s.skin), "is given and was not found"));
  head::HeadLandmarks less = found;
  less.landmarks.erase(less.landmarks.begin());
  EXPECT_TRUE(has(refusal(given, &less, s.skin), "is given and was not found"));
  // Somebody says which, and why.
  face::FaceBeliefParams says;
  says.believe = face::FaceBelief::given;
  EXPECT_TRUE(has(refusal(given, &found, s.skin, says), "why are these landmarks right?"));
  says.believe_reason = "the finder took the tip of the nose";
  EXPECT_EQ(face::face_regions(given, &found, s.skin, says).at(0).nasion_mm, given.landmarks[0].position_mm);
  says.believe = face::FaceBelief::found;
  const auto region = face::face_regions(given, &found, s.skin, says);
  ASSERT_EQ(region.size(), 1u);
  EXPECT_EQ(region[0].nasion_mm, found.landmarks[0].position_mm);
  // A found one that is not sure of itself is no region of its own, but a contradiction all the same.
  head::HeadLandmarks doubtful = found;
  for (cases::CaseLandmark& l : doubtful.landmarks) l.confidence = 0.2;
  EXPECT_TRUE(has(refusal(given, &doubtful, s.skin), "with a confidence of 0.20"));
}

TEST(FaceBelief, NoiseBelowAirIsNoRestOfACut) {
  // Where only one of two regions reaches, the other one leaves the scan's own air, which is noise about -1000.
  const Scanned& s = small_head();
  const head::HeadLandmarks found = landmarks_of(s.head, "found");
  head::HeadLandmarks given = found;
  for (cases::CaseLandmark& l : given.landmarks) l.position_mm.y -= 4;
  const auto regions = face::face_regions(given, &found, s.skin, {});
  ASSERT_EQ(regions.size(), 2u);
  Report report;
  const auto both = std::get<grid::Grid<std::int16_t>>(value_of(report, face::deface(s.volume, s.skin, regions, {}))),
             one = std::get<grid::Grid<std::int16_t>>(value_of(report, face::deface(s.volume, s.skin, regions[1], {})));
  int below = 0;
  for (std::size_t v = 0; v < one.voxels.size(); ++v) below += one.voxels[v] == -1000 && both.voxels[v] != -1000;
  EXPECT_EQ(below, 0);
}

TEST(FaceBelief, TragiAreCheckedByAnatomy) {
  const Scanned& s = small_head();
  head::HeadLandmarks l = landmarks_of(s.head, "found");
  const auto ratio = face::tragi_position_ratio(face::face_region(l), s.skin);
  ASSERT_TRUE(ratio);
  EXPECT_NEAR(*ratio, 0.5, 0.05);
  face::FaceBeliefParams says;
  says.believe = face::FaceBelief::given;
  says.believe_reason = "a wrong one";
  for (const double forward_mm : {25.0, 40.0}) {
    head::HeadLandmarks wrong = l;
    for (std::size_t i = 1; i < 3; ++i) wrong.landmarks[i].position_mm.y -= forward_mm;
    EXPECT_TRUE(has(refusal(wrong, &l, s.skin, says), "of the way from the nasion")) << forward_mm;
    EXPECT_TRUE(has(refusal(wrong, nullptr, s.skin, says), "of the way from the nasion")) << "nothing was found";
  }
}

// Of random wrong sets: refused, or the true face is gone. Returns how many were accepted.
int attack(const Scanned& s, std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto off = [&](double most) {
    return Vec3{uniform(-most, most), uniform(-most, most), uniform(-most, most)} * 0.577;
  };
  const face::FaceRegion truth = face::face_region(landmarks_of(s.head, "truth"));
  int accepted = 0;
  for (int i = 0; i < count; ++i) {
    head::HeadLandmarks found = landmarks_of(s.head, "found"), given = found;
    // The region's margins are for errors of the finder as small as these, with voxels of 2 mm.
    for (cases::CaseLandmark& l : found.landmarks) l.position_mm += off(1);
    const double most = i % 4 == 0 ? 14 : i % 4 == 1 ? 30 : 70;
    for (cases::CaseLandmark& l : given.landmarks) {
      l.source = "given";
      if (random() % 2) l.position_mm += off(most);
    }
    if (i % 4 == 2)  // both ears to the front
      for (std::size_t t = 1; t < 3; ++t) given.landmarks[t].position_mm.y -= uniform(5, 60);
    try {
      const auto regions = face::face_regions(given, &found, s.skin, {});
      Report report;
      const grid::HuVolume out = value_of(report, face::deface(s.volume, s.skin, regions, {}));
      // The gate of a run; at these coarse voxels it may refuse, too.
      face::check_face_removed(s.skin, regions, {}, {face::face_volume("ct", out)});
      const double left_mm = face::face_distances(s.skin, truth, {}, {face::face_volume("ct", out)})[0].distance_mm;
      EXPECT_GE(left_mm, face::face_clearance_mm) << "set " << i << ", of " << regions.size() << " regions";
      ++accepted;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::privacy) << e.line("");
    }
  }
  return accepted;
}

TEST(LongFaceBelief, RandomWrongLandmarksPublishNoFace) { EXPECT_GE(attack(small_head(), 11, 10), 1); }

TEST(LongFaceBelief, TwoHundredWrongSetsOnThreePhantomsPublishNoFace) {
  for (const std::uint64_t seed : {3, 4, 9}) {  // whose skins differ
    const Scanned s = scanned(seed, phantom::Variant::normal, 150, 80);
    const int accepted = attack(s, seed + 2, 200);
    EXPECT_GE(accepted, 1);
    std::printf("%d of 200 accepted\n", accepted);
  }
}

}  // namespace
}  // namespace trephine
