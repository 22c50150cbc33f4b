// SPDX-License-Identifier: GPL-3.0-or-later
// The template of a head: that it is where synthetic heads have their parts, that it finds a tilted cavity, and what is
// decided by it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "head/brain.h"
#include "head/brain_dark.h"
#include "head/brain_pits.h"
#include "head/deep_csf.h"
#include "head/ventricle_parts.h"
#include "mask/filters.h"
#include "phantom/head.h"

namespace trephine::segmentation {
namespace {

grid::Lattice lattice_about(Vec3 centre, Vec3 half_mm, double spacing_mm) {
  grid::Lattice l;
  for (int a = 0; a < 3; ++a) {
    l.size[a] = 2 * int(half_mm[a] / spacing_mm) + 1;
    l.spacing_mm[a] = spacing_mm;
    l.origin_mm[a] = centre[a] - spacing_mm * int(half_mm[a] / spacing_mm);
  }
  return l;
}

template <class F>
mask::BitMask mask_of(const grid::Lattice& l, F&& holds) {
  return mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = holds(l.to_world_mm({double(i), double(j), double(k)}));
  });
}

double ventricle_mm(Vec3 p) {
  return std::min({place::place_mm(place::Place::lateral_left, p), place::place_mm(place::Place::lateral_right, p),
                   place::place_mm(place::Place::third, p)});
}

/// A head that lies as the template does.
place::HeadPlace straight() {
  place::HeadPlace place;
  place.centre_mm = place.to_template({0, 0, 0});
  place.sure = true;
  return place;
}

TEST(SegmentPlace, TheTemplatesVentriclesAreThoseOfTheSyntheticHead) {
  for (const phantom::Variant variant :
       {phantom::Variant::normal, phantom::Variant::hydrocephalic, phantom::Variant::shifted, phantom::Variant::small})
    for (const int seed : {1, 2, 3}) {
      phantom::HeadParams params;
      params.variant = variant;
      params.seed = seed;
      const phantom::Head head(params);
      std::size_t inside = 0, near = 0;
      for (double z = 15; z < 80; z += 2.5)
        for (double y = -65; y < 75; y += 2.5)
          for (double x = -55; x < 55; x += 2.5) {
            if (head.implicit_mm(phantom::Anatomy::ventricles, {x, y, z}) > 0) continue;
            ++inside;
            near += ventricle_mm({x, y, z}) < 8;
          }
      EXPECT_GT(inside, 200u);
      EXPECT_GT(double(near), 0.94 * double(inside)) << seed;
    }
}

TEST(SegmentPlace, ATiltedStretchedAndCutHeadIsFound) {
  const Vec3 centre{30, -120, 900}, scale{1.04, 0.95, 0.92};
  for (const double pitch_deg : {-28.0, 12.0})
    for (const double top_mm : {1e3, 40.0}) {
      const double c = std::cos(pitch_deg * pi / 180), s = std::sin(pitch_deg * pi / 180);
      place::HeadPlace truth;
      truth.centre_mm = centre;
      truth.axes.column = {Vec3{1, 0, 0}, Vec3{0, c, s}, Vec3{0, -s, c}};
      truth.scale = scale;
      grid::Lattice l = lattice_about(centre, {90, 110, 100}, 2.5);
      if (top_mm < 100) l.size[2] = int((centre.z + top_mm - l.origin_mm.z) / 2.5);
      const mask::BitMask cavity =
          mask_of(l, [&](Vec3 p) { return place::template_cavity_mm(truth.to_template(p)) < 0; });
      const place::HeadPlace found = place::place_head(cavity, nullptr, l);
      EXPECT_TRUE(found.sure);
      EXPECT_LT(found.residual_mm, 1.5);
      for (const Vec3 p : {Vec3{0, -6, 43}, Vec3{22, -44, 56}, Vec3{-24, 40, 50}, Vec3{0, 26, -24}})
        EXPECT_LT(norm(found.to_template(truth.to_lps(p)) - p), top_mm < 100 ? 5 : 2) << pitch_deg << " " << top_mm;
    }
}

