// SPDX-License-Identifier: GPL-3.0-or-later
// Volume files that are no DICOM: read right, or refused with the key that is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/write_file.h"
#include "dicom/import.h"
#include "grid/nrrd.h"
#include "grid/nrrd_header.h"
#include "itk/volume_file.h"
#include "itk_small_ct.h"
#include "phantom/random.h"
#include "scratch_folder.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

std::string numbers(const std::vector<double>& v) {
  std::string text;
  char one[40];
  for (const double d : v) std::snprintf(one, sizeof one, " %.17g", d), text += one;
  return text;
}

using Keys = std::vector<std::pair<std::string, std::string>>;

Keys meta_keys(const grid::Lattice& l, const std::string& type) {
  const auto& c = l.direction.column;
  return {{"ObjectType", "Image"},
          {"NDims", "3"},
          {"BinaryData", "True"},
          {"BinaryDataByteOrderMSB", "False"},
          {"CompressedData", "False"},
          {"TransformMatrix", numbers({c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z})},
          {"Offset", numbers({l.origin_mm.x, l.origin_mm.y, l.origin_mm.z})},
          {"ElementSpacing", numbers({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z})},
          {"DimSize", numbers({double(l.size[0]), double(l.size[1]), double(l.size[2])})},
          {"ElementType", type}};
}

std::string text_of(const Keys& keys, const std::string& data = "LOCAL") {
  std::string text;
  for (const auto& [key, value] : keys) text += key + " = " + value + "\n";
  return text + "ElementDataFile = " + data + "\n";
}

Keys with(Keys keys, const std::string& key, const std::string& value) {
  for (auto& k : keys)
    if (k.first == key) k.second = value;
  return keys;
}
Keys without(Keys keys, const std::string& key) {
  keys.erase(std::remove_if(keys.begin(), keys.end(), [&](const auto& k) { return k.first == key; }), keys.end());
  return keys;
}

template <class T>
std::string bytes_of(const grid::Grid<std::int16_t>& g, double slope = 1) {
  std::string bytes;
  for (const std::int16_t v : g.voxels) {
    const T t = static_cast<T>(v * slope);
    bytes.append(reinterpret_cast<const char*>(&t), sizeof t);
  }
  return bytes;
}

void expect_same(const fs::path& file, const grid::Grid<std::int16_t>& g) {
  const itk::VolumeFile read = itk::read_volume_file(file);
  ASSERT_TRUE(std::holds_alternative<grid::Grid<std::int16_t>>(read.volume)) << file;
  const auto& got = std::get<grid::Grid<std::int16_t>>(read.volume);
  EXPECT_EQ(got.voxels, g.voxels) << file;
  EXPECT_EQ(got.size, g.size);
  for (const Vec3 v : {Vec3{0, 0, 0}, Vec3{23, 19, 17}, Vec3{23, 0, 17}})
    EXPECT_LT(norm(got.to_world_mm(v) - g.to_world_mm(v)), 1e-9) << file;
}

struct Refused {
  ExitCode code = ExitCode::ok;
  std::string field, what;
};
Refused refusal(const fs::path& file) {
  try {
    itk::read_volume_file(file);
  } catch (const Error& e) {
    return {e.code(), e.field(), e.what()};
  }
  return {};
}

class Volumes : public testing::Test {
 protected:
  ScratchFolder folder;
  grid::Grid<std::int16_t> ct = small_ct();
  fs::path write(const std::string& name, const std::string& bytes) {
    const fs::path file = folder.path() / name;
    write_file(file, bytes);
    return file;
  }
};

}  // namespace

