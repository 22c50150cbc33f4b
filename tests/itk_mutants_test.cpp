// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged headers of NIfTI and NRRD, which our own parsers read: what is read lies where the header now says, as a
// naive reader here understands it, and has every voxel. (MetaImage: itk_volume_test.cpp; MINC: itk_write_test.cpp.)
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>

#include "base/error.h"
#include "grid/nifti.h"
#include "grid/nrrd.h"
#include "itk/volume_file.h"
#include "phantom/random.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

grid::Grid<std::int16_t> sample() {
  grid::Lattice l;
  l.size = {13, 11, 9};
  l.spacing_mm = {0.75, 1.25, 2};
  l.origin_mm = {-30.5, 41.25, 12.5};
  l.direction = {{Vec3{0.8, 0.6, 0}, Vec3{-0.6, 0.8, 0}, Vec3{0, 0, 1}}};
  grid::Grid<std::int16_t> g(l);
  for (std::size_t n = 0; n < g.voxels.size(); ++n) g.voxels[n] = static_cast<std::int16_t>(n - 600);
  return g;
}

struct Place {
  std::array<Vec3, 3> steps;
  Vec3 origin;
};

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T v;
  std::memcpy(&v, bytes.data() + at, sizeof v);
  return v;
}

// LPS. Nothing where the header has neither sform nor qform: the reader then has to say so.
std::optional<Place> naive_nifti(const std::string& bytes) {
  const int code = bytes[123] & 7;
  const double unit = code == 1 ? 1000 : code == 3 ? 0.001 : 1;
  Place p;
  if (value_at<std::int16_t>(bytes, 254) <= 0) {
    if (value_at<std::int16_t>(bytes, 252) <= 0) return {};
    const double b = value_at<float>(bytes, 256), c = value_at<float>(bytes, 260), d = value_at<float>(bytes, 264),
                 a = std::sqrt(std::max(0.0, 1 - b * b - c * c - d * d));
    const Vec3 axes[3] = {{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
                          {2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
                          {2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}};
    const auto lps = [&](Vec3 v) { return Vec3{-unit * v.x, -unit * v.y, unit * v.z}; };
    for (std::size_t k = 0; k < 3; ++k)
      p.steps[k] = lps(axes[k]) *
                   (double(value_at<float>(bytes, 80 + 4 * k)) * (k == 2 && value_at<float>(bytes, 76) < 0 ? -1 : 1));
    p.origin = lps({value_at<float>(bytes, 268), value_at<float>(bytes, 272), value_at<float>(bytes, 276)});
    return p;
  }
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 4; ++c) {
      const double v = (row < 2 ? -unit : unit) * double(value_at<float>(bytes, 280 + (row * 4 + c) * 4));
      (c < 3 ? p.steps[c] : p.origin)[static_cast<int>(row)] = v;
    }
  return p;
}

std::vector<double> numbers_behind(const std::string& head, const std::string& key) {
  const std::size_t at = head.find(key);
  std::vector<double> found;
  if (at == std::string::npos) return found;
  std::string line = head.substr(at + key.size(), head.find('\n', at) - at - key.size());
  for (char& c : line)
    if (c == '(' || c == ')' || c == ',') c = ' ';
  const char* p = line.c_str();
  for (char* end = nullptr;; p = end) {
    const double v = std::strtod(p, &end);
    if (end == p) break;
    found.push_back(v);
  }
  return found;
}

std::optional<Place> naive_nrrd(const std::string& bytes) {
  // Keys and the space's name are known in any case.
  std::string head = bytes.substr(0, bytes.find("\n\n"));
  for (char& c : head) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto steps = numbers_behind(head, "space directions: "), origin = numbers_behind(head, "space origin: ");
  if (steps.size() != 9 || origin.size() != 3) return {};
  const bool ras = head.find("space: left-posterior-superior") == std::string::npos;
  Place p;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) p.steps[std::size_t(a)][b] = (ras && b < 2 ? -1 : 1) * steps[std::size_t(3 * a + b)];
  for (int b = 0; b < 3; ++b) p.origin[b] = (ras && b < 2 ? -1 : 1) * origin[std::size_t(b)];
  return p;
}