// A ball of 65 mm in 8 mm of bone; below `dark_z_mm` it is as dark as CSF, and so no brain.
TEST(SegmentPlace, ABrainThatFillsLittleOfItsCavityIsTold) {
  for (const double dark_z_mm : {-1e3, -20.0}) {
    const grid::Lattice l = lattice_about({0, 0, 0}, {80, 80, 80}, 2);
    grid::Grid<std::int16_t> ct;
    static_cast<grid::Lattice&>(ct) = l;
    ct.voxels.resize(l.count());
    grid::Field skull;
    static_cast<grid::Lattice&>(skull) = l;
    skull.voxels.resize(l.count());
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
          const double out = norm(p) - 65;
          ct.at(i, j, k) = out < 0 ? (p.z < dark_z_mm ? 0 : 35) : out < 8 ? 1000 : -1000;
          skull.at(i, j, k) = float(4 - std::abs(out - 4));
        }
    const Warnings warnings = head::find_brain(ct, {&skull, nullptr, nullptr, {}}, {}).warnings;
    const bool told = std::any_of(warnings.begin(), warnings.end(), [](const Warning& w) {
      return to_text(w).find("% of the space that bone encloses was taken for brain") != std::string::npos;
    });
    EXPECT_EQ(told, dark_z_mm > -65) << dark_z_mm;
  }
}

TEST(SegmentPlace, WhatIsNoHeadIsNotSure) {
  const grid::Lattice l = lattice_about({0, 0, 0}, {60, 60, 160}, 3);
  EXPECT_FALSE(place::place_head(mask::BitMask(l), nullptr, l).sure);
  const mask::BitMask pipe = mask_of(l, [](Vec3 p) { return std::hypot(p.x, p.y) < 25; });
  const place::HeadPlace place = place::place_head(pipe, nullptr, l);
  EXPECT_FALSE(place.sure);
  ASSERT_EQ(place::warnings_of(place).size(), 1u);
}

/// Soft tissue with the template's fluid, a slit of a third ventricle, and what is not ventricle.
struct Scene {
  grid::Lattice lattice = lattice_about({0, 5, 45}, {66, 85, 62}, 1);
  mask::BitMask envelope = mask_of(lattice, [](Vec3 p) { return place::template_cavity_mm(p) < -3; });
  grid::Grid<float> soft{lattice, 30.f};
  static constexpr Vec3 cyst{24, -52, 78};
  Scene() {
    for (int k = 0; k < lattice.size[2]; ++k)
      for (int j = 0; j < lattice.size[1]; ++j)
        for (int i = 0; i < lattice.size[0]; ++i) {
          const Vec3 p = lattice.to_world_mm({double(i), double(j), double(k)});
          float& v = soft.at(i, j, k);
          if (std::min(place::place_mm(place::Place::lateral_left, p),
                       place::place_mm(place::Place::lateral_right, p)) < 0)
            v = 6;
          if (std::abs(p.x) < 1.2 && p.y > -20 && p.y < 6 && p.z > 36 && p.z < 50) v = 21;
          if (std::abs(p.x) < 1.6 && p.z > 69 && p.z < 100 && std::abs(p.y) < 50) v = 6;
          if (place::place_mm(place::Place::quadrigeminal, p) < 0) v = 6;
          if (norm(p - cyst) < 14) v = 6;
        }
  }
};

bool holds(const mask::BitMask& m, Vec3 p) {
  const Vec3 q = m.lattice().to_index(p);
  return m.at(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z)));
}

