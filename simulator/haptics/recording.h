// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "haptics/frame.h"
#include "haptics/proxy.h"

namespace trephine {

constexpr int recording_version = 1;

/// What a recording says of itself: all that its replay needs beside the case.
struct RecordingHeader {
  std::string case_token, haptic_sha256;  ///< of the case, and of its haptic volume's file
  std::string feel_sha256;                ///< feel_digest(); empty in recordings made before it was there
  std::string device;
  double rate_hz = 1000;
  std::string felt_shape;  ///< the one shape that could be touched; empty: all that the case says
  ContactParams contact;
  ForceParams force;
  ShaftParams shaft;
  ToolParams tool;  ///< as own_tool() gives it; recordings made before there were tools are of a point
};

/// Writes through FileWriter: the file is there when finish() was called, or not at all. Throws 73 and 74.
class RecordingWriter {
 public:
  RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
  ~RecordingWriter();
  void add(const std::vector<ServoFrame>& frames);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct Recording {
  RecordingHeader header;
  std::vector<ServoFrame> frames;
};

/// Throws Error 66; 65 naming the field: no recording, another version, a damaged header, a part of a frame at the end,
/// more or fewer frames than its header says (recordings made before that was there, or into a pipe, do not say),
/// ticks or times that do not ascend. Frames may be missing where the disk was too slow: missing_frames().
Recording read_recording(const std::filesystem::path& file);
std::uint64_t missing_frames(const std::vector<ServoFrame>& frames);

/// SHA-256 of all numbers of the materials as they were felt.
std::string feel_digest(const Feels& feels);

/// How good forces are, by the measure of [Rizzi, chapter 4] and by what that measure leaves out.
struct ForceFigures {
  std::uint64_t frames = 0, touching = 0;
  double anomaly_ratio = 0;     ///< share of d|F|/dt (central differences) outside mean +- 10 sigma
  double zero_force_ratio = 0;  ///< frames without force
  double most_step_n = 0, sigma_n_per_s = 0, mean_force_n = 0, most_force_n = 0;
  double mean_lag_mm = 0, most_lag_mm = 0;  ///< while touching: of the proxy behind the device, along the surface
};
/// The frames to judge forces by, [begin, end): from `settle_s` after the first contact, when the tool has struck the
/// surface, to the end, for contact that is lost for good is what counts most. Empty where there is no contact.
struct ForceWindow {
  std::size_t begin = 0, end = 0;
};
ForceWindow force_window(const std::vector<ServoFrame>& frames, double settle_s = 0.5);
/// All zero for an empty window.
ForceFigures force_figures(const std::vector<ServoFrame>& frames, const ForceWindow& window);

/// Runs the recording's poses, buttons, steps and lost device through the proxy; what it answers stands in the frames
/// that are returned.
std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, Proxy& proxy);

/// Whether two frames are the same bit for bit, lateness apart.
bool same_frame(const ServoFrame& a, const ServoFrame& b);

}  // namespace trephine
