// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/volume_write.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/temporary_folder.h"
#include "base/write_file.h"
#include "grid/bounded_read.h"
#include "grid/nifti.h"
#include "itk/itk_child.h"
#include "itk/volume_file.h"
#include "itk/volume_message.h"

namespace trephine::itk {
namespace fs = std::filesystem;
namespace {

constexpr double max_off_mm = 1e-3;

struct Ending {
  const char* text;
  std::optional<ItkFormat> itk;
};

// The longer ones first, for one may end in another.
const std::vector<Ending>& endings() {
  static const std::vector<Ending> all = {{".nii.gz", {}},
                                          {".gipl.gz", ItkFormat::gipl},
                                          {".nrrd", {}},
                                          {".nii", {}},
                                          {".mha", ItkFormat::meta_image},
                                          {".gipl", ItkFormat::gipl},
                                          {".vtk", ItkFormat::vtk},
                                          {".mnc", ItkFormat::minc}};
  return all;
}

const Ending* ending_of(const fs::path& file) {
  for (const Ending& e : endings())
    if (has_ending(file, e.text)) return &e;
  return nullptr;
}

const grid::Lattice& lattice_of_grid(const grid::AnyGrid& grid) {
  return std::visit([](const auto& g) -> const grid::Lattice& { return g; }, grid);
}

// GIPL and VTK images: axes along the patient's, or nothing says where they point.
void require_no_directions(const grid::Lattice& lattice, const char* ending) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      if (std::fabs(lattice.direction.column[a][b] - (a == b)) > 1e-6)
        throw Error(ExitCode::bad_input, "", "direction",
                    std::string(ending) +
                        " cannot say that the volume's axes do not lie along left, back and up: write .mha, .nii.gz "
                        "or .nrrd");
}

ItkVolume head_of(const grid::Lattice& lattice) {
  ItkVolume head;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    if (lattice.size[a] > 65535) throw Error(ExitCode::bad_input, "", "size", "more than 65,535 voxels along an axis");
    head.size[a] = lattice.size[a];
    head.spacing[a] = lattice.spacing_mm[axis];
    head.origin[a] = lattice.origin_mm[axis];
    for (std::size_t b = 0; b < 3; ++b) head.axis[a][b] = lattice.direction.column[a][static_cast<int>(b)];
  }
  return head;
}

void write_with_itk(const fs::path& file, ItkFormat format, const grid::AnyGrid& grid, const Progress& progress) {
  MessageWriter request = itk_child::request();
  request.value(format);
  request.value(std::holds_alternative<grid::Grid<std::int16_t>>(grid) ? ItkSample::int16
                : std::holds_alternative<grid::Mask>(grid)             ? ItkSample::uint8
                                                                       : ItkSample::float32);
  request.value(head_of(lattice_of_grid(grid)));
  request.text(file.string());
  std::size_t bytes = 0;
  std::visit(
      [&](const auto& g) {
        bytes = g.voxels.size() * sizeof(*g.voxels.data());
        request.text({reinterpret_cast<const char*>(g.voxels.data()), bytes});
      },
      grid);
  ChildLimits limits;
  limits.memory_bytes = (std::uint64_t{3} << 30) + 6 * bytes;
  limits.cpu_s = 60 + static_cast<double>(bytes) / 2e6;
  limits.wall_s = 2 * limits.cpu_s;
  itk_child::run(write_worker_name, request, limits, progress);
}

double value_at(const grid::AnyGrid& grid, std::size_t i) {
  return std::visit([&](const auto& g) { return double(g.voxels[i]); }, grid);
}

void require_read_back(const fs::path& file, const grid::AnyGrid& grid, const Progress& progress) {
  const grid::AnyGrid back = read_grid_file(file, nullptr, nullptr, progress);
  const grid::Lattice &is = lattice_of_grid(back), &was = lattice_of_grid(grid);
  const auto differs = [](const std::string& field) {
    throw Error(ExitCode::io, "", field, "what was written does not read back: write .nrrd or .mha");
  };
  const bool turned = determinant(was.direction) < 0 && determinant(is.direction) > 0;
  if (is.size != was.size) differs("size");
  const int last = was.size[2] - 1;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 v{(corner & 1) * (was.size[0] - 1.0), (corner >> 1 & 1) * (was.size[1] - 1.0),
                 (corner >> 2) * double(last)};
    const Vec3 w{v.x, v.y, turned ? last - v.z : v.z};
    if (!(norm(is.to_world_mm(w) - was.to_world_mm(v)) < max_off_mm + 1e-6 * norm(was.origin_mm))) differs("place");
  }
  const std::size_t slice = std::size_t(was.size[0]) * std::size_t(was.size[1]);
  for (std::size_t i = 0; i < was.count(); ++i) {
    const std::size_t k = i / slice, at = turned ? (std::size_t(last) - k) * slice + i % slice : i;
    if (value_at(back, at) != value_at(grid, i)) differs("data");
  }
}

