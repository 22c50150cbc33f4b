// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/session.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <future>
#include <mutex>

#include "base/error.h"
#include "base/hash.h"
#include "device/rate_hand.h"
#include "device/witness.h"
#include "haptics/delayed_walls.h"

namespace trephine::session {
namespace {

// A session without a clock would outrun any disk, so its frames are kept until its end, up to this number.
constexpr double max_kept_ticks = 2e7;
constexpr double apart_mm = 30;  // a second hand that is led begins so far to the patient's left of the first

double thread_cpu_s() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

std::unique_ptr<haptics::RecordingWriter> recording_of(const SessionOptions& options,
                                                       const haptics::RecordingHeader& header) {
  return options.record.empty() ? nullptr : std::make_unique<haptics::RecordingWriter>(options.record, header);
}

std::uint64_t ticks_of(const SessionOptions& options) {
  const double ticks = std::max(1.0, std::round(options.seconds * options.servo.rate_hz));
  if (!options.servo.paced && !options.stepped && ticks > max_kept_ticks)
    throw Error(ExitCode::usage, "", "--seconds", "is too long without --paced");
  return std::uint64_t(ticks);
}

std::unique_ptr<device::Device> before_screen(std::unique_ptr<device::Device> device, const SessionOptions& o) {
  if (!o.screen) return device;
  return std::make_unique<device::ScreenDevice>(std::move(device), *o.screen, o.screen_view);
}

std::unique_ptr<device::Device> witnessed(std::unique_ptr<device::Device> device, const SessionOptions& o,
                                          const std::string& case_sha256) {
  if (o.record_server_port <= 0 || o.second) return device;
  return device::with_witness(std::move(device), o.record_server_port, lesson_number(case_sha256, o));
}

// The port with the damping that it is measured against. `flags`: what its flags begin with.
haptics::PortParams port_of(haptics::PortParams port, const device::Device& device, double workspace_scale,
                            const std::string& flags = "--") {
  if (!(port.device_delay_ms > 0)) return port;
  if (port.device_own_damping_n_s_per_mm == 0)
    port.device_own_damping_n_s_per_mm = device.damping_n_s_per_mm();
  else
    port.device_own_damping_n_s_per_mm /= workspace_scale;  // as the tool meets it, which the device reports by itself
  if (port.device_own_damping_n_s_per_mm == 0 && !port.allow_undamped)
    throw Error(ExitCode::usage, "", flags + "device-delay-ms",
                fmt::format("{0:g}, and the device's damping is not known: no wall is stable behind a delay without "
                            "it. Give it with {1}device-own-damping-n-s-per-mm (its maker says it), or start with "
                            "{1}allow-undamped, where a wall yields to a lasting press",
                            port.device_delay_ms, flags));
  return port;
}

}  // namespace

std::uint32_t lesson_number(const std::string& case_sha256, const SessionOptions& o) {
  std::string text = case_sha256 + "\n" + o.rubric_sha256 + "\n" + o.lesson + "\n" + o.participant + "\n" + o.task;
  for (const haptics::AskedQuestion& a : o.asked) {
    text += "\n" + a.question;
    for (const std::string& choice : a.choices) text += " " + choice;
  }
  if (o.second) text += "\nsecond " + (o.second->switch_only ? "" : o.second->tool.name);
  return std::uint32_t(std::stoul(sha256_of_bytes(text).substr(0, 8), nullptr, 16)) | 1;
}

std::function<int(Vec3)> shape_at_of(std::shared_ptr<const Patient> patient) {
  return [patient = std::move(patient)](Vec3 place_mm) { return patient->contact.shape_at(place_mm); };
}

std::uint32_t lasting_second_faults(const SessionResult& result) {
  return result.second ? result.second->faults & ~haptics::haptic_fault::passing : 0;
}

double SessionResult::cpu_us_a_tick() const {
  return statistics.ticks > 0 ? 1e6 * cpu_s / double(statistics.ticks) : 0;
}

Session::Session(const SessionOptions& options, const std::atomic<bool>& stop,
                 const std::function<void(const texts::Note&)>& say, std::shared_ptr<Patient> patient)
    : options_(options),
      stop_(stop),
      patient_(patient ? std::move(patient)
                       : std::make_shared<Patient>(options.case_folder, options.shape, options.contact)),
      device_(witnessed(
          with_board(device::in_workspace(before_screen(made_device(options, say), options), options.workspace),
                     options.board),
          options, patient_->felt.case_sha256)),
      second_device_(made_second(options, say)),
      header_(header_of(options)),
      drilling_(patient_->felt.drilling_of(header_, patient_->contact, &patient_->marks)),
      port_(header_.port, options.force,
            haptics::free_behind(patient_->felt.feels, options.free, header_.port, options.servo.rate_hz)),
      recording_(recording_of(options, header_)),
      ticks_(ticks_of(options)),
      queue_(queue_size()) {
  if (options.second && options.record_server_port > 0) {
    // Both at once: the server answers the first hand when it has heard of both.
    const std::uint32_t lesson = lesson_number(patient_->felt.case_sha256, options);
    // Where one of them is refused the other waits in vain: what failed first is the reason.
    std::mutex mutex;
    std::exception_ptr reason;
    const auto connect = [&](std::unique_ptr<device::Device>& to, int port, const char* flag) {
      try {
        to = device::with_witness(std::move(to), port, lesson, flag);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!reason) reason = std::current_exception();
      }
    };
    std::future<void> second = std::async(std::launch::async, [&] {
      connect(second_device_, options.second->record_server_port, "--record-server-second-port");
    });
    connect(device_, options.record_server_port, "--record-server-port");
    second.get();
    if (reason) std::rethrow_exception(reason);
  }
  haptics::FrameQueue* queue = recording_ || options.watched ? &queue_ : nullptr;
  const haptics::PortParams& port = header_.port;
  const haptics::Feels feels = haptics::feels_behind(patient_->felt.feels, options.free, port, options.servo.rate_hz);
  const double ratio =
      haptics::walls_behind(patient_->felt.feels, options.free, port, options.servo.rate_hz).stiffness_ratio;
  if (ratio < 1)
    say({texts::NoteId::softer_walls,
         {fmt::format("{:.2g}", ratio), fmt::format("{:g}", port.device_delay_ms),
          fmt::format("{:g}", 1e3 * port.device_own_damping_n_s_per_mm)}});
  if (port.device_delay_ms > 0 && !port.bounds_walls()) say(texts::NoteId::undamped_device);
  const touch::FeltSpace space(patient_->contact, patient_->felt.beside(options.shaft));
  if (drilling_ && patient_->felt.meshes)
    for (const auto& [number, name] : patient_->felt.shapes)
      if (touch::is_mesh(number)) say({texts::NoteId::mesh_not_cut, {name}});
  if (header_.tools.empty()) {
    proxy_ =
        std::make_unique<haptics::Proxy>(space, feels, options.force, options.shaft, haptics::make_tool(header_.tool));
    servo_.emplace(*proxy_, *device_, options.servo, queue, drilling_.get());
  } else {
    belt_ =
        std::make_unique<haptics::ToolBelt>(space, feels, options.force, options.shaft, header_.tools, drilling_.get());
    servo_.emplace(*belt_, *device_, options.servo, queue);
  }
  servo_->set_port(&port_);
  if (second_device_) {
    second_ = std::make_unique<SecondHand>(touch::FeltSpace(patient_->contact, patient_->felt.beside({})),
                                           patient_->felt.feels, header_, drilling_.get(), second_device_.get());
    servo_->set_other(second_.get());
  }
  if (options.sound.sound && options.servo.paced && drilling_)
    sound_ = std::make_unique<sound::LiveSound>(options.sound, sound::BurrVoice{header_.drilling.spindle_rpm}, [this] {
      const haptics::Drilling::Heard h = drilling_->heard();
      return sound::DrillHeard{0, h.runs, h.stalled, h.load_ratio, h.energy_j_per_mm3, h.flutes};
    });
}

