// SPDX-License-Identifier: GPL-3.0-or-later
// What is given as a segmentation comes back voxel for voxel, on the slices that it was given on.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "grid/labels.h"
#include "pacs/anatomy_codes.h"
#include "pacs/removed_face.h"
#include "pacs_samples.h"
#include "surface/inside.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

using namespace pacs_samples;

void expect_same_slices(const pacs::SliceSet& a, const pacs::SliceSet& b, std::size_t first, std::size_t count) {
  ASSERT_EQ(b.origins_mm.size(), count);
  for (std::size_t k = 0; k < count; ++k) EXPECT_LT(norm(a.origins_mm[first + k] - b.origins_mm[k]), 1e-9);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_DOUBLE_EQ(a.dx_mm, b.dx_mm);
  EXPECT_DOUBLE_EQ(a.dy_mm, b.dy_mm);
  EXPECT_LT(norm(a.u - b.u) + norm(a.v - b.v), 1e-9);
}

TEST(Segmentation, ComesBackVoxelForVoxelOnTiltedAndUnevenSlices) {
  for (const double lean : {0.0, 0.25})
    for (const auto& heights : {uniform_mm, uneven_mm}) {
      const pacs::SliceSet slices = slices_at(heights, lean);
      const std::vector<pacs::Segment> given{noise("skin", slices, 0), noise("brain", slices, 1),
                                             noise("third_ventricle", slices, 2)};
      const pacs::LabelObject back = decoded(pacs::encode_segmentation(identity(), slices, given).bytes);
      expect_same_slices(slices, back.slices, 0, heights.size());
      ASSERT_EQ(back.segments.size(), 3u);
      for (std::size_t n = 0; n < 3; ++n) {
        EXPECT_EQ(back.segments[n].name, given[n].name);
        EXPECT_EQ(back.segments[n].bits, given[n].bits) << n;
      }
    }
}

TEST(Segmentation, OfSlicesThatNoSegmentUsesThoseBetweenKeepTheirPlace) {
  const pacs::SliceSet slices = slices_at(uneven_mm);
  pacs::Segment brain = noise("brain", slices, 3);
  for (const std::size_t k : {0, 4, 5, 9}) brain.bits[k].clear();
  const pacs::LabelObject back = decoded(pacs::encode_segmentation(identity(), slices, {brain}).bytes);
  expect_same_slices(slices, back.slices, 1, 8);
  EXPECT_EQ(back.segments[0].bits, pacs::SliceBits(brain.bits.begin() + 1, brain.bits.end() - 1));
}

TEST(Segmentation, TheSameContentHasTheSameBytesAndUidsWhateverTheThreads) {
  const pacs::SliceSet slices = slices_at(uniform_mm);
  const surface::TriMesh ball = shapes::sphere(4, 8, {0, -2, 49});
  std::vector<pacs::ObjectFile> made;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    made.push_back(pacs::encode_segmentation(identity(), slices, {{"brain", {}, pacs::bits_inside(ball, slices)}}));
  }
  set_thread_count(0);
  EXPECT_EQ(made[0].bytes, made[1].bytes);
  const auto other = pacs::encode_segmentation(identity(), slices, {{"skull", {}, pacs::bits_inside(ball, slices)}});
  EXPECT_NE(other.instance_uid, made[0].instance_uid);
}

TEST(Segmentation, APixelBelongsWhereItsMiddleLiesInTheSurface) {
  const Vec3 centre{1.1, -1.3, 49.2};
  const surface::TriMesh ball = shapes::sphere(6, 8, centre);
  for (const double lean : {0.0, 0.25}) {
    const pacs::SliceSet slices = slices_at(uneven_mm, lean);
    const pacs::SliceBits bits = pacs::bits_inside(ball, slices);
    std::size_t set = 0;
    for (std::size_t k = 0; k < bits.size(); ++k)
      for (int j = 0; j < slices.rows; ++j)
        for (int i = 0; i < slices.columns; ++i) {
          const double from = norm(slices.lattice_of(k).to_world_mm({double(i), double(j), 0}) - centre) - 8;
          if (std::abs(from) < 0.01) continue;  // the mesh's flat triangles lie a little within the ball
          const std::size_t at = std::size_t(j) * 37 + std::size_t(i);
          const bool is = !bits[k].empty() && (static_cast<unsigned char>(bits[k][at / 8]) >> at % 8 & 1);
          EXPECT_EQ(is, from < 0) << i << " " << j << " " << k;
          set += is;
        }
    EXPECT_GT(set, 1000u);
  }
}

