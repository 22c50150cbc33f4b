// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/data_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"
#include "grid/bounded_read.h"
#include "json/declared_json.h"
#include "meshio/vtp.h"
#include "pacs/label_objects.h"
#include "voxel/haptic_file.h"

namespace trephine::stages {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ParameterValue& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

struct WarningList {
  Warnings list;
  template <class V>
  static void describe(V& v) {
    v.list(&WarningList::list, "list", "What a person should know.");
  }
};

constexpr std::uint64_t max_cutters_bytes = 64 << 20;

voxel::HapticVolume foreign_haptic(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    grid::BoundedGrid nrrd = grid::read_nrrd_bounded(file, grid::labels_limit);
    return voxel::haptic_of(std::move(nrrd.grid), nrrd.keys);
  });
}

}  // namespace

double bytes_in_memory(const StageData& data) {
  const auto voxel_bytes = [](const auto& grid) { return double(grid.voxels.size()) * sizeof(grid.voxels[0]); };
  if (const auto* v = std::get_if<std::shared_ptr<const grid::HuVolume>>(&data)) return std::visit(voxel_bytes, **v);
  if (const auto* f = std::get_if<std::shared_ptr<const grid::Field>>(&data)) return voxel_bytes(**f);
  if (const auto* m = std::get_if<std::shared_ptr<const surface::TriMesh>>(&data))
    return double((*m)->points_mm.size()) * sizeof(Vec3) * 2 + double((*m)->triangles.size()) * 12;
  if (const auto* h = std::get_if<std::shared_ptr<const voxel::HapticVolume>>(&data)) return voxel_bytes((*h)->voxels);
  return 0;
}

DataKind kind_of(const StageData& data) {
  constexpr DataKind kinds[] = {DataKind::nothing, DataKind::volume,  DataKind::field,     DataKind::mesh,
                                DataKind::haptic,  DataKind::cutters, DataKind::landmarks, DataKind::labels};
  return kinds[data.index()];
}

const char* file_extension(DataKind kind) {
  switch (kind) {
    case DataKind::mesh:
      return ".vtp";
    case DataKind::cutters:
    case DataKind::landmarks:
    case DataKind::nothing:
      return ".json";
    default:
      return ".nrrd";
  }
}

void save_data(const std::filesystem::path& file, const StageData& data) {
  const char* extension = file_extension(kind_of(data));
  if (file.extension() != extension)
    throw Error(ExitCode::usage, file.string(), "output", std::string("must end in ") + extension);
  if (const auto* volume = std::get_if<std::shared_ptr<const grid::HuVolume>>(&data))
    grid::write_nrrd(file, **volume, {{"content", "HU"}});
  else if (const auto* field = std::get_if<std::shared_ptr<const grid::Field>>(&data))
    grid::write_nrrd(file, **field, {{"content", "field"}});
  else if (const auto* mesh = std::get_if<std::shared_ptr<const surface::TriMesh>>(&data))
    meshio::write_vtp(file, **mesh);
  else if (const auto* haptic = std::get_if<std::shared_ptr<const voxel::HapticVolume>>(&data))
    voxel::write_haptic(file, **haptic);
  else if (const auto* cutters = std::get_if<std::shared_ptr<const std::vector<boolean::Cutter>>>(&data))
    write_file(file, boolean::cutters_json(**cutters));
  else if (const auto* landmarks = std::get_if<std::shared_ptr<const head::HeadLandmarks>>(&data))
    write_file(file, head::landmarks_json(**landmarks));
  else if (const auto* labels = std::get_if<std::shared_ptr<const grid::LabelFile>>(&data))
    write_file(file, grid::encode_labels(**labels));
}

StageData load_data(const std::filesystem::path& file, DataKind kind, DataOf whose) {
  const bool foreign = whose == DataOf::stranger;
  switch (kind) {
    case DataKind::volume:
      return std::make_shared<const grid::HuVolume>(foreign ? grid::read_foreign_hu(file) : grid::read_hu_nrrd(file));
    case DataKind::field:
      return std::make_shared<const grid::Field>(foreign ? grid::read_foreign_field(file)
                                                         : grid::read_field_nrrd(file));
    case DataKind::mesh:
      return std::make_shared<const surface::TriMesh>(meshio::read_vtp(file));
    case DataKind::haptic:
      return std::make_shared<const voxel::HapticVolume>(foreign ? foreign_haptic(file) : voxel::read_haptic(file));
    case DataKind::cutters: {
      const std::vector<char> bytes = read_file(file, max_cutters_bytes);
      return std::make_shared<const std::vector<boolean::Cutter>>(with_file(
          file.string(), [&] { return boolean::parse_cutters_json(std::string(bytes.begin(), bytes.end())); }));
    }
    case DataKind::landmarks:
      return std::make_shared<const head::HeadLandmarks>(head::read_head_landmarks(file));
    case DataKind::labels:
      return std::make_shared<const grid::LabelFile>(pacs::read_label_file(file));
    case DataKind::nothing:
      break;
  }
  return {};
}

StageData load_field_or_volume(const std::filesystem::path& file) {
  grid::BoundedGrid nrrd = with_file(file.string(), [&] { return grid::read_nrrd_bounded(file, grid::labels_limit); });
  const auto content = nrrd.keys.find("content");
  if ((content != nrrd.keys.end() && content->second == "HU") ||
      std::holds_alternative<grid::Grid<std::int16_t>>(nrrd.grid))
    return std::make_shared<const grid::HuVolume>(grid::to_hu(std::move(nrrd.grid)));
  return std::make_shared<const grid::Field>(grid::to_field(std::move(nrrd.grid)));
}

std::string report_json(const Report& report) {
  Json j = Json::object();
  for (const auto& [name, value] : report.figures) j[name] = json_of(value);
  j["warnings"] = report.warnings;
  return j.dump(2) + "\n";
}

std::string report_text(const Report& report) {
  std::size_t width = 0;
  for (const auto& f : report.figures) width = std::max(width, f.first.size());
  std::string text;
  for (const auto& [name, value] : report.figures)
    text += name + std::string(width - name.size() + 2, ' ') + trephine::to_text(value) + "\n";
  for (const std::string& w : report.warnings) text += "warning: " + w + "\n";
  return text;
}

std::string outcome_json(const StageOutcome& outcome) {
  const WarningList warnings{outcome.warnings};
  return Json{{"result", json::declared_json(outcome.result, -1)}, {"warnings", json::json_of_value(warnings)}}.dump();
}

StageOutcome parse_outcome_json(const std::string& text, const StageType& type) {
  StageOutcome out{{}, type.make_result(), {}};
  try {
    const Json parsed = Json::parse(text);
    json::read_declared_json(parsed.at("result").get<std::string>(), *out.result.set, out.result.object.get(),
                             json::of_a_program);
    out.warnings = json::value_of_json<WarningList>(parsed.at("warnings").get<std::string>()).list;
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::bad_input, "", "outcome", "is none of ours");
  }
  return out;
}

}  // namespace trephine::stages