TEST_F(Volumes, MetaImagesOfAllKinds) {
  const Keys keys = meta_keys(ct, "MET_SHORT");
  const std::string data = bytes_of<std::int16_t>(ct);
  expect_same(write("a.mha", text_of(keys) + data), ct);
  write("b.raw", data);
  expect_same(write("b.mhd", text_of(keys, "b.raw")), ct);
  expect_same(write("c.mha", text_of(meta_keys(ct, "MET_FLOAT")) + bytes_of<float>(ct)), ct);
  expect_same(write("d.mha", text_of(meta_keys(ct, "MET_DOUBLE")) + bytes_of<double>(ct)), ct);
  std::string swapped = data;
  for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
  expect_same(write("e.mha", text_of(with(keys, "BinaryDataByteOrderMSB", "True")) + swapped), ct);
  const std::string small = grid::detail::gzip_compress(data);
  Keys packed = with(keys, "CompressedData", "True");
  packed.insert(packed.begin() + 5, {"CompressedDataSize", std::to_string(small.size())});
  expect_same(write("f.mha", text_of(packed) + small), ct);
  // Half of the compressed data: ITK itself reads it without a word.
  Keys half = packed;
  half[5].second = std::to_string(small.size() / 2);
  EXPECT_EQ(refusal(write("g.mha", text_of(half) + small.substr(0, small.size() / 2))).code, ExitCode::bad_input);
  // Nor does it say that there is more than the header says: twice the voxels, or something behind them.
  const std::string twice = grid::detail::gzip_compress(data + data);
  const Keys plain = with(keys, "CompressedData", "True");
  for (const std::string& more : {twice, small + small, small + "x"}) {
    Keys sized = packed;
    sized[5].second = std::to_string(more.size());
    for (const Keys& header : {sized, plain})
      EXPECT_EQ(refusal(write("h.mha", text_of(header) + more)).field, "data") << more.size();
    write("i.zraw", more);
    EXPECT_EQ(refusal(write("i.mhd", text_of(plain, "i.zraw"))).field, "data") << more.size();
  }
}

TEST_F(Volumes, OtherFormatsThatItkReads) {
  const std::string data = bytes_of<std::int16_t>(ct);
  const auto& c = ct.direction.column;
  const auto axis = [&](int k) {
    const Vec3 v = c[k] * ct.spacing_mm[k];
    std::string t = "(";
    for (int a = 0; a < 3; ++a) t += (a ? "," : "") + numbers({v[a]}).substr(1);
    return t + ")";
  };
  const std::string nrrd =
      "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 24 20 18\nspace directions: " +
      axis(0) + " " + axis(1) + " " + axis(2) + "\nendian: little\nencoding: raw\nspace origin: (-30,-41.5,12.25)\n";
  write("n.raw", data);
  expect_same(write("n.nhdr", nrrd + "data file: n.raw\n\n"), ct);
  write("more.raw", data + data);
  EXPECT_EQ(refusal(write("o.nhdr", nrrd + "data file: more.raw\n\n")).field, "data") << "more than the header says";
  std::string packed = nrrd;
  packed.replace(packed.find("raw"), 3, "gzip");
  write("n.raw.gz", grid::detail::gzip_compress(data));
  expect_same(write("n.nhdr", packed + "data file: n.raw.gz\n\n"), ct);
  write("more.raw.gz", grid::detail::gzip_compress(data + data));
  EXPECT_EQ(refusal(write("o.nhdr", packed + "data file: more.raw.gz\n\n")).field, "data");
  EXPECT_EQ(refusal(write("o.nhdr", nrrd + "data file: /etc/passwd\n\n")).field, "data file");
  // The reader knows keys in any case and without spaces, so the check does.
  EXPECT_EQ(refusal(write("o.nhdr", nrrd + "Data File: /etc/passwd\n\n")).field, "data file");
  EXPECT_EQ(refusal(write("o.nhdr", nrrd + "Space Units: \"cm\" \"cm\" \"cm\"\ndata file: n.raw\n\n")).field,
            "Space Units");
  EXPECT_EQ(refusal(write("o.nhdr", nrrd + "data file: n.raw\nDataFile: n.raw\n\n")).field, "DataFile");
  EXPECT_EQ(refusal(write("o.nhdr", nrrd + "\n")).field, "data file");
  EXPECT_EQ(refusal(write("p.nhdr", nrrd + "space units: \"cm\" \"cm\" \"cm\"\ndata file: n.raw\n\n")).field,
            "space units");
  grid::write_nrrd(folder.path() / "own.nrrd", grid::HuVolume(ct));
  expect_same(folder.path() / "own.nrrd", ct);

  std::string swapped = data;  // legacy VTK is big endian
  for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
  const fs::path vtk =
      write("v.vtk",
            "# vtk DataFile Version 3.0\nvolume\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 24 20 18\n"
            "SPACING 2.5 3 4\nORIGIN -30 -41.5 12.25\nPOINT_DATA 8640\nSCALARS s short 1\nLOOKUP_TABLE default\n" +
                swapped);
  const itk::VolumeFile read = itk::read_volume_file(vtk);
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(read.volume).voxels, ct.voxels);
  EXPECT_EQ(read.warnings.size(), 1u);
  // Analyze, which does not say which side is left, in a folder of its own.
  std::string header(348, '\0');
  const auto put = [&](std::size_t at, auto v) { std::memcpy(header.data() + at, &v, sizeof v); };
  put(0, std::int32_t{348});
  const std::int16_t dim[] = {3, 24, 20, 18};
  for (std::size_t a = 0; a < 4; ++a) put(40 + 2 * a, dim[a]);
  put(70, std::int16_t{4});
  put(72, std::int16_t{16});
  const float steps[] = {2.5f, 3, 4};
  for (std::size_t a = 0; a < 3; ++a) put(80 + 4 * a, steps[a]);
  fs::create_directories(folder.path() / "pair");
  EXPECT_EQ(refusal(write("pair/h.hdr", header)).field, "image");
  const fs::path image = write("pair/h.img", bytes_of<std::int16_t>(ct));
  EXPECT_EQ(refusal(folder.path() / "pair/h.hdr").field, "analyze_axes");
  EXPECT_EQ(refusal(image).field, "format");
  const itk::VolumeFile pair = itk::read_volume_file(folder.path() / "pair/h.hdr", {}, "LPS");
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(pair.volume).voxels, ct.voxels);
  EXPECT_EQ(pair.format, "Analyze");
  EXPECT_EQ(pair.warnings.size(), 1u);
  EXPECT_EQ(itk::find_volume_files(folder.path() / "pair").size(), 1u) << "the image is no volume of its own";
  EXPECT_EQ(itk::data_file_of(folder.path() / "pair/h.hdr"), image);
}

