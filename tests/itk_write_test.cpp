// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes written in other programs' formats, and scenes of 3D Slicer that hold them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "base/error.h"
#include "base/write_file.h"
#include "dicom/import.h"
#include "itk/slicer_scene.h"
#include "itk/volume_file.h"
#include "itk/volume_write.h"
#include "itk_small_ct.h"
#include "phantom/random.h"
#include "scratch_folder.h"
#include "zip_writer.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

std::string fault(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return std::to_string(static_cast<int>(e.code())) + " " + e.field() + ": " + e.what();
  }
  return "";
}

std::string scene(const std::string& volumes) {
  return "<MRML version=\"Slicer4.4.0\" userTags=\"\">\n <!-- a > comment -->\n" + volumes + "</MRML>\n";
}
std::string volume(int n, const std::string& file, const std::string& more = "") {
  const std::string id = std::to_string(n);
  return "  <Volume\n  id=\"vtkMRMLScalarVolumeNode" + id + "\" name=\"A &amp; B\" references=\"display:d" + id +
         ";storage:vtkMRMLVolumeArchetypeStorageNode" + id + ";" + more +
         "\" ></Volume>\n  <VolumeArchetypeStorage id=\"vtkMRMLVolumeArchetypeStorageNode" + id + "\" fileName=\"" +
         file + "\" ></VolumeArchetypeStorage>\n";
}

}  // namespace

TEST(VolumeWrite, EveryFormatAndSampleComesBack) {
  const ScratchFolder folder;
  const grid::Grid<std::int16_t> ct = small_ct(false);
  grid::Grid<float> field(static_cast<const grid::Lattice&>(ct));
  grid::Mask labels(static_cast<const grid::Lattice&>(ct));
  for (std::size_t n = 0; n < ct.voxels.size(); ++n) {
    field.voxels[n] = 0.123f * static_cast<float>(ct.voxels[n]);
    labels.voxels[n] = ct.voxels[n] > 226 ? 2 : ct.voxels[n] > -500;
  }
  for (const std::string& ending : itk::written_volume_endings())
    for (const grid::AnyGrid& grid : {grid::AnyGrid(ct), grid::AnyGrid(field), grid::AnyGrid(labels)}) {
      const fs::path file = folder.path() / ("v" + ending);
      itk::write_volume_file(file, grid);
      const grid::AnyGrid back = itk::read_grid_file(file, nullptr, nullptr);
      const grid::Lattice& at = std::visit([](const auto& g) -> const grid::Lattice& { return g; }, back);
      ASSERT_EQ(at.size, ct.size) << ending;
      for (const Vec3 v : {Vec3{0, 0, 0}, Vec3{23, 19, 17}})
        EXPECT_LT(norm(at.to_world_mm(v) - ct.to_world_mm(v)), 1e-4) << ending;
      for (std::size_t n = 0; n < ct.voxels.size(); ++n)
        ASSERT_EQ(std::visit([&](const auto& g) { return double(g.voxels[n]); }, back),
                  std::visit([&](const auto& g) { return double(g.voxels[n]); }, grid))
            << ending;
      const std::vector<char> once = read_file(file);
      itk::write_volume_file(file, grid);
      EXPECT_EQ(read_file(file), once) << ending << ": the same bytes again";
    }
  EXPECT_EQ(fault([&] { itk::write_volume_file(folder.path() / "v.hdr", ct); }).substr(0, 2), "64");
}

TEST(VolumeWrite, DirectionsAreKeptOrRefused) {
  const ScratchFolder folder;
  grid::Grid<std::int16_t> ct = small_ct();
  for (const bool left_handed : {false, true}) {
    if (left_handed) ct.direction.column[2] = -ct.direction.column[2];
    for (const std::string& ending : itk::written_volume_endings()) {
      const fs::path file = folder.path() / ("o" + ending);
      const std::string said = fault([&] { itk::write_volume_file(file, ct); });
      if (ending == ".vtk" || ending.substr(0, 5) == ".gipl") {
        EXPECT_EQ(said.substr(0, 12), "65 direction") << ending;
        EXPECT_FALSE(fs::exists(file));
        continue;
      }
      EXPECT_EQ(said, "") << ending;
      const itk::VolumeFile back = itk::read_volume_file(file);
      const auto& g = std::get<grid::Grid<std::int16_t>>(back.volume);
      EXPECT_GT(determinant(g.direction), 0) << ending;
      for (const auto& at : {std::array<int, 3>{2, 3, 4}, std::array<int, 3>{20, 11, 15}}) {
        const Vec3 v = g.to_index(ct.to_world_mm({double(at[0]), double(at[1]), double(at[2])}));
        EXPECT_EQ(g.at(int(std::lround(v.x)), int(std::lround(v.y)), int(std::lround(v.z))), ct.at(at[0], at[1], at[2]))
            << ending;
      }
    }
  }
}

