// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/load_case.h"

#include <cmath>
#include <exception>
#include <set>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/case_names.h"
#include "cases/glb.h"
#include "cases/load_hashed.h"
#include "grid/nrrd.h"
#include "voxel/haptic_file.h"
#include "voxel/shape_field.h"

namespace trephine::cases {
namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

template <class T>
void require_same(const T& file, const T& manifest, const std::string& field) {
  if (file != manifest) refuse(field, std::to_string(file) + ", case.json says " + std::to_string(manifest));
}

// Compares a sum over float32 positions with the sum that was made before the positions were rounded.
void require_near(double file, double manifest, double smallest, const std::string& field) {
  if (!(std::abs(file - manifest) <= smallest + 1e-3 * std::abs(manifest)))
    refuse(field, to_text(file) + ", case.json says " + to_text(manifest));
}

surface::TriMesh read_surface(const std::vector<char>& bytes, const CaseAnatomy& anatomy, Vec3 center_mm) {
  GlbMesh glb = read_glb(std::string_view(bytes.data(), bytes.size()));
  require_same(glb.mesh.triangles.size(), std::size_t{anatomy.triangles}, "triangles");
  require_same(glb.mesh.points_mm.size(), std::size_t{anatomy.points}, "points");
  if (glb.mesh.origin_mm != center_mm) refuse("center_mm", "is not that of case.json");
  if (glb.name != anatomy.name) refuse("name", "'" + glb.name + "', case.json says '" + anatomy.name + "'");
  require_near(surface::volume_mm3(glb.mesh) / 1000, anatomy.volume_ml, 1e-6, "volume_ml");
  require_near(surface::area_mm2(glb.mesh) / 100, anatomy.area_cm2, 1e-6, "area_cm2");
  return std::move(glb.mesh);
}

void compare_shape(const voxel::HapticShape& file, const CaseShape& manifest) {
  const std::string at = "shapes." + manifest.name;
  if (file.name != manifest.name) refuse(at + ".name", "'" + file.name + "' in the file");
  require_same(file.number, manifest.number, at + ".number");
  require_same(int{file.window_low}, int{manifest.window_low}, at + ".window");
  require_same(int{file.window_high}, int{manifest.window_high}, at + ".window");
}

void compare_haptic(const voxel::HapticVolume& volume, const CaseHaptic& manifest) {
  if (volume.encoding != (manifest.encoding == "hu" ? voxel::HapticEncoding::hu : voxel::HapticEncoding::occupancy))
    refuse("encoding", "is not the '" + manifest.encoding + "' of case.json");
  for (int i = 0; i < 3; ++i) {
    require_same(volume.voxels.size[i], manifest.size[i], "size");
    // NRRD keeps oblique axes to the last bit or two.
    if (!(std::abs(volume.voxels.spacing_mm[i] / manifest.spacing_mm[i] - 1) <= 1e-9))
      refuse("spacing_mm",
             to_text(volume.voxels.spacing_mm[i]) + ", case.json says " + to_text(manifest.spacing_mm[i]));
  }
  require_same(volume.shapes.size(), manifest.shapes.size(), "shapes");
  for (std::size_t i = 0; i < manifest.shapes.size(); ++i) compare_shape(volume.shapes[i], manifest.shapes[i]);
}

grid::Grid<std::int16_t> read_ct(const std::vector<char>& bytes, const CaseCt& manifest) {
  grid::Nrrd nrrd = grid::decode_nrrd({bytes.data(), bytes.size()});
  auto* grid = std::get_if<grid::Grid<std::int16_t>>(&nrrd.grid);
  if (!grid) refuse("type", "is not int16");
  for (int i = 0; i < 3; ++i) {
    require_same(grid->size[i], manifest.size[i], "size");
    if (!(std::abs(grid->spacing_mm[i] / manifest.spacing_mm[i] - 1) <= 1e-9))
      refuse("spacing_mm", to_text(grid->spacing_mm[i]) + ", case.json says " + to_text(manifest.spacing_mm[i]));
  }
  return std::move(*grid);
}

// Volumes of 0 ml are those that the writer did not measure.
void compare_volumes(const voxel::HapticVolume& volume, const CaseHaptic& manifest) {
  if (volume.encoding != voxel::HapticEncoding::occupancy) return;  // an HU says nothing of a part of a voxel
  const auto mm3 = voxel::shape_volumes_mm3(volume);
  for (const CaseShape& s : manifest.shapes)
    if (s.volume_ml > 0)
      require_near(mm3.at(std::size_t(s.number)) / 1000, s.volume_ml, 1e-3, "shapes." + s.name + ".volume_ml");
}

// The figures of the patient are those of the surfaces.
void compare_figures(const CaseManifest& m) {
  for (const auto& [name, value] : m.figures)
    for (const CaseAnatomy& a : m.anatomies)
      if (const auto* ml = std::get_if<double>(&value); ml && !a.file.empty() && name == a.name + "_ml")
        require_near(*ml, a.volume_ml, 1e-6, "figures." + name);
}

// How many of the places lie within the lattice, give or take two voxels: what is capped at the scan's end, and padded.
class Within {
 public:
  explicit Within(const grid::Lattice& lattice) : lattice_(lattice) {}
  void add(Vec3 world_mm) {
    const Vec3 index = lattice_.to_index(world_mm);
    bool in = true;
    for (int a = 0; a < 3; ++a) in = in && index[a] >= -2 && index[a] <= lattice_.size[a] + 1;
    ++(in ? inside_ : outside_);
  }
  /// A part of what is seen may be of another scan, which shows more.
  bool most() const { return outside_ <= inside_; }

