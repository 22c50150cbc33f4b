// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/felt_case.h"

#include "base/error.h"

namespace trephine {

FeltCase::FeltCase(const std::filesystem::path& folder, const std::string& shape, LoadParts parts)
    : loaded(load_case(folder, parts)), feels(feels_of(loaded.manifest.haptic)), felt_shape(shape) {
  if (!loaded.has_haptic())
    throw Error(ExitCode::bad_input, folder.string(), "haptic", "the case has no haptic volume");
  if (shape.empty()) return;
  const HapticShape* only = loaded.haptic.find_shape(shape);
  if (!only) {
    std::string names;
    for (const HapticShape& s : loaded.haptic.shapes) names += (names.empty() ? "" : ", ") + s.name;
    throw Error(ExitCode::usage, "", "--shape", "the case has none of that name, but " + names);
  }
  for (int n = 1; n <= haptic_max_shapes; ++n)
    if (n != only->number) {
      ShapeFeel& f = feels[std::size_t(n)];
      f = {};
      f.front.touchable = f.back.touchable = false;
    }
}

std::unique_ptr<Drilling> FeltCase::drilling_of(const RecordingHeader& header, ContactVolume& contact,
                                                DirtyBricks* marks) {
  if (!header.drilling.drill) return nullptr;
  ToolParams tool = header.tool;
  for (const BeltToolParams& t : header.tools)
    if (t.cuts) tool = whole_tool(t);
  DrillShapes shapes = drill_shapes_of(loaded.manifest.haptic);
  if (tool_kind(tool.tool).cut == ToolKind::Cut::incision)
    for (DrillShape& s : shapes) s.cuttable = s.cuttable && !(s.energy_j_per_mm3 > 0);
  return std::make_unique<Drilling>(loaded.haptic, contact, shapes, header.drilling, header.law,
                                    cutter_of(header.drilling, own_tool(tool)), marks);
}

ToolParams FeltCase::felt_tool_of(const RecordingHeader& header) const {
  return felt_tool(header.drilling, header.tool, loaded.haptic.voxels.spacing_mm);
}

RecordingHeader FeltCase::header() const {
  RecordingHeader h;
  h.case_token = loaded.manifest.case_token;
  const CaseFile* file = loaded.manifest.find_file(loaded.manifest.haptic.file);
  h.haptic_sha256 = file ? file->sha256 : "";
  h.feel_sha256 = feel_digest(feels);
  h.felt_shape = felt_shape;
  return h;
}

void set_lesson(RecordingHeader& h, const std::vector<BeltToolParams>& tools, const std::string& module,
                const std::string& participant, const CaseHaptic& haptic) {
  h.tools = tools;
  bool cuts = false;
  for (const BeltToolParams& t : tools) cuts = cuts || t.cuts;
  h.drilling.drill = cuts && drilled_shapes(haptic) != 0;
  for (BeltToolParams& t : h.tools) {
    if (!t.cuts) continue;
    const ToolParams whole = whole_tool(t);
    t.tool_diameter_mm = felt_tool(h.drilling, whole, haptic.spacing_mm).tool_diameter_mm;
    t.cuts_wider_mm = whole.tool_diameter_mm - t.tool_diameter_mm;
  }
  h.tool = h.tools.front();
  h.lesson = module;
  h.participant = participant;
  h.in_open = true;
}

Rerun::Rerun(FeltCase& felt, ContactVolume& contact, const std::string& file, const RecordingHeader& h,
             DirtyBricks* marks)
    : rate_hz_(h.rate_hz), drilling_(felt.drilling_of(h, contact, marks)) {
  if (h.tools.empty())
    proxy_ = std::make_unique<Proxy>(contact, felt.feels, h.force, h.shaft, tool_again(file, felt.felt_tool_of(h)));
  else
    belt_ = with_file(file, [&] {
      return std::make_unique<ToolBelt>(contact, felt.feels, h.force, h.shaft, h.tools, drilling_.get(), h.in_open);
    });
}

std::vector<ServoFrame> Rerun::run(const std::vector<ServoFrame>& recorded) {
  return belt_ ? replay_frames(recorded, rate_hz_, *belt_)
               : replay_frames(recorded, rate_hz_, *proxy_, drilling_.get());
}

FeltCase felt_again(const std::filesystem::path& folder, const std::string& file, const RecordingHeader& h,
                    LoadParts parts, bool after_others) {
  const auto refuse = [&](const char* field, const std::string& what) {
    throw Error(ExitCode::bad_input, file, field, what);
  };
  if (!h.begins_sha256.empty() && !after_others)
    refuse("begins_sha256", "it began with what an earlier session had cut: give that session's recording as well");
  try {
    FeltCase felt(folder, h.felt_shape, parts);
    const RecordingHeader now = felt.header();
    if (now.haptic_sha256 != h.haptic_sha256)
      refuse("haptic_sha256", "the recording is of another haptic volume (case " + h.case_token + ")");
    if (!h.feel_sha256.empty() && now.feel_sha256 != h.feel_sha256)
      refuse("feel_sha256", "the case's materials are not those of the recording");
    return felt;
  } catch (const Error& e) {
    if (e.code() == ExitCode::usage) refuse("felt_shape", h.felt_shape + ", which the case does not have");
    throw;
  }
}

Tool tool_again(const std::string& file, const ToolParams& params) {
  try {
    return make_tool(params);
  } catch (const Error& e) {
    throw Error(ExitCode::bad_input, file, e.field(), e.what());
  }
}

}  // namespace trephine
