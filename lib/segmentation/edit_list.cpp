// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/edit_list.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "grid/bounded_read.h"
#include "json/declared_json.h"
#include "segmentation/correct.h"
#include "segmentation/hand_edits.h"

namespace trephine::segmentation {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t max_list_bytes = 1 << 20;

Outcome<grid::Field, CorrectedResult> patched(const grid::Field& field, const grid::HuVolume& volume,
                                              const PatchEdit& patch, const fs::path& folder,
                                              const Progress& progress) {
  // It is a name and no path: what a list says is all that it can reach.
  if (patch.file.empty() || patch.file.front() == '.' || patch.file.find('/') != std::string::npos)
    throw Error(ExitCode::bad_input, "", "file", "must be the name of a file beside the list");
  const fs::path file = folder / patch.file;
  const std::vector<char> read = read_file(file);
  const std::string_view bytes(read.data(), read.size());
  if (sha256_of_bytes(bytes) != patch.sha256)
    throw Error(ExitCode::bad_input, "", "sha256", "is not that of " + patch.file + ": the patch was changed since");
  return corrected(field, grid::lattice_of(volume),
                   with_file(file.string(), [&] { return grid::decode_labels_bounded(bytes); }), progress);
}

}  // namespace

std::vector<StepChoice> EditList::choices() {
  return {{"patch", "A painted correction.", &parameters_of<PatchEdit>()},
          {"snake", "A ball that grows over what has its HU.", &parameters_of<SnakeEdit>()},
          {"cut", "One side of a plane is taken away.", &parameters_of<CutEdit>()},
          {"smooth", "The shape is smoothed within a ball.", &parameters_of<SmoothEdit>()}};
}

EditReach reach_of(const std::string& name, const AnyParams& params) {
  const auto at = [](const std::array<double, 3>& p, double radius_mm) {
    return EditReach{{p[0], p[1], p[2]}, radius_mm};
  };
  if (name == "snake") return at(params.as<SnakeEdit>().seed_mm, params.as<SnakeEdit>().within_mm);
  if (name == "cut") return at(params.as<CutEdit>().point_mm, params.as<CutEdit>().within_mm);
  if (name != "smooth") throw Error(ExitCode::internal, "", name, "has no ball");
  const auto& p = params.as<SmoothEdit>();
  return at(p.point_mm, p.within_mm + 4 * p.sigma_mm);
}

bool is_edit_list(const fs::path& file) { return file.extension() == ".json"; }

EditList read_edit_list(const fs::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, max_list_bytes);
    EditList list;
    json::read_declared_json({bytes.data(), bytes.size()}, parameters_of<EditList>(), &list);
    return list;
  });
}

std::string encode_edit_list(EditList list) { return json::declared_json(parameters_of<EditList>(), &list) + "\n"; }

Outcome<grid::Field, EditsResult> apply_edits(const grid::Field& field, const grid::HuVolume& volume,
                                              const EditList& list, const fs::path& folder, const Progress& progress) {
  Outcome<grid::Field, EditsResult> out{field, {}, {}};
  EditsResult& all = out.result;
  for (std::size_t i = 0; i < list.edits.size(); ++i) {
    const auto& [name, params] = list.edits[i];
    const std::string which = "edits[" + std::to_string(i) + "]." + name;
    const Progress part =
        progress.part(double(i) / double(list.edits.size()), double(i + 1) / double(list.edits.size()));
    auto made = with_field(which, [&, &params = params, &name = name]() -> Outcome<grid::Field, EditedResult> {
      if (name == "snake") return edited(out.value, volume, params.as<SnakeEdit>(), part);
      if (name == "cut") return edited(out.value, volume, params.as<CutEdit>(), part);
      if (name == "smooth") return edited(out.value, volume, params.as<SmoothEdit>(), part);
      auto patch = patched(out.value, volume, params.as<PatchEdit>(), folder, part);
      all.already_ratio = std::max(all.already_ratio, patch.result.already_ratio);
      return {std::move(patch.value),
              {patch.result.changed.added_ml, patch.result.changed.removed_ml},
              std::move(patch.warnings)};
    });
    out.value = std::move(made.value);
    all.added_ml += made.result.added_ml;
    all.removed_ml += made.result.removed_ml;
    for (Warning& w : made.warnings) {
      w.form = "edit {edit_number} ({edit}): " + w.form;
      w.values.emplace_back("edit_number", static_cast<std::int64_t>(i + 1));
      w.values.emplace_back("edit", name);
      out.warnings.push_back(std::move(w));
    }
  }
  all.edits_count = list.edits.size();
  return out;
}

}  // namespace trephine::segmentation
