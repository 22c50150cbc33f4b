// SPDX-License-Identifier: GPL-3.0-or-later
// The anatomical gate: gaps of spheres are known; every fault put in is found, said and placed.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/write_file.h"
#include "consistency/anatomy_gate.h"
#include "consistency/anatomy_gate_gap.h"
#include "consistency_samples.h"
#include "picture/image.h"

namespace trephine {
namespace {

using consistency::Clearance;
using consistency::clearance;
using consistency::Relation;

grid::Field ball(const grid::Lattice& l, Vec3 centre, double radius) {
  return field_of(l, [=](Vec3 p) { return radius - norm(p - centre); });
}

TEST(Clearance, GapOfSpheres) {
  const grid::Lattice l = raster({0.7, 0.7, 1.1}, 40);
  const grid::Field outer = ball(l, {}, 35);
  for (const double gap : {0.2, 0.6, 1.5, 4.0}) {
    const Vec3 towards = normalized({1, 2, 0.5});
    const grid::Field inner = ball(l, towards * (35 - 20 - gap), 20);
    const Clearance c = clearance(inner, outer, Relation::inside, gap + 0.3);
    EXPECT_EQ(c.wrong_ml, 0);
    EXPECT_NEAR(c.gap_mm, gap, 0.05);
    EXPECT_LT(norm(c.gap_at_mm - towards * (35 - gap)), 4) << gap;
    EXPECT_GT(c.near_mm2, 20);
    EXPECT_EQ(clearance(inner, outer, Relation::inside, gap - 0.1).near_mm2, 0);
    const Clearance away =
        clearance(ball(l, {-22, 0, 0}, 15), ball(l, {15 + gap - 22 + 12.0, 0, 0}, 12), Relation::apart, 0);
    EXPECT_NEAR(away.gap_mm, gap, 0.05);
  }
  EXPECT_GT(clearance(ball(l, {}, 20), outer, Relation::inside, 0).gap_mm, 1e5);  // beyond 5 mm
}

TEST(Clearance, DepthAndVolumeOfWhatPokesOut) {
  const grid::Lattice l = raster({0.8, 0.8, 0.8}, 40);
  const Clearance c = clearance(ball(l, {0, 0, 12}, 20), ball(l, {}, 28), Relation::inside, 0);
  EXPECT_NEAR(c.depth_mm, 4, 0.9);  // to the nearest voxel that is inside
  EXPECT_NEAR(c.deepest_mm.z, 32, 0.9);
  EXPECT_EQ(c.gap_mm, 0);
  EXPECT_GT(c.wrong_ml, 1);
  // Cropped fields of one raster lie where they lie.
  const grid::Field whole = ball(l, {0, 0, 12}, 20);
  const Clearance cropped =
      clearance(grid::crop(whole, grid::Box{{20, 20, 30}, {80, 80, 95}}), ball(l, {}, 28), Relation::inside, 0);
  EXPECT_EQ(cropped.wrong_ml, c.wrong_ml);
  EXPECT_EQ(cropped.deepest_mm, c.deepest_mm);
}

TEST(Clearance, WhereTheVolumeCutsThereIsNoSurface) {
  grid::Lattice l = raster({1, 1, 1}, 30);
  l.size[2] = 30;  // both are cut at their middle
  const Clearance c = clearance(ball(l, {}, 20), ball(l, {}, 24), Relation::inside, 1);
  EXPECT_NEAR(c.gap_mm, 4, 0.05);
}

TEST(AnatomyGate, PassesWhatIsRight) {
  EllipsoidHead head;
  head.make();
  const consistency::AnatomyFindings found = head.examine();
  EXPECT_TRUE(found.faults.empty()) << found.faults[0].what;
  EXPECT_NO_THROW(consistency::require_anatomy(found));
  EXPECT_NEAR(*found.result.skull_brain_gap_mm, 3, 0.2);
  EXPECT_EQ(*found.result.brain_pieces_count, 1);
  EXPECT_LT(*found.result.brain_outside_skull_ml, 1);
}

/// The first fault's text holds each of the words, and it lies within `off_mm` of the place.
void expect_fault(const EllipsoidHead& head, std::vector<std::string> words, Vec3 place, double off_mm) {
  const consistency::AnatomyFindings found = head.examine();
  ASSERT_FALSE(found.faults.empty());
  const consistency::AnatomyFault& f = found.faults[0];
  for (const std::string& w : words) EXPECT_NE(f.what.find(w), std::string::npos) << f.what;
  EXPECT_LT(norm(f.place_mm - place), off_mm) << f.what;
  try {
    consistency::require_anatomy(found);
    FAIL() << "no error";
  } catch (const consistency::AnatomyError& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "");
    EXPECT_EQ(e.faults().size(), found.faults.size());
  }
}

TEST(AnatomyGate, VentriclePokesOutOfTheBrain) {
  EllipsoidHead head;
  head.ventricles_at = {0, -35, 5};
  head.make();
  expect_fault(head, {"ml of the ventricles lie outside of the brain", "deepest at", "mm"}, {0, -75, 5}, 6);
}

TEST(AnatomyGate, BrainInTwoPieces) {
  EllipsoidHead head;
  head.slit_mm = 4;
  head.make();
  expect_fault(head, {"the brain is in 2 pieces"}, {48, 0, 0}, 12);
}

TEST(AnatomyGate, SkullTouchesTheSkin) {
  EllipsoidHead head;
  head.skull_at = head.brain_at = {6.9, 0, 0};  // of a gap of 7
  head.make();
  consistency::AnatomyGateParams params;
  params.min_skin_skull_gap_mm = 0.5;
  consistency::AnatomyFindings found = consistency::examine_anatomy(head.fields(), nullptr, params);
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_NE(found.faults[0].what.find("surfaces of skull and skin are only 0.1"), std::string::npos)
      << found.faults[0].what;
  EXPECT_LT(norm(found.faults[0].place_mm - Vec3{82, 0, 0}), 12);
  params.min_skin_skull_gap_mm = 0;
  EXPECT_TRUE(consistency::examine_anatomy(head.fields(), nullptr, params).faults.empty());
  head.skull_at = head.brain_at = {8.5, 0, 0};
  head.make();
  expect_fault(head, {"of the skull lie outside of the skin"}, {83, 0, 0}, 50);
}

// In thick slices the vertex is a mixture of bone and scalp: there skin and skull may be near over more.
TEST(AnatomyGate, ThickSlicesMayBringSurfacesNearOverMore) {
  consistency::AnatomyGateParams params;
  params.min_skin_skull_gap_mm = 0.5;
  const auto faults = [&](double slice_mm) {
    EllipsoidHead head;
    head.l = raster({1.4, 1.4, slice_mm}, 90);
    head.skull_at = head.brain_at = {6.9, 0, 0};
    head.make();
    return consistency::examine_anatomy(head.fields(), nullptr, params).faults;
  };
  const auto thin = faults(1.4);
  ASSERT_EQ(thin.size(), 1u);
  ASSERT_FALSE(thin[0].places_to_accept_mm.empty());
  const double near_mm2 = std::stod(thin[0].what.substr(thin[0].what.find("over ") + 5));
  params.max_near_mm2 = near_mm2 / 2;
  EXPECT_EQ(faults(1.4).size(), 1u);
  EXPECT_TRUE(faults(6).empty());
}

TEST(AnatomyGate, BrainInTheBone) {
  EllipsoidHead head;
  head.brain_at = {0, 7, 0};
  head.make();
  expect_fault(head, {"ml of the brain lie in the skull"}, {0, 74, 0}, 35);
}

// What the message says to set lets the case pass, at the first try, also where several pairs are at fault.
TEST(AnatomyGate, TheRemedyFollowedWorks) {
  EllipsoidHead head;
  head.brain_at = {0, 7, 0};
  head.skull_at = {8.5, 0, 0};
  head.ventricles_at = {0, -35, 5};
  head.make();
  consistency::AnatomyGateParams params;
  const consistency::AnatomyFindings found = consistency::examine_anatomy(head.fields(), nullptr, params);
  ASSERT_GE(found.faults.size(), 3u);
  std::string text;
  try {
    consistency::require_anatomy(found);
  } catch (const consistency::AnatomyError& e) {
    text = e.what();
  }
  if (const std::size_t end = text.find(" for `accepted_places_mm`"); end != std::string::npos)
    params.accepted_places_mm = text.substr(text.rfind(' ', end - 1) + 1, end - text.rfind(' ', end - 1) - 1);
  const auto follow = [&](const char* key, double& value) {
    const std::size_t at = text.find(std::string(" for `") + key + "`");
    if (at == std::string::npos) return false;
    value = std::stod(text.substr(text.rfind(' ', at - 1) + 1));
    EXPECT_EQ(text.find(std::string("`") + key + "`", at + 8), std::string::npos) << "said twice: " << text;
    return true;
  };
  EXPECT_TRUE(follow("max_outside_ml", params.max_outside_ml)) << text;
  follow("max_near_mm2", params.max_near_mm2);
  follow("max_outside_skull_ml", params.max_outside_skull_ml);
  follow("max_loose_brain_ml", params.max_loose_brain_ml);
  const consistency::AnatomyFindings now = consistency::examine_anatomy(head.fields(), nullptr, params);
  EXPECT_TRUE(now.faults.empty()) << text << "\n" << now.faults[0].what;
}

// A place that a person has looked at passes; the same fault at another place is refused as before.
TEST(AnatomyGate, AnAcceptedPlaceIsNoAcceptedLimit) {
  const auto message_of = [](const EllipsoidHead& head, const consistency::AnatomyGateParams& params) {
    try {
      consistency::require_anatomy(consistency::examine_anatomy(head.fields(), nullptr, params));
    } catch (const consistency::AnatomyError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EllipsoidHead head;
  head.skull_at = head.brain_at = {6.9, 0, 0};
  head.make();
  consistency::AnatomyGateParams params;
  params.min_skin_skull_gap_mm = 0.5;
  const std::string text = message_of(head, params);
  EXPECT_EQ(text.find("max_near_mm2"), std::string::npos) << text;
  const std::size_t end = text.find(" for `accepted_places_mm` of the stage `anatomy`");
  ASSERT_NE(end, std::string::npos) << text;
  const std::size_t from = text.rfind(' ', end - 1) + 1;
  params.accepted_places_mm = text.substr(from, end - from);
  EXPECT_EQ(message_of(head, params), "");
  head.skull_at = head.brain_at = {-6.9, 0, 0};
  head.make();
  const std::string other = message_of(head, params);
  const std::size_t both = other.find(" for `accepted_places_mm`");
  ASSERT_NE(both, std::string::npos) << other;
  EXPECT_NE(other.find(params.accepted_places_mm + ";-"), std::string::npos) << "the earlier place stays: " << other;
  for (const char* bad : {"1,2", "1,2,3,4", "a,b,c", "1,2,3;;4,5,6"}) {
    params.accepted_places_mm = bad;
    EXPECT_THROW(consistency::examine_anatomy(head.fields(), nullptr, params), Error) << bad;
  }
}

TEST(AnatomyGate, BrainOutsideOfTheSkull) {
  EllipsoidHead head;
  head.make();
  // A bud beyond the bone, under the skin.
  for (std::size_t v = 0; v < head.brain.voxels.size(); ++v) {
    const int i = int(v % head.l.size[0]), j = int(v / head.l.size[0] % head.l.size[1]),
              k = int(v / head.l.size[0] / head.l.size[1]);
    const Vec3 p = head.l.to_world_mm({double(i), double(j), double(k)});
    if (norm({p.x, p.y, p.z - 40}) < 62 && p.y < -30 && head.skull.voxels[v] < -1 && head.skin.voxels[v] < 5.5 &&
        head.skin.voxels[v] > 0.5)
      head.brain.voxels[v] = 1;
  }
  consistency::AnatomyGateParams params;
  params.max_outside_skull_ml = 1;
  const consistency::AnatomyFindings found = consistency::examine_anatomy(head.fields(), nullptr, params);
  bool said = false;
  for (const consistency::AnatomyFault& f : found.faults)
    said = said || f.what.find("cranial cavity") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(AnatomyGate, AnEmptyAnatomyIsAFault) {
  EllipsoidHead head;
  head.make();
  std::fill(head.ventricles.voxels.begin(), head.ventricles.voxels.end(), -1.f);
  const consistency::AnatomyFindings found = head.examine();
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_NE(found.faults[0].what.find("not one voxel"), std::string::npos);
}

TEST(AnatomyGate, OnlyWhatIsGivenIsChecked) {
  EllipsoidHead head;
  head.ventricles_at = {0, -35, 5};
  head.make();
  head::HeadFields fields = head.fields();
  fields.ventricles = nullptr;
  EXPECT_TRUE(consistency::examine_anatomy(fields, nullptr, {}).faults.empty());
}

TEST(AnatomyGate, RefusesOtherRastersAndNaN) {
  EllipsoidHead head;
  head.make();
  EllipsoidHead other = head;
  other.brain.spacing_mm.x *= 1.01;
  EXPECT_THROW(other.examine(), Error);
  head.brain.voxels[1000] = std::nanf("");
  EXPECT_THROW(head.examine(), Error);
}

TEST(AnatomyGate, TheSameBitsWithOneThread) {
  EllipsoidHead head;
  head.ventricles_at = {0, -35, 5};
  head.make();
  const consistency::AnatomyFindings a = head.examine();
  set_thread_count(1);
  const consistency::AnatomyFindings b = head.examine();
  set_thread_count(0);
  EXPECT_EQ(figures_of(a.result), figures_of(b.result));
  EXPECT_EQ(a.faults[0].what, b.faults[0].what);
}

TEST(AnatomyGate, PictureShowsThePlace) {
  EllipsoidHead head;
  head.ventricles_at = {0, -35, 5};
  head.make();
  grid::Grid<std::int16_t> volume(head.l, -1000);
  for (std::size_t v = 0; v < volume.voxels.size(); ++v)
    volume.voxels[v] = head.skull.voxels[v] > 0        ? 900
                       : head.ventricles.voxels[v] > 0 ? 8
                       : head.brain.voxels[v] > 0      ? 35
                       : head.skin.voxels[v] > 0       ? 60
                                                       : -1000;
  const consistency::AnatomyFindings found = head.examine();
  ASSERT_FALSE(found.faults.empty());
  const std::string png = consistency::anatomy_picture(volume, head.fields(), found.faults[0]);
  const picture::Image image = picture::decode_png(png);
  EXPECT_GT(image.width, 1500);
  // Outlines in their colours, and the cross.
  std::size_t blue = 0, red = 0, white = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.at(x, y);
      blue += p[2] > 200 && p[0] < 120;
      red += p[0] > 200 && p[1] < 120;
      white += p[0] == 255 && p[1] == 255 && p[2] == 255;
    }
  EXPECT_GT(blue, 300u);
  EXPECT_GT(red, 800u);
  EXPECT_GT(white, 100u);
  EXPECT_EQ(png, consistency::anatomy_picture(volume, head.fields(), found.faults[0]));
  if (const char* to = std::getenv("TREPHINE_KEEP_PICTURES")) write_file(std::string(to) + "/gate.png", png);
}

TEST(LongAnatomyGate, PassesThePhantom) {
  for (int n = 0; n < 4; ++n) {
    phantom::HeadParams p;
    p.variant = phantom::Variant(n);
    p.seed = n + 1;
    p.level = phantom::Level::clinical;
    const TrueHead h = true_head(p, 1.5);
    const consistency::AnatomyFindings found = consistency::examine_anatomy(h.fields(), &h.landmarks, {});
    EXPECT_TRUE(found.faults.empty()) << found.faults[0].what;
  }
}

}  // namespace
}  // namespace trephine
