// SPDX-License-Identifier: GPL-3.0-or-later
#include <gdcmImageReader.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "meshio/vtp.h"
#include "phantom/phantom.h"
#include "scratch_folder.h"

using namespace trephine;
using namespace trephine::phantom;

namespace {

phantom::PhantomParams tiny() {
  phantom::PhantomParams p;
  p.scan.columns_count = 64;
  p.scan.rows_count = 48;
  p.scan.pixel_mm = 4;
  p.scan.slices_count = 5;
  p.scan.slice_step_mm = 20;
  p.truth.mesh_step_mm = 4;
  return p;
}

/// A body in voxels of 2 mm that neither noise nor a kernel changes.
phantom::PhantomParams exact(phantom::BodyParams::Body body, int columns, int slices) {
  phantom::PhantomParams p;
  p.body.body = body;
  p.scan.columns_count = p.scan.rows_count = columns;
  p.scan.pixel_mm = 2;
  p.scan.slices_count = slices;
  p.scan.slice_step_mm = p.scan.slice_thickness_mm = 2;
  p.scan.noise_hu = 0;
  p.scan.kernel_mm = 0;
  return p;
}

std::string text_of(const gdcm::DataSet& set, std::uint16_t group, std::uint16_t element) {
  const gdcm::Tag tag(group, element);
  if (!set.FindDataElement(tag) || !set.GetDataElement(tag).GetByteValue()) return "";
  const gdcm::ByteValue& bytes = *set.GetDataElement(tag).GetByteValue();
  std::string text(bytes.GetPointer(), bytes.GetLength());
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

std::map<std::string, std::string> hashes_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& e : std::filesystem::recursive_directory_iterator(folder))
    if (e.is_regular_file()) out[e.path().lexically_relative(folder).string()] = sha256_of_file(e.path());
  return out;
}

}  // namespace

// GDCM reads back geometry and HU as they were, in each encoding.
TEST(PhantomSeries, GdcmReadsItBack) {
  struct Case {
    phantom::Encoding encoding;
    phantom::Pixels pixels;
    std::int64_t intercept;
  };
  for (const Case& c : {Case{phantom::Encoding::none, phantom::Pixels::signed_16, 0},
                        Case{phantom::Encoding::none, phantom::Pixels::unsigned_16, -2048},
                        Case{phantom::Encoding::rle, phantom::Pixels::signed_16, 100},
                        Case{phantom::Encoding::jpeg_ls, phantom::Pixels::unsigned_12, -1024},
                        Case{phantom::Encoding::jpeg_ls, phantom::Pixels::signed_16, 0},
                        Case{phantom::Encoding::jpeg_2000, phantom::Pixels::unsigned_16, -1024},
                        Case{phantom::Encoding::jpeg_2000, phantom::Pixels::signed_16, 0}}) {
    ScratchFolder folder;
    phantom::PhantomParams p = tiny();
    p.scan.tilt_deg = 13.5;
    p.scan.position = phantom::Position::feet_first_prone;
    p.series = {c.encoding, c.pixels, c.intercept};
    const phantom::Scan s = phantom::scan(phantom::Head(p.head), p.scan);
    const std::uint64_t bytes = phantom::write_series(folder.path(), s, p.scan, p.series, phantom::identity_of(p));
    std::uint64_t on_disk = 0;
    for (int k = 0; k < 5; ++k) {
      const auto file = folder.path() / ("slice_000" + std::to_string(k + 1) + ".dcm");
      on_disk += std::filesystem::file_size(file);
      gdcm::ImageReader reader;
      reader.SetFileName(file.c_str());
      ASSERT_TRUE(reader.Read());
      const gdcm::Image& image = reader.GetImage();
      const phantom::SlicePose& pose = s.slices[k];
      for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR(image.GetOrigin(a), pose.origin_mm[a], 1e-8);
        EXPECT_NEAR(image.GetDirectionCosines()[a], pose.row[a], 1e-12);
        EXPECT_NEAR(image.GetDirectionCosines()[3 + a], pose.column[a], 1e-12);
      }
      EXPECT_EQ(image.GetSpacing(0), 4);
      EXPECT_EQ(image.GetDimension(0), 64u);
      EXPECT_EQ(image.GetDimension(1), 48u);
      EXPECT_EQ(image.GetIntercept(), c.intercept);
      EXPECT_EQ(image.GetSlope(), 1);
      std::vector<std::int16_t> stored(64 * 48);
      ASSERT_EQ(image.GetBufferLength(), stored.size() * 2);
      ASSERT_TRUE(image.GetBuffer(reinterpret_cast<char*>(stored.data())));
      for (std::size_t i = 0; i < stored.size(); ++i) {
        const long value = c.pixels == phantom::Pixels::signed_16 ? stored[i] : static_cast<std::uint16_t>(stored[i]);
        ASSERT_EQ(value + c.intercept, s.hu[k * stored.size() + i]) << "pixel " << i;
      }
      const gdcm::DataSet& set = reader.GetFile().GetDataSet();
      EXPECT_EQ(text_of(set, 0x0008, 0x0016), "1.2.840.10008.5.1.4.1.1.2");
      EXPECT_EQ(text_of(set, 0x0012, 0x0062), "YES");
      EXPECT_EQ(text_of(set, 0x0018, 0x5100), "FFP");
      EXPECT_EQ(text_of(set, 0x0018, 0x1120), "13.5");
      const std::string uid = text_of(set, 0x0008, 0x0018);
      EXPECT_EQ(uid.substr(0, 5), "2.25.");
      EXPECT_LE(uid.size(), 64u);
    }
    EXPECT_EQ(bytes, on_disk);
  }
}