TEST(VolumeWrite, LabelsOfEveryFormat) {
  const ScratchFolder folder;
  grid::Mask labels(small_lattice(false));
  for (std::size_t n = 0; n < labels.voxels.size(); ++n) labels.voxels[n] = n % 5;
  for (const char* name : {"l.mha", "l.mnc", "l.gipl", "l.vtk", "l.nii.gz", "l.nrrd"}) {
    itk::write_volume_file(folder.path() / name, labels);
    const grid::LabelFile read = itk::read_label_file(folder.path() / name);
    EXPECT_EQ(grid::pick_label(read, "3").voxels, labels.voxels.size() / 5) << name;
  }
  grid::Grid<float> none(small_lattice(false), 0.5f);
  itk::write_volume_file(folder.path() / "f.mha", none);
  EXPECT_EQ(fault([&] { itk::read_label_file(folder.path() / "f.mha"); }).substr(0, 7), "65 data");
}

TEST(SlicerScene, ItsVolumesAndWhatLiesElsewhere) {
  using itk::scene_volumes;
  const auto two = scene_volumes(scene(volume(1, "CT%20head.nrrd") + volume(2, "./Data/mr.nrrd", "transform:t1;")));
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].file, "CT head.nrrd");
  EXPECT_FALSE(two[0].transformed);
  EXPECT_EQ(two[1].file, "Data/mr.nrrd");
  EXPECT_TRUE(two[1].transformed);
  for (const char* file : {"/etc/passwd", "../x.nrrd", "a/%2e%2e/x.nrrd", "C:/x.nrrd", "..%5Cx.nrrd", ""})
    EXPECT_NE(fault([&] { scene_volumes(scene(volume(1, file))); }), "") << file;
  EXPECT_NE(fault([&] { scene_volumes("<html><Volume></html>"); }).find("no scene"), std::string::npos);
  const std::string whole = scene(volume(1, "a.nrrd"));
  for (std::size_t end = 0; end < whole.size() - 8; ++end) try {  // cut short anywhere: read or refused
      scene_volumes(std::string_view(whole).substr(0, end));
    } catch (const Error& e) {
      EXPECT_EQ(e.field(), "scene");
    }
}

TEST(SlicerScene, IsImportedFromFolderAndArchive) {
  const ScratchFolder folder;
  const grid::Grid<std::int16_t> ct = small_ct();
  grid::Grid<std::int16_t> second = ct;
  second.voxels[5] = -990;
  fs::create_directories(folder.path() / "scene/Data");
  itk::write_volume_file(folder.path() / "scene/Data/CT head.nrrd", ct);
  itk::write_volume_file(folder.path() / "scene/Data/b.nrrd", second);
  const auto bytes = [&](const char* name) {
    const std::vector<char> b = read_file(folder.path() / "scene/Data" / name);
    return std::string(b.begin(), b.end());
  };
  const std::string both = scene(volume(1, "Data/CT%20head.nrrd") + volume(2, "Data/b.nrrd")),
                    one = scene(volume(1, "Data/CT%20head.nrrd")),
                    moved = scene(volume(1, "Data/CT%20head.nrrd", "transform:t;"));
  dicom::ImportParams p;
  p.volume_values = dicom::VolumeValues::hu;
  std::string sha;
  for (const bool archive : {false, true}) {
    const auto made = [&](const std::string& mrml) {
      const fs::path path = folder.path() / (archive ? "s.mrb" : "scene/s.mrml");
      write_file(path, archive ? synthetic::zip_bytes({{"s/s.mrml", mrml},
                                                       {"s/Data/CT head.nrrd", bytes("CT head.nrrd")},
                                                       {"s/Data/b.nrrd", bytes("b.nrrd")}})
                               : mrml);
      return path;
    };
    p.series = "";
    const dicom::ImportResult r = dicom::import_series(made(one), p);
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(r.volume).voxels, ct.voxels);
    EXPECT_TRUE(sha.empty() || sha == r.input_sha256) << "the same content is the same input";
    sha = r.input_sha256;
    EXPECT_EQ(dicom::hash_of_series_input(made(one), p), sha);
    EXPECT_NE(fault([&] { dicom::import_series(made(both), p); }).find("2 volumes, choose one by its token: s1, s2"),
              std::string::npos);
    EXPECT_EQ(dicom::list_series(made(both), p).series.size(), 2u);
    EXPECT_EQ(dicom::list_series(made(both), p).series[1].token, "s2-24x20x18");
    p.series = "s2-24x20x18";
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(dicom::import_series(made(both), p).volume).voxels, second.voxels);
    p.series = "s3";
    EXPECT_EQ(fault([&] { dicom::import_series(made(both), p); }).substr(0, 9), "64 series");
    p.series = "";
    EXPECT_NE(fault([&] { dicom::import_series(made(moved), p); }).find("harden the transform"), std::string::npos);
    EXPECT_NE(fault([&] {
                dicom::import_series(made(scene(volume(1, "Data/gone.nrrd"))), p);
              }).find("scene: the volume's file"),
              std::string::npos);
  }
}