TEST_F(Volumes, AMetaImageThatLeavesAnythingOpenIsRefused) {
  const Keys keys = meta_keys(ct, "MET_SHORT");
  const std::string data = bytes_of<std::int16_t>(ct);
  const auto field = [&](const Keys& k, const std::string& d, const std::string& name = "LOCAL") {
    return refusal(write("x.mha", text_of(k, name) + d)).field;
  };
  for (const char* key : {"NDims", "DimSize", "ElementSpacing", "Offset", "TransformMatrix", "ElementType"})
    EXPECT_EQ(field(without(keys, key), data), key);
  EXPECT_EQ(field(keys, data.substr(2)), "data");
  EXPECT_EQ(field(keys, data + "ab"), "data");
  EXPECT_EQ(field(keys, "", "../x.raw"), "ElementDataFile");
  EXPECT_EQ(field(keys, "", "/etc/passwd"), "ElementDataFile");
  EXPECT_EQ(field(keys, "", "LIST"), "ElementDataFile");
  EXPECT_EQ(field(keys, "", "s%d.raw"), "ElementDataFile");
  EXPECT_EQ(field(with(keys, "ElementSpacing", "2.5 3 nan"), data), "ElementSpacing");
  EXPECT_EQ(field(with(keys, "ElementSpacing", "2.5 3 0"), data), "spacing");
  EXPECT_EQ(field(with(keys, "NDims", "4"), data), "NDims");
  EXPECT_EQ(field(with(keys, "TransformMatrix", "1 0 0 0.3 0.954 0 0 0 1"), data), "direction");
  Keys twice = keys;
  twice.push_back({"Offset", "0 0 0"});
  EXPECT_EQ(field(twice, data), "Offset");
  twice.back().first = "Position";
  EXPECT_EQ(field(twice, data), "Position");
}

