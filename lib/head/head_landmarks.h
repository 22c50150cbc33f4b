// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/vec3.h"
#include "cases/case.h"

namespace trephine::head {

/// The plane that separates the two sides of a head.
struct MidsagittalPlane {
  Vec3 point_mm;
  Vec3 normal{1, 0, 0};   ///< unit, to the patient's left
  double confidence = 0;  ///< 0: not known
};

/// The known landmarks of a head, found or given. Names: nasion, inion, vertex, tragus_left, tragus_right, bregma
/// (of the bone; the others are of the skin or inside), monro_left, monro_right, kocher_left, kocher_right, and others
/// that the user chooses. No name occurs twice. Sources: "found", "estimated", "given", "truth".
struct HeadLandmarks {
  MidsagittalPlane midsagittal;
  std::vector<cases::CaseLandmark> landmarks;
  const cases::CaseLandmark* find(std::string_view name) const;
};

/// A bregma that was found and is at least so sure lies at a suture that is seen, if not at the midline itself.
constexpr double seen_bregma_confidence = 0.35;

/// The names of the landmarks that are searched for in a head; a user may give others.
const std::vector<std::string>& findable_landmarks();

/// The error of a landmark that is not where it can be (65), which is about this name, so that a caller can tell who
/// gave it.
Error landmark_fault(const std::string& name, const std::string& what);

/// Our own JSON format, which keeps every value. parse throws Error 65 naming the field.
std::string landmarks_json(const HeadLandmarks& landmarks);
HeadLandmarks parse_landmarks_json(std::string_view text);

/// Reads a file by its ending: .mrk.json or .fcsv of 3D Slicer (cases/slicer_points.h), or .json for our own format.
/// Throws Error 66; 65 as the parsers do, naming the file; and `other_ending` for any other ending.
HeadLandmarks read_head_landmarks(const std::filesystem::path& file, ExitCode other_ending = ExitCode::bad_input);
/// Only the points of a file; throws Error 64 for another ending.
std::vector<cases::CaseLandmark> read_landmark_file(const std::filesystem::path& file);

}  // namespace trephine::head
