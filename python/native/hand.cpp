// SPDX-License-Identifier: GPL-3.0-or-later
#include "native/hand.h"

#include <algorithm>
#include <stdexcept>

#include "base/error.h"
#include "lesson/approval.h"
#include "lessons/lesson_type.h"

namespace trephine::python {
namespace {

void require_lesson(bool given, const char* field) {
  if (given)
    throw Error(ExitCode::usage, "", field, "is of a lesson, and none is given: give lesson as well, or leave it");
}

}  // namespace

std::unique_lock<std::mutex> Hand::alone() {
  std::unique_lock<std::mutex> lock(used_, std::try_to_lock);
  if (!lock) throw std::runtime_error("another thread uses this session");
  return lock;
}

session::SessionOptions Hand::options_of(const HandParams& p) const {
  session::SessionOptions o;
  o.shape = p.shape;
  o.device.name = "python";
  o.begin = device::HandBegin{};  // else a place over the case is looked for
  o.servo.rate_hz = p.rate_hz;
  o.servo.paced = o.servo.realtime = false;
  o.watched = o.stepped = true;
  o.contact = p.contact;
  o.force = p.force;
  o.port = p.port;
  o.free = p.free;
  o.tool = p.tool;
  o.shaft = p.shaft;
  o.drilling = p.drilling;
  o.law = p.law;
  if (p.lesson.empty()) {
    require_lesson(p.participant != HandParams().participant, "participant");
    require_lesson(!p.task.empty(), "task");
    return o;
  }
  lesson::validate_token(p.participant, "participant");
  if (p.tool.tool != haptics::ToolParams().tool || p.drilling.drill)
    throw Error(ExitCode::bad_input, "", p.drilling.drill ? "drill" : "tool",
                "is the lesson's own: give one of the two");
  const lessons::LessonType& type = lessons::lesson_type(p.lesson);
  const cases::CaseManifest& manifest = patient_->felt.loaded.manifest;
  type.require(manifest);
  o.tools = type.tools();
  o.lesson = p.lesson;
  o.participant = p.participant;
  if (!p.task.empty())
    o.task = lessons::task_of(type, manifest, p.task).name;
  else if (const auto offered = lessons::offered_tasks(type, manifest); !offered.empty())
    o.task = offered.front().name;
  return o;
}

Hand::Hand(const std::string& folder, const HandParams& params, const std::string& record)
    : patient_(std::make_shared<session::Patient>(folder, params.shape, params.contact)),
      options_(options_of(params)),
      knows_across_(params.knows_across) {
  options_.case_folder = folder;
  options_.own_device = [this, knows = params.knows_across](const device::DeviceScene&) {
    auto made = std::make_unique<PlacedDevice>(knows);
    device_ = made.get();
    return made;
  };
  begin(record);
  if (session_->drilling()) uncut_ = patient_->felt.loaded.haptic.voxels.voxels;
}

void Hand::begin(const std::string& record) {
  options_.record = record;
  session_ = std::make_unique<session::Session>(
      options_, stop_, [](const texts::Note&) {}, patient_);
  header_ = session_->header();
}

void Hand::reset(const std::string& record) {
  const auto lock = alone();
  end();
  removed_units_.clear();
  // In place, for arrays are views of the voxels.
  if (!uncut_.empty()) {
    grid::Grid<std::int16_t>& voxels = patient_->felt.loaded.haptic.voxels;
    const grid::Box all = grid::whole_box(voxels);
    patient_->contact.loosen(all);
    std::copy(uncut_.begin(), uncut_.end(), voxels.voxels.begin());
    patient_->contact.loosen(all);
    patient_->contact.settle(all);
  }
  begin(record);
}

session::Session& Hand::session() {
  if (!session_) throw std::runtime_error("the session has ended: call reset()");
  return *session_;
}

haptics::ServoFrame Hand::step(const device::DeviceReading& pose) {
  const auto lock = alone();
  session::Session& s = session();
  device_->now = pose;
  return s.step();
}

std::vector<haptics::ServoFrame> Hand::run(const std::vector<device::DeviceReading>& poses, const Progress& progress) {
  const auto lock = alone();
  session::Session& s = session();
  std::vector<haptics::ServoFrame> frames;
  frames.reserve(poses.size());
  for (const device::DeviceReading& pose : poses) {
    if (frames.size() % 256 == 0) progress.check();
    device_->now = pose;
    frames.push_back(s.step());
  }
  return frames;
}

Vec3 Hand::torque_n_mm() {
  const auto lock = alone();
  return session_ ? device_->torque_n_mm : Vec3{};
}

std::int64_t Hand::removed_units(int shape) {
  const auto lock = alone();
  if (session_) return session_->drilling() ? session_->drilling()->removed_units(shape) : 0;
  const auto kept = removed_units_.find(shape);
  return kept != removed_units_.end() ? kept->second : 0;
}

std::unique_ptr<session::Session> Hand::end() {
  device_ = nullptr;
  if (session_ && session_->drilling())
    for (const voxel::HapticShape& s : loaded().haptic.shapes)
      removed_units_[s.number] = session_->drilling()->removed_units(s.number);
  return std::move(session_);
}

void Hand::drop() {
  const auto lock = alone();
  end();
}

std::optional<session::SessionResult> Hand::finish() {
  const auto lock = alone();
  const auto ended = end();
  if (!ended) return {};
  return ended->finish();
}

}  // namespace trephine::python
