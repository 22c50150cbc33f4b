// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/refusal.h"
#include "base/text.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::haptics {
namespace {

// 8 bytes, then the version and the header's length, 4 bytes each; the header's JSON, filled up with blanks.
constexpr char magic[9] = "TREPHSRV";
constexpr std::size_t fixed_bytes = 16, header_bytes = 8192;

std::size_t frame_bytes(const RecordingHeader& h) { return h.knows_across ? sizeof(ServoFrame) : short_frame_bytes; }
std::size_t hands_of(const RecordingHeader& h) { return h.second ? 2 : 1; }

/// The header as it stands in the file.
struct HeaderFile : RecordingHeader {
  std::uint64_t frame_bytes = 0;
  std::int64_t frames = -1;      ///< not known while it is recorded
  std::string seal_sha256 = {};  ///< nor is this
  template <class V>
  static void describe(V& v) {
    v.template all_of<RecordingHeader>();
    v.integer(&HeaderFile::frame_bytes, "frame_bytes", Range{}, "Bytes of a frame.");
    v.integer(&HeaderFile::frames, "frames", Range{}, "How many there are of each hand.").not_always();
    v.text(&HeaderFile::seal_sha256, "seal_sha256",
           "Of the frames, and of what stands before them with these digits 0.")
        .not_always();
  }
};

const std::string unsealed(64, '0');  // stands in place of the seal while it is computed

std::string header_text(const RecordingHeader& h, std::optional<std::uint64_t> frames = {}) {
  HeaderFile file{h, frame_bytes(h)};
  if (frames) file.frames = std::int64_t(*frames);
  if (frames) file.seal_sha256 = unsealed;
  std::string text = json::declared_json(parameters_of<HeaderFile>(), &file, h.tools.empty() ? 1 : 0);
  const std::size_t left_for_frames = frames ? 0 : 2400;  // with the outcome, known only when all is recorded
  if (text.size() + left_for_frames + 1 > header_bytes) throw Error(ExitCode::internal, "", "header", "is too long");
  text.resize(header_bytes - 1, ' ');
  return text + "\n";
}

HeaderFile read_header(std::string_view text) {
  HeaderFile h;
  json::JsonRules rules;
  rules.by_program = true;
  json::read_declared_json(text, parameters_of<HeaderFile>(), &h, rules);
  h.knows_across = h.frame_bytes == sizeof(ServoFrame);
  return h;
}

void put_u32(std::uint32_t v, char* out) {
  for (int n = 0; n < 4; ++n) out[n] = char(v >> 8 * n);
}
std::uint32_t get_u32(const char* in) {
  std::uint32_t v = 0;
  for (int n = 0; n < 4; ++n) v |= std::uint32_t(std::uint8_t(in[n])) << 8 * n;
  return v;
}

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

std::string fixed_text() {
  char fixed[fixed_bytes];
  std::memcpy(fixed, magic, 8);
  put_u32(recording_version, fixed + 8);
  put_u32(header_bytes, fixed + 12);
  return {fixed, sizeof fixed};
}

// Of a whole file whose header says `said`; the frames come first, because the header is known last.
Seal seal_of(std::string_view head, std::string_view frames, const std::string& said) {
  if (said.empty()) return Seal::absent;
  std::string zeroed(head);
  const std::size_t at = zeroed.rfind(said);
  if (said.size() != unsealed.size() || at == std::string::npos) return Seal::broken;
  zeroed.replace(at, said.size(), unsealed);
  const std::string is = Sha256().bytes(frames.data(), frames.size()).bytes(zeroed.data(), zeroed.size()).hex();
  return is == said ? Seal::whole : Seal::broken;
}

// A name typed wrongly (CASE/case.json) must not cost a file that is no recording.
const std::filesystem::path& replaceable(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return file;
  char begin[sizeof magic] = {};
  std::ifstream(file, std::ios::binary).read(begin, 8);
  if (begin[0] != 0 && std::memcmp(begin, magic, 8) != 0)
    throw Error(ExitCode::cannot_create, file.string(), "",
                "is there already and is no recording, so that it is not replaced; give another name");
  return file;
}

}  // namespace

struct RecordingWriter::Impl {
  FileWriter out;
  RecordingHeader header;
  std::uint64_t frames = 0;
  Sha256 seal = {};
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header)
    : impl_(new Impl{FileWriter(replaceable(file)), header}) {
  impl_->out.write(fixed_text());
  impl_->out.write(header_text(header));
}
RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::add(const std::vector<ServoFrame>& frames, const std::vector<ServoFrame>& second) {
  const std::size_t hands = hands_of(impl_->header);
  if (second.size() != (hands - 1) * frames.size())
    throw Error(ExitCode::internal, "", "second", "frames are not as many");
  for (const ServoFrame& f : frames)
    if (!std::isfinite(f.time_s))
      throw Error(ExitCode::bad_input, "", "time_s", "of tick " + std::to_string(f.tick) + " is not finite");
  const std::size_t each = frame_bytes(impl_->header);
  std::string bytes(hands * frames.size() * each, 0);
  for (std::size_t n = 0; n < frames.size(); ++n) std::memcpy(&bytes[hands * n * each], &frames[n], each);
  for (std::size_t n = 0; n < second.size(); ++n) std::memcpy(&bytes[(hands * n + 1) * each], &second[n], each);
  impl_->out.write(bytes);
  impl_->seal.bytes(bytes.data(), bytes.size());
  impl_->frames += frames.size();
}
void RecordingWriter::finish(const std::optional<RecordedCutting>& outcome) {
  impl_->header.outcome = outcome;
  const std::string fixed = fixed_text();
  std::string text = header_text(impl_->header, impl_->frames);
  const std::string seal = impl_->seal.bytes(fixed.data(), fixed.size()).bytes(text.data(), text.size()).hex();
  text.replace(text.rfind(unsealed), unsealed.size(), seal);
  impl_->out.overwrite(fixed_bytes, text);
  impl_->out.commit();
}

