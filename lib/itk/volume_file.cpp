// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/volume_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory_budget.h"
#include "base/temporary_folder.h"
#include "base/write_file.h"
#include "grid/bounded_read.h"
#include "grid/nrrd_header.h"
#include "itk/itk_child.h"
#include "itk/volume_header.h"
#include "itk/volume_message.h"

namespace trephine::itk {
namespace fs = std::filesystem;

namespace {

enum class Kind { none, nifti, nrrd, detached_nrrd, meta_image, gipl, vtk, minc, pair, image };

Kind kind_of(const fs::path& file) {
  static const std::pair<const char*, Kind> endings[] = {
      {".nii", Kind::nifti},      {".nii.gz", Kind::nifti},   {".nrrd", Kind::nrrd}, {".nhdr", Kind::detached_nrrd},
      {".mha", Kind::meta_image}, {".mhd", Kind::meta_image}, {".gipl", Kind::gipl}, {".gipl.gz", Kind::gipl},
      {".vtk", Kind::vtk},        {".mnc", Kind::minc},       {".hdr", Kind::pair},  {".img", Kind::image},
      {".img.gz", Kind::image}};
  for (const auto& [ending, kind] : endings)
    if (has_ending(file, ending)) return kind;
  return Kind::none;
}

/// The other file of a header and an image; empty where there is none.
fs::path image_of_pair(fs::path header) {
  std::error_code none;
  for (const char* ending : {".img", ".img.gz"})
    if (fs::is_regular_file(header.replace_extension(ending), none)) return header;
  return {};
}
fs::path header_of_pair(fs::path image) {
  std::error_code none;
  if (has_ending(image, ".gz")) image.replace_extension();
  return fs::is_regular_file(image.replace_extension(".hdr"), none) ? image : fs::path();
}

// DICOM files of any name; those without a preamble too where the name is one that scanners' exports have.
bool is_dicom(const fs::path& file) {
  char head[132] = {};
  std::ifstream in(file, std::ios::binary);
  in.read(head, sizeof head);
  if (in && std::memcmp(head + 128, "DICM", 4) == 0) return true;
  const Kind kind = kind_of(file);
  const bool alone = kind == Kind::pair || (kind == Kind::image && header_of_pair(file).empty());
  return alone && (head[0] == 8 || head[0] == 2) && head[1] == 0;
}

bool is_data_file(const fs::path& file) {
  if (has_ending(file, ".img") || has_ending(file, ".img.gz")) return !header_of_pair(file).empty();
  return has_ending(file, ".raw") || has_ending(file, ".zraw") || has_ending(file, ".raw.gz");
}

VolumeFile decoded(grid::BoundedGrid read, const char* format) {
  VolumeFile out;
  out.volume = grid::to_hu(std::move(read.grid));
  out.format = format;
  out.warnings = std::move(read.warnings);
  return out;
}

VolumeFile read_pair(const fs::path& file, const std::string& analyze_axes, const Progress& progress) {
  const fs::path image = image_of_pair(file);
  if (image.empty()) throw Error(ExitCode::no_input, "", "image", "lacks its other file, .img or .img.gz, beside it");
  grid::BoundedGrid read = grid::read_pair_bounded(file, image, analyze_axes, progress);
  const bool analyze = read.is_analyze;
  return decoded(std::move(read), analyze ? "Analyze" : "NIfTI");
}

grid::Lattice lattice_of(const ItkVolume& head) {
  grid::Lattice lattice;
  std::array<Vec3, 3> steps;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    lattice.size[a] = head.size[a];
    if (!(head.spacing[a] > 0)) throw Error(ExitCode::bad_input, "", "spacing", "is not positive");
    lattice.origin_mm[axis] = head.origin[a];
    steps[a] = Vec3{head.axis[a][0], head.axis[a][1], head.axis[a][2]};
    if (!(std::fabs(norm(steps[a]) - 1) < 1e-3))
      throw Error(ExitCode::bad_input, "", "direction", "an axis is no unit vector: the volume is sheared or scaled");
    steps[a] = normalized(steps[a]) * head.spacing[a];
  }
  if (!is_finite(lattice.origin_mm)) throw Error(ExitCode::bad_input, "", "origin", "is not finite");
  grid::detail::take_axes(lattice, steps, "direction");
  grid::detail::require_place(lattice, "origin");
  return lattice;
}

// ITK knows a format by its ending in lower case alone: another one is read by a link of such a name.
fs::path named_for_itk(const fs::path& file, const fs::path& data_file, std::optional<TemporaryFolder>& folder) {
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const fs::path whole = fs::absolute(file);
  if (fs::path(name).extension() == file.extension()) return whole;
  if (!data_file.empty())
    throw Error(ExitCode::bad_input, "", "name", "a header with a data file beside it needs its ending in lower case");
  folder.emplace();
  fs::create_symlink(whole, folder->path() / ("volume" + fs::path(name).extension().string()));
  return folder->path() / ("volume" + fs::path(name).extension().string());
}

VolumeFile read_with_itk(const fs::path& file, ItkFormat format, const char* name, const Progress& progress) {
  VolumeHeader said = format == ItkFormat::meta_image ? check_meta_header(head_of(file), file)
                      : format == ItkFormat::nrrd     ? check_nrrd_text(head_of(file), file)
                                                      : VolumeHeader{};
  std::error_code none;
  std::uint64_t bytes = fs::file_size(file, none);
  if (!said.data_file.empty()) bytes += fs::file_size(said.data_file, none);
  std::optional<TemporaryFolder> link;
  MessageWriter request = itk_child::request();
  request.value(format);
  request.text(named_for_itk(file, said.data_file, link).string());
  ChildLimits limits;
  // Compressed files grow by an unknown factor; a volume in memory is held twice, in its own type, and as it is handed
  // over.
  limits.memory_bytes = std::min<std::uint64_t>((std::uint64_t{3} << 30) + 40 * bytes, available_memory_bytes());
  limits.cpu_s = 60 + static_cast<double>(bytes) / 2e6;
  limits.wall_s = 2 * limits.cpu_s;
  const ChildResult result = itk_child::run(read_worker_name, request, limits, progress);
  MessageReader in(read_worker_name, result.bytes());
  const auto head = in.value<ItkVolume>();
  for (std::uint64_t left = in.number(); left > 0; --left) said.unknown.emplace_back(in.text());
  said.require_same(head);
  const grid::Lattice lattice = lattice_of(head);
  const auto take = [&](auto zero) {
    grid::Grid<decltype(zero)> grid(lattice);
    const std::string_view from = in.take(grid.voxels.size() * sizeof zero);
    if (!from.empty()) std::memcpy(grid.voxels.data(), from.data(), from.size());
    return grid;
  };
  VolumeFile out;
  out.format = name;
  out.modality = said.modality;
  if (!said.unknown.empty()) out.warnings.push_back(grid::detail::told_unknown(said.unknown));
  if (head.is_int16) {
    out.volume = take(std::int16_t{});
  } else {
    grid::Grid<float> grid = take(float{});
    for (const float v : grid.voxels)
      if (!std::isfinite(v)) throw Error(ExitCode::bad_input, "", "data", "holds a voxel that is not finite");
    out.volume = std::move(grid);
  }
  if (!in.empty()) throw Error(ExitCode::internal, "", read_worker_name, "the child gave another number of bytes");
  return out;
}

// Turned over along its last axis where it is left-handed, as an import's volume is not.
grid::HuVolume right_handed(grid::HuVolume volume) {
  return std::visit(
      [](auto grid) -> grid::HuVolume {
        if (determinant(grid.direction) > 0) return grid;
        const std::size_t slice = std::size_t(grid.size[0]) * grid.size[1];
        for (int low = 0, high = grid.size[2] - 1; low < high; ++low, --high)
          std::swap_ranges(grid.voxels.begin() + static_cast<std::ptrdiff_t>(low * slice),
                           grid.voxels.begin() + static_cast<std::ptrdiff_t>((low + 1) * slice),
                           grid.voxels.begin() + static_cast<std::ptrdiff_t>(high * slice));
        grid.origin_mm = grid.to_world_mm({0, 0, grid.size[2] - 1.0});
        grid.direction.column[2] = -grid.direction.column[2];
        return grid;
      },
      std::move(volume));
}

VolumeFile read_any(const fs::path& file, const Progress& progress, const std::string& analyze_axes) {
  switch (kind_of(file)) {
    case Kind::nifti:
      return decoded(grid::read_nifti_bounded(file, grid::scan_limit, progress), "NIfTI");
    case Kind::nrrd:
      try {
        return decoded(grid::read_nrrd_bounded(file, grid::scan_limit, progress), "NRRD");
      } catch (const Error& e) {
        if (e.cause() != Cause::other_encoding) throw;
      }
      return read_with_itk(file, ItkFormat::nrrd, "NRRD", progress);
    case Kind::detached_nrrd:
      return read_with_itk(file, ItkFormat::nrrd, "NRRD", progress);
    case Kind::meta_image:
      return read_with_itk(file, ItkFormat::meta_image, "MetaImage", progress);
    case Kind::gipl:
    case Kind::vtk: {
      const bool vtk = kind_of(file) == Kind::vtk;
      VolumeFile out =
          read_with_itk(file, vtk ? ItkFormat::vtk : ItkFormat::gipl, vtk ? "VTK image" : "GIPL", progress);
      out.warnings.push_back(out.format + " does not say which way its axes lie: they are taken as left, back and up");
      return out;
    }
    case Kind::minc:
      return read_with_itk(file, ItkFormat::minc, "MINC", progress);
    case Kind::pair:
      return read_pair(file, analyze_axes, progress);
    case Kind::image:
      throw Error(ExitCode::usage, "", "format", "is the image of a pair: name its header, the .hdr beside it");
    case Kind::none:
      break;
  }
  throw Error(ExitCode::bad_input, "", "format", "is no volume of a format that is read");
}

}  // namespace