TEST(SegmentPlace, SlitsAreFoundFissuresCisternsAndCystsAreNot) {
  const Scene s;
  mask::BitMask others;
  const mask::BitMask found = head::deep_csf(s.soft, s.envelope, straight(), -15, 18.5, {}, &others);
  for (const double side : {-1.0, 1.0})
    for (const Vec3 p : {Vec3{10, -38, 58}, Vec3{7, -13, 61}, Vec3{24, 34, 55}, Vec3{23, 50, 49}})
      EXPECT_TRUE(holds(found, {side * p.x, p.y, p.z})) << side * p.x << " " << p.y;
  EXPECT_TRUE(holds(found, {0, -8, 43}));
  for (const Vec3 p : {Vec3{0, -30, 90}, Vec3{0, 10, 75}, Vec3{0, 33, 33}, Scene::cyst})
    EXPECT_FALSE(holds(found, p)) << p.y;
}

// The streak of a catheter's valve lies across both ventricles, as dark as they are.
TEST(SegmentPlace, AStreakAcrossTheVentriclesIsNoPartOfThem) {
  Scene s;
  const Vec3 from{-44, -32, 62}, to{44, 12, 62};
  const auto on = [&](double t) { return from + (to - from) * t; };
  for (int k = 0; k < s.lattice.size[2]; ++k)
    for (int j = 0; j < s.lattice.size[1]; ++j)
      for (int i = 0; i < s.lattice.size[0]; ++i) {
        const Vec3 p = s.lattice.to_world_mm({double(i), double(j), double(k)});
        const double t = std::clamp(dot(p - from, to - from) / dot(to - from, to - from), 0.0, 1.0);
        if (norm(p - on(t)) < 2) s.soft.at(i, j, k) = 6;
      }
  mask::BitMask others, cut_off;
  const mask::BitMask found = head::deep_csf(s.soft, s.envelope, straight(), -15, 18.5, {}, &others, &cut_off);
  // Its stubs in the ventricles are said.
  const auto stubs = head::warn_of_stubs(cut_off, found);
  ASSERT_TRUE(stubs);
  EXPECT_NE(to_text(*stubs).find("a thin dark streak was cut off"), std::string::npos) << to_text(*stubs);
  const Scene whole;
  const mask::BitMask sound = head::deep_csf(whole.soft, whole.envelope, straight(), -15, 18.5, {}, nullptr, &cut_off);
  EXPECT_FALSE(head::warn_of_stubs(cut_off, sound));
  for (const double side : {-1.0, 1.0})
    for (const Vec3 p : {Vec3{10, -38, 58}, Vec3{7, -13, 61}, Vec3{24, 34, 55}, Vec3{23, 50, 49}, Vec3{33, -5, 27}})
      EXPECT_TRUE(holds(found, {side * p.x, p.y, p.z})) << side * p.x << " " << p.y;
  for (const double t : {0.05, 0.15, 0.25, 0.8, 0.9, 0.95}) {
    EXPECT_FALSE(holds(found, on(t))) << t;
    EXPECT_TRUE(holds(others, on(t))) << t;
  }
}

TEST(SegmentPlace, MissingAndCompressedPartsAreSaid) {
  const grid::Lattice l = lattice_about({0, 5, 45}, {45, 75, 45}, 1.5);
  const mask::BitMask whole = mask_of(l, [](Vec3 p) { return ventricle_mm(p) < 0; });
  const auto sound = head::measure_parts(whole, straight());
  EXPECT_TRUE(sound.warnings.empty()) << to_text(sound.warnings.front());
  EXPECT_NEAR(sound.result.sides.value().asymmetry_ml, 0, 0.2);
  const mask::BitMask hurt = mask_of(l, [](Vec3 p) {
    return ventricle_mm(p) < 0 && !(p.x > 0 && p.y < -21) && place::place_mm(place::Place::third, p) > 0;
  });
  const auto parts = head::measure_parts(hurt, straight());
  ASSERT_EQ(parts.warnings.size(), 2u);
  EXPECT_EQ(to_text(parts.warnings[0]), "no frontal horn of the left lateral ventricle found where it should be");
  EXPECT_EQ(to_text(parts.warnings[1]), "no third ventricle found where it should be");
  EXPECT_LT(parts.result.sides.value().asymmetry_ml, -0.5);
}