Session::~Session() {
  if (thread_.joinable()) thread_.join();
}

std::unique_ptr<device::Device> Session::made_device(const SessionOptions& options,
                                                     const std::function<void(const texts::Note&)>& say) {
  const device::DeviceScene scene = scene_of(options, options.workspace, say);
  std::unique_ptr<device::Device> device =
      options.own_device ? options.own_device(scene) : device::make_device(options.device, scene);
  place_error_mm_ = device->place_error_mm();
  return device;
}

std::unique_ptr<device::Device> Session::made_second(const SessionOptions& options,
                                                     const std::function<void(const texts::Note&)>& say) {
  if (!options.second) return nullptr;
  const SecondOptions& o = *options.second;
  device::DeviceScene scene = scene_of(options, o.workspace, say);
  scene.begin->tip_mm += Vec3{apart_mm, 0, 0} / o.workspace.workspace_scale;
  scene.drilled = 0;
  scene.tools.clear();
  return device::in_workspace(o.own_device ? o.own_device(scene) : device::make_device(o.device, scene), o.workspace);
}

device::DeviceScene Session::scene_of(const SessionOptions& options, const device::WorkspaceParams& w,
                                      const std::function<void(const texts::Note&)>& say) {
  device::DeviceScene scene{patient_->contact,
                            haptics::touchable_of(patient_->felt.feels),
                            options.servo.paced,
                            options.servo.realtime,
                            say,
                            Progress({}, &stop_),
                            0,
                            0,
                            {},
                            options.view,
                            options.begin};
  // The workspace moves and scales what a device says: it begins where the tool is to begin.
  device::HandBegin begin = device::begin_of(scene);
  const Mat3 axes = device::workspace_axes(w);
  const Vec3 offset_mm{w.workspace_offset_mm[0], w.workspace_offset_mm[1], w.workspace_offset_mm[2]};
  begin.tip_mm = transpose_times(axes, begin.tip_mm - offset_mm) / w.workspace_scale;
  begin.axis = transpose_times(axes, begin.axis);
  scene.begin = begin;
  const cases::CaseManifest& m = patient_->felt.loaded.manifest;
  scene.case_token = m.case_token;
  scene.case_sha256 = patient_->felt.case_sha256;
  for (const haptics::BeltToolParams& tool : options.tools) scene.tools.push_back(tool.name);
  if (!options.drilling.drill) return scene;
  scene.drilled = haptics::drilled_shapes(m.haptic);
  scene.tool_radius_mm = 0.5 * haptics::own_tool(options.tool).tool_diameter_mm;
  for (const cases::CaseLandmark& l : m.landmarks) scene.sites.emplace_back(l.name, l.position_mm);
  for (const cases::CaseBurrHole& b : m.burr_holes) scene.sites.emplace_back(b.name, b.position_mm);
  return scene;
}