std::string nifti_of(const grid::AnyGrid& grid, bool gzip) {
  if (const auto* mask = std::get_if<grid::Mask>(&grid)) return grid::encode_nifti(*mask, gzip);
  return grid::encode_nifti(grid::to_hu(grid), gzip);
}

}  // namespace

const std::vector<std::string>& written_volume_endings() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const Ending& e : endings()) names.emplace_back(e.text);
    return names;
  }();
  return all;
}

void write_volume_file(const fs::path& file, const grid::AnyGrid& grid, const Progress& progress) {
  const Ending* ending = ending_of(file);
  if (!ending) {
    std::string known;
    for (const std::string& e : written_volume_endings()) known += " " + e;
    throw Error(ExitCode::usage, file.string(), "output", "must end in one of" + known);
  }
  with_file(file.string(), [&] {
    if (ending->itk == ItkFormat::gipl || ending->itk == ItkFormat::vtk)
      require_no_directions(lattice_of_grid(grid), ending->text);
    const TemporaryFolder folder;
    const fs::path made = folder.path() / (std::string("volume") + ending->text);
    const std::size_t voxels = lattice_of_grid(grid).count();
    folder.fill(512 + voxels * sizeof(float), [&] {
      if (ending->itk)
        write_with_itk(made, *ending->itk, grid, progress.part(0, 0.6));
      else if (std::string_view(ending->text) != ".nrrd")
        write_file(made, nifti_of(grid, std::string_view(ending->text) == ".nii.gz"));
      else if (const auto* mask = std::get_if<grid::Mask>(&grid))
        grid::write_nrrd(made, *mask, {}, grid::NrrdEncoding::gzip);
      else
        grid::write_nrrd(made, grid::to_hu(grid), {}, grid::NrrdEncoding::gzip);
    });
    require_read_back(made, grid, progress.part(0.6, 0.9));
    const std::vector<char> bytes = read_file(made, std::uint64_t{1} << 36);
    write_file(file, {bytes.data(), bytes.size()});
  });
}

grid::AnyGrid read_grid_file(const fs::path& file, std::string* format, std::vector<std::string>* warnings,
                             const Progress& progress, const std::string& analyze_axes) {
  const auto tell = [&](const std::string& name, const std::vector<std::string>& said) {
    if (format) *format = name;
    if (warnings) *warnings = said;
  };
  const std::string name = file.filename().string();
  const Ending* ending = ending_of(file);
  if (ending && !ending->itk && analyze_axes.empty()) {
    const bool nrrd = std::string_view(ending->text) == ".nrrd";
    try {
      return with_file(file.string(), [&]() -> grid::AnyGrid {
        grid::BoundedGrid read = nrrd ? grid::read_nrrd_bounded(file, grid::labels_limit, progress)
                                      : grid::read_nifti_bounded(file, grid::labels_limit, progress);
        tell(nrrd ? "NRRD" : "NIfTI", read.warnings);
        return std::move(read.grid);
      });
    } catch (const Error& e) {
      if (!nrrd || e.cause() != Cause::other_encoding) throw;
    }
  }
  VolumeFile volume = read_volume_file(file, progress, analyze_axes);
  tell(volume.format, volume.warnings);
  return std::visit([](auto&& g) -> grid::AnyGrid { return std::move(g); }, std::move(volume.volume));
}

grid::LabelFile read_label_file(const fs::path& file, const Progress& progress) {
  const Ending* ending = ending_of(file);
  if (!ending || !ending->itk) return grid::read_labels(file);
  return with_file(file.string(), [&] {
    std::string format;
    std::vector<std::string> warnings;
    grid::AnyGrid grid = read_grid_file(file, &format, &warnings, progress);
    if (!data_file_of(file).empty())
      throw Error(ExitCode::bad_input, "", "ElementDataFile",
                  "names another file, of which a cache would know nothing: save the labels as one .mha");
    grid::LabelFile map = grid::labels_of(std::move(grid), format);
    map.warnings = std::move(warnings);
    return map;
  });
}

}  // namespace trephine::itk
