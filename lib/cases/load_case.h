// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cases/case.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::cases {

/// A case in memory as a simulator needs it. Everything in it has been checked.
struct LoadedCase {
  CaseManifest manifest;
  /// One surface for each anatomy of the manifest, in its order: origin_mm is the case's centre, normals have unit
  /// length; empty where nothing is displayed.
  std::vector<surface::TriMesh> surfaces;
  voxel::HapticVolume haptic;   ///< without voxels where the case has none
  grid::Grid<std::int16_t> ct;  ///< HU; without voxels where the case has none or it was not asked for
  std::uint64_t bytes = 0;      ///< of all files and case.json

  bool has_haptic() const { return !haptic.voxels.voxels.empty(); }
  bool has_ct() const { return !ct.voxels.empty(); }
  /// The surface of that anatomy; null where there is none.
  const surface::TriMesh* find_surface(const std::string& anatomy) const;
};

/// What of a case is loaded beside surfaces and haptic volume; what is not asked for is only hashed.
struct LoadParts {
  bool ct = false;
  /// Also compare what takes a walk over all of it: the shapes' volumes with the voxels that are felt, the patient's
  /// figures with the surfaces' volumes, the CT's place with that of what is seen and felt.
  bool compare_all = false;
};
/// As `check` and `library verify` do.
constexpr LoadParts whole_case{true, true};

/// Loads a case and verifies all of it, on up to thread_count() threads. Each file is read once, and the bytes that
/// were hashed are the bytes that are parsed. The checks, in this order: case.json (version, checksum, every value's
/// range; a newer minor version loads without the parts that this program does not know); each file's size and SHA-256;
/// the content of each file, which is not trusted (cases/glb.h, voxel/haptic_file.h): counts and indices are checked
/// before anything is allocated from them; and that the content is what case.json says: triangles, points, centre,
/// name, volume and area of a surface; encoding, size, spacing, shapes and hardness of the haptic volume; type, size
/// and spacing of the CT. A file that case.json names and this program does not know is only hashed.
///
/// Throws Error naming the file and the field: 66 where one is missing, 65 where one is damaged, contradicts case.json,
/// or the major version is another (both are named). Of several faults it is always the same one.
LoadedCase load_case(const std::filesystem::path& case_folder, LoadParts parts = {});

/// The same from another source (an archive, a network, a test). `read` returns the whole file of that name, relative
/// to the case ("case.json", "meshes/skull-0123456789abcdef.glb"), or throws Error; it should refuse a file longer than
/// `max_bytes`. It is called from several threads.
using CaseFileReader = std::function<std::vector<char>(const std::string& name, std::uint64_t max_bytes)>;
LoadedCase load_case_through(const CaseFileReader& read, LoadParts parts = {});

}  // namespace trephine::cases