haptics::RecordingHeader Session::header_of(const SessionOptions& options) const {
  haptics::RecordingHeader header = patient_->felt.header();
  header.device = options.device.name;
  header.knows_across = device_->knows_across() || (second_device_ && second_device_->knows_across());
  header.place_error_mm = place_error_mm_;
  header.rate_hz = options.servo.rate_hz;
  header.contact = options.contact;
  header.force = options.force;
  header.port = port_of(options.port, *device_, options.workspace.workspace_scale);
  header.free = options.free;
  header.shaft = options.shaft;
  header.tool = haptics::own_tool(options.tool);
  header.drilling = options.drilling;
  header.law = options.law;
  header.target = options.target;
  header.begins_sha256 = options.begins_sha256;
  if (options.second) {
    const SecondOptions& o = *options.second;
    header.second = haptics::RecordedSecondHand{o.device.name, o.switch_only, o.force, {}, o.tool};
    header.second->port = port_of(o.port, *second_device_, o.workspace.workspace_scale, "--second-");
  }
  if (!options.tools.empty()) {
    set_lesson(header, options.tools, options.lesson, options.participant, patient_->felt.loaded.manifest.haptic);
    header.task = options.task;
    header.rubric_sha256 = options.rubric_sha256;
    header.asked = options.asked;
  }
  return header;
}

std::size_t Session::queue_size() const {
  if (options_.stepped || (!recording_ && !options_.watched)) return 64;
  return options_.servo.paced ? std::size_t(1) << 16 : std::size_t(ticks_) * (options_.second ? 2 : 1);
}

int Session::tool_points() const { return proxy_ && proxy_->tool_body() ? proxy_->tool_body()->count() : 0; }

void Session::run() {
  const double before_s = thread_cpu_s();
  servo_->run(ticks_, stop_);
  cpu_s_ = thread_cpu_s() - before_s;
  done_ = true;
}

const haptics::RealtimeGrant& Session::start() {
  std::promise<haptics::RealtimeGrant> promise;
  std::future<haptics::RealtimeGrant> granted = promise.get_future();
  const bool realtime = options_.servo.paced && options_.servo.realtime;
  thread_ = std::thread([this, realtime, promise = std::move(promise)]() mutable {
    promise.set_value(realtime ? haptics::claim_realtime() : haptics::RealtimeGrant{});
    run();
  });
  grant_ = granted.get();
  return grant_;
}

const haptics::ServoFrame& Session::step() {
  servo_->tick(1 / options_.servo.rate_hz, 0);
  drain();
  return frames_.back();
}

void Session::drain() {
  frames_.clear();
  second_frames_.clear();
  session::drain(queue_, second_ != nullptr, frames_, second_frames_);
  if (recording_) recording_->add(frames_, second_frames_);
}

const std::vector<haptics::ServoFrame>& Session::take_frames() {
  drain();
  return frames_;
}

void Session::write_frames() {
  if (recording_ && options_.servo.paced) drain();
}

SessionResult Session::finish() {
  if (thread_.joinable()) thread_.join();
  sound_.reset();
  SessionResult result;
  result.header = header_;
  result.grant = grant_;
  result.statistics = servo_->statistics();
  result.device_counts = device_->counts();
  result.frames_lost = queue_.dropped();
  result.cpu_s = cpu_s_;
  result.shapes = patient_->felt.shapes;
  result.jumps = port_.jumps();
  result.gaps = port_.gaps();
  if (second_)
    result.second = SessionResult::Second{second_device_->counts(), second_->jumps(),        second_->gaps(),
                                          second_->touching(),      second_->most_force_n(), second_->faults()};
  if (drilling_) {
    result.drilled = drilling_->outcome();
    result.outcome = haptics::outcome_of(patient_->felt.loaded.haptic, drilling_->outcome());
  }
  if (recording_ || options_.watched) drain();
  if (recording_) recording_->finish(result.outcome);
  return result;
}

}  // namespace trephine::session
