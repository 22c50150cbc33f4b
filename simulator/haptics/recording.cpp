// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/material.h"

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

// 8 bytes, then the version and the header's length, 4 bytes each; the header's JSON, filled up with blanks.
constexpr char magic[9] = "TREPHSRV";
constexpr std::size_t fixed_bytes = 16, header_bytes = 8192;

// Fields that were added later: recordings without them were made before there was such a thing.
bool is_newer(const std::string& name) {
  for (const char* newer : {"max_torque_n_mm", "turn_stiffness_n_mm_per_rad", "tool_points", "tool_points_sha256",
                            "pierce_n", "clearance_voxels", "max_step_s", "cut_at", "force_law", "release_s"})
    if (name == newer) return true;
  return false;
}

template <class P>
Json to_json(const P& params) {
  Json out = Json::object();
  for (const Parameter& p : parameters_of<P>().parameters)
    if (const ParameterValue value = p.get(&params); !is_newer(p.name) || value != ParameterValue(std::string()))
      std::visit([&](const auto& v) { out[p.name] = v; }, value);
  return out;
}

template <class P>
void from_json(const Json& in, P& params) {
  for (const Parameter& p : parameters_of<P>().parameters) {
    if (is_newer(p.name) && !in.contains(p.name)) continue;
    const Json& v = in.at(p.name);
    const std::string text = v.is_string() ? v.get<std::string>() : v.dump();
    ParameterValue value;
    const std::string fault = parse_parameter(p, {text}, value);
    if (!fault.empty()) throw Error(ExitCode::bad_input, "", p.name, fault);
    p.set(&params, value);
  }
}

std::size_t frame_bytes(const RecordingHeader& h) { return h.knows_across ? sizeof(ServoFrame) : short_frame_bytes; }

int version_of(const RecordingHeader& h) {
  if (h.force.force_law == ForceParams::Law::second ||
      (h.drilling.drill && h.drilling.cut_at == DrillingParams::At::tool))
    return recording_version;
  return h.knows_across ? across_version : h.tools.empty() ? single_tool_version : several_tools_version;
}

std::string header_text(const RecordingHeader& h, std::optional<std::uint64_t> frames = {}) {
  Json j = {{"case", h.case_token},          {"haptic_sha256", h.haptic_sha256},
            {"feel_sha256", h.feel_sha256},  {"device", h.device},
            {"rate_hz", h.rate_hz},          {"felt_shape", h.felt_shape},
            {"frame_bytes", frame_bytes(h)}, {"contact", to_json(h.contact)},
            {"force", to_json(h.force)},     {"shaft", to_json(h.shaft)},
            {"tool", to_json(h.tool)}};
  if (h.drilling.drill) {
    j["drilling"] = to_json(h.drilling);
    j["law"] = to_json(h.law);
  }
  if (!h.tools.empty()) {
    j["lesson"] = {{"module", h.lesson}, {"participant", h.participant}, {"tools", Json::array()}};
    if (!h.task.empty()) j["lesson"]["task"] = h.task;
    if (h.in_open) j["lesson"]["in_open"] = true;
    for (const BeltToolParams& t : h.tools) j["lesson"]["tools"].push_back(to_json(t));
  }
  if (!h.begins_sha256.empty()) j["begins_sha256"] = h.begins_sha256;
  if (h.outcome) {
    const RecordingHeader::Outcome& o = *h.outcome;
    j["outcome"] = {{"volume_sha256", o.volume_sha256}, {"removed_mm3", o.removed_mm3}, {"breached", o.breached}};
    if (o.breached) {
      j["outcome"]["breach_time_s"] = o.breach_time_s;
      j["outcome"]["breach_mm"] = {o.breach_mm.x, o.breach_mm.y, o.breach_mm.z};
    }
  }
  if (frames) j["frames"] = *frames;
  std::string text = j.dump(h.tools.empty() ? 1 : 0);
  const std::size_t left_for_frames = frames ? 0 : 2400;  // with the outcome, known only when all is recorded
  if (text.size() + left_for_frames + 1 > header_bytes) throw Error(ExitCode::internal, "", "header", "is too long");
  text.resize(header_bytes - 1, ' ');
  return text + "\n";
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

RecordingHeader::Outcome read_outcome(const Json& j) {
  RecordingHeader::Outcome o;
  o.volume_sha256 = j.at("volume_sha256").get<std::string>();
  o.removed_mm3 = j.at("removed_mm3").get<std::map<std::string, double>>();
  o.breached = j.at("breached").get<bool>();
  if (o.breached) {
    o.breach_time_s = j.at("breach_time_s").get<double>();
    const auto at = j.at("breach_mm").get<std::array<double, 3>>();
    o.breach_mm = {at[0], at[1], at[2]};
  }
  return o;
}

}  // namespace