TEST(VolumeFolder, OfSeveralMetaImages) {
  const ScratchFolder folder;
  const grid::Grid<std::int16_t> ct = small_ct();
  fs::create_directories(folder.path() / "many");
  itk::write_volume_file(folder.path() / "many/a.mha", small_ct(false));
  itk::write_volume_file(folder.path() / "many/b.mha", ct);
  dicom::ImportParams p;
  p.volume_values = dicom::VolumeValues::hu;
  EXPECT_EQ(fault([&] { dicom::import_series(folder.path() / "many", p); }).substr(0, 9), "64 series");
  EXPECT_EQ(dicom::list_series(folder.path() / "many", p).series.size(), 2u);
  p.series = "s2";
  const dicom::ImportResult r = dicom::import_series(folder.path() / "many", p);
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(r.volume).voxels, ct.voxels);
  EXPECT_LT(norm(grid::lattice_of(r.volume).to_world_mm({0, 19, 0}) - ct.to_world_mm({0, 19, 0})), 1e-9);
}

// Damaged MINC files: the parent lives, and what is read lies where the file's attributes now say, with the values that
// valid_range, image-min and image-max now say.
namespace {

/// Where a double lies in the file, each time that it occurs.
std::vector<std::size_t> places_of(const std::vector<char>& bytes, double number) {
  const char* raw = reinterpret_cast<const char*>(&number);
  std::vector<std::size_t> found;
  for (auto at = bytes.begin(); (at = std::search(at, bytes.end(), raw, raw + 8)) != bytes.end(); ++at)
    found.push_back(static_cast<std::size_t>(at - bytes.begin()));
  return found;
}
/// Where numbers lie side by side, which must be in the file once.
std::size_t place_of(const std::vector<char>& bytes, const std::vector<double>& numbers) {
  const char* raw = reinterpret_cast<const char*>(numbers.data());
  const auto at = std::search(bytes.begin(), bytes.end(), raw, raw + 8 * numbers.size());
  EXPECT_NE(at, bytes.end());
  EXPECT_EQ(std::search(at + 1, bytes.end(), raw, raw + 8 * numbers.size()), bytes.end());
  return static_cast<std::size_t>(at - bytes.begin());
}
double double_at(const std::vector<char>& bytes, std::size_t at) {
  double v;
  std::memcpy(&v, bytes.data() + at, 8);
  return v;
}

void read_minc_mutants(std::uint64_t count, std::uint64_t seed) {
  const ScratchFolder folder;
  const grid::Grid<std::int16_t> ct = small_ct();
  const fs::path file = folder.path() / "m.mnc";
  itk::write_volume_file(file, ct);
  const std::vector<char> whole = read_file(file);
  std::array<std::size_t, 3> step_at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto places = places_of(whole, ct.spacing_mm[static_cast<int>(a)]);
    ASSERT_EQ(places.size(), 1u) << "the step's double occurs once";
    step_at[a] = places[0];
  }
  // MINC's RAS: a place is the sum of (start + step times index) times direction_cosines over the axes.
  std::array<std::size_t, 3> start_at{}, cosines_at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 axis = ct.direction.column[a];
    double start = 0;
    for (int r = 0; r < 3; ++r) start += ct.origin_mm[r] * axis[r];
    start_at[a] = place_of(whole, {start});
    cosines_at[a] = place_of(whole, {0 - axis.x + 0.0, 0 - axis.y + 0.0, axis.z});
  }
  // valid_range lies as two numbers side by side; image-min and image-max are the other two.
  const auto lows = places_of(whole, -32768), highs = places_of(whole, 32767);
  ASSERT_EQ(lows.size(), 2u);
  ASSERT_EQ(highs.size(), 2u);
  const bool first = highs[0] == lows[0] + 8 || highs[1] == lows[0] + 8;
  const std::size_t stored_low = lows[first ? 0 : 1], image_low = lows[first ? 1 : 0], stored_high = stored_low + 8,
                    image_high = highs[highs[0] == stored_high ? 1 : 0];
  ASSERT_TRUE(highs[0] == stored_high || highs[1] == stored_high);
  int read = 0, refused = 0, died = 0, other_voxels = 0, other_place = 0, unsaid = 0;
  for (std::uint64_t n = 0; n < count; ++n) {
    std::vector<char> mutant = whole;
    for (std::uint64_t m = 0; m <= n % 3; ++m) {
      const auto bits = phantom::random_bits(seed, 2 + m, n);
      mutant[bits % mutant.size()] = static_cast<char>(bits >> 40);
    }
    write_file(file, {mutant.data(), mutant.size()});
    try {
      const itk::VolumeFile v = itk::read_volume_file(file);
      ++read;
      const grid::Lattice& l = grid::lattice_of(v.volume);
      ASSERT_EQ(l.count(), ct.count()) << n;
      for (std::size_t a = 0; a < 3; ++a) {
        const double said = std::fabs(double_at(mutant, step_at[a]));
        ASSERT_NEAR(l.spacing_mm[static_cast<int>(a)], said, 1e-9 * said) << n;
      }
      for (int corner = 0; corner < 8; ++corner) {
        Vec3 said;
        for (std::size_t a = 0; a < 3; ++a) {
          const double along =
              double_at(mutant, start_at[a]) + (corner >> a & 1 ? ct.size[a] - 1 : 0) * double_at(mutant, step_at[a]);
          for (int r = 0; r < 3; ++r)
            said[r] += (r < 2 ? -1 : 1) * along * double_at(mutant, cosines_at[a] + 8 * std::size_t(r));
        }
        double nearest = 1e300;
        for (int other = 0; other < 8; ++other) {
          Vec3 index;
          for (int a = 0; a < 3; ++a) index[a] = other >> a & 1 ? l.size[std::size_t(a)] - 1.0 : 0;
          nearest = std::min(nearest, norm(l.to_world_mm(index) - said));
        }
        // Axes that are not quite of length one, or at right angles, are made so.
        ASSERT_LT(nearest, 0.01 + 2e-3 * norm(said)) << n << ": lies elsewhere, unsaid";
      }
      other_place += norm(l.to_world_mm({0, 0, 0}) - ct.to_world_mm({0, 0, 0})) > 1e-6;
      const double low = double_at(mutant, stored_low), high = double_at(mutant, stored_high),
                   zero = double_at(mutant, image_low), scale = (double_at(mutant, image_high) - zero) / (high - low);
      bool other = false, elsewhere = false;
      for (std::size_t i = 0; i < ct.voxels.size(); ++i) {
        const double said = zero + (ct.voxels[i] - low) * scale,
                     is = std::visit([&](const auto&g) { return double(g.voxels[i]); }, v.volume);
        elsewhere = elsewhere || !(std::fabs(is - said) <= 1e-6 * (std::fabs(zero) + std::fabs(said) + 32768));
        other = other || is != ct.voxels[i];
      }
      other_voxels += other;
      unsaid += elsewhere;
    } catch (const Error& e) {
      ASSERT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal) << e.what();
      ++refused;
      died += e.code() == ExitCode::internal;
    }
  }
  std::printf(
      "MINC: %d read (%d with other values, as the file then says, %d elsewhere), %d refused, %d of them by the "
      "child's death\n",
      read, other_voxels, other_place, refused, died);
  // An address that leads to another place of the same file is believed: one of 10,000.
  EXPECT_LE(unsaid, 1) << "other values, unsaid";
  EXPECT_GT(refused, 0);
  EXPECT_GT(read, 0);
}

}  // namespace

TEST(VolumeWrite, DamagedMinc) { read_minc_mutants(100, 1); }

class LongDamagedMinc : public testing::TestWithParam<int> {};
TEST_P(LongDamagedMinc, AThousandOfTen) { read_minc_mutants(1000, static_cast<std::uint64_t>(100 + GetParam())); }
INSTANTIATE_TEST_SUITE_P(Volumes, LongDamagedMinc, testing::Range(0, 10));