TEST(PhantomSeries, PaddingIsNamedByItsTag) {
  ScratchFolder folder;
  phantom::PhantomParams p = tiny();
  p.scan.round_field = true;
  p.series = {phantom::Encoding::none, phantom::Pixels::signed_16, 0};
  phantom::write_series(folder.path(), phantom::scan(phantom::Head(p.head), p.scan), p.scan, p.series, "x");
  gdcm::ImageReader reader;
  reader.SetFileName((folder.path() / "slice_0001.dcm").c_str());
  ASSERT_TRUE(reader.Read());
  const std::string padding = text_of(reader.GetFile().GetDataSet(), 0x0028, 0x0120);
  ASSERT_EQ(padding.size(), 2u);
  std::int16_t value;
  std::memcpy(&value, padding.data(), 2);
  EXPECT_EQ(value, -2000);
}

TEST(PhantomSeries, ValuesThatDoNotFitAreRefused) {
  ScratchFolder folder;
  phantom::PhantomParams p = tiny();
  p.series = {phantom::Encoding::none, phantom::Pixels::unsigned_12, 0};
  try {
    phantom::write_series(folder.path(), phantom::scan(phantom::Head(p.head), p.scan), p.scan, p.series, "x");
    FAIL() << "-1000 HU in an unsigned pixel with intercept 0";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::usage);
  }
}

TEST(PhantomSeries, ShorterSeriesLeavesNoSliceOfALongerOne) {
  ScratchFolder folder;
  phantom::PhantomParams p = tiny();
  phantom::write_series(folder.path(), phantom::scan(phantom::Head(p.head), p.scan), p.scan, p.series, "x");
  p.scan.slices_count = 3;
  phantom::write_series(folder.path(), phantom::scan(phantom::Head(p.head), p.scan), p.scan, p.series, "x");
  EXPECT_EQ(hashes_of(folder.path()).size(), 3u);
}

