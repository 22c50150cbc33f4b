// SPDX-License-Identifier: GPL-3.0-or-later
// Contact and drilling: a hand in a case, moved from Python.
#include <cmath>
#include <limits>

#include "base/error.h"
#include "native/binding.h"
#include "native/frames.h"
#include "native/hand.h"

namespace trephine::python {
namespace {

using device::DeviceReading;

constexpr std::size_t few_ticks = 1000;  // that nobody need interrupt

void require_direction(Vec3 v, const char* name) {
  if (std::abs(norm(v) - 1) > 1e-6)
    refuse(std::string(name) + " must have length 1, it has " + to_text(ParameterValue(norm(v))));
}

DeviceReading pose_from(const Hand& hand, const py::object& tip, const py::object& axis, std::uint32_t buttons,
                        const py::object& across) {
  DeviceReading pose;
  pose.tip_mm = vec3_from(tip, "tip_mm");
  pose.axis = vec3_from(axis, "axis");
  require_direction(pose.axis, "axis");
  pose.buttons = buttons;
  if (across.is_none() == hand.knows_across())
    refuse(across.is_none() ? "across is missing: the session was made with knows_across"
                            : "across is not used: make the session with knows_across=True");
  if (!across.is_none()) {
    pose.across = vec3_from(across, "across");
    require_direction(pose.across, "across");
  }
  return pose;
}

// One value for every row, or as many as there are.
std::vector<Vec3> directions_from(const py::object& value, std::size_t rows, const char* name) {
  std::vector<Vec3> all;
  if (py::isinstance<py::array>(value) && py::reinterpret_borrow<py::array>(value).ndim() == 2) {
    all = points_from(value, name);
    if (all.size() != rows)
      refuse(std::string(name) + " has " + std::to_string(all.size()) + " rows, tip_mm has " + std::to_string(rows));
  } else {
    all.assign(rows, vec3_from(value, name));
  }
  for (const Vec3& v : all) require_direction(v, name);
  return all;
}

// A whole number from 0, of Python or numpy. Arrays come here too, and are refused as any other thing.
std::uint32_t buttons_from(const py::object& value) {
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  const std::int64_t bits = whole ? PyLong_AsLongLong(whole.ptr()) : -1;
  if (PyErr_Occurred()) PyErr_Clear();
  if (bits < 0 || bits > std::numeric_limits<std::uint32_t>::max())
    refuse("buttons must be a whole number from 0 to 4294967295");
  return std::uint32_t(bits);
}

// One value for every row, or as many as there are.
std::vector<std::uint32_t> buttons_from(const py::object& value, std::size_t rows) {
  if (!PySequence_Check(value.ptr())) return std::vector<std::uint32_t>(rows, buttons_from(value));
  const auto given = py::array::ensure(value);
  if (!given) PyErr_Clear();
  if (given && given.ndim() == 0) return std::vector<std::uint32_t>(rows, buttons_from(value));
  if (!given || (given.dtype().kind() != 'i' && given.dtype().kind() != 'u') || given.ndim() != 1 ||
      std::size_t(given.shape(0)) != rows)
    refuse("buttons must be a whole number, or an array of them with one for each row of tip_mm");
  // What is beyond int64 becomes negative.
  const auto a = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(given);
  std::vector<std::uint32_t> buttons(rows);
  for (std::size_t n = 0; n < rows; ++n) {
    const std::int64_t bits = a.data()[n];
    if (bits < 0 || bits > std::numeric_limits<std::uint32_t>::max())
      refuse("buttons: row " + std::to_string(n) + " is not from 0 to 4294967295");
    buttons[n] = std::uint32_t(bits);
  }
  return buttons;
}

py::array run(Hand& hand, const py::object& tip, const py::object& axis, const py::object& buttons,
              const py::object& across) {
  const std::vector<Vec3> tips = points_from(tip, "tip_mm");
  const std::vector<Vec3> axes = directions_from(axis, tips.size(), "axis");
  const std::vector<std::uint32_t> pressed = buttons_from(buttons, tips.size());
  if (across.is_none() == hand.knows_across())
    pose_from(hand, py::cast(std::vector<double>{0, 0, 0}), py::cast(std::vector<double>{0, 0, 1}), 0, across);
  const std::vector<Vec3> turned =
      across.is_none() ? std::vector<Vec3>(tips.size()) : directions_from(across, tips.size(), "across");
  std::vector<DeviceReading> poses(tips.size());
  for (std::size_t n = 0; n < poses.size(); ++n) {
    poses[n].tip_mm = tips[n];
    poses[n].axis = axes[n];
    poses[n].buttons = pressed[n];
    poses[n].across = turned[n];
  }
  if (poses.size() > few_ticks) return array_of_frames(run_long([&](const Progress& p) { return hand.run(poses, p); }));
  std::vector<haptics::ServoFrame> frames;
  {
    const py::gil_scoped_release unlocked;
    frames = hand.run(poses, {});
  }
  return array_of_frames(std::move(frames));
}

/// The raw voxels about a place, `size` along each axis of the volume; beyond it, what is read there.
py::array patch(Hand& hand, const py::object& place, int size) {
  if (size < 1 || size > 256) refuse("size must be from 1 to 256");
  const auto lock = hand.alone();
  const voxel::HapticVolume& volume = hand.loaded().haptic;
  const grid::Grid<std::int16_t>& voxels = volume.voxels;
  const std::int16_t outside =
      volume.encoding == voxel::HapticEncoding::hu ? std::int16_t(voxel::haptic_beyond_hu) : voxel::haptic_empty;
  const Vec3 at = voxels.to_index(vec3_from(place, "place_mm"));
  int begin[3];
  for (int a = 0; a < 3; ++a) begin[a] = int(std::lround(std::clamp(at[a], -1e6, 1e6))) - size / 2;
  py::array_t<std::int16_t> out({size, size, size});
  std::int16_t* o = out.mutable_data();
  for (int k = begin[2]; k < begin[2] + size; ++k)
    for (int j = begin[1]; j < begin[1] + size; ++j)
      for (int i = begin[0]; i < begin[0] + size; ++i) *o++ = voxels.contains(i, j, k) ? voxels.at(i, j, k) : outside;
  return std::move(out);
}

py::dict removed_mm3(Hand& hand) {
  py::dict out;
  const voxel::HapticVolume& volume = hand.loaded().haptic;
  for (const voxel::HapticShape& s : volume.shapes)
    out[py::str(s.name)] = double(hand.removed_units(s.number)) / voxel::haptic_full * volume.voxels.voxel_volume_mm3();
  return out;
}

py::object first_hit(Hand& hand, const py::object& start, const py::object& end) {
  const Vec3 start_mm = vec3_from(start, "start_mm"), end_mm = vec3_from(end, "end_mm");
  const auto lock = hand.alone();
  const contact::Contact c =
      hand.patient().contact.intersect(start_mm, end_mm, haptics::touchable_of(hand.patient().felt.feels));
  if (c.refused) refuse("start_mm and end_mm must lie within 1e9 mm");
  if (!c.hit) return py::none();
  return py::make_tuple(array_of(c.point_mm), array_of(c.normal), c.shape);
}

py::object finish(Hand& hand) {
  const auto result = hand.finish();
  if (!result) return py::none();
  return result->outcome ? py::cast(json::json_of_value(*result->outcome)) : py::cast("{}");
}

py::dict shapes_of(const Hand& hand) {
  py::dict out;
  for (const voxel::HapticShape& s : hand.loaded().haptic.shapes) out[py::int_(s.number)] = s.name;
  return out;
}

}  // namespace

void bind_session(py::module_& m) {
  py::class_<Hand>(m, "Hand")
      .def(py::init([](const std::string& folder, const std::string& params_json, const std::string& record) {
        const auto params = params_of<HandParams>(params_json);
        return run_long([&](const Progress&) { return std::make_unique<Hand>(folder, params, record); });
      }))
      .def("reset",
           [](Hand& hand, const std::string& record) { run_long([&](const Progress&) { hand.reset(record); }); })
      .def("step",
           [](Hand& hand, const py::object& tip, const py::object& axis, const py::object& buttons,
              const py::object& across) {
             return array_of_frame(hand.step(pose_from(hand, tip, axis, buttons_from(buttons), across)));
           })
      .def("run", &run)
      .def("finish", &finish)
      .def("drop", [](Hand& hand) { hand.drop(); })
      .def("first_hit", &first_hit)
      .def("patch", &patch)
      .def("shape_at",
           [](Hand& hand, const py::object& place) {
             const Vec3 place_mm = vec3_from(place, "place_mm");
             const auto lock = hand.alone();
             return hand.patient().contact.shape_at(place_mm);
           })
      .def_property_readonly("header",
                             [](Hand& hand) {
                               const auto lock = hand.alone();
                               return json::json_of_value(hand.header());
                             })
      .def_property_readonly("shapes", &shapes_of)
      .def_property_readonly("torque_n_mm", [](Hand& hand) { return array_of(hand.torque_n_mm()); })
      .def_property_readonly("removed_mm3", &removed_mm3)
      .def_property_readonly("voxels", [](const py::object& self) {
        const auto& voxels = self.cast<const Hand&>().loaded().haptic.voxels;
        return py::make_tuple(view_of_voxels(voxels, self), place_of(voxels));
      });
}

}  // namespace trephine::python
