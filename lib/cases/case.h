// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/exit_code.h"
#include "base/report.h"
#include "base/vec3.h"

namespace trephine {

/// The case package: a folder with case.json and what it names; docs/case-package.md specifies it for other programs.
/// Positions are DICOM patient LPS, mm.

constexpr int case_version_major = 1, case_version_minor = 4;

/// Figures by name, in the order of insertion; numbers are finite.
using CaseValues = std::vector<std::pair<std::string, ParameterValue>>;

struct CaseDeviation {
  double max_mm = 0, p99_mm = 0, rms_mm = 0;  ///< two-sided, to the surface before decimation
};

struct CaseAnatomy {
  std::string name;
  std::string file;                                 ///< one of the manifest's files; empty where nothing is displayed
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB
  double opacity = 1;
  std::uint64_t triangles = 0, points = 0;
  double volume_ml = 0, area_cm2 = 0;
  CaseDeviation deviation;
  double budget_asked_mm = 0, budget_used_mm = 0;  ///< sums over the stages that moved the surface
  CaseValues figures;                              ///< other figures that the stages reported
};

struct CaseLandmark {
  std::string name;
  Vec3 position_mm;
  double confidence = 1;  ///< 0 to 1
  std::string source;     ///< "found", "estimated", "given", "truth"
};

struct CaseTarget {
  std::string name;
  Vec3 position_mm;
  double confidence = 1;
  std::string anatomy;  ///< the anatomy in which it lies; may be empty
};

struct CaseBurrHole {
  std::string name;
  Vec3 position_mm;
  Vec3 direction;  ///< unit, into the head
  double diameter_mm = 0;
  std::vector<std::string> cut;  ///< anatomies whose surface and haptic shape it is cut from; since 1.1
  CaseValues figures;  ///< bone_thickness_mm, "skull.removed_mesh_mm3", "skull.removed_haptic_mm3", ...; since 1.1
};

/// How one side of a shape's surface acts on the tool. A front face is met from outside, a back face from inside.
struct CaseFace {
  bool touchable = true;
  double stiffness_n_per_mm = 0, damping_n_s_per_mm = 0;
  double static_friction_ratio = 0, dynamic_friction_ratio = 0;
  double pop_through_n = 0;  ///< the force above which the tool enters; 0: never
};

struct CaseMaterial {
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB, of what is displayed from the haptic volume
  CaseFace front, back;
  double drag_n_s_per_mm = 0;           ///< drag on the tip inside
  double shaft_friction_n_per_mm = 0;   ///< friction for each mm of shaft inside
  double removal_energy_j_per_mm3 = 0;  ///< energy that a drill must spend; 0: it cannot be drilled
};

/// How far the felt surface lies from the displayed one: along the normals of the displayed surface within the haptic
/// region, positive where the felt surface lies outside.
struct CaseMismatch {
  double bias_mm = 0, rms_mm = 0, p99_mm = 0, max_mm = 0;
  double missed_ratio = 0;  ///< share of the samples near which nothing is felt
  std::uint64_t samples = 0;
};

struct CaseShape {
  std::string name;  ///< name of the anatomy
  int number = 1;
  std::int16_t window_low = 0, window_high = 0;  ///< raw values that are its own
  CaseMaterial material;
  bool cuttable = false;
  std::string displayed = "surface";  ///< "surface": from its GLB; "haptic": from the volume
  double volume_ml = 0;
  CaseMismatch mismatch;  ///< 0 samples where it is displayed from the volume, which has no mismatch by construction
};

/// The haptic volume (voxel/haptic_volume.h); since 1.1.
struct CaseHaptic {
  std::string file;           ///< one of the manifest's files; empty: the case has none
  std::string hardness_file;  ///< may be empty
  std::string encoding = "occupancy";
  std::array<int, 3> size{0, 0, 0};
  Vec3 spacing_mm{1, 1, 1};
  std::vector<CaseShape> shapes;  ///< by ascending number
};

/// The CT that a scene asked for: int16 HU, gzip, cropped to what is shown and felt, after the face policy; since 1.3.
struct CaseCt {
  std::string file;  ///< one of the manifest's files; empty: the case has none
  std::array<int, 3> size{0, 0, 0};
  Vec3 spacing_mm{1, 1, 1};
};

/// An anatomy that the scene asked for and could do without; since 1.4.
struct CaseMissing {
  std::string anatomy;
  std::string why;  ///< what refused it
};

struct CaseFile {
  std::string name;    ///< relative, "meshes/skull-0123456789abcdef.glb"
  std::string sha256;  ///< 64 lower-case digits
  std::uint64_t bytes = 0;
};

struct CaseManifest {
  int version_major = case_version_major, version_minor = case_version_minor;
  std::string case_token;
  Vec3 center_mm;  ///< origin of GLB positions
  std::vector<CaseAnatomy> anatomies;
  std::vector<CaseMissing> missing;
  std::vector<CaseLandmark> landmarks;
  std::vector<CaseTarget> targets;
  std::vector<CaseBurrHole> burr_holes;
  CaseHaptic haptic;
  CaseCt ct;
  CaseValues figures;  ///< of the patient: class, evans_index_ratio, midline_shift_mm, ...; since 1.2
  std::string face_policy = "keep", face_reason;
  std::string program_version;  ///< "trephine 0.1.0"
  std::string input_sha256;     ///< hash of what was read, without identifiers
  CaseValues parameters;        ///< effective parameters by path, "skull.decimate.max_deviation_mm"
  std::vector<CaseFile> files;