// Everything that make_phantom writes is the same for the same parameters with 1 and 2 threads, and the truth can be
// read back.
TEST(PhantomTruth, SameFilesWhateverTheThreadsAndReadBack) {
  ScratchFolder a, b;
  phantom::PhantomParams p = tiny();
  p.head.variant = phantom::Variant::hydrocephalic;
  p.head.seed = 11;
  p.scan.contents = phantom::Contents::head_with_fiducials;
  set_thread_count(1);
  const phantom::PhantomResult made = phantom::make_phantom(a.path() / "one", p);
  set_thread_count(2);
  phantom::make_phantom(b.path() / "elsewhere", p);
  set_thread_count(0);
  const auto files = hashes_of(a.path() / "one");
  EXPECT_EQ(files, hashes_of(b.path() / "elsewhere"));
  for (const char* name : {"truth/truth.json", "truth/labels.nrrd", "truth/skin.vtp", "truth/skull.vtp",
                           "truth/brain.vtp", "truth/ventricles.vtp", "dicom/slice_0005.dcm"})
    EXPECT_EQ(files.count(name), 1u) << name;
  ASSERT_NE(find_item(figures_of(made), "brain_volume_ml"), nullptr);

  const phantom::Truth truth = phantom::read_truth(a.path() / "one/truth/truth.json");
  const phantom::Head head(p.head);
  EXPECT_EQ(truth.head.params().variant, phantom::Variant::hydrocephalic);
  EXPECT_EQ(truth.head.params().seed, 11);
  EXPECT_EQ(truth.head.landmark("kocher_left"), head.landmark("kocher_left"));
  EXPECT_EQ(truth.fiducials.size(), 12u);
  for (const phantom::Anatomy anatomy : phantom::all_anatomies)
    EXPECT_EQ(truth.head.implicit_mm(anatomy, {10, 20, 30}), head.implicit_mm(anatomy, {10, 20, 30}));

  // Labels were made block by block: they are the head's own at every voxel.
  const grid::Mask labels = grid::read_mask_nrrd(a.path() / "one/truth/labels.nrrd");
  std::array<int, 6> counts{};
  for (int k = 0; k < labels.size[2]; ++k)
    for (int j = 0; j < labels.size[1]; ++j)
      for (int i = 0; i < labels.size[0]; ++i) {
        const std::uint8_t label = labels.at(i, j, k);
        ASSERT_EQ(label, head.label(labels.to_world_mm({1.0 * i, 1.0 * j, 1.0 * k})));
        ++counts[label];
      }
  for (const int c : counts) EXPECT_GT(c, 0);
}

