// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/felt_case.h"

#include <algorithm>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "cases/load_hashed.h"
#include "haptics/delayed_walls.h"
#include "session/second_hand.h"

namespace trephine::session {

FeltCase::FeltCase(const std::filesystem::path& folder, const std::string& shape, cases::LoadParts parts)
    : felt_shape(shape) {
  cases::HashedCase read = cases::load_hashed_case(folder, parts);
  loaded = std::move(read.loaded);
  case_sha256 = std::move(read.sha256);
  feels = haptics::feels_of(loaded.manifest.haptic);
  if (!loaded.has_haptic())
    throw Error(ExitCode::bad_input, folder.string(), "haptic", "the case has no haptic volume");
  for (const cases::CaseShape& s : loaded.manifest.haptic.shapes) shapes[s.number] = s.name;
  feel_beside();
  if (shape.empty()) return;
  int only = 0;
  for (const auto& [number, name] : shapes)
    if (name == shape && only == 0) only = number;
  if (only == 0)
    throw Error(ExitCode::usage, "", "--shape",
                "the case has none of that name, but " + joined(shapes, ", ", [](const auto& s) { return s.second; }));
  for (std::size_t n = 1; n < feels.size(); ++n)
    if (int(n) != only) {
      haptics::ShapeFeel& f = feels[n];
      f = {};
      f.front.touchable = f.back.touchable = false;
    }
}

// The surfaces that are touched as meshes, in the case's order, and the ramps of a raw CT.
void FeltCase::feel_beside() {
  constexpr double skin_ratio = 0.00025;  // of a voxel's side: a quarter of the distance that tools keep from surfaces
  const cases::CaseManifest& m = loaded.manifest;
  std::vector<touch::MeshSurfaces::Part> parts;
  for (std::size_t n = 0; n < m.anatomies.size() && n < loaded.surfaces.size(); ++n) {
    const cases::CaseAnatomy& a = m.anatomies[n];
    if (!a.touched_as || loaded.surfaces[n].triangles.empty()) continue;
    const int number = touch::first_mesh_shape + int(parts.size());
    parts.push_back({loaded.surfaces[n], number});
    haptics::ShapeFeel& feel = feels[std::size_t(number)];
    feel = *a.touched_as;
    feel.back = feel.front;
    shapes[number] = a.name;
  }
  const Vec3 s = loaded.haptic.voxels.spacing_mm;
  if (!parts.empty()) meshes = std::make_shared<touch::MeshSurfaces>(parts, skin_ratio * std::min({s.x, s.y, s.z}));
  if (touch::StiffnessRamps all(m.haptic); all.any()) ramps = std::make_shared<touch::StiffnessRamps>(std::move(all));
}

touch::Beside FeltCase::beside(const haptics::ShaftParams& shaft) const {
  touch::Beside all{meshes.get(), ramps.get()};
  if (shaft.line_lock_in.empty()) {
    if (shaft.shaft_rigidity_n_mm2 > 0)
      throw Error(ExitCode::usage, "", "--shaft-rigidity-n-mm2",
                  "a shaft bends where --line-lock-in holds it on a line, and that is not given");
    return all;
  }
  for (const std::string& name : split_at(shaft.line_lock_in, ',')) {
    const std::uint64_t before = all.line_lock;
    for (const cases::CaseShape& s : loaded.manifest.haptic.shapes)
      if (s.name == name) all.line_lock |= std::uint64_t{1} << s.number;
    if (all.line_lock == before)
      throw Error(ExitCode::usage, "", "--line-lock-in",
                  name + ": is none of the case's shapes (" +
                      joined(loaded.manifest.haptic.shapes, ", ", &cases::CaseShape::name) + "), or comes twice");
  }
  return all;
}

std::unique_ptr<haptics::Drilling> FeltCase::drilling_of(const haptics::RecordingHeader& header,
                                                         contact::ContactVolume& contact, drill::DirtyBricks* marks) {
  if (!header.drilling.drill) return nullptr;
  std::vector<haptics::ToolParams> tools;
  for (const haptics::BeltToolParams& t : header.tools)
    if (t.cuts) tools.push_back(t);
  if (tools.empty()) tools.push_back(header.tool);
  drill::DrillShapes shapes = haptics::drill_shapes_of(loaded.manifest.haptic);
  if (haptics::tool_kind(tools.front().tool).cut == haptics::ToolKind::Cut::incision)
    for (drill::DrillShape& s : shapes) s.cuttable = s.cuttable && !(s.energy_j_per_mm3 > 0);
  std::vector<haptics::Burr> burrs;
  for (const haptics::ToolParams& t : tools)
    burrs.push_back({haptics::cutter_of(header.drilling, haptics::own_tool(t)), haptics::tool_kind(t.tool).flutes});
  return std::make_unique<haptics::Drilling>(loaded.haptic, contact, shapes, header.drilling, header.law,
                                             std::move(burrs), marks);
}

haptics::RecordingHeader FeltCase::header() const {
  haptics::RecordingHeader h;
  h.case_token = loaded.manifest.case_token;
  h.case_sha256 = case_sha256;
  h.feel_sha256 = haptics::feel_digest(feels);
  h.felt_shape = felt_shape;
  return h;
}

void set_lesson(haptics::RecordingHeader& h, const std::vector<haptics::BeltToolParams>& tools,
                const std::string& module, const std::string& participant, const cases::CaseHaptic& haptic) {
  h.tools = tools;
  bool cuts = false;
  for (const haptics::BeltToolParams& t : tools) cuts = cuts || t.cuts;
  h.drilling.drill = cuts && haptics::drilled_shapes(haptic) != 0;
  h.tool = h.tools.front();
  h.lesson = module;
  h.participant = participant;
}

Rerun::Rerun(FeltCase& felt, contact::ContactVolume& contact, const std::string& file,
             const haptics::RecordingHeader& h, drill::DirtyBricks* marks)
    : rate_hz_(h.rate_hz),
      port_(h.port, h.force, haptics::free_behind(felt.feels, h.free, h.port, h.rate_hz)),
      drilling_(felt.drilling_of(h, contact, marks)) {
  const haptics::Feels feels = haptics::feels_behind(felt.feels, h.free, h.port, h.rate_hz);
  const touch::FeltSpace space(contact, felt.beside(h.shaft));
  if (h.tools.empty())
    proxy_ = std::make_unique<haptics::Proxy>(space, feels, h.force, h.shaft, tool_again(file, h.tool));
  else
    belt_ = with_file(file, [&] {
      return std::make_unique<haptics::ToolBelt>(space, feels, h.force, h.shaft, h.tools, drilling_.get());
    });
  if (h.second)
    second_ = with_file(file, [&] {
      return std::make_unique<SecondHand>(touch::FeltSpace(contact, felt.beside({})), felt.feels, h, drilling_.get());
    });
}
Rerun::~Rerun() = default;

std::vector<haptics::ServoFrame> Rerun::run(const std::vector<haptics::ServoFrame>& recorded) {
  return belt_ ? haptics::replay_frames(recorded, rate_hz_, *belt_, &port_)
               : haptics::replay_frames(recorded, rate_hz_, *proxy_, drilling_.get(), &port_);
}

std::vector<haptics::ServoFrame> Rerun::run(const std::vector<haptics::ServoFrame>& recorded,
                                            const haptics::ServoFrame* second,
                                            std::vector<haptics::ServoFrame>& answered) {
  if (!second_) return run(recorded);
  std::vector<haptics::ServoFrame> out;
  out.reserve(recorded.size());
  for (const haptics::ServoFrame& f : recorded) {
    out.push_back(run({f}).front());
    answered.push_back(second_->again(*second++, belt_.get()));
  }
  return out;
}

void Rerun::follow(const haptics::ServoFrame& recorded, const haptics::ServoFrame* second) {
  belt_->follow(haptics::input_of(recorded, rate_hz_), haptics::state_of(recorded));
  if (second_) second_->follow(*second, belt_.get());
}

const haptics::ToolBelt* Rerun::second_belt() const { return second_ ? second_->belt() : nullptr; }

FeltCase felt_again(const std::filesystem::path& folder, const std::string& file, const haptics::RecordingHeader& h,
                    cases::LoadParts parts, bool after_others) {
  const auto refuse = [&](const char* field, const std::string& what) {
    throw Error(ExitCode::bad_input, file, field, what);
  };
  if (!h.begins_sha256.empty() && !after_others)
    refuse("begins_sha256", "it began with what an earlier session had cut: give that session's recording as well");
  try {
    FeltCase felt(folder, h.felt_shape, parts);
    const haptics::RecordingHeader now = felt.header();
    if (now.case_sha256 != h.case_sha256)
      refuse("case_sha256", "the recording is of another case.json (case " + h.case_token +
                                "): take the case as it was when this was recorded");
    if (now.feel_sha256 != h.feel_sha256) refuse("feel_sha256", "the case's materials are not those of the recording");
    return felt;
  } catch (const Error& e) {
    if (e.code() == ExitCode::usage) refuse("felt_shape", h.felt_shape + ", which the case does not have");
    throw;
  }
}

haptics::Tool tool_again(const std::string& file, const haptics::ToolParams& params) {
  try {
    return haptics::make_tool(params);
  } catch (const Error& e) {
    throw Error(ExitCode::bad_input, file, e.field(), e.what());
  }
}

}  // namespace trephine::session