TEST(Segmentation, ReadAsLabelsOfUprightUniformSlicesEachVoxelIsTheGivenOne) {
  const pacs::SliceSet slices = slices_at(uniform_mm);
  const std::vector<pacs::Segment> given{noise("skin", slices, 0), noise("brain", slices, 1)};
  const grid::LabelFile labels =
      pacs::label_file_of(decoded(pacs::encode_segmentation(identity(), slices, given).bytes));
  EXPECT_EQ(labels.layers, 2);  // they overlap
  for (std::size_t n = 0; n < 2; ++n) {
    const grid::PickedLabel label = grid::pick_label(labels, given[n].name);
    EXPECT_LT(norm(label.mask.to_world_mm({0, 0, 1}) - slices.origins_mm[0]), 1e-9);  // an empty slice before
    for (std::size_t k = 0; k < slices.origins_mm.size(); ++k) {
      const std::uint8_t* first = &label.mask.voxels[label.mask.index(0, 0, int(k) + 1)];
      const std::string is = pacs::packed({first, first + slices.pixels()});
      EXPECT_EQ(is, given[n].bits[k].empty() ? std::string(is.size(), '\0') : given[n].bits[k]);
    }
  }
}

// The largest distance from the ball's surface of a voxel on the wrong side, and the volume's error.
void expect_ball(const grid::LabelFile& labels, Vec3 centre, double radius_mm, double within_mm, double within_ratio) {
  const grid::Mask mask = grid::pick_label(labels, "brain").mask;
  double most = 0, volume = 0;
  for (int k = 0; k < mask.size[2]; ++k)
    for (int j = 0; j < mask.size[1]; ++j)
      for (int i = 0; i < mask.size[0]; ++i) {
        const double from = norm(mask.to_world_mm({double(i), double(j), double(k)}) - centre) - radius_mm;
        volume += mask.at(i, j, k) * mask.voxel_volume_mm3();
        if ((from < 0) != (mask.at(i, j, k) != 0)) most = std::max(most, std::abs(from));
      }
  EXPECT_LT(most, within_mm);
  EXPECT_NEAR(volume / (4 / 3.0 * 3.14159265 * std::pow(radius_mm, 3)), 1, within_ratio);
}

TEST(Segmentation, ReadAsLabelsOfTiltedAndUnevenSlicesABallKeepsItsPlaceAndVolume) {
  const Vec3 centre{1.1, -1.3, 48};
  const surface::TriMesh ball = shapes::sphere(6, 6.5, centre);
  const std::vector<double> heights[] = {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16},
                                         {0, 1, 2, 3, 4, 5, 6, 7, 8, 9.5, 11, 12.5, 14, 15.5, 17}};
  for (const double lean : {0.0, 0.25})
    for (const auto& h : heights) {
      const pacs::SliceSet slices = slices_at(h, lean);
      const auto file = pacs::encode_segmentation(identity(), slices, {{"brain", {}, pacs::bits_inside(ball, slices)}});
      expect_ball(pacs::label_file_of(decoded(file.bytes)), centre, 6.5, 0.6, 0.03);
    }
}