TEST(SegmentPlace, PitsThatNoiseExplainsAreNoSulci) {
  const grid::Lattice l = lattice_about({0, 0, 0}, {30, 30, 30}, 1);
  const mask::BitMask shape = mask_of(l, [](Vec3 p) { return norm(p) < 28; });
  grid::Grid<float> hu(l, 30.f);
  std::uint32_t state = 1;
  for (float& v : hu.voxels) {  // the sum of four uniform numbers, of a standard deviation of 12
    float sum = 0;
    for (int n = 0; n < 4; ++n) sum += float((state = state * 1664525u + 1013904223u) >> 8) / 16777216.f - 0.5f;
    v += 12 * sum / std::sqrt(4.f / 12);
  }
  const auto sulcus = [](Vec3 p) { return std::abs(p.x) < 1.6 && p.z > 17; };
  const auto pit = [](Vec3 p) { return std::hypot(p.y - 12, p.z) < 2.2 && p.x > 20; };
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        if (sulcus(p)) hu.at(i, j, k) -= 20;
        if (pit(p)) hu.at(i, j, k) -= 5;  // what a search for dark places in noise comes upon
      }
  const mask::BitMask cut = mask_of(l, [&](Vec3 p) { return norm(p) < 28 && (sulcus(p) || pit(p)); });
  const mask::BitMask pits = head::noise_pits(cut, shape, hu, shape, 12);
  const auto share = [&](const auto& place) {
    const mask::BitMask there = mask_of(l, [&](Vec3 p) { return norm(p) < 26 && place(p); });
    return double(mask::both(pits, there).count()) / double(there.count());
  };
  EXPECT_GT(share(pit), 0.5);
  EXPECT_LT(share(sulcus), 0.02);
}

TEST(SegmentPlace, DarkPlacesWithinALesionAreNoSulci) {
  const grid::Lattice l = lattice_about({0, 0, 0}, {40, 40, 40}, 1);
  const mask::BitMask shape = mask_of(l, [](Vec3 p) { return norm(p) < 38; });
  grid::Grid<float> soft(l, 30.f);
  const auto lesion = [](Vec3 p) { return norm(p - Vec3{28, 0, 0}) < 14; };
  const auto pit = [](Vec3 p) { return std::hypot(p.y, p.z) < 2.5 && p.x > 20; };
  const auto narrow = [](Vec3 p) { return std::abs(p.y) < 1 && p.z > 20 && p.x < 10; };
  const auto fissure = [](Vec3 p) { return std::abs(p.y) < 5 && p.z < -15; };
  const auto fluid = [](Vec3 p) { return std::abs(p.y - 6) < 1.5 && p.x > 24; };  // a sulcus beside the lesion's middle
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        float& hu = soft.at(i, j, k);
        if (lesion(p)) hu = 23;
        if (pit(p)) hu = 19;
        if (narrow(p)) hu = 20;
        if (fissure(p) || fluid(p)) hu = 7;
      }
  const mask::BitMask cut =
      mask_of(l, [&](Vec3 p) { return norm(p) < 38 && (pit(p) || narrow(p) || fissure(p) || fluid(p)); });
  const mask::BitMask tissue = head::dark_tissue(cut, shape, soft);
  EXPECT_TRUE(holds(tissue, {30, 0, 0}));
  for (const Vec3 csf : {Vec3{0, 0, 28}, Vec3{0, 0, -25}, Vec3{0, 4, -25}, Vec3{30, 6, 0}})
    EXPECT_FALSE(holds(tissue, csf)) << csf.x << " " << csf.y << " " << csf.z;
}

}  // namespace
}  // namespace trephine::segmentation
