// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "haptics/recording.h"
#include "session/hand_watch.h"
#include "session/session.h"

namespace trephine::session {

/// An incision of a recording, or of a session that runs.
struct IncisionMark {
  double time_s = 0;
  Vec3 point_mm;
  double radius_mm = 0;
};
/// Finds incisions in frames as they come: where the button goes down while a tool may cut, or, in a session with
/// several tools, at the marker's last point when the command is given (tool_belt.h). One that is taken back is taken
/// off the list again.
class IncisionWatch {
 public:
  explicit IncisionWatch(const haptics::RecordingHeader& header, HandWatch::ShapeAt shape_at = {})
      : drilling_(header.drilling), tools_(header.tools), hand_(header, std::move(shape_at)) {}
  void look(const haptics::ServoFrame& frame, std::vector<IncisionMark>& out);
  const HandWatch& hand() const { return hand_; }  ///< after the last frame

 private:
  haptics::DrillingParams drilling_;
  void add(const IncisionMark& mark, std::vector<IncisionMark>& out);
  void follow_steps(const haptics::ServoFrame& frame, std::uint32_t before, std::vector<IncisionMark>& out);
  std::vector<haptics::BeltToolParams> tools_;
  HandWatch hand_;
  std::vector<bool> steps_;  // that can be taken back; true: an incision
  bool stroke_ = false;      // the pedal is down, and nothing was touched so far
  std::uint32_t buttons_ = 0;
  bool has_mark_ = false;
  Vec3 mark_mm_;
};

/// The patient as a recording finds it: the case, and what the recordings before it cut, which are run again in their
/// order. `contact`: how the recording itself is felt. Throws as read_recording and felt_again do; 65 where the volume
/// is not the one with which the recording begins. `incisions`: gets those of the recordings before.
std::shared_ptr<Patient> patient_again(const std::filesystem::path& case_folder, const std::filesystem::path& file,
                                       const haptics::RecordingHeader& header, const contact::ContactParams& contact,
                                       const std::vector<std::filesystem::path>& before, cases::LoadParts parts = {},
                                       const Progress& progress = {}, std::vector<IncisionMark>* incisions = nullptr);

/// A recording that can be shown at any of its times, with the voxels as they were then. The constructor runs it once;
/// then going to another time, forwards or backwards, changes only the voxels that differ.
class Playback {
 public:
  /// `before`: the recordings that it follows. Throws as patient_again does; 80 where the replay gives other voxels
  /// than the recording says; Cancelled.
  Playback(const std::filesystem::path& case_folder, const std::filesystem::path& recording,
           const std::vector<std::filesystem::path>& before, cases::LoadParts parts, const Progress& progress = {});

  const std::shared_ptr<Patient>& patient() const { return patient_; }
  const cases::LoadedCase& loaded() const { return patient_->felt.loaded; }  ///< its voxels are those at time_s()
  const haptics::Recording& recording() const { return recording_; }
  const haptics::RecordingHeader& header() const { return recording_.header; }
  const std::vector<haptics::ServoFrame>& frames() const { return recording_.frames; }
  double begin_s() const;
  double end_s() const;
  const std::vector<IncisionMark>& incisions() const { return incisions_; }

  /// Shows that time; times beyond the recording are its ends.
  void go_to(double time_s);
  double time_s() const { return time_s_; }
  const haptics::ServoFrame& frame() const { return recording_.frames[frame_]; }
  std::size_t frame_number() const { return frame_; }  ///< of frames()
  /// What the other hand held, and its frame then; null where there was one hand.
  const haptics::RecordedSecondHand* held_second() const { return header().second ? &*header().second : nullptr; }
  const haptics::ServoFrame* second_frame() const { return header().second ? &recording_.second[frame_] : nullptr; }
  /// How voxels changed from begin to end, in the order of their times. They are compared each 60th of a second.
  struct VoxelChange {
    double time_s;
    std::uint32_t at;  ///< of the volume's voxels
    std::int16_t before, after;
  };
  std::vector<VoxelChange> voxel_changes() const;
  /// Runs the recording again, where the constructor did not because nothing of it cuts. Throws Error 80 where the
  /// answer of any frame is another one than recorded, in any bit.
  void require_same_frames(const std::filesystem::path& file);
  /// The tools as they were taken into the hand, the first at the begin.
  struct ToolTaken {
    double time_s;
    haptics::ToolParams tool;
  };
  std::vector<ToolTaken> tools_taken() const;
  /// The tool in hand at that time, and its name.
  haptics::ToolParams tool() const;
  std::string tool_name() const;
  /// What changed since marks were last taken.
  drill::DirtyBricks& marks() { return patient_->marks; }

 private:
  struct Change {
    std::uint32_t at;
    std::int16_t before, after;
  };
  struct Step {
    double end_s;             ///< the voxels have these values from then on
    std::size_t first, last;  ///< of changes_
  };
  void run_through(const std::filesystem::path& file, const Progress& progress);
  void follow(std::size_t first, std::size_t end);
  void note_changes(double time_s, std::vector<std::int16_t>& mirror);
  void apply(std::size_t change, bool forwards);
  std::size_t tool_in_hand() const;
  haptics::ToolParams tool_numbered(std::size_t tool) const;

  haptics::Recording recording_;
  std::shared_ptr<Patient> patient_;
  std::vector<Change> changes_;
  std::vector<Step> steps_;
  std::vector<std::size_t> taken_;
  std::vector<IncisionMark> incisions_;
  struct Taken {
    std::size_t frame, tool;
  };
  std::vector<Taken> in_hand_;          // from each of these frames on
  std::optional<IncisionWatch> watch_;  // while the constructor works
  std::size_t shown_steps_ = 0, frame_ = 0, different_ = 0;
  double time_s_ = 0;
};

}  // namespace trephine::session
