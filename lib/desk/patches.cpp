// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/patches.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/text.h"
#include "base/write_file.h"
#include "config/config_root.h"
#include "config/yaml_document.h"
#include "grid/labels.h"
#include "json/declared_json.h"
#include "segmentation/correct.h"
#include "segmentation/hand_edits.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

grid::Mask voxels_of(const fs::path& file) {
  const grid::LabelFile labels = grid::read_labels(file);
  grid::Mask out(labels.lattice);
  for (const auto& [name, value] : {std::pair{"added", added_byte}, {"removed", removed_byte}}) {
    const grid::Mask one = grid::pick_label(labels, name).mask;
    for (std::size_t i = 0; i < out.voxels.size(); ++i)
      if (one.voxels[i]) out.voxels[i] = value;
  }
  return out;
}

/// The first patch with the others over it.
grid::Mask together(const std::vector<grid::Mask>& patches) {
  const grid::Lattice& first = patches.front();
  grid::Box all = grid::whole_box(first);
  std::vector<grid::Box> places;
  for (const grid::Mask& patch : patches) {
    places.push_back(grid::place_in(patch, first));
    for (int a = 0; a < 3; ++a) {
      all.begin[a] = std::min(all.begin[a], places.back().begin[a]);
      all.end[a] = std::max(all.end[a], places.back().end[a]);
    }
  }
  grid::Lattice lattice = first;
  lattice.origin_mm = first.to_world_mm({double(all.begin[0]), double(all.begin[1]), double(all.begin[2])});
  for (int a = 0; a < 3; ++a) lattice.size[a] = all.end[a] - all.begin[a];
  if (lattice.count() > std::size_t{1} << 32) throw Error(ExitCode::bad_input, "", "patches", "lie too far apart");
  grid::Mask out(lattice);
  for (std::size_t p = 0; p < patches.size(); ++p)
    for (int k = 0; k < patches[p].size[2]; ++k)
      for (int j = 0; j < patches[p].size[1]; ++j)
        for (int i = 0; i < patches[p].size[0]; ++i)
          if (const std::uint8_t v = patches[p].at(i, j, k))
            out.at(i + places[p].begin[0] - all.begin[0], j + places[p].begin[1] - all.begin[1],
                   k + places[p].begin[2] - all.begin[2]) = v;
  return out;
}

std::string union_name(const std::string& anatomy) { return anatomy + ".nrrd"; }
std::string list_name(const std::string& anatomy) { return anatomy + ".json"; }

/// A correction that the configuration names, and that the desk did not make.
std::optional<std::string> foreign_correction(const DeskCase& one, const std::string& anatomy) {
  const config::YamlNode file = config::read_yaml(one.text_file());
  const config::YamlNode* all = file.find("corrections");
  const config::YamlNode* named = all ? all->find(anatomy) : nullptr;
  if (!named) return {};
  for (const std::string& ours : {union_name(anatomy), list_name(anatomy)})
    if (named->text == one.token + ".desk/" + ours) return {};
  return named->text;
}

std::string union_of(const DeskCase& one, const std::vector<HandEntry>& patches) {
  std::vector<grid::Mask> all;
  for (const HandEntry& e : patches) all.push_back(voxels_of(one.hand_folder() / e.file));
  return grid::encode_labels(segmentation::correction_of(together(all)));
}

std::string list_of(const DeskCase& one, const std::vector<HandEntry>& entries) {
  segmentation::EditList list;
  for (const HandEntry& e : entries) {
    if (e.edit.empty()) {
      list.edits.emplace_back(
          "patch", AnyParams::make(segmentation::PatchEdit{e.file, sha256_of_file(one.hand_folder() / e.file)}));
      continue;
    }
    segmentation::EditList single;
    json::read_declared_json(R"({"trephine_edits": 1, "edits": [)" + e.edit + "]}",
                             parameters_of<segmentation::EditList>(), &single);
    list.edits.push_back(single.edits.at(0));
  }
  return segmentation::encode_edit_list(std::move(list));
}