TEST_F(Volumes, ValuesMustBeSaidAndLookLikeHu) {
  const fs::path file = folder.path() / "ct.nrrd";
  const auto refused = [&](const grid::Grid<std::int16_t>& g, dicom::VolumeValues values) {
    grid::write_nrrd(file, grid::HuVolume(g));
    dicom::ImportParams p;
    p.volume_values = values;
    try {
      dicom::import_series(file, p);
    } catch (const Error& e) {
      return std::to_string(static_cast<int>(e.code())) + " " + e.what();
    }
    return std::string();
  };
  EXPECT_EQ(refused(ct, dicom::VolumeValues::hu), "");
  EXPECT_EQ(refused(ct, dicom::VolumeValues::unsaid).substr(0, 2), "64");
  grid::Grid<std::int16_t> other = ct;
  for (auto& v : other.voxels) v = static_cast<std::int16_t>(v + 1024);
  EXPECT_NE(refused(other, dicom::VolumeValues::hu).find("without its offset"), std::string::npos);
  EXPECT_EQ(refused(other, dicom::VolumeValues::any), "");
  other = ct;
  for (auto& v : other.voxels) v = static_cast<std::int16_t>(v - 1024);
  EXPECT_NE(refused(other, dicom::VolumeValues::hu), "");
  other = ct;
  for (auto& v : other.voxels) v = static_cast<std::int16_t>(v / 2);
  EXPECT_NE(refused(other, dicom::VolumeValues::hu).find("does not lie at air"), std::string::npos);
  other = ct;  // a picture's grey values
  for (auto& v : other.voxels) v = static_cast<std::int16_t>(std::clamp(v + 1024, 0, 4095) / 17);
  EXPECT_NE(refused(other, dicom::VolumeValues::hu).find("8-bit"), std::string::npos);
  other = ct;  // padding around the field of view is air
  other.voxels[0] = -3024;
  EXPECT_EQ(refused(other, dicom::VolumeValues::hu), "");
}

// Damaged headers: the parent lives, and what is read has its voxels and lies where the header now says, as the naive
// reader below understands it.
namespace {

std::vector<double> naive(const std::string& head, const std::string& key) {
  std::vector<double> found;
  std::istringstream lines(head);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, equals;
    words >> name >> equals;
    if (name == key)
      for (double v; words >> v;) found.push_back(v);
  }
  return found;
}

void read_mutants(const ScratchFolder& folder, const grid::Grid<std::int16_t>& ct, std::uint64_t count) {
  const std::string head = text_of(meta_keys(ct, "MET_SHORT")), data = bytes_of<std::int16_t>(ct);
  const fs::path file = folder.path() / "m.mha";
  int read = 0, refused = 0, died = 0;
  for (std::uint64_t n = 0; n < count; ++n) {
    std::string mutant = head;
    for (std::uint64_t m = 0; m <= n % 3; ++m) {
      const auto bits = phantom::random_bits(1, 2 + m, n);
      mutant[bits % head.size()] = static_cast<char>(32 + (bits >> 40) % 95);
    }
    write_file(file, mutant + data);
    try {
      const itk::VolumeFile v = itk::read_volume_file(file);
      ++read;
      const auto* grid = std::get_if<grid::Grid<std::int16_t>>(&v.volume);
      ASSERT_TRUE(grid) << mutant;
      const auto spacing = naive(mutant, "ElementSpacing"), offset = naive(mutant, "Offset");
      ASSERT_EQ(spacing.size(), 3u) << mutant;
      for (int a = 0; a < 3; ++a) ASSERT_NEAR(grid->spacing_mm[a], spacing[a], 1e-6 * spacing[a]) << mutant;
      if (determinant({{grid->direction.column[0], grid->direction.column[1], grid->direction.column[2]}}) > 0 &&
          offset.size() == 3 && grid->voxels == ct.voxels) {
        for (int a = 0; a < 3; ++a)
          ASSERT_NEAR(grid->origin_mm[a], offset[a], 1e-6 * (1 + std::fabs(offset[a]))) << mutant;
      }
      ASSERT_EQ(grid->count(), ct.count());
      auto voxels = grid->voxels, wanted = ct.voxels;  // a left-handed one is turned over
      std::sort(voxels.begin(), voxels.end());
      std::sort(wanted.begin(), wanted.end());
      ASSERT_EQ(voxels, wanted) << mutant;
    } catch (const Error& e) {
      ASSERT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal || e.code() == ExitCode::no_input)
          << e.what();
      ++refused;
      died += e.code() == ExitCode::internal;
    }
  }
  std::printf("%d read, %d refused, %d of them by the child's death\n", read, refused, died);
  EXPECT_GT(refused, static_cast<int>(count / 5));
  EXPECT_GT(read, 0);
}

}  // namespace

TEST_F(Volumes, DamagedMetaImages) { read_mutants(folder, ct, 200); }
TEST_F(Volumes, LongTenThousandDamagedMetaImages) { read_mutants(folder, ct, 10000); }