TEST(Segmentation, WhatIsNoBinarySegmentationIsRefusedNamingTheTag) {
  const pacs::SliceSet slices = slices_at(uniform_mm);
  const std::string good = pacs::encode_segmentation(identity(), slices, {noise("skin", slices, 0)}).bytes;
  EXPECT_EQ(fault_of(good), "");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    const std::size_t at = bytes.find(from);
    EXPECT_NE(at, std::string::npos);
    return bytes.replace(at, from.size(), to);
  };
  EXPECT_EQ(fault_of(changed("BINARY", "LABELM")).substr(0, 31), "65 SegmentationType (0062,0001)");
  EXPECT_EQ(fault_of(good.substr(0, good.size() - 100)).substr(0, 2), "65");
  EXPECT_EQ(fault_of("not DICOM").substr(0, 2), "65");
  std::string ct;
  pacs::SliceSet images = slices;
  pacs::encode_ct(identity(), grid::Grid<std::int16_t>(slices.lattice_of(0)), images,
                  [&](std::size_t, const std::string& bytes) { ct = bytes; });
  EXPECT_EQ(fault_of(ct).substr(0, 26), "65 SOPClassUID (0008,0016)");
  pacs::SliceSet far = slices;
  far.origins_mm[3].z = 1e9;
  EXPECT_NE(fault_of(pacs::encode_segmentation(identity(), far, {noise("skin", far, 0)}).bytes).find("kilometres"),
            std::string::npos);
  // Whatever byte of the header is damaged, it is read or refused.
  const std::size_t header = good.size() - slices.pixels() * 8 / 8;
  for (std::size_t at = 132; at < header; at += 7) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x55);
    const std::string fault = fault_of(bytes);
    EXPECT_TRUE(fault.empty() || fault.substr(0, 2) == "65") << at << " " << fault;
  }
}

TEST(Segmentation, FramesBesideEachOtherAtOneHeightAreRefused) {
  pacs::SliceSet slices = slices_at({0, 2, 4, 4});
  slices.origins_mm[3].x += 50;
  pacs::Segment one = noise("skin", slices, 3), other = one;
  one.bits[3].clear();
  other.bits[3] = other.bits[2];
  other.bits[2].clear();
  const std::string fault = fault_of(pacs::encode_segmentation(identity(), slices, {one, other}).bytes);
  EXPECT_EQ(fault.substr(0, 39), "65 ImagePositionPatient (0020,0032): fr") << fault;
  EXPECT_NE(fault.find("50.000 mm apart"), std::string::npos) << fault;
}

TEST(Segmentation, CountsAndSizesBeyondTheirLimitsAreRefusedBeforeAnythingIsMadeOfThem) {
  const pacs::SliceSet slices = slices_at(uniform_mm);
  const std::vector<pacs::Segment> most(255, noise("skin", slices, 1));
  EXPECT_EQ(fault_of(pacs::encode_segmentation(identity(), slices, most).bytes), "");
  const std::vector<pacs::Segment> many(256, noise("skin", slices, 1));
  EXPECT_NE(fault_of(pacs::encode_segmentation(identity(), slices, many).bytes).find("at most 255"), std::string::npos);
  // A few frames, and their step, that make 998 empty slices of each gap.
  for (const std::size_t gaps : {9, 12}) {
    pacs::SliceSet fine = slices;
    fine.origins_mm.clear();
    for (std::size_t k = 0; k <= gaps * 998; ++k) fine.origins_mm.push_back({0, 0, 0.02 * double(k)});
    pacs::Segment sparse{"skin", {}, pacs::SliceBits(fine.origins_mm.size())};
    for (std::size_t k = 0; k <= gaps; ++k) sparse.bits[k * 998] = std::string((slices.pixels() + 7) / 8, '\1');
    std::string bytes = pacs::encode_segmentation(identity(), fine, {sparse}).bytes;
    const std::string fault = fault_of(bytes);
    if (gaps < 10)
      EXPECT_EQ(fault, "");
    else
      EXPECT_NE(fault.find("at most 10000"), std::string::npos) << fault;
  }
  for (const double spacing : {1e-4, 2e3}) {
    pacs::SliceSet strange = slices;
    strange.dx_mm = spacing;
    const std::string fault =
        fault_of(pacs::encode_segmentation(identity(), strange, {noise("skin", slices, 1)}).bytes);
    EXPECT_EQ(fault.substr(0, 28), "65 PixelSpacing (0028,0030):") << fault;
  }
}

TEST(Segmentation, ColoursAreThoseOfDicom) {
  EXPECT_EQ(pacs::lab_of({1, 1, 1}), (std::array<int, 3>{65535, 32896, 32896}));
  EXPECT_EQ(pacs::lab_of({0, 0, 0}), (std::array<int, 3>{0, 32896, 32896}));
  // sRGB red is L 53.24, a 80.09, b 67.20 for D65.
  const auto red = pacs::lab_of({1, 0, 0});
  EXPECT_NEAR(red[0] / 65535.0 * 100, 53.24, 0.02);
  EXPECT_NEAR(red[1] / 65535.0 * 255 - 128, 80.09, 0.02);
  EXPECT_NEAR(red[2] / 65535.0 * 255 - 128, 67.20, 0.01);
}