Recording read_recording(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, std::uint64_t{1} << 35);
    const auto refuse = [](const char* field, const std::string& what) {
      throw Error(ExitCode::bad_input, "", field, what);
    };
    if (bytes.size() < fixed_bytes || std::memcmp(bytes.data(), magic, 8) != 0) refuse("", "is no recording");
    const std::uint32_t version = get_u32(bytes.data() + 8), length = get_u32(bytes.data() + 12);
    if (version != recording_version)
      refuse("version", std::to_string(version) + ", this program reads version " + std::to_string(recording_version) +
                            ": record it anew");
    if (length > bytes.size() - fixed_bytes || length > (1u << 20)) refuse("header", "is cut short");
    const HeaderFile header = read_header({bytes.data() + fixed_bytes, length});
    if (!(header.rate_hz > 0)) refuse("rate_hz", to_text(header.rate_hz) + ", must be above 0");
    if (header.frame_bytes != frame_bytes(header)) refuse("frame_bytes", "are not those of a frame");
    Recording r;
    r.header = header;
    const std::string_view all(bytes.data(), bytes.size());
    r.sha256 = sha256_of_bytes(all);
    r.seal = seal_of(all.substr(0, fixed_bytes + length), all.substr(fixed_bytes + length), header.seal_sha256);
    const std::size_t rest = bytes.size() - fixed_bytes - length;
    const std::size_t each = frame_bytes(r.header), hands = hands_of(r.header), count = rest / (hands * each);
    const std::string whole = ": the file was cut short or added to; take it as it was recorded";
    if (rest % (hands * each) != 0) refuse("frames", "the last one is incomplete" + whole);
    if (header.frames >= 0 && std::uint64_t(header.frames) != count)
      refuse("frames", "the file holds " + std::to_string(count) + ", and " + std::to_string(header.frames) +
                           " were recorded" + whole);
    const char* const first = bytes.data() + fixed_bytes + length;
    r.frames.resize(count);
    r.second.resize((hands - 1) * count);
    for (std::size_t n = 0; n < count; ++n) std::memcpy(&r.frames[n], first + hands * n * each, each);
    for (std::size_t n = 0; n < r.second.size(); ++n) {
      std::memcpy(&r.second[n], first + (hands * n + 1) * each, each);
      const ServoFrame &a = r.frames[n], &b = r.second[n];
      if (a.tick != b.tick || a.dt_s != b.dt_s || !(a.time_s == b.time_s || std::isnan(a.time_s)))
        refuse("second", "tick and times of frame " + std::to_string(n) + " are not those of the first hand");
    }
    // A count of ticks is a difference of two ticks plus one, which must not overflow.
    if (!r.frames.empty() && r.frames.back().tick == std::numeric_limits<std::uint64_t>::max())
      refuse("frames", "the last tick is beyond what can be counted");
    // A program that steps through a recording by its times would never reach a time that is not finite.
    for (std::size_t n = 0; n < r.frames.size(); ++n)
      if (!std::isfinite(r.frames[n].time_s))
        refuse("frames", "time_s of frame " + std::to_string(n) + " is not finite");
    for (std::size_t n = 1; n < r.frames.size(); ++n)
      if (r.frames[n].tick <= r.frames[n - 1].tick || !(r.frames[n].time_s > r.frames[n - 1].time_s))
        refuse("frames", "tick and time_s of frame " + std::to_string(n) + " must be above those before");
    return r;
  });
}

const char* name_of(Seal seal) {
  return seal == Seal::absent ? "not sealed" : seal == Seal::whole ? "sealed" : "broken seal";
}

void require_seal(const Recording& recording, const std::filesystem::path& file) {
  if (recording.seal != Seal::broken) return;
  throw refusal("seal_sha256", "is not of these bytes: the recording was changed after it was written",
                {"take the file as it was recorded, or record again with `servo`, `lesson` or `play`"})
      .in_file(file.string());
}

std::uint64_t missing_frames(const std::vector<ServoFrame>& frames) {
  return frames.empty() ? 0 : frames.back().tick + 1 - frames.size();
}

