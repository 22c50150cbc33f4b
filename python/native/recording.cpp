// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings as arrays, and their replay.
#include "haptics/recording.h"

#include "native/binding.h"
#include "native/frames.h"
#include "session/felt_case.h"

namespace trephine::python {
namespace {

py::tuple read(const std::string& file) {
  haptics::Recording r = run_long([&](const Progress&) { return haptics::read_recording(file); });
  const bool two = r.header.second.has_value();
  return py::make_tuple(json::json_of_value(std::move(r.header)), array_of_frames(std::move(r.frames)),
                        haptics::name_of(r.seal), r.sha256,
                        two ? py::object(array_of_frames(std::move(r.second))) : py::object(py::none()));
}

/// The answers to a recording's poses, and the volume that they leave.
py::tuple replay(const std::string& folder, const std::string& file) {
  std::string digest;
  auto frames = run_long([&](const Progress&) {
    const haptics::Recording r = haptics::read_recording(file);
    haptics::require_seal(r, file);
    session::FeltCase felt = session::felt_again(folder, file, r.header);
    contact::ContactVolume contact(felt.loaded.haptic, r.header.contact);
    session::Rerun rerun(felt, contact, file, r.header);
    std::vector<haptics::ServoFrame> second;  // of the other hand, which the first one's may depend on
    std::vector<haptics::ServoFrame> again = rerun.run(r.frames, r.second.data(), second);
    digest = haptics::volume_digest(felt.loaded.haptic);
    return again;
  });
  return py::make_tuple(array_of_frames(std::move(frames)), digest);
}

}  // namespace

py::array array_of_frames(std::vector<haptics::ServoFrame> frames) {
  auto kept = std::make_unique<std::vector<haptics::ServoFrame>>(std::move(frames));
  const haptics::ServoFrame* data = kept->data();
  const auto size = py::ssize_t(kept->size());
  py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<haptics::ServoFrame>*>(p); });
  kept.release();
  return py::array(py::dtype::of<haptics::ServoFrame>(), {size}, data, owner);
}

py::array array_of_frame(const haptics::ServoFrame& frame) {
  return py::array(py::dtype::of<haptics::ServoFrame>(), std::vector<py::ssize_t>{}, &frame);
}

void bind_recording(py::module_& m) {
  using haptics::ServoFrame;
  PYBIND11_NUMPY_DTYPE(ServoFrame, tick, time_s, dt_s, tip_mm, axis, proxy_mm, normal, force_n, buttons, touched, face,
                       inside, held_by, events, faults, late_us, held_at, held_mm, across);
  m.attr("frame_dtype") = py::dtype::of<ServoFrame>();
  m.attr("event_names") = std::vector<std::string>(haptics::haptic_event::names,
                                                   haptics::haptic_event::names + haptics::haptic_event::count);
  m.attr("fault_names") = std::vector<std::string>(haptics::haptic_fault::names,
                                                   haptics::haptic_fault::names + haptics::haptic_fault::count);
  m.def("read_recording", &read);
  m.def("replay", &replay);
}

}  // namespace trephine::python
