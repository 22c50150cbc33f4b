// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec3.h"
#include "cases/case.h"

namespace trephine {

/// The plane that parts a head into its two sides.
struct MidsagittalPlane {
  Vec3 point_mm;
  Vec3 normal{1, 0, 0};   ///< unit, to the patient's left
  double confidence = 0;  ///< 0: not known
};

/// What is known of a head's places, found or given. Names: nasion, inion, vertex, tragus_left, tragus_right, bregma
/// (estimated from the coronal suture's measured arc), monro_left, monro_right, kocher_left, kocher_right; others as
/// the user calls them. No name twice. Sources: "found", "estimated", "given", "truth".
struct HeadLandmarks {
  MidsagittalPlane midsagittal;
  std::vector<CaseLandmark> landmarks;
  const CaseLandmark* find(std::string_view name) const;
};

/// The names that are looked for in a head; a user may give others.
const std::vector<std::string>& findable_landmarks();

/// Our own JSON, value for value. parse throws Error 65 naming the field.
std::string landmarks_json(const HeadLandmarks& landmarks);
HeadLandmarks parse_landmarks_json(std::string_view text);

/// Points that a person placed: 3D Slicer's markups JSON (.mrk.json; coordinateSystem LPS or RAS, orientation ignored,
/// controlPoints by label, those that are "undefined" or "preview" left out) and its older table (.fcsv; "#
/// CoordinateSystem = RAS | LPS | 0 | 1", in files before 4.10 RAS is what 0 means). Source "given", confidence 1;
/// labels in lower case, blanks and hyphens to underscores. Throws Error 65 naming the field: no point, a name twice
/// with another place, a number that is not finite or beyond 1e5 mm, an unknown coordinate system or unit.
std::vector<CaseLandmark> parse_slicer_markups(std::string_view text);
std::vector<CaseLandmark> parse_slicer_fcsv(std::string_view text);

/// A file by its ending: .mrk.json, .fcsv, or .json for our own. Throws Error 66; 65 as the parsers do, naming the
/// file; and `other_ending` for any other.
HeadLandmarks read_head_landmarks(const std::filesystem::path& file, ExitCode other_ending = ExitCode::bad_input);
/// Its points alone; 64 for another ending.
std::vector<CaseLandmark> read_landmark_file(const std::filesystem::path& file);

}  // namespace trephine
