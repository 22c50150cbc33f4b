// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "config/config.h"
#include "face/face_gate.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// The one gate through which everything passes that others will see of a case: surfaces, haptic volume, CT, pictures
/// and page. tests/house/face_gate.py fails for a source that publishes and does not ask it. It looks at what the
/// things show and not at what a recipe says of them, and it measures the skin itself, of every scan that the case
/// reads (face/scan_skin.h). The stage face_gate, which is cached, asks the same of the recipe's own skin.

/// What is about to be seen. The pointers are used only while the gate runs.
struct FaceShown {
  std::vector<face::FaceSurface> surfaces;
  const voxel::HapticVolume* haptic = nullptr;
  const grid::HuVolume* scan = nullptr;  ///< which the case holds as its CT, or of which pictures are made
};

/// Where the gate finds what the nodes of the case made: the data, and the result with its declared struct. Without
/// either, nothing passes that needs it.
struct FaceSources {
  std::function<stages::StageData(int node)> data;
  std::function<const AnyParams*(int node)> result;
};
FaceSources face_sources(const std::vector<pipeline::NodeResult>& results);

struct FaceClearance {
  bool scan_may_be_seen = true;  ///< in pictures; where not, pictures are of the surfaces alone
};

/// Adds the nodes whose data the gate reads: the scans as they were read, and the landmarks.
void add_face_nodes(const config::CaseConfig& config, const pipeline::Graph& graph, std::vector<int>& wanted);

/// By the scene's policy:
/// - keep: everything passes;
/// - deface, crop: nothing may come within face_clearance_mm of any scan's skin in the region of the face;
/// - none: where no scan shows a head, everything passes. Where one does, no surface, haptic volume or CT may show its
///   skin (skin_is_shown_cm2), and no picture is made of the scan.
/// Throws Error 81 naming the thing; Cancelled.
FaceClearance require_no_face(const config::CaseConfig& config, const pipeline::Graph& graph,
                              const FaceSources& sources, const FaceShown& shown, const Progress& progress = {});

/// The same of all that a run has made and is about to publish, where the scan is seen if the case has a CT or
/// `pictures` are wanted. The results are those of wanted_nodes and add_face_nodes.
FaceClearance require_no_face(const config::CaseConfig& config, const pipeline::Graph& graph,
                              const std::vector<pipeline::NodeResult>& results, bool pictures,
                              const Progress& progress = {});

/// What of a case may be looked at that the gate refuses as a whole, or has not passed yet: each surface by itself,
/// where it shows the skin of no scan. False where a scan is missing that would say so.
bool shows_no_skin(const config::CaseConfig& config, const pipeline::Graph& graph, const FaceSources& sources,
                   const surface::TriMesh& mesh, const Progress& progress = {});

/// For a picture of what one stage made. Throws Error 81 where the scene takes the face away and the stage reads a scan
/// that has it still.
void require_made_without_face(const config::CaseConfig& config, const pipeline::Graph& graph, int node);

/// How the face that a case shows is taken off: by a setting alone, or, where the landmarks were looked for and do not
/// say where the face is, once they are given.
std::string how_to_take_face_off(const std::vector<cases::CaseLandmark>& landmarks);

}  // namespace trephine::publish
