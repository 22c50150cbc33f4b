// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/playback.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/refusal.h"

namespace trephine::session {
namespace {

constexpr double step_s = 1.0 / 60;  // voxels are kept at that interval

const Remedy another_program{
    "replay it with the version of the program that recorded it, or record it anew with `servo`"};

// How many frames are not, bit for bit, those of the recording from that number on.
std::size_t unlike(const std::vector<haptics::ServoFrame>& again, const std::vector<haptics::ServoFrame>& recorded,
                   std::size_t first) {
  std::size_t count = 0;
  for (std::size_t n = 0; n < again.size(); ++n) count += !haptics::same_frame(again[n], recorded[first + n]);
  return count;
}

}  // namespace

void IncisionWatch::look(const haptics::ServoFrame& f, std::vector<IncisionMark>& out) {
  const std::uint32_t before = std::exchange(buttons_, f.buttons);
  hand_.look(f);
  if (!drilling_.drill || f.faults != 0) return;
  follow_steps(f, before, out);
  if (tools_.empty()) {
    if ((f.buttons & haptics::Drilling::mark) && !(before & haptics::Drilling::mark))
      add({f.time_s, {f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]}, drilling_.incision_radius_mm}, out);
    return;
  }
  if (!hand_.works()) return;
  if (tools_[hand_.tool()].marks && (f.buttons & haptics::belt_button::pedal) && f.touched != 0) {
    has_mark_ = true;
    mark_mm_ = {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
  }
  if (hand_.command() == haptics::belt_command::incise && has_mark_)
    add({f.time_s, mark_mm_, drilling_.incision_radius_mm}, out);
}

void IncisionWatch::add(const IncisionMark& mark, std::vector<IncisionMark>& out) {
  out.push_back(mark);
  steps_.push_back(true);
}

// Strokes that touched something are steps as incisions are, as the drill counts them (Drilling::take_back).
void IncisionWatch::follow_steps(const haptics::ServoFrame& f, std::uint32_t before, std::vector<IncisionMark>& out) {
  if (drilling_.undo_steps == 0) return;
  const bool pedal =
      hand_.works() && (f.buttons & haptics::Drilling::pedal) && (tools_.empty() || tools_[hand_.tool()].cuts);
  if (!pedal || !(before & haptics::Drilling::pedal)) stroke_ = pedal;
  if (stroke_ && f.touched != 0) {
    stroke_ = false;
    steps_.push_back(false);
  }
  const int command = hand_.command();
  if (pedal || !hand_.works()) return;
  std::size_t back = command == haptics::belt_command::undo    ? std::min<std::size_t>(1, steps_.size())
                     : command == haptics::belt_command::reset ? steps_.size()
                                                               : 0;
  for (; back > 0; --back) {
    if (steps_.back() && !out.empty()) out.pop_back();
    steps_.pop_back();
  }
}

haptics::ToolParams Playback::tool_numbered(std::size_t tool) const {
  const haptics::RecordingHeader& h = recording_.header;
  return h.tools.empty() ? h.tool : haptics::own_tool(h.tools[tool]);
}

haptics::ToolParams Playback::tool() const { return tool_numbered(tool_in_hand()); }

std::vector<Playback::ToolTaken> Playback::tools_taken() const {
  std::vector<ToolTaken> all;
  for (const Taken& t : in_hand_) all.push_back({recording_.frames[t.frame].time_s, tool_numbered(t.tool)});
  return all;
}

std::string Playback::tool_name() const {
  const haptics::RecordingHeader& h = recording_.header;
  return h.tools.empty() ? h.tool.tool : h.tools[tool_in_hand()].name;
}

std::size_t Playback::tool_in_hand() const {
  const auto after = std::upper_bound(in_hand_.begin(), in_hand_.end(), frame_,
                                      [](std::size_t n, const Taken& taken) { return n < taken.frame; });
  return after == in_hand_.begin() ? 0 : std::prev(after)->tool;
}

std::shared_ptr<Patient> patient_again(const std::filesystem::path& folder, const std::filesystem::path& file,
                                       const haptics::RecordingHeader& header, const contact::ContactParams& contact,
                                       const std::vector<std::filesystem::path>& before, cases::LoadParts parts,
                                       const Progress& progress, std::vector<IncisionMark>* incisions) {
  FeltCase felt = felt_again(folder, file.string(), header, parts, !before.empty());
  voxel::HapticVolume& volume = felt.loaded.haptic;
  const auto must_begin = [&](const haptics::RecordingHeader& h, const std::filesystem::path& name) {
    if (!h.begins_sha256.empty() && haptics::volume_digest(volume) != h.begins_sha256)
      throw Error(ExitCode::bad_input, name.string(), "begins_sha256",
                  "the recordings given before it lead to another volume than it begins with");
  };
  std::shared_ptr<const grid::Grid<std::int16_t>> uncut;
  if (!before.empty()) uncut = std::make_shared<const grid::Grid<std::int16_t>>(volume.voxels);
  const haptics::Feels feels = felt.feels;
  for (const std::filesystem::path& earlier : before) {
    // Each recording is felt with the parameters of its own time, because what is cut depends on the force.
    const haptics::Recording r = haptics::read_recording(earlier);
    haptics::require_seal(r, earlier);
    felt.feels = felt_again(folder, earlier.string(), r.header, {}, true).feels;
    must_begin(r.header, earlier);
    contact::ContactVolume as_then(volume, r.header.contact);
    Rerun rerun(felt, as_then, earlier.string(), r.header);
    // The hand is followed with the volume as it is before each piece.
    IncisionWatch watch(r.header, [&](Vec3 p) { return as_then.shape_at(p); });
    for (std::size_t first = 0; first < r.frames.size() && rerun.drilling();) {
      progress.check();
      std::size_t end = first + 1;
      while (end < r.frames.size() && r.frames[end].time_s < r.frames[first].time_s + step_s) ++end;
      for (std::size_t n = first; incisions && n < end; ++n) watch.look(r.frames[n], *incisions);
      rerun.run({r.frames.begin() + std::ptrdiff_t(first), r.frames.begin() + std::ptrdiff_t(end)});
      first = end;
    }
  }
  felt.feels = feels;
  must_begin(header, file);
  auto patient = std::make_shared<Patient>(std::move(felt), contact);
  patient->uncut = std::move(uncut);
  return patient;
}

Playback::Playback(const std::filesystem::path& folder, const std::filesystem::path& file,
                   const std::vector<std::filesystem::path>& before, cases::LoadParts parts, const Progress& progress)
    : recording_(haptics::read_recording(file)) {
  const haptics::RecordingHeader& h = recording_.header;
  haptics::require_seal(recording_, file);
  if (recording_.frames.empty()) throw Error(ExitCode::bad_input, file.string(), "frames", "there are none to show");
  patient_ = patient_again(folder, file, h, h.contact, before, parts, progress, &incisions_);
  for (IncisionMark& mark : incisions_) mark.time_s = begin_s();  // earlier ones are there from the begin
  watch_.emplace(h, shape_at_of(patient_));
  if (h.drilling.drill)
    run_through(file, progress);
  else
    follow(0, recording_.frames.size());
  watch_.reset();
  go_to(begin_s());
}

// With the volume as it is before these frames.
void Playback::follow(std::size_t first, std::size_t end) {
  for (std::size_t n = first; n < end; ++n) {
    watch_->look(recording_.frames[n], incisions_);
    const std::size_t tool = watch_->hand().tool();
    if (in_hand_.empty() || tool != in_hand_.back().tool) in_hand_.push_back({n, tool});
  }
}

void Playback::run_through(const std::filesystem::path& file, const Progress& progress) {
  const haptics::RecordingHeader& h = recording_.header;
  const std::vector<haptics::ServoFrame>& frames = recording_.frames;

  voxel::HapticVolume& volume = patient_->felt.loaded.haptic;
  std::vector<std::int16_t> mirror = volume.voxels.voxels;
  Rerun rerun(patient_->felt, patient_->contact, file.string(), h, &patient_->marks);
  std::vector<haptics::ServoFrame> second;
  double next_s = frames.front().time_s + step_s;
  for (std::size_t first = 0; first < frames.size();) {
    std::size_t end = first;
    while (end < frames.size() && frames[end].time_s < next_s) ++end;
    follow(first, end);
    second.clear();
    different_ += unlike(rerun.run({frames.begin() + std::ptrdiff_t(first), frames.begin() + std::ptrdiff_t(end)},
                                   recording_.second.data() + (recording_.second.empty() ? 0 : first), second),
                         frames, first);
    different_ += unlike(second, recording_.second, first);
    if (end > first) note_changes(frames[end - 1].time_s, mirror);
    first = end;
    next_s += step_s;
    progress.report(double(first) / double(frames.size()));
  }
  if (h.outcome && haptics::volume_digest(volume) != h.outcome->volume_sha256)
    throw refusal("volume_sha256", "the volume differs when replayed", another_program).in_file(file.string());
  shown_steps_ = steps_.size();
}

void Playback::require_same_frames(const std::filesystem::path& file) {
  std::size_t different = different_;
  if (!header().drilling.drill) {
    Rerun rerun(patient_->felt, patient_->contact, file.string(), header());
    std::vector<haptics::ServoFrame> second;
    different = unlike(rerun.run(frames(), recording_.second.data(), second), frames(), 0);
    different += unlike(second, recording_.second, 0);
  }
  if (different > 0)
    throw refusal("frames",
                  std::to_string(different) + " of " + std::to_string(frames().size()) + " differ when replayed",
                  another_program)
        .in_file(file.string());
}

std::vector<Playback::VoxelChange> Playback::voxel_changes() const {
  std::vector<VoxelChange> all;
  all.reserve(changes_.size());
  for (const Step& step : steps_)
    for (std::size_t n = step.first; n < step.last; ++n)
      all.push_back({step.end_s, changes_[n].at, changes_[n].before, changes_[n].after});
  return all;
}

double Playback::begin_s() const { return recording_.frames.front().time_s; }
double Playback::end_s() const { return recording_.frames.back().time_s; }

// Compares the marked bricks with the mirror, and keeps what differs.
void Playback::note_changes(double time_s, std::vector<std::int16_t>& mirror) {
  taken_.clear();
  patient_->marks.take(taken_);
  if (taken_.empty()) return;
  const grid::Grid<std::int16_t>& g = patient_->felt.loaded.haptic.voxels;
  const drill::BrickLayout& layout = patient_->marks.layout();
  const std::size_t first = changes_.size();
  for (const std::size_t b : taken_) {
    const std::array<int, 3> at = layout.place(b);
    int low[3], high[3];
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(0, drill::BrickLayout::side * at[a] - 1);
      high[a] = std::min(g.size[a], drill::BrickLayout::side * (at[a] + 1));
    }
    for (int k = low[2]; k < high[2]; ++k)
      for (int j = low[1]; j < high[1]; ++j)
        for (int i = low[0]; i < high[0]; ++i) {
          const std::size_t n = g.index(i, j, k);
          if (g.voxels[n] == mirror[n]) continue;
          changes_.push_back({std::uint32_t(n), mirror[n], g.voxels[n]});
          mirror[n] = g.voxels[n];
        }
  }
  if (changes_.size() > first) steps_.push_back({time_s, first, changes_.size()});
}