TEST(Segmentation, EachAnatomyHasOneCode) {
  std::string last;
  for (const pacs::AnatomyCode& c : pacs::anatomy_codes()) {
    EXPECT_LT(last, c.anatomy);
    last = c.anatomy;
    EXPECT_EQ(std::string(pacs::code_of(c.anatomy).code), c.code);
  }
  EXPECT_STREQ(pacs::code_of("tumour").code, "91723000");
}

TEST(DicomCt, VoxelsOfTheCtAreCopiedAndOthersInterpolated) {
  pacs::SliceSet slices = slices_at(uniform_mm);
  grid::Lattice lattice = slices.lattice_of(2);
  lattice.size = {20, 15, 6};
  lattice.spacing_mm.z = 2;
  lattice.origin_mm = slices.lattice_of(2).to_world_mm({5, 4, 0});
  grid::Grid<std::int16_t> ct(lattice);
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 15; ++j)
      for (int i = 0; i < 20; ++i) ct.at(i, j, k) = std::int16_t(100 + 30 * i - 40 * j + 50 * k);
  const auto on = pacs::resampled_on(ct, slices, 4, -1000);
  for (int j = 0; j < slices.rows; ++j)
    for (int i = 0; i < slices.columns; ++i) {
      const bool in = i >= 5 && i < 25 && j >= 4 && j < 19;
      EXPECT_EQ(on[std::size_t(j) * 37 + std::size_t(i)], in ? ct.at(i - 5, j - 4, 2) : -1000);
    }
  // Tilted slices between the voxels: a linear function stays one, to the rounding of HU.
  const pacs::SliceSet tilted = slices_at({5.3, 6.1, 7.7}, 0.2);
  std::size_t inside = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto moved = pacs::resampled_on(ct, tilted, k, -1000);
    for (int j = 0; j < tilted.rows; ++j)
      for (int i = 0; i < tilted.columns; ++i) {
        const std::int16_t is = moved[std::size_t(j) * 37 + std::size_t(i)];
        if (is == -1000) continue;
        const Vec3 q = lattice.to_index(tilted.lattice_of(k).to_world_mm({double(i), double(j), 0}));
        EXPECT_NEAR(is, 100 + 30 * q.x - 40 * q.y + 50 * q.z, 0.51);
        ++inside;
      }
  }
  EXPECT_GT(inside, 500u);
}

TEST(DicomCt, OfAFaceThatWasRemovedTheSlicesShowNothingNearer) {
  const pacs::SliceSet own = slices_at(uniform_mm);
  grid::Lattice lattice = own.lattice_of(0);
  lattice.size[2] = 10;
  lattice.spacing_mm.z = 2;
  grid::Grid<std::int16_t> ct(lattice, 40);
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 29; ++j)
      for (int i = 0; i < 12; ++i) ct.at(i, j, k) = -1000;  // a face
  ct.at(30, 20, 5) = -1000;                                 // a voxel of air by chance
  EXPECT_EQ(pacs::with_room_around_removed(ct, own), ct);
  pacs::SliceSet tilted = slices_at({0.4, 3.1, 5.8, 8.5, 11.2, 13.9, 16.6}, 0.2);
  const auto changed = pacs::with_room_around_removed(ct, tilted);
  EXPECT_EQ(changed.at(30, 20, 5), -1000);
  EXPECT_EQ(changed.at(29, 20, 5), 40);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(changed.at(13, 14, k), -1000);  // two pixels more
    EXPECT_EQ(changed.at(14, 14, k), 40);
  }
  // A lid over the face alone: two slices more.
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 29; ++j)
      for (int i = 0; i < 37; ++i) ct.at(i, j, k) = k < 3 ? -1000 : 40;
  const auto lid = pacs::with_room_around_removed(ct, tilted);
  EXPECT_EQ(lid.at(18, 14, 5), -1000);
  EXPECT_EQ(lid.at(18, 14, 6), 40);
}

}  // namespace
}  // namespace trephine