struct RecordingWriter::Impl {
  FileWriter out;
  RecordingHeader header;
  std::uint64_t frames = 0;
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header)
    : impl_(new Impl{FileWriter(file), header}) {
  char fixed[fixed_bytes];
  std::memcpy(fixed, magic, 8);
  put_u32(std::uint32_t(version_of(header)), fixed + 8);
  put_u32(header_bytes, fixed + 12);
  impl_->out.write(fixed, sizeof fixed);
  impl_->out.write(header_text(header));
}
RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::add(const std::vector<ServoFrame>& frames) {
  for (const ServoFrame& f : frames)
    if (!std::isfinite(f.time_s))
      throw Error(ExitCode::bad_input, "", "time_s", "of tick " + std::to_string(f.tick) + " is not finite");
  const std::size_t each = frame_bytes(impl_->header);
  std::string bytes(frames.size() * each, 0);
  for (std::size_t n = 0; n < frames.size(); ++n) std::memcpy(&bytes[n * each], &frames[n], each);
  impl_->out.write(bytes);
  impl_->frames += frames.size();
}
void RecordingWriter::finish(const std::optional<RecordingHeader::Outcome>& outcome) {
  impl_->header.outcome = outcome;
  impl_->out.overwrite(fixed_bytes, header_text(impl_->header, impl_->frames));
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
    if (version < oldest_recording_version || version > recording_version)
      refuse("version", std::to_string(version) + ", this program reads " + std::to_string(oldest_recording_version) +
                            " to " + std::to_string(recording_version));
    if (length > bytes.size() - fixed_bytes || length > (1u << 20)) refuse("header", "is cut short");
    Recording r;
    std::optional<std::uint64_t> frames;
    try {
      const Json j = Json::parse(bytes.begin() + fixed_bytes, bytes.begin() + fixed_bytes + length);
      RecordingHeader& h = r.header;
      h.case_token = j.at("case").get<std::string>();
      h.haptic_sha256 = j.at("haptic_sha256").get<std::string>();
      h.feel_sha256 = j.value("feel_sha256", "");
      h.device = j.at("device").get<std::string>();
      h.rate_hz = j.at("rate_hz").get<double>();
      if (!(h.rate_hz > 0)) refuse("rate_hz", to_text(h.rate_hz) + ", must be above 0");
      h.felt_shape = j.at("felt_shape").get<std::string>();
      h.knows_across = version == across_version ||
                       (version > across_version && j.at("frame_bytes").get<std::size_t>() == sizeof(ServoFrame));
      if (j.at("frame_bytes").get<std::size_t>() != frame_bytes(h)) refuse("frame_bytes", "are not this version's");
      from_json(j.at("contact"), h.contact);
      h.force.force_law = ForceParams::Law::first;  // as recordings without one were felt
      from_json(j.at("force"), h.force);
      from_json(j.at("shaft"), h.shaft);
      if (j.contains("tool")) from_json(j.at("tool"), h.tool);
      if (j.contains("drilling")) {
        h.drilling.clearance_voxels = 0;  // as recordings without it were felt
        h.drilling.cut_at = DrillingParams::At::device;
        from_json(j.at("drilling"), h.drilling);
        from_json(j.at("law"), h.law);
      }
      if (j.contains("lesson")) {
        h.lesson = j.at("lesson").at("module").get<std::string>();
        h.participant = j.at("lesson").at("participant").get<std::string>();
        h.task = j.at("lesson").value("task", "");
        h.in_open = j.at("lesson").value("in_open", false);
        for (const Json& tool : j.at("lesson").at("tools")) from_json(tool, h.tools.emplace_back());
      }
      h.begins_sha256 = j.value("begins_sha256", "");
      if (j.contains("outcome")) h.outcome = read_outcome(j.at("outcome"));
      if (j.contains("frames")) frames = j.at("frames").get<std::uint64_t>();
    } catch (const Json::parse_error&) {
      refuse("header", "is no JSON");
    } catch (const Json::exception&) {
      refuse("header", "lacks a field, or one is of another kind");
    }
    const std::size_t rest = bytes.size() - fixed_bytes - length;
    const std::size_t each = frame_bytes(r.header), count = rest / each;
    if (rest % each != 0) refuse("frames", "end within one");
    if (frames && *frames != count) refuse("frames", std::to_string(count) + ", were " + std::to_string(*frames));
    r.frames.resize(count);
    for (std::size_t n = 0; n < count; ++n)
      std::memcpy(&r.frames[n], bytes.data() + fixed_bytes + length + n * each, each);
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

std::uint64_t missing_frames(const std::vector<ServoFrame>& frames) {
  return frames.empty() ? 0 : frames.back().tick + 1 - frames.size();
}

std::string feel_digest(const Feels& feels) {
  std::string text;
  const auto add = [&](double v) { text += to_text(v) + " "; };
  for (const ShapeFeel& f : feels) {
    for (const CaseFace* face : {&f.front, &f.back}) {
      const MaterialFaceParams params = face_params(*face);
      for (const Parameter& p : parameters_of<MaterialFaceParams>().parameters) {
        const ParameterValue v = p.get(&params);
        add(p.kind == ParameterKind::flag ? std::get<bool>(v) : std::get<double>(v));
      }
    }
    add(f.drag_n_s_per_mm);
    add(f.shaft_friction_n_per_mm);
  }
  return sha256_of_bytes(text);
}

std::string volume_digest(const HapticVolume& volume) {
  const std::vector<std::int16_t>& v = volume.voxels.voxels;
  return sha256_of_bytes({reinterpret_cast<const char*>(v.data()), v.size() * sizeof v[0]});
}

RecordingHeader::Outcome outcome_of(const HapticVolume& volume, const DrillingOutcome& outcome) {
  RecordingHeader::Outcome o;
  o.volume_sha256 = volume_digest(volume);
  for (const HapticShape& s : volume.shapes)
    if (const std::int64_t units = outcome.units[std::size_t(s.number)]; units > 0)
      o.removed_mm3[s.name] = double(units) / haptic_full * volume.voxels.voxel_volume_mm3();
  o.breached = outcome.breached;
  o.breach_time_s = outcome.breach_time_s;
  o.breach_mm = outcome.breach_mm;
  return o;
}

ForceWindow force_window(const std::vector<ServoFrame>& frames, double settle_s) {
  std::size_t first = 0;
  while (first < frames.size() && frames[first].touched == 0) ++first;
  while (first < frames.size() && settle_s > 0) settle_s -= frames[first++].dt_s;
  return {first, frames.size()};
}

ForceFigures force_figures(const std::vector<ServoFrame>& frames, const ForceWindow& window) {
  ForceFigures f;
  if (window.begin >= window.end || window.end > frames.size()) return f;
  const std::size_t first = window.begin, last = window.end - 1;
  std::vector<double> size, slope;
  double lag = 0;
  for (std::size_t n = first; n <= last; ++n) {
    const ServoFrame& a = frames[n];
    const Vec3 force = vec(a.force_n);
    size.push_back(norm(force));
    f.zero_force_ratio += force == Vec3{};
    f.mean_force_n += size.back();
    f.most_force_n = std::max(f.most_force_n, size.back());
    if (n > first) f.most_step_n = std::max(f.most_step_n, norm(force - vec(frames[n - 1].force_n)));
    if (a.touched == 0) continue;
    ++f.touching;
    const Vec3 behind = vec(a.proxy_mm) - vec(a.tip_mm), normal = vec(a.normal);
    const double along = norm(behind - normal * dot(normal, behind));
    lag += along;
    f.most_lag_mm = std::max(f.most_lag_mm, along);
  }
  f.frames = size.size();
  f.zero_force_ratio /= double(f.frames);
  f.mean_force_n /= double(f.frames);
  f.mean_lag_mm = f.touching > 0 ? lag / double(f.touching) : 0;
  for (std::size_t n = 1; n + 1 < size.size(); ++n)
    slope.push_back((size[n + 1] - size[n - 1]) / (2 * frames[first + n].dt_s));
  if (slope.empty()) return f;
  double mean = 0, square = 0;
  for (const double s : slope) mean += s / double(slope.size());
  for (const double s : slope) square += (s - mean) * (s - mean) / double(slope.size());
  f.sigma_n_per_s = std::sqrt(square);
  const auto out =
      std::count_if(slope.begin(), slope.end(), [&](double s) { return std::abs(s - mean) > 10 * f.sigma_n_per_s; });
  f.anomaly_ratio = double(out) / double(slope.size());
  return f;
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
  f.events = s.events;
  f.faults = s.faults;
}

std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, double rate_hz, Proxy& proxy,
                                      Drilling* drilling) {
  std::vector<ServoFrame> out = recorded;
  for (ServoFrame& f : out) {
    HapticInput in = input_of(f, rate_hz);
    if (drilling) in.extra_n = drilling->force_n();
    if (f.faults & haptic_fault::device_lost) proxy.latch(haptic_fault::device_lost);
    const HapticState& s = proxy.update(in);
    if (drilling) drilling->tick(in, s);
    put_answer(s, f);
  }
  return out;
}

std::vector<ServoFrame> replay_frames(const std::vector<ServoFrame>& recorded, double rate_hz, ToolBelt& belt) {
  std::vector<ServoFrame> out = recorded;
  for (ServoFrame& f : out) {
    const HapticInput in = input_of(f, rate_hz);
    if (f.faults & haptic_fault::device_lost) belt.latch(haptic_fault::device_lost);
    const HapticState& s = belt.update(in);
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

}  // namespace trephine
