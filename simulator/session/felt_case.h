// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "cases/load_case.h"
#include "haptics/feel.h"
#include "haptics/recording.h"
#include "haptics/tool_belt.h"
#include "touch/felt_space.h"

namespace trephine::session {

class SecondHand;

/// A loaded case that can be felt.
struct FeltCase {
  cases::LoadedCase loaded;
  haptics::Feels feels;
  std::shared_ptr<const touch::MeshSurfaces> meshes;   ///< null where no surface is touched as a mesh
  std::shared_ptr<const touch::StiffnessRamps> ramps;  ///< null where no stiffness follows HU
  std::map<int, std::string> shapes;                   ///< names by number, of the volume and of the meshes
  std::string felt_shape, case_sha256;                 ///< the second of the very case.json that was loaded

  /// Throws as load_case does; 65 where the case has no haptic volume; 64 for --shape where it has no such shape. If a
  /// shape is given, of the volume or a surface that is touched as a mesh, no other can be touched.
  FeltCase(const std::filesystem::path& folder, const std::string& shape, cases::LoadParts parts = {});
  /// What is felt beside the volume; this must outlive it. Throws Error 64 where the case has no shape that the shaft
  /// is to be held in.
  touch::Beside beside(const haptics::ShaftParams& shaft) const;
  /// The drill of the recording's tool; null where that tool cuts nothing. Throws as Drilling and cutter_of do.
  std::unique_ptr<haptics::Drilling> drilling_of(const haptics::RecordingHeader& header,
                                                 contact::ContactVolume& contact, drill::DirtyBricks* marks = nullptr);
  /// The case and shape of a recording.
  haptics::RecordingHeader header() const;

 private:
  void feel_beside();
};

/// What a lesson's recording has beside a session's: its tools, of which the burr drills where the case can be drilled.
void set_lesson(haptics::RecordingHeader& header, const std::vector<haptics::BeltToolParams>& tools,
                const std::string& module, const std::string& participant, const cases::CaseHaptic& haptic);

/// The part of a recorded session that answers to poses: one tool, or several, and the drill. It can be run again.
class Rerun {
 public:
  /// `felt` and `contact` must outlive it; `file` names the recording in errors. Throws as tool_again does.
  /// `marks`, where given, notes what is cut.
  Rerun(FeltCase& felt, contact::ContactVolume& contact, const std::string& file,
        const haptics::RecordingHeader& header, drill::DirtyBricks* marks = nullptr);
  ~Rerun();
  std::vector<haptics::ServoFrame> run(const std::vector<haptics::ServoFrame>& recorded);
  /// The same of both hands, tick by tick: the second one's frames are those from `second` on, as many as `recorded`,
  /// and its answers are appended to `answered`. Where the recording has one hand they are not read.
  std::vector<haptics::ServoFrame> run(const std::vector<haptics::ServoFrame>& recorded,
                                       const haptics::ServoFrame* second, std::vector<haptics::ServoFrame>& answered);
  /// The answers that were recorded are taken as they are: both belts follow, and what was cut is cut. Of a lesson.
  void follow(const haptics::ServoFrame& recorded, const haptics::ServoFrame* second);
  const haptics::ToolBelt* second_belt() const;  ///< of the second hand; null without a tool in it
  const haptics::Drilling* drilling() const { return drilling_.get(); }
  haptics::ToolBelt* belt() { return belt_.get(); }  ///< null for one tool

 private:
  double rate_hz_;
  haptics::DevicePort port_;
  std::unique_ptr<haptics::Drilling> drilling_;
  std::unique_ptr<haptics::Proxy> proxy_;
  std::unique_ptr<haptics::ToolBelt> belt_;
  std::unique_ptr<SecondHand> second_;
};

/// The case and the tool as a recording has them. Throws Error 65, naming the file, where they are others, and where
/// the recording began with a volume that was cut, unless the caller sees to that (patient_again).
FeltCase felt_again(const std::filesystem::path& folder, const std::string& file,
                    const haptics::RecordingHeader& header, cases::LoadParts parts = {}, bool after_others = false);
haptics::Tool tool_again(const std::string& file, const haptics::ToolParams& params);

}  // namespace trephine::session