std::string feel_digest(const Feels& feels) {
  std::string text;
  for (std::size_t n = 0; n < feels.size(); ++n) {
    const ShapeFeel& f = feels[n];
    if (touch::is_mesh(int(n)) && !f.front.touchable) continue;
    const AnyParams params = AnyParams::make(f);
    for (const ParameterLeaf& leaf : leaves_of(params)) {
      const ParameterValue v = leaf.value();
      if (std::count(std::begin(ShapeFeel::not_felt), std::end(ShapeFeel::not_felt), leaf.path)) continue;
      const bool* flag = std::get_if<bool>(&v);
      text += (flag ? to_text(double(*flag)) : to_text(v)) + " ";
    }
  }
  return sha256_of_bytes(text);
}

std::string volume_digest(const voxel::HapticVolume& volume) {
  const std::vector<std::int16_t>& v = volume.voxels.voxels;
  return sha256_of_bytes({reinterpret_cast<const char*>(v.data()), v.size() * sizeof v[0]});
}

RecordedCutting outcome_of(const voxel::HapticVolume& volume, const DrillingOutcome& outcome) {
  RecordedCutting o;
  o.volume_sha256 = volume_digest(volume);
  for (const voxel::HapticShape& s : volume.shapes)
    if (const std::int64_t units = outcome.units[std::size_t(s.number)]; units > 0)
      o.removed_mm3[s.name] = double(units) / voxel::haptic_full * volume.voxels.voxel_volume_mm3();
  if (outcome.energy_j > 0) {
    o.max_bone_c = outcome.max_bone_c;
    o.heat_dose_min = outcome.heat_dose_min;
  }
  o.late_mm3 = double(outcome.late_units) / voxel::haptic_full * volume.voxels.voxel_volume_mm3();
  o.undone = outcome.undone;
  o.resets = outcome.resets;
  o.breached = outcome.breached;
  o.breach_time_s = outcome.breach_time_s;
  o.breach_mm = outcome.breach_mm;
  return o;
}

HapticInput input_of(const ServoFrame& f, double rate_hz) {
  HapticInput in;
  in.tip_mm = vec(f.tip_mm);
  in.axis = vec(f.axis);
  in.across = vec(f.across);
  in.buttons = f.buttons;
  in.dt_s = f.dt_s;
  in.period_s = 1 / rate_hz;
  return in;
}

HapticState state_of(const ServoFrame& f) {
  HapticState s;
  s.force_n = vec(f.force_n);
  s.proxy_mm = vec(f.proxy_mm);
  s.axis = vec(f.axis);
  s.normal = vec(f.normal);
  s.touched = f.touched;
  s.face = f.face;
  s.inside = f.inside;
  s.held_by = f.held_by;
  s.held_at = std::clamp(f.held_at, 0, 3);
  std::memcpy(s.held_mm, f.held_mm, sizeof s.held_mm);
  s.events = f.events;
  s.faults = f.faults;
  return s;
}

void put_input(const HapticInput& in, ServoFrame& f) {
  for (int a = 0; a < 3; ++a) {
    f.tip_mm[a] = in.tip_mm[a];
    f.axis[a] = in.axis[a];
    f.across[a] = in.across[a];
  }
  f.buttons = in.buttons;
}

void put_answer(const HapticState& s, ServoFrame& f) {
  for (int a = 0; a < 3; ++a) {
    f.proxy_mm[a] = s.proxy_mm[a];
    f.normal[a] = s.normal[a];
    f.force_n[a] = s.force_n[a];
  }
  f.touched = s.touched;
  f.face = s.face;
  f.inside = s.inside;
  f.held_by = s.held_by;
  f.held_at = s.held_at;
  for (int n = 0; n < 3; ++n)
    for (int a = 0; a < 3; ++a) f.held_mm[n][a] = n < s.held_at ? s.held_mm[n][a] : 0;
  f.events = s.events;
  f.faults = s.faults;
}

std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, double rate_hz, Proxy& proxy,
                                      Drilling* drilling, DevicePort* port) {
  std::vector<ServoFrame> out = recorded;
  for (ServoFrame& f : out) {
    HapticInput in = input_of(f, rate_hz);
    if (drilling) drilling->prepare(in);
    if (port) port->again(in, f.faults);
    if (f.faults & haptic_fault::device_lost) proxy.latch(haptic_fault::device_lost);
    const HapticState& felt = proxy.update(in);
    const HapticState& s = port ? port->after(in, felt) : felt;
    if (drilling) drilling->tick(in, s);
    put_answer(s, f);
  }
  return out;
}

std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, double rate_hz, ToolBelt& belt,
                                      DevicePort* port) {
  std::vector<ServoFrame> out = recorded;
  for (ServoFrame& f : out) {
    HapticInput in = input_of(f, rate_hz);
    if (port) port->again(in, f.faults);
    if (f.faults & haptic_fault::device_lost) belt.latch(haptic_fault::device_lost);
    const HapticState& felt = belt.update(in);
    const HapticState& s = port ? port->after(in, felt) : felt;
    belt.after(in, s);
    put_answer(s, f);
  }
  return out;
}

bool same_frame(const ServoFrame& a, const ServoFrame& b) {
  ServoFrame c = a;
  c.late_us = b.late_us;
  return std::memcmp(&c, &b, sizeof c) == 0;
}

}  // namespace trephine::haptics