/// Makes the file of all that counts, patches together or a list, and the line that names it.
HandChange combined(const DeskCase& one, const std::string& anatomy, const std::vector<HandEntry>& journal) {
  std::vector<HandEntry> all;
  bool edits = false;
  for (const HandEntry& e : journal) {
    if (!e.on || e.anatomy != anatomy || !e.is_correction()) continue;
    all.push_back(e);
    edits = edits || !e.edit.empty();
  }
  HandChange change;
  const std::string name = edits ? list_name(anatomy) : union_name(anatomy);
  if (!all.empty()) {
    write_file(one.hand_folder() / name, edits ? list_of(one, all) : union_of(one, all));
    change.changes = {{{"corrections", anatomy}, config::yaml_scalar(one.token + ".desk/" + name)}};
  } else {
    const config::YamlNode file = config::read_yaml(one.text_file());
    const config::YamlNode* all = file.find("corrections");
    if (all && all->find(anatomy)) change.changes = {{{"corrections", anatomy}, {}}};
  }
  change.check = [anatomy, wanted = !all.empty()](const config::CaseConfig& now) {
    const config::RecipeAnatomy* found = now.find_anatomy(anatomy);
    if (wanted && (!found || !found->find_step("correct")))
      throw Error(ExitCode::bad_config, "", "corrections." + anatomy, "has no effect in this recipe");
  };
  return change;
}

void keep_foreign(const DeskLibrary& library, const DeskCase& one, const std::string& anatomy,
                  std::vector<HandEntry>& journal) {
  const auto named = foreign_correction(one, anatomy);
  if (!named) return;
  std::string fault;
  const fs::path file = config::path_in_roots(one.config.parent_path(), *named, library.roots(), fault);
  if (!fault.empty()) throw Error(ExitCode::bad_config, one.config.filename().string(), "corrections", fault);
  if (segmentation::is_edit_list(file))
    throw Error(ExitCode::usage, one.config.filename().string(), "corrections." + anatomy,
                "names a list of edits that this desk did not make: it can be gone on with by an editor alone");
  HandEntry entry;
  entry.kind = "patch";
  entry.what = "the correction that was there";
  entry.anatomy = anatomy;
  HandEntry& made = add_entry(journal, entry);
  made.file = anatomy + "-" + std::to_string(made.id) + ".nrrd";
  write_file(one.hand_folder() / made.file, grid::encode_labels(segmentation::correction_of(voxels_of(file))));
}

void finish(DeskLibrary& library, const DeskCase& one, const std::string& anatomy, const Said& said,
            std::vector<HandEntry>& journal, const std::string& kind, const std::string& what) {
  HandChange change = combined(one, anatomy, journal);
  change.base_sha256 = said.base_sha256;
  change.by = said.by;
  change.why = said.why;
  change.kind = kind;
  change.what = what;
  save_change(library, one, change, journal);
}

void require_unchanged(const DeskCase& one, const Said& said) {
  if (!one.fixed.empty()) throw Error(ExitCode::usage, "", one.token, one.fixed);
  if (config_sha256(one) != said.base_sha256)
    throw Error(ExitCode::busy, one.text_file().filename().string(), "",
                "was changed meanwhile, by another desk or an editor: open the case again");
}

std::string in_words(const std::string& name, const AnyParams& params) {
  const auto place = [](const std::array<double, 3>& v) {
    const std::string text = joined(v, ", ", [](const double x) { return to_text(double(std::llround(x * 10)) / 10); });
    return "(" + text + ") mm";
  };
  if (name == "snake") {
    const auto& p = params.as<segmentation::SnakeEdit>();
    return "snake from " + place(p.seed_mm) + ", " + std::to_string(p.steps_count) + " steps, " +
           (p.removes ? "removed" : "added");
  }
  if (name == "cut") {
    const auto& p = params.as<segmentation::CutEdit>();
    return "cut by a plane at " + place(p.point_mm) + ", within " + to_text(p.within_mm) + " mm";
  }
  const auto& p = params.as<segmentation::SmoothEdit>();
  return "smoothed within " + to_text(p.within_mm) + " mm of " + place(p.point_mm);
}

}  // namespace

grid::Mask decode_painted(std::string_view bytes, const grid::Lattice& scan) {
  std::int32_t head[6];
  if (bytes.size() < sizeof head) throw Error(ExitCode::bad_input, "", "patch", "is cut short");
  std::memcpy(head, bytes.data(), sizeof head);
  grid::Box box;
  std::size_t count = 1;
  for (int a = 0; a < 3; ++a) {
    if (head[a] < 0 || head[a + 3] < 1 || head[a] >= scan.size[a] || head[a + 3] > scan.size[a] - head[a])
      throw Error(ExitCode::bad_input, "", "patch", "lies beyond the scan's voxels");
    box.begin[a] = head[a];
    box.end[a] = head[a] + head[a + 3];
    count *= std::size_t(head[a + 3]);
  }
  if (bytes.size() != sizeof head + count) throw Error(ExitCode::bad_input, "", "patch", "has not a byte a voxel");
  grid::Mask out(grid::cropped(scan, box));
  std::memcpy(out.voxels.data(), bytes.data() + sizeof head, count);
  bool any = false;
  for (const std::uint8_t v : out.voxels) {
    if (v > removed_byte) throw Error(ExitCode::bad_input, "", "patch", "holds a byte that is not 0, 1 or 2");
    any = any || v;
  }
  if (!any) throw Error(ExitCode::usage, "", "patch", "nothing is painted");
  return out;
}

