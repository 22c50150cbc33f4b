// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/progress.h"
#include "render/stage.h"
#include "session/playback.h"

namespace trephine::dataset {

/// What is made of a recording.
struct RecordingDataOptions {
  int width = 640, height = 480;
  std::vector<double> times_s;  ///< of the recording, at which it is seen
  double baseline_mm = 0;       ///< between a left and a right picture; 0: one picture, of the camera itself
};
struct RecordingDataResult {
  std::uint64_t frames = 0, voxels_removed = 0, bytes = 0;
};

/// A recording as data: an HDF5 file with the groups and data sets of volumetric_drilling's recorder
/// (docs/reference/recording-data.md names it, and says what is ours): at each of the times the picture, the depth, the
/// labels and the poses, and of the whole recording the voxels that were removed, the force and the tool's pose in each
/// tick. Positions are metres, in the patient's coordinates (LPS).
///
/// The camera's middle of pixel (u, v), both counted from 0 at the upper left, lies at u and v: a point (x, y, z) of
/// the camera, x to the right, y down and z forwards, is seen at camera_intrinsic * (x, y, z) / z. The stage shows the
/// playback's case without a cut plane, rays and insets. Throws Error 70, 73 and 74 as DataFile does, 74 as the
/// renderer does; Cancelled.
RecordingDataResult write_recording_data(session::Playback& playback, render::Stage& stage,
                                         const scene::OrbitCamera& camera, const RecordingDataOptions& options,
                                         const std::filesystem::path& target, const Progress& progress = {});

}  // namespace trephine::dataset
