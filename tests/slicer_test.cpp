// SPDX-License-Identifier: GPL-3.0-or-later
// A segmentation comes back voxel for voxel, on axes of any direction, with segments that overlap.
#include <gtest/gtest.h>

#include <random>

#include "grid/labels.h"
#include "meshio/zip_bundle.h"
#include "slicer/segmentation.h"

namespace trephine {
namespace {

grid::Lattice lattice_of(bool left_handed) {
  grid::Lattice l;
  l.size = {13, 7, 5};
  l.spacing_mm = {0.7, 0.9, 1.5};
  l.origin_mm = {-11.25, 40.5, 300};
  const double c = 0.8, s = 0.6;
  l.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, left_handed ? -1.0 : 1.0}};
  return l;
}

/// Voxels by chance, of the lattice.
std::vector<std::uint8_t> noise(const grid::Lattice& l, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> all(l.count());
  for (std::uint8_t& v : all) v = random() % 3 == 0;
  return all;
}

// As pacs::bits_inside gives them: slices in the direction of the normal.
pacs::SliceBits bits_of(const grid::Lattice& l, const std::vector<std::uint8_t>& voxels) {
  pacs::SliceBits bits;
  const std::size_t pixels = std::size_t(l.size[0]) * std::size_t(l.size[1]);
  for (std::size_t k = 0; k < std::size_t(l.size[2]); ++k)
    bits.push_back(pacs::packed({voxels.begin() + long(k * pixels), voxels.begin() + long((k + 1) * pixels)}));
  if (determinant(l.direction) < 0) std::reverse(bits.begin(), bits.end());
  return bits;
}

TEST(Segmentation, ComesBackVoxelForVoxelInLayersOnAnyAxes) {
  for (const bool left_handed : {false, true}) {
    const grid::Lattice l = lattice_of(left_handed);
    const auto skin = noise(l, 1), skull = noise(l, 2);
    std::vector<std::uint8_t> brain(l.count());  // beside the skull, so that it needs no layer of its own
    for (std::size_t i = 0; i < brain.size(); ++i) brain[i] = !skull[i] && i % 2 == 0;
    const std::vector<std::vector<std::uint8_t>> given{skin, skull, brain};
    std::vector<pacs::Segment> segments;
    const char* const names[] = {"skin", "skull", "brain"};
    for (std::size_t n = 0; n < 3; ++n) segments.push_back({names[n], {0.25, 0.5, 0.9}, bits_of(l, given[n])});
    const std::string bytes = slicer::encode_segmentation(l, segments);
    EXPECT_EQ(bytes, slicer::encode_segmentation(l, segments));

    const grid::LabelFile back = grid::decode_labels(bytes);
    EXPECT_EQ(back.format, "seg.nrrd");
    EXPECT_EQ(back.layers, 2);
    EXPECT_EQ(back.lattice.size, l.size);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 ijk{corner & 1 ? 12.0 : 0, corner & 2 ? 6.0 : 0, corner & 4 ? 4.0 : 0};
      EXPECT_LT(norm(back.lattice.to_world_mm(ijk) - l.to_world_mm(ijk)), 1e-9);
    }
    for (std::size_t n = 0; n < 3; ++n)
      EXPECT_EQ(grid::pick_label(back, names[n]).mask.voxels, given[n]) << names[n] << left_handed;
  }
}

TEST(Segmentation, SaysWhatEachSegmentIs) {
  const grid::Lattice l = lattice_of(false);
  const std::string bytes = slicer::encode_segmentation(
      l, {{"brain", {0.85, 0.62, 0.62}, bits_of(l, noise(l, 1))}, {"odd_thing", {}, bits_of(l, noise(l, 2))}});
  const grid::LayeredNrrd back = grid::decode_layered_nrrd(bytes);
  EXPECT_EQ(back.keys.at("Segment0_Color"), "0.85 0.62 0.62");
  EXPECT_NE(back.keys.at("Segment0_Tags").find("~SCT^123037004^Anatomical Structure~SCT^12738006^Brain~^^~"),
            std::string::npos);
  EXPECT_NE(back.keys.at("Segment1_Tags").find("~SCT^91723000^Anatomical Structure~^^~"), std::string::npos);
}

TEST(Bundle, IsTheSameWhateverTheTimeZone) {
  const std::vector<meshio::ExportFile> files{{"a.mrml", "<MRML/>"}, {"Data/b.bin", std::string(100000, 'b')}};
  const std::string bytes = meshio::bundle_of("case", files);
  setenv("TZ", "Pacific/Kiritimati", 1);
  tzset();
  EXPECT_EQ(bytes, meshio::bundle_of("case", files));
  unsetenv("TZ");
  tzset();
  EXPECT_EQ(bytes.substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(bytes.substr(10, 4), std::string("\0\0\x21\0", 4));  // time 0 on 1 January 1980
  EXPECT_NE(bytes.find("case/Data/b.bin"), std::string::npos);
  EXPECT_LT(bytes.size(), 2000u);
}

}  // namespace
}  // namespace trephine