 private:
  const grid::Lattice lattice_;
  std::size_t inside_ = 0, outside_ = 0;
};

// The CT is cut to what is seen and felt, so both lie within it.
void compare_places(const LoadedCase& c) {
  Within surfaces(c.ct), felt(c.ct);
  for (const surface::TriMesh& mesh : c.surfaces)
    for (std::size_t i = 0; i < mesh.points_mm.size(); ++i) surfaces.add(mesh.world_mm(i));
  const grid::Grid<std::int16_t>& voxels = c.haptic.voxels;
  if (c.haptic.encoding == voxel::HapticEncoding::occupancy)
    for (int k = 0; k < voxels.size[2]; ++k)
      for (int j = 0; j < voxels.size[1]; ++j)
        for (int i = (j + k) % 4; i < voxels.size[0]; i += 4)
          if (voxels.at(i, j, k) != voxel::haptic_empty)
            felt.add(voxels.to_world_mm({double(i), double(j), double(k)}));
  if (!surfaces.most()) refuse("space origin", "most of what is seen lies beyond the CT");
  if (!felt.most()) refuse("space origin", "most of what is felt lies beyond the CT");
}

class Loader {
 public:
  /// `prefix` stands before a file's name in errors.
  Loader(const CaseFileReader& read, std::string prefix, LoadParts parts)
      : read_(read), prefix_(std::move(prefix)), parts_(parts) {}

  LoadedCase load() {
    read_manifest();
    plan();
    run();
    if (parts_.compare_all) compare_all();
    return std::move(out_);
  }

 private:
  template <class F>
  void within(const std::string& name, F&& f) const {
    with_file(prefix_ + name, std::forward<F>(f));
  }

  void read_manifest() {
    within(detail::manifest_name, [&] {
      const std::vector<char> bytes = read_(detail::manifest_name, detail::max_manifest_bytes);
      if (bytes.size() > detail::max_manifest_bytes) refuse("size", "more than a case.json can be");
      out_.manifest = parse_case_json({bytes.data(), bytes.size()});
      out_.bytes = bytes.size();
    });
    for (const CaseFile& f : out_.manifest.files) out_.bytes += f.bytes;
  }

  // From here on size and checksum are known to be right.
  std::vector<char> bytes_of(const std::string& name) const {
    const CaseFile& file = *out_.manifest.find_file(name);
    std::vector<char> bytes;
    within(name, [&] {
      bytes = read_(name, file.bytes);
      if (bytes.size() != file.bytes)
        refuse("size", std::to_string(bytes.size()) + " bytes, case.json says " + std::to_string(file.bytes) +
                           detail::damaged_remedy);
      if (sha256_of_bytes({bytes.data(), bytes.size()}) != file.sha256)
        refuse("checksum", std::string("is not that of case.json: the file is damaged") + detail::damaged_remedy);
    });
    return bytes;
  }