TEST(PhantomTruth, WhatIsNoTruthIsRefused) {
  ScratchFolder folder;
  const auto code_of = [](const std::filesystem::path& file) {
    try {
      phantom::read_truth(file);
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of(folder.path() / "none.json"), ExitCode::no_input);
  EXPECT_EQ(code_of(folder.write("a.json", "hello")), ExitCode::bad_input);
  EXPECT_EQ(code_of(folder.write("b.json", "{}")), ExitCode::bad_input);
  EXPECT_EQ(code_of(folder.write("c.json", "{\"trephine_phantom_truth\": 2}")), ExitCode::bad_input);
  EXPECT_EQ(code_of(folder.write("d.json", "{\"trephine_phantom_truth\": 1, \"head\": {\"variant\": \"blue\"}}")),
            ExitCode::bad_input);
}

// sample_dicom/ is what its preset makes, to the byte.
TEST(PhantomSeries, AParameterThatCameLaterNamesASeriesOnlyWhereItIsSet) {
  phantom::PhantomParams p = tiny(), other = tiny();
  p.scan.subvoxel_mm = phantom::ScanParams().subvoxel_mm;
  other.scan.subvoxel_mm = 1.5;
  EXPECT_EQ(phantom::identity_of(p).find("subvoxel_mm"), std::string::npos);
  EXPECT_NE(phantom::identity_of(other).find("subvoxel_mm=1.5\n"), std::string::npos);
}

TEST(PhantomSample, RegeneratesTheCommittedSeries) {
  ScratchFolder folder;
  const phantom::PhantomParams p = phantom::sample_phantom();
  phantom::write_series(folder.path(), phantom::scan(phantom::Head(p.head), p.scan), p.scan, p.series,
                        phantom::identity_of(p));
  const std::filesystem::path committed = std::filesystem::path(TREPHINE_SOURCE_DIR) / "sample_dicom";
  std::uint64_t total = 0;
  for (const auto& e : std::filesystem::directory_iterator(committed)) total += e.file_size();
  EXPECT_LE(total, 6u << 20);
  EXPECT_EQ(hashes_of(folder.path()), hashes_of(committed));
}

// A spine: the same bytes whatever the thread count, HU of its tissues where they are, and the truth of what it shows.
TEST(PhantomSpine, IsScannedWithItsTruth) {
  const phantom::PhantomParams p = exact(phantom::BodyParams::Body::spine, 120, 40);
  const ScratchFolder one, other;
  const phantom::PhantomResult made = phantom::make_phantom(one.path(), p);
  set_thread_count(1);
  phantom::make_phantom(other.path(), p);
  set_thread_count(0);
  EXPECT_EQ(hashes_of(one.path()), hashes_of(other.path()));
  // 80 mm hold the one vertebra of 34 mm that is whole, and parts of its neighbours.
  EXPECT_EQ(made.pedicles_count, 2);
  const std::vector<char> truth = read_file(one.path() / "truth" / "truth.json", 1 << 20);
  const std::string text(truth.begin(), truth.end());
  EXPECT_NE(text.find("pedicle_1_left"), std::string::npos);
  EXPECT_EQ(text.find("pedicle_2_left"), std::string::npos);
  const phantom::Scan scanned = phantom::scan(p.body.spine, p.scan, 1);
  const grid::Grid<std::int16_t> ct = phantom::volume_of(scanned);
  const grid::Mask labels = grid::read_mask_nrrd(one.path() / "truth" / "labels.nrrd");
  ASSERT_EQ(labels.count(), ct.count());
  double sum[4] = {0, 0, 0, 0}, count[4] = {0, 0, 0, 0};
  for (std::size_t n = 0; n < ct.count(); ++n) {
    sum[labels.voxels[n]] += ct.voxels[n];
    count[labels.voxels[n]] += 1;
  }
  EXPECT_LT(sum[0] / count[0], -950);
  EXPECT_NEAR(sum[1] / count[1], 45, 40);
  EXPECT_GT(sum[2] / count[2], 250);
  EXPECT_NEAR(sum[3] / count[3], 15, 60);
}

// The truth names the vertebrae that the slices show whole where the spine is, not where their corners are.
TEST(PhantomSpine, ATiltedScansTruthIsOfWhatItShows) {
  phantom::PhantomParams p;
  p.body.body = phantom::BodyParams::Body::spine;
  p.scan.columns_count = p.scan.rows_count = 60;
  p.scan.pixel_mm = 4;
  p.scan.slices_count = 60;
  p.scan.slice_step_mm = p.scan.slice_thickness_mm = 2;
  p.scan.noise_hu = 0;
  p.scan.tilt_deg = 20;
  const ScratchFolder folder;
  phantom::make_phantom(folder.path(), p);
  const std::vector<char> bytes = read_file(folder.path() / "truth" / "truth.json", 1 << 20);
  const auto truth = nlohmann::json::parse(bytes.begin(), bytes.end());
  const std::vector<phantom::SlicePose> slices = phantom::slice_poses(p.scan);
  ASSERT_FALSE(truth.at("pedicles").empty());
  for (const auto& pedicle : truth.at("pedicles")) {
    const auto& m = pedicle.at("middle_mm");
    const Vec3 middle{m[0], m[1], m[2]};
    const Vec3 normal = cross(slices[0].row, slices[0].column);
    const double half = 0.4 * p.body.spine.pitch_mm;
    double low = 1e9, high = -1e9;
    for (const phantom::SlicePose& s : slices) {
      low = std::min(low, dot(normal, s.origin_mm - middle) / normal.z);
      high = std::max(high, dot(normal, s.origin_mm - middle) / normal.z);
    }
    EXPECT_LT(low, -half) << middle.z;
    EXPECT_GT(high, half) << middle.z;
  }
}

// A chest: the same bytes whatever the thread count; each tissue has its HU where the labels have it; vessels and lung
// lie where truth.json and anatomy say; a turn turns all of it.
TEST(PhantomChest, IsScannedWithItsTruth) {
  const phantom::PhantomParams p = exact(phantom::BodyParams::Body::chest, 165, 56);
  const ScratchFolder one, other;
  phantom::make_phantom(one.path(), p);
  set_thread_count(1);
  phantom::make_phantom(other.path(), p);
  set_thread_count(0);
  EXPECT_EQ(hashes_of(one.path()), hashes_of(other.path()));
  const grid::Grid<std::int16_t> ct = phantom::volume_of(phantom::scan(p.body.chest, p.scan, 1));
  const grid::Mask labels = grid::read_mask_nrrd(one.path() / "truth" / "labels.nrrd");
  ASSERT_EQ(labels.count(), ct.count());
  double sum[7] = {}, count[7] = {};
  for (std::size_t n = 0; n < ct.count(); ++n) {
    sum[labels.voxels[n]] += ct.voxels[n];
    count[labels.voxels[n]] += 1;
  }
  const double expected[7] = {-1000, 50, 700, 600, 200, 42, -850};  // edges are mixed
  const double within[7] = {20, 40, 150, 150, 40, 15, 60};
  for (int n = 0; n < 7; ++n) {
    ASSERT_GT(count[n], 200) << n;
    EXPECT_NEAR(sum[n] / count[n], expected[n], within[n]) << n;
  }
  // The needle's way: below the clavicle the vein, behind it the artery, below both the lung; all of it symmetric.
  const phantom::Chest chest;
  const Vec3 notch = chest.notch_mm();
  EXPECT_NEAR(notch.x, 0, 1e-9);
  for (const bool left : {false, true}) {
    const Vec3 bone = chest.clavicle_line(left)[15], vein = chest.vein_line(left)[30],
               artery = chest.artery_line(left)[20];
    EXPECT_GT(chest.clavicle(bone), 5.9);
    EXPECT_GT(chest.vein(vein), 4.9);
    EXPECT_LT(chest.clavicle(vein), 0);
    EXPECT_LT(chest.vein(artery), -2);
    EXPECT_GT(vein.y, bone.y);
    EXPECT_LT(vein.z, bone.z);
    EXPECT_GT(artery.y, vein.y);
    EXPECT_GT(chest.lung({left ? 30.0 : -30.0, 0, -40}), 5);
    for (const Vec3& q : chest.vein_line(left)) {
      EXPECT_LT(chest.lung(q), -6) << q.x << " " << q.y << " " << q.z;  // the pleura's 2 mm lie between
      EXPECT_LT(chest.other_bone(q), 0) << q.x << " " << q.y << " " << q.z;
      EXPECT_GT(chest.skin(q), 10);
    }
  }
  phantom::ChestParams askew;
  askew.chest_turned_deg = 8;
  const phantom::Chest turned(askew);
  const double a = 8 * M_PI / 180, x = notch.x * std::cos(a) - notch.y * std::sin(a);
  EXPECT_NEAR(turned.notch_mm().x, x, 1e-9);
  EXPECT_NEAR(turned.vein(turned.vein_line(true)[20]), 5, 0.01);
}

TEST(PhantomSpine, WhatIsOfHeadsIsRefused) {
  const ScratchFolder folder;
  const auto refused = [&](const phantom::PhantomParams& p, const char* field) {
    try {
      phantom::make_phantom(folder.path(), p);
      ADD_FAILURE() << field;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::usage);
      EXPECT_EQ(e.field(), field);
    }
  };
  phantom::PhantomParams spine = tiny();
  spine.body.body = phantom::BodyParams::Body::spine;
  phantom::PhantomParams p = spine;
  p.head.variant = phantom::Variant::small;
  refused(p, "variant");
  p = spine;
  p.head.hard.couch = true;
  refused(p, "couch");
  p = spine;
  p.scan.contents = phantom::Contents::fiducials;
  refused(p, "contents");
  p = tiny();
  p.body.spine.turned_deg = 5;
  refused(p, "turned_deg");
  p.body.body = phantom::BodyParams::Body::chest;
  refused(p, "turned_deg");
  p = spine;
  p.body.chest.vein_contrast_hu = 0;
  refused(p, "vein_contrast_hu");
}
