// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "cases/load_case.h"
#include "haptics/feel.h"
#include "haptics/recording.h"
#include "haptics/tool_belt.h"

namespace trephine {

/// A loaded case that can be felt.
struct FeltCase {
  LoadedCase loaded;
  Feels feels;
  std::string felt_shape;

  /// Throws as load_case does; 65 where the case has no haptic volume; 64 for --shape where it has no such shape. If a
  /// shape is given, no other can be touched.
  FeltCase(const std::filesystem::path& folder, const std::string& shape, LoadParts parts = {});
  /// What cuts, where the recording's tool does; else null. Throws as Drilling and cutter_of do.
  std::unique_ptr<Drilling> drilling_of(const RecordingHeader& header, ContactVolume& contact,
                                        DirtyBricks* marks = nullptr);
  /// The tool of a session with one, as it is felt.
  ToolParams felt_tool_of(const RecordingHeader& header) const;
  /// The case and shape of a recording.
  RecordingHeader header() const;
};

/// What a lesson's recording has beside a session's: its tools, of which the burr drills where the case can be drilled,
/// and is felt narrower than it cuts by the clearance of `header.drilling`.
void set_lesson(RecordingHeader& header, const std::vector<BeltToolParams>& tools, const std::string& module,
                const std::string& participant, const CaseHaptic& haptic);

/// The part of a recorded session that answers to poses: one tool, or several, and the drill. It can be run again.
class Rerun {
 public:
  /// `felt` and `contact` must outlive it; `file` names the recording in errors. Throws as tool_again does.
  /// `marks`, where given, notes what is cut.
  Rerun(FeltCase& felt, ContactVolume& contact, const std::string& file, const RecordingHeader& header,
        DirtyBricks* marks = nullptr);
  std::vector<ServoFrame> run(const std::vector<ServoFrame>& recorded);
  const Drilling* drilling() const { return drilling_.get(); }
  ToolBelt* belt() { return belt_.get(); }  ///< null for one tool

 private:
  double rate_hz_;
  std::unique_ptr<Drilling> drilling_;
  std::unique_ptr<Proxy> proxy_;
  std::unique_ptr<ToolBelt> belt_;
};

/// The case and the tool as a recording has them. Throws Error 65, naming the file, where they are others, and where
/// the recording began with a volume that was cut, unless the caller sees to that (patient_again).
FeltCase felt_again(const std::filesystem::path& folder, const std::string& file, const RecordingHeader& header,
                    LoadParts parts = {}, bool after_others = false);
Tool tool_again(const std::string& file, const ToolParams& params);

}  // namespace trephine
