// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/device_port.h"
#include "haptics/drilling.h"
#include "haptics/frame.h"
#include "haptics/free_feel.h"
#include "haptics/proxy.h"
#include "haptics/target_params.h"
#include "haptics/tool_belt.h"

namespace trephine::haptics {

/// The one version that is written and read. Whatever changes forces, the header or the frames raises it and removes
/// what it replaces.
constexpr int recording_version = 21;

/// What was cut.
struct RecordedCutting {
  std::string volume_sha256;  ///< of the voxels at the end
  std::map<std::string, double> removed_mm3;
  bool breached = false;
  double breach_time_s = 0;
  Vec3 breach_mm;
  double max_bone_c = 0, heat_dose_min = 0, late_mm3 = 0;
  std::int64_t undone = 0, resets = 0;
  template <class V>
  static void describe(V& v) {
    using P = RecordedCutting;
    v.text(&P::volume_sha256, "volume_sha256", "SHA-256 of the voxels at the end.");
    v.map(&P::removed_mm3, "removed_mm3", "What was removed, by shape.");
    v.flag(&P::breached, "breached", "Whether the tip left drilled bone on the other side than it came in.");
    v.number(&P::breach_time_s, "breach_time_s", Range{}, "When.").not_always();
    v.numbers(&P::breach_mm, "breach_mm", Range{}, "Where.").not_always();
    v.number(&P::max_bone_c, "max_bone_c", Range{}, "How warm the bone became.").not_always();
    v.number(&P::heat_dose_min, "heat_dose_min", Range{}, "As minutes at 43 degrees.").not_always();
    v.number(&P::late_mm3, "late_mm3", Range{}, "What was removed from behind the tool.").not_always();
    v.integer(&P::undone, "undone", Range{}, "Strokes and incisions that were taken back.").not_always();
    v.integer(&P::resets, "resets", Range{}, "How often all was taken back.").not_always();
  }
};

/// A question that a lesson asks (lesson/questions.h), with the answers that it offers in the order of their numbers,
/// by their names. An answer is a command of the buttons (belt_command::answer).
struct AskedQuestion {
  std::string question;
  std::vector<std::string> choices;
  template <class V>
  static void describe(V& v) {
    v.text(&AskedQuestion::question, "question", "Its name in the rubric.");
    v.words(&AskedQuestion::choices, "choices", "The answers that are offered, in the order of their numbers.");
  }
};

/// What the other hand held, where there were two, and what limited its own device.
struct RecordedSecondHand {
  std::string device;
  bool switch_only = false;  ///< it held nothing, and felt nothing: its switch alone counts
  ForceParams force;
  PortParams port = PortParams::none();
  BeltToolParams tool;
  template <class V>
  static void describe(V& v) {
    using P = RecordedSecondHand;
    v.text(&P::device, "device", "What moved it.");
    v.flag(&P::switch_only, "switch_only", "It held nothing, and its switch alone counts.");
    v.group(&P::force, "force", "The limits on its forces.");
    v.group(&P::port, "port", "What lies between its device and its tool.");
    v.group(&P::tool, "tool", "What it held.");
  }
};

/// The header of a recording: everything besides the case that its replay needs.
struct RecordingHeader {
  std::string case_token, case_sha256;  ///< and of its case.json, which holds the hash of all else
  std::string feel_sha256;              ///< feel_digest()
  std::string device;
  double rate_hz = 1000;
  double place_error_mm = 0;  ///< Device::place_error_mm()
  bool knows_across = false;  ///< Device::knows_across() of either; frames then hold it, and are longer
  std::string felt_shape;     ///< the only shape that could be touched; empty: all shapes of the case
  contact::ContactParams contact;
  ForceParams force;
  PortParams port = PortParams::none();
  FreeParams free;
  ShaftParams shaft;
  ToolParams tool;  ///< as own_tool() gives it
  DrillingParams drilling;
  drill::DrillParams law;
  TargetParams target;
  std::vector<BeltToolParams> tools;  ///< of a lesson; empty: `tool` alone
  std::string lesson, participant;    ///< the module, and an anonymous token; with tools only
  std::string task;                   ///< what was asked for in the lesson
  std::string rubric_sha256;          ///< of the rubric by which it was to be judged; empty: none was given
  std::vector<AskedQuestion> asked;   ///< in the order of their numbers; empty: nothing was asked
  /// Of the voxels at its begin, where an earlier session had cut some; else empty.
  std::string begins_sha256;
  std::optional<RecordedSecondHand> second;
  std::optional<RecordedCutting> outcome;  ///< where the tool cut; not in a recording that was not finished
  template <class V>
  static void describe(V& v) {
    using P = RecordingHeader;
    v.text(&P::case_token, "case", "The case.");
    v.text(&P::case_sha256, "case_sha256", "SHA-256 of its case.json, which holds the hash of every file.");
    v.text(&P::feel_sha256, "feel_sha256", "Digest of its materials.");
    v.text(&P::device, "device", "Who held the tool.");
    v.only_where(v.number(&P::place_error_mm, "place_error_mm", Range{},
                          "How far the tool may really have been from its poses: the expected error."),
                 [](const P& h) { return h.place_error_mm != 0; });
    v.number(&P::rate_hz, "rate_hz", Range{}, "Ticks in each second, as they were asked for.");
    v.text(&P::felt_shape, "felt_shape", "The only shape that could be touched; empty: all.");
    v.group(&P::contact, "contact", "How contact is found.");
    v.group(&P::force, "force", "The limits on forces.");
    v.group(&P::port, "port", "What lies between device and tool.");
    v.only_where(v.group(&P::free, "free", "What is felt everywhere."), [](const P& h) { return h.free.any(); });
    v.group(&P::shaft, "shaft", "The shaft behind the tip.");
    v.group(&P::tool, "tool", "The tool.");
    const auto drills = [](const P& h) { return h.drilling.drill; };
    v.only_where(v.group(&P::drilling, "drilling", "How the session cuts."), drills);
    v.only_where(v.group(&P::law, "law", "How material is removed."), drills);
    v.only_where(v.group(&P::target, "target", "The target that the hand was to follow."),
                 [](const P& h) { return h.target.target; });
    v.only_where(v.section("lesson", "The lesson, where it is one.",
                           [](auto& in) {
                             in.text(&P::lesson, "module", "Its module.");
                             in.text(&P::participant, "participant", "An anonymous token.");
                             in.text(&P::task, "task", "What was asked for.");
                             in.text(&P::rubric_sha256, "rubric_sha256", "The rubric that was announced.");
                             in.list(&P::asked, "asked", "What was asked.").not_always();
                             in.list(&P::tools, "tools", "Its tools.");
                           }),
                 [](const P& h) { return !h.tools.empty(); });
    v.group(&P::second, "second", "The other hand, where there were two.").not_always();
    v.text(&P::begins_sha256, "begins_sha256", "SHA-256 of the voxels at the begin.").not_always();
    v.group(&P::outcome, "outcome", "What was cut.").not_always();
  }
};

/// SHA-256 of a volume's raw voxels, little endian.
std::string volume_digest(const voxel::HapticVolume& volume);
RecordedCutting outcome_of(const voxel::HapticVolume& volume, const DrillingOutcome& outcome);

/// Writes through FileWriter: the file exists after finish(), or not at all. Another recording of that name is
/// replaced; Error 73 for any other file, which is left as it is. Throws Error 73 and 74; add() 65 for a frame whose
/// time is not finite, which nobody could read.
class RecordingWriter {
 public:
  RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
  ~RecordingWriter();
  /// `second`: as many, of the same ticks, where the header has a second hand.
  void add(const std::vector<ServoFrame>& frames, const std::vector<ServoFrame>& second = {});
  void finish(const std::optional<RecordedCutting>& outcome = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether the bytes of a recording are those that were written. A seal is no signature: who can write the file can
/// also make its seal anew.
enum class Seal { absent, whole, broken };
const char* name_of(Seal seal);  ///< "not sealed", "sealed", "broken seal"

struct Recording {
  RecordingHeader header;
  std::vector<ServoFrame> frames, second = {};  ///< `second`: of the same ticks, where there were two hands
  Seal seal = Seal::absent;                     ///< as read_recording found it
  /// Of the very bytes that were parsed. Whoever says something of a recording's file says it of these: the file may be
  /// another one by the time it is read again.
  std::string sha256 = {};
};
/// Throws Error 80 where the seal is broken.
void require_seal(const Recording& recording, const std::filesystem::path& file);

/// Throws Error 66; 65 naming the field: not a recording, another version (both are named), a damaged header, a part of
/// a frame at the end, more or fewer frames than the header says (those made into a pipe do not say), ticks or times
/// that do not ascend, or of two hands are not the same, a time that is not finite. Frames may be missing where the
/// disk was too slow: missing_frames().
Recording read_recording(const std::filesystem::path& file);
std::uint64_t missing_frames(const std::vector<ServoFrame>& frames);

/// SHA-256 of all numbers of the materials as they were felt.
std::string feel_digest(const Feels& feels);

/// Runs the recording's poses, buttons, steps and lost device through the proxy, and where it is given the drilling.
/// The returned frames hold their answers.
std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, double rate_hz, Proxy& proxy,
                                      Drilling* drilling = nullptr, DevicePort* port = nullptr);
/// The same with several tools.
std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, double rate_hz, ToolBelt& belt,
                                      DevicePort* port = nullptr);
/// A recorded frame as the tick had it: what was read from the device, and the answer.
HapticInput input_of(const ServoFrame& frame, double rate_hz);
HapticState state_of(const ServoFrame& frame);
/// The same, written into a frame; they allocate nothing.
void put_input(const HapticInput& input, ServoFrame& frame);
void put_answer(const HapticState& state, ServoFrame& frame);

/// Whether two frames are equal bit for bit, except for their lateness.
bool same_frame(const ServoFrame& a, const ServoFrame& b);

}  // namespace trephine::haptics