  const CaseAnatomy* find_anatomy(std::string_view name) const;
  const CaseFile* find_file(std::string_view name) const;
};

/// Throws Error with that code (64 from a flag, 78 from a config) unless the token is [a-z0-9][a-z0-9_-]{0,63}.
void validate_case_token(const std::string& token, ExitCode code);

/// The bytes of case.json: keys in fixed order, shortest numbers, files sorted by name, and at the end a checksum of
/// everything before it. It holds no time, host or path unless the caller put one into a value. Throws Error 70 where
/// the manifest contradicts itself (an anatomy's file that is not listed, repeated names, numbers that are not finite).
std::string to_json(const CaseManifest& manifest);
/// Checks the version, then the checksum, then parses. Of a newer minor version it takes the parts that it knows.
/// Throws Error 65.
CaseManifest parse_case_json(std::string_view json);

/// Reads case.json and checks size and SHA-256 of every file that it names, without parsing them. Throws Error naming
/// the file: 66 where one is missing, 65 where one is damaged or the version is newer (both versions are named).
CaseManifest read_case(const std::filesystem::path& case_folder);

/// The bytes of one of the case's files, checked again, so that the parsed bytes are the checked ones.
std::string read_case_file(const std::filesystem::path& case_folder, const CaseFile& file);

/// The name of a file by its content: "meshes/skull", ".glb" and bytes give meshes/skull-<first 16 digits of the
/// SHA-256>.glb.
CaseFile describe_case_file(const std::string& stem, const std::string& extension, std::string_view bytes);

/// Writes the bytes under their content name, unless the file exists already; synced. Throws Error 73 and 74.
CaseFile write_case_file(const std::filesystem::path& case_folder, const std::string& stem,
                         const std::string& extension, std::string_view bytes);

/// Renames case.json into place as the last step: before it the old case is complete, after it the new one. Throws
/// Error 70 where a file that the manifest names is missing or has another size; 73 and 74. Files of the old case stay
/// until remove_unnamed_case_files.
void publish_case(const std::filesystem::path& case_folder, const CaseManifest& manifest);

/// Removes files with a content name that case.json does not name, and temporary files of dead processes; returns how
/// many. Call it only under the case's lock, because another run may be about to name them. A reader of the older case
/// that misses a file gets the Error 66 of read_case or read_case_file, which names the file; it should read case.json
/// again.
int remove_unnamed_case_files(const std::filesystem::path& case_folder);

}  // namespace trephine