void read_mutants(const char* name, const std::string& whole, std::size_t header, bool letters, std::uint64_t count,
                  std::uint64_t seed, std::optional<Place> (*naive)(const std::string&)) {
  const ScratchFolder folder;
  const auto file = folder.path() / name;
  const grid::Grid<std::int16_t> g = sample();
  std::vector<std::int16_t> wanted = g.voxels;
  std::sort(wanted.begin(), wanted.end());
  int read = 0, refused = 0, unsaid = 0, scaled = 0;
  for (std::uint64_t n = 0; n < count; ++n) {
    std::string mutant = whole;
    for (std::uint64_t m = 0; m <= n % 3; ++m) {
      const auto bits = phantom::random_bits(seed, 2 + m, n);
      mutant[bits % header] = static_cast<char>(letters ? 32 + (bits >> 40) % 95 : bits >> 40);
    }
    std::ofstream(file, std::ios::binary) << mutant;
    try {
      const itk::VolumeFile v = itk::read_volume_file(file);
      ++read;
      const grid::Lattice& l = grid::lattice_of(v.volume);
      const auto place = naive(mutant);
      if (!place) {
        ASSERT_FALSE(v.warnings.empty()) << name << " " << n << ": another frame, and nothing said";
        ++unsaid;
      } else {
        for (int corner = 0; corner < 8; ++corner) {
          Vec3 at = place->origin;
          for (int a = 0; a < 3; ++a)
            if (corner >> a & 1) at += place->steps[std::size_t(a)] * double(l.size[std::size_t(a)] - 1);
          // A left-handed volume was turned over along its last axis, so some corner of it must be there; axes that are
          // not quite at right angles are straightened.
          double nearest = 1e300;
          for (int other = 0; other < 8; ++other) {
            Vec3 v_index;
            for (int a = 0; a < 3; ++a) v_index[a] = other >> a & 1 ? l.size[std::size_t(a)] - 1.0 : 0.0;
            nearest = std::min(nearest, norm(l.to_world_mm(v_index) - at));
          }
          ASSERT_LT(nearest, 5e-3 * (1 + 1e-3 * norm(at))) << name << " " << n << "\n" << mutant.substr(0, header);
        }
      }
      const auto* whole_numbers = std::get_if<grid::Grid<std::int16_t>>(&v.volume);
      std::vector<std::int16_t> voxels = whole_numbers ? whole_numbers->voxels : std::vector<std::int16_t>();
      std::sort(voxels.begin(), voxels.end());
      scaled += voxels != wanted;
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), ExitCode::bad_input) << e.what();
      ++refused;
    }
  }
  std::printf(
      "%s: %d read (%d in another frame that is warned of, %d with other values, as the header says), %d refused\n",
      name, read, unsaid, scaled, refused);
  EXPECT_GT(read, static_cast<int>(count / 20));
  EXPECT_GT(refused, static_cast<int>(count / 20));
}

void read_nifti_mutants(std::uint64_t count, std::uint64_t seed) {
  read_mutants("m.nii", grid::encode_nifti(grid::HuVolume(sample()), false), 348, false, count, seed, naive_nifti);
}
void read_nrrd_mutants(std::uint64_t count, std::uint64_t seed) {
  const std::string whole = grid::encode_nrrd(grid::HuVolume(sample()));
  read_mutants("m.nrrd", whole, whole.find("\n\n"), true, count, seed, naive_nrrd);
}

}  // namespace

TEST(Mutants, OfNifti) { read_nifti_mutants(300, 11); }
TEST(Mutants, OfNrrd) { read_nrrd_mutants(300, 11); }
TEST(Mutants, LongTenThousandOfNifti) { read_nifti_mutants(10000, 12); }
TEST(Mutants, LongTenThousandOfNrrd) { read_nrrd_mutants(10000, 12); }