std::string encode_painted(const grid::Mask& voxels, const grid::Lattice& scan) {
  const grid::Box place = grid::place_in(voxels, scan);
  std::int32_t head[6];
  for (std::size_t a = 0; a < 3; ++a) {
    head[a] = place.begin[a];
    head[a + 3] = voxels.size[a];
  }
  std::string bytes(reinterpret_cast<const char*>(head), sizeof head);
  bytes.append(reinterpret_cast<const char*>(voxels.voxels.data()), voxels.voxels.size());
  return bytes;
}

std::size_t drop_what_is_so(grid::Mask& painted, const DrawnField& field, const grid::Lattice& scan) {
  const grid::Box place = grid::place_in(painted, scan);
  const auto is_inside = [&](int i, int j, int k) {
    const int at[3] = {i + place.begin[0] - field.place.begin[0], j + place.begin[1] - field.place.begin[1],
                       k + place.begin[2] - field.place.begin[2]};
    return field.samples.contains(at[0], at[1], at[2]) && field.samples.at(at[0], at[1], at[2]) > 0;
  };
  std::size_t dropped = 0;
  for (int k = 0; k < painted.size[2]; ++k)
    for (int j = 0; j < painted.size[1]; ++j)
      for (int i = 0; i < painted.size[0]; ++i) {
        std::uint8_t& v = painted.at(i, j, k);
        if (v == 0 || (v == added_byte) != is_inside(i, j, k)) continue;
        v = 0;
        ++dropped;
      }
  return dropped;
}

std::string save_patch(DeskLibrary& library, const std::string& token, const Painted& painted, const Said& said) {
  const DeskLock lock(library);
  const DeskCase one = library.find(token);
  require_unchanged(one, said);
  std::vector<HandEntry> journal = read_journal(one);
  make_output_folder(one.hand_folder());
  keep_foreign(library, one, painted.anatomy, journal);
  std::size_t plus = 0, minus = 0;
  for (const std::uint8_t v : painted.voxels.voxels) plus += v == added_byte, minus += v == removed_byte;
  const double ml = painted.voxels.voxel_volume_mm3() / 1000;
  HandEntry entry;
  entry.by = said.by;
  entry.why = said.why;
  entry.kind = "patch";
  entry.anatomy = painted.anatomy;
  const auto rounded = [&](std::size_t n) { return to_text(double(std::llround(double(n) * ml * 1000)) / 1000); };
  entry.what = painted.anatomy + ": " + rounded(plus) + " ml added, " + rounded(minus) + " ml removed";
  HandEntry& made = add_entry(journal, entry);
  made.file = painted.anatomy + "-" + std::to_string(made.id) + ".nrrd";
  write_file(one.hand_folder() / made.file, grid::encode_labels(segmentation::correction_of(painted.voxels)));
  const std::string what = made.what;  // finish() may add to the journal
  finish(library, one, painted.anatomy, said, journal, "", "");
  return what;
}

int save_edit(DeskLibrary& library, const std::string& token, const std::string& anatomy,
              const segmentation::EditList& edit, const Said& said) {
  const DeskLock lock(library);
  const DeskCase one = library.find(token);
  require_unchanged(one, said);
  std::vector<HandEntry> journal = read_journal(one);
  make_output_folder(one.hand_folder());
  keep_foreign(library, one, anatomy, journal);
  const auto& [name, params] = edit.edits.at(0);
  HandEntry entry;
  entry.by = said.by;
  entry.why = said.why;
  entry.kind = name;
  entry.anatomy = anatomy;
  entry.what = anatomy + ": " + in_words(name, params);
  entry.edit = R"({")" + name + R"(": )" + json::declared_json(params, -1) + "}";
  const int id = add_entry(journal, entry).id;  // finish() may add to the journal
  finish(library, one, anatomy, said, journal, "", "");
  return id;
}

void switch_patch(DeskLibrary& library, const std::string& token, int id, bool on, const Said& said) {
  const DeskLock lock(library);
  const DeskCase one = library.find(token);
  std::vector<HandEntry> journal = read_journal(one);
  for (HandEntry& e : journal)
    if (e.id == id && e.is_correction()) {
      if (e.on == on) return;
      e.on = on;
      const std::string what = std::string(on ? "on" : "off") + ": " + e.what, anatomy = e.anatomy;
      return finish(library, one, anatomy, said, journal, "switch", what);
    }
  throw Error(ExitCode::no_input, "", "patch", "the journal has no such patch");
}

}  // namespace trephine::desk