bool has_ending(const fs::path& file, std::string_view ending) {
  const std::string name = file.filename().string();
  return name.size() > ending.size() && std::equal(ending.rbegin(), ending.rend(), name.rbegin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

std::vector<fs::path> find_volume_files(const fs::path& path) {
  std::error_code none;
  const auto is_volume = [](const fs::path& file) { return kind_of(file) != Kind::none && !is_dicom(file); };
  if (fs::is_regular_file(path, none) && is_volume(path)) return {path};
  if (!fs::is_directory(path, none)) return {};
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, none)) {
    if (!entry.is_regular_file(none)) return {};
    if (is_data_file(entry.path())) continue;
    if (!is_volume(entry.path())) return {};
    found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

VolumeFile read_volume_file(const fs::path& file, const Progress& progress, const std::string& analyze_axes) {
  return with_file(file.string(), [&] {
    if (!analyze_axes.empty() && kind_of(file) != Kind::pair)
      throw Error(ExitCode::usage, "", "analyze_axes", "is only for Analyze (.hdr)");
    VolumeFile out = read_any(file, progress, analyze_axes);
    out.volume = right_handed(std::move(out.volume));
    return out;
  });
}

fs::path data_file_of(const fs::path& file) {
  const Kind kind = kind_of(file);
  return with_file(file.string(), [&] {
    return kind == Kind::meta_image                            ? check_meta_header(head_of(file), file).data_file
           : kind == Kind::detached_nrrd || kind == Kind::nrrd ? check_nrrd_text(head_of(file), file).data_file
           : kind == Kind::pair                                ? image_of_pair(file)
                                                               : fs::path();
  });
}

std::string hash_of_volume_file(const fs::path& file) {
  Sha256 sha;
  sha.text("trephine volume file 1").text(sha256_of_file(file));
  const fs::path data = data_file_of(file);
  if (!data.empty()) sha.text(sha256_of_file(data));
  return sha.hex();
}

}  // namespace trephine::itk