void Playback::apply(std::size_t n, bool forwards) {
  const Change& c = changes_[n];
  grid::Grid<std::int16_t>& g = patient_->felt.loaded.haptic.voxels;
  g.voxels[c.at] = forwards ? c.after : c.before;
  const std::size_t row = std::size_t(g.size[0]), rest = c.at / row;
  patient_->marks.mark_voxel(int(c.at % row), int(rest % std::size_t(g.size[1])), int(rest / std::size_t(g.size[1])));
}

void Playback::go_to(double time_s) {
  const std::vector<haptics::ServoFrame>& frames = recording_.frames;
  time_s_ = std::clamp(time_s, begin_s(), end_s());
  const auto after = std::upper_bound(frames.begin(), frames.end(), time_s_,
                                      [](double t, const haptics::ServoFrame& f) { return t < f.time_s; });
  frame_ = after == frames.begin() ? 0 : std::size_t(after - frames.begin()) - 1;
  while (shown_steps_ < steps_.size() && steps_[shown_steps_].end_s <= time_s_) {
    for (std::size_t n = steps_[shown_steps_].first; n < steps_[shown_steps_].last; ++n) apply(n, true);
    ++shown_steps_;
  }
  while (shown_steps_ > 0 && steps_[shown_steps_ - 1].end_s > time_s_) {
    --shown_steps_;
    for (std::size_t n = steps_[shown_steps_].last; n-- > steps_[shown_steps_].first;) apply(n, false);
  }
}

}  // namespace trephine::session