  void load_haptic() {
    const CaseHaptic& h = out_.manifest.haptic;
    const std::vector<char> bytes = bytes_of(h.file);
    std::vector<char> hardness;
    if (!h.hardness_file.empty()) hardness = bytes_of(h.hardness_file);
    try {
      out_.haptic = voxel::decode_haptic({bytes.data(), bytes.size()}, {hardness.data(), hardness.size()});
      compare_haptic(out_.haptic, h);
    } catch (Error& e) {
      e.in_file(prefix_ + (e.about().empty() ? h.file : h.hardness_file));
      throw;
    }
  }

  void load_surface(std::size_t anatomy) {
    const CaseAnatomy& a = out_.manifest.anatomies[anatomy];
    const std::vector<char> bytes = bytes_of(a.file);
    within(a.file, [&] { out_.surfaces[anatomy] = read_surface(bytes, a, out_.manifest.center_mm); });
  }

  void load_ct() {
    const CaseCt& ct = out_.manifest.ct;
    const std::vector<char> bytes = bytes_of(ct.file);
    within(ct.file, [&] { out_.ct = read_ct(bytes, ct); });
  }

  void compare_all() const {
    const CaseManifest& m = out_.manifest;
    if (out_.has_haptic()) within(m.haptic.file, [&] { compare_volumes(out_.haptic, m.haptic); });
    within(detail::manifest_name, [&] { compare_figures(m); });
    if (out_.has_ct()) within(m.ct.file, [&] { compare_places(out_); });
  }

  // A task a file, the largest first.
  void plan() {
    const CaseManifest& m = out_.manifest;
    std::set<std::string> planned{m.haptic.file, m.haptic.hardness_file};
    if (!m.haptic.file.empty()) tasks_.push_back([this] { load_haptic(); });
    if (parts_.ct && !m.ct.file.empty()) {
      tasks_.push_back([this] { load_ct(); });
      planned.insert(m.ct.file);
    }
    out_.surfaces.resize(m.anatomies.size());
    for (std::size_t i = 0; i < m.anatomies.size(); ++i) {
      if (m.anatomies[i].file.empty()) continue;
      tasks_.push_back([this, i] { load_surface(i); });
      planned.insert(m.anatomies[i].file);
    }
    for (const CaseFile& f : m.files)
      if (!planned.count(f.name)) tasks_.push_back([this, &f] { bytes_of(f.name); });
  }

  // The fault that comes first in the plan is reported, whichever thread finds its own first.
  void run() {
    std::vector<std::exception_ptr> faults(tasks_.size());
    parallel_for(0, static_cast<std::int64_t>(tasks_.size()), 1, [&](std::int64_t task, std::int64_t) {
      try {
        tasks_[static_cast<std::size_t>(task)]();
      } catch (...) {
        faults[static_cast<std::size_t>(task)] = std::current_exception();
      }
    });
    for (const auto& fault : faults)
      if (fault) std::rethrow_exception(fault);
  }

  const CaseFileReader& read_;
  const std::string prefix_;
  const LoadParts parts_;
  LoadedCase out_;
  std::vector<std::function<void()>> tasks_;
};

}  // namespace

const surface::TriMesh* LoadedCase::find_surface(const std::string& anatomy) const {
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    if (manifest.anatomies[i].name == anatomy) return surfaces[i].triangles.empty() ? nullptr : &surfaces[i];
  return nullptr;
}

LoadedCase load_case(const std::filesystem::path& case_folder, LoadParts parts) {
  const CaseFileReader read = [&](const std::string& name, std::uint64_t max_bytes) {
    return read_file(case_folder / name, max_bytes);
  };
  return Loader(read, (case_folder / "").string(), parts).load();
}

HashedCase load_hashed_case(const std::filesystem::path& case_folder, LoadParts parts) {
  HashedCase out;
  const CaseFileReader read = [&](const std::string& name, std::uint64_t max_bytes) {
    std::vector<char> bytes = read_file(case_folder / name, max_bytes);
    if (name == detail::manifest_name) out.sha256 = sha256_of_bytes({bytes.data(), bytes.size()});
    return bytes;
  };
  out.loaded = Loader(read, (case_folder / "").string(), parts).load();
  return out;
}

LoadedCase load_case_through(const CaseFileReader& read, LoadParts parts) { return Loader(read, "", parts).load(); }

}  // namespace trephine::cases
