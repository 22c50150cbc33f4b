// SPDX-License-Identifier: GPL-3.0-or-later
#include "ambf/image_stack.h"

#include <algorithm>
#include <map>

#include "ambf/read_pictures.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/png.h"
#include "base/text.h"
#include "voxel/drilled.h"

namespace trephine::ambf {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t opaque = 255;

// Which slice of the lattice the n-th picture is.
int slice_of(const grid::Lattice& l, int n) { return determinant(l.direction) < 0 ? l.size[2] - 1 - n : n; }

// By the number at the end of the name, in which leading zeros may be the prefix's.
std::map<long long, fs::path> pictures_in(const fs::path& folder) {
  std::error_code failed;
  fs::directory_iterator it(folder, failed);
  if (failed) throw Error(ExitCode::no_input, folder.string(), "", "is no folder that can be read");
  std::map<long long, fs::path> all;
  for (const fs::directory_entry& entry : it) {
    if (entry.path().extension() != ".png") continue;
    const std::string stem = entry.path().stem().string();
    const std::size_t last = stem.find_last_not_of("0123456789");
    std::string digits = last == std::string::npos ? stem : stem.substr(last + 1);
    digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - (digits.empty() ? 0 : 1)));
    const auto number = parse_integer(digits);
    if (!number) throw Error(ExitCode::bad_input, entry.path().string(), "name", "ends in no number of a slice");
    if (!all.emplace(*number, entry.path()).second)
      throw Error(ExitCode::bad_input, entry.path().string(), "name", "its number is that of another picture");
  }
  return all;
}

}  // namespace

std::string picture_name(std::size_t slice) { return stack_prefix + std::to_string(slice) + ".png"; }

std::vector<meshio::ExportFile> encode_stack(const grid::Mask& shown, const Palette& palette) {
  std::vector<meshio::ExportFile> files(std::size_t(shown.size[2]));
  parallel_for(0, shown.size[2], 1, [&](std::int64_t n, std::int64_t) {
    const int k = slice_of(shown, int(n)), width = shown.size[0], height = shown.size[1];
    std::vector<std::uint8_t> rows(std::size_t(width) * std::size_t(height) * 4);
    for (int r = 0; r < height; ++r)
      for (int i = 0; i < width; ++i) {
        const std::uint8_t shape = shown.at(i, height - 1 - r, k);
        if (shape == 0) continue;
        std::uint8_t* pixel = &rows[(std::size_t(r) * std::size_t(width) + std::size_t(i)) * 4];
        std::copy(palette.at(shape).begin(), palette.at(shape).end(), pixel);
        pixel[3] = opaque;
      }
    files[std::size_t(n)] = {picture_name(std::size_t(n)), png_of(width, height, 4, rows)};
  });
  return files;
}

grid::Mask read_stack(const fs::path& folder, const grid::Mask& shown, const Palette& palette,
                      const Progress& progress) {
  const std::map<long long, fs::path> found = pictures_in(folder);
  const auto wanted = std::size_t(shown.size[2]);
  if (found.size() != wanted || found.rbegin()->first != static_cast<long long>(wanted) - 1)
    throw Error(ExitCode::bad_input, folder.string(), "pictures",
                "must be " + std::to_string(wanted) + " PNG files, numbered from 0, for the case's haptic volume; " +
                    std::to_string(found.size()) + " are there");
  std::vector<fs::path> files;
  files.reserve(found.size());
  for (const auto& item : found) files.push_back(item.second);
  grid::Mask now(shown);
  std::fill(now.voxels.begin(), now.voxels.end(), std::uint8_t{0});
  const auto take = [&](std::size_t n, const std::uint8_t* pixels) {
    const int k = slice_of(shown, int(n)), width = shown.size[0], height = shown.size[1];
    for (int r = 0; r < height; ++r)
      for (int i = 0; i < width; ++i, pixels += 4) {
        if (pixels[3] == 0) continue;
        const std::uint8_t shape = shown.at(i, height - 1 - r, k);
        if (shape == 0 || pixels[3] != opaque || !std::equal(pixels, pixels + 3, palette.at(shape).begin()))
          throw Error(ExitCode::bad_input, files[n].string(), "pixels",
                      "column " + std::to_string(i) + ", row " + std::to_string(r) +
                          " is not as the case was exported: the stack is of another case, or was changed otherwise "
                          "than by removing voxels");
        now.at(i, height - 1 - r, k) = 1;
      }
  };
  read_pictures(files, shown.size[0], shown.size[1], take, progress);
  return now;
}

DrilledLabels drilled_labels(const voxel::HapticVolume& volume, const grid::Mask& shown, const grid::Mask& now) {
  DrilledLabels out;
  std::array<std::size_t, 1 + voxel::haptic_max_shapes> is{}, removed{};
  grid::Mask labels(shown);
  for (std::size_t i = 0; i < shown.voxels.size(); ++i) {
    const std::uint8_t shape = shown.voxels[i];
    if (shape == 0) continue;
    ++is[shape];
    if (now.voxels[i]) continue;
    ++removed[shape];
    labels.voxels[i] = std::uint8_t(shape + voxel::haptic_max_shapes);
  }
  out.labels.lattice = shown;
  out.labels.format = "seg.nrrd";
  for (const voxel::HapticShape& s : volume.shapes) {
    const auto n = std::size_t(s.number);
    out.shapes.push_back({s.name, is[n], removed[n]});
    if (is[n] > removed[n]) out.labels.segments.push_back({"Segment_" + s.name, s.name, s.number, 0, false});
  }
  for (const voxel::HapticShape& s : volume.shapes)
    if (removed[std::size_t(s.number)] > 0) {
      const std::string name = s.name + voxel::removed_suffix;
      out.labels.segments.push_back({"Segment_" + name, name, s.number + voxel::haptic_max_shapes, 0, false});
    }
  out.labels.samples = std::move(labels);
  return out;
}

}  // namespace trephine::ambf
