// SPDX-License-Identifier: GPL-3.0-or-later
// What a user does with the transfer function by which rays see a volume.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

#include "base/error.h"
#include "base/joined.h"
#include "base/write_file.h"
#include "cast/cast_table.h"
#include "cast/transfer_edit.h"
#include "window/action_entries.h"
#include "window/action_replies.h"
#include "window/action_when.h"

namespace trephine::window {
namespace {

const char* const shape_word = "shape";

Reply show_editor(Player& p, Screen& s, Words& w) {
  s.editor_shown = w.on(s.editor_shown);
  if (s.editor_shown && !p.view().stage().cast_source().voxels()) {
    Words first("cast", hu_choices(p).at(0));
    return cast_volume(p, first);
  }
  return {};
}

std::vector<std::string> beginnings(const Player& p) {
  std::vector<std::string> all = voxel::preset_names();
  const cases::LoadedCase& loaded = p.view().stage().loaded();
  if (loaded.has_haptic() && loaded.haptic.encoding == voxel::HapticEncoding::hu)
    for (const cases::CaseShape& shape : loaded.manifest.haptic.shapes)
      all.push_back(std::string(shape_word) + " " + shape.name);
  return all;
}

voxel::TransferFunction function_of_shape(const Player& p, const std::string& name) {
  const cases::CaseHaptic& haptic = p.view().manifest().haptic;
  for (std::size_t n = 0; n < haptic.shapes.size(); ++n)
    if (haptic.shapes[n].name == name) return cast::functions_of(haptic)[n];
  throw Error(ExitCode::usage, "", shape_word, name + ": the haptic volume has no such shape");
}

Reply begin_with(Player& p, Words& w) {
  render::Stage& stage = p.view().stage();
  if (!w.more()) return joined(stage.cast_source().functions(), " | ", cast::points_text);
  const std::string what = w.word();
  stage.cast(what == shape_word ? function_of_shape(p, w.word()) : cast::transfer_of(what, w.verb()));
  return {};
}

// Changes the only function of what is cast.
template <class Change>
Reply changed(Player& p, const Change& change) {
  render::Stage& stage = p.view().stage();
  if (stage.cast_source().functions().size() != 1) return texts::NoteId::several_functions;
  return change(stage, stage.cast_source().functions().front());
}

// The same, of a point that the words name.
template <class Change>
Reply point_changed(Player& p, Words& w, const Change& change) {
  return changed(p, [&](render::Stage& stage, const voxel::TransferFunction& f) -> Reply {
    const double number = w.number();
    if (!(number >= 1 && number <= double(f.points.size())) || number != std::floor(number))
      return texts::Answer(
          texts::Note{texts::NoteId::no_transfer_point,
                      {std::to_string(std::lround(std::min(std::abs(number), 1e6))), std::to_string(f.points.size())}});
    stage.cast(change(f, std::size_t(number) - 1));
    return {};
  });
}

Reply move_point(Player& p, Words& w) {
  return point_changed(p, w, [&](const voxel::TransferFunction& f, std::size_t point) {
    const double hu = w.number(), opacity = w.number();
    voxel::TransferFunction made = cast::with_moved(f, point, hu, opacity);
    if (!w.more()) return made;
    const std::string colour = "0:0:" + w.word();
    return cast::with_colour(made, point,
                             voxel::transfer_from_text(colour + "," + colour, w.verb()).points[0].colour_rgb);
  });
}

Reply add_point(Player& p, Words& w) {
  return changed(p, [&](render::Stage& stage, const voxel::TransferFunction& f) -> Reply {
    const double hu = w.number();
    const auto added = cast::with_added(f, hu, w.number());
    if (!added) return texts::NoteId::no_more_points;
    stage.cast(added->function);
    return {};
  });
}

Reply remove_point(Player& p, Words& w) { return point_changed(p, w, cast::with_removed); }

// A folder that cannot be written is no reason to end somebody's session.
Reply write_transfer(Player& p, Words&) {
  return changed(p, [&](render::Stage&, const voxel::TransferFunction& f) -> Reply {
    const std::filesystem::path file = p.next_file("transfer", ".yaml");
    try {
      write_file(file, cast::transfer_file_text(f));
      return file.string();
    } catch (const Error& e) {
      return texts::Answer(texts::Note{texts::NoteId::file_not_written, {e.file(), e.what()}});
    }
  });
}

}  // namespace

void transfer_actions(Entries e) {
  e.add("editor", "on|off|toggle",
        {{"the editor of the transfer function by which rays see a volume",
          "der Editor der Transferfunktion, mit der Strahlen ein Volumen sehen"}},
        with_volume);
  e->label = {{"Transfer function", "Transferfunktion"}};
  e->keys = {{GLFW_KEY_U, KeyUse::How::press, "toggle"}};
  e->run = show_editor;
  e.add("transfer", "[bone|skin|vessels|shape NAME|POINTS|FILE]",
        {{"rays see by that preset, the function of that shape, points as of `--transfer`, or a file that the editor "
          "wrote; alone: answers the points",
          nullptr}},
        with_rays);
  e->choices = beginnings;
  e->run = does(begin_with);
  e.add("point", "N HU OPACITY [RRGGBB]",
        {{"moves point N of the transfer function, from 1 on, and colours it; its neighbours hold it", nullptr}},
        with_rays);
  e->run = does(move_point);
  e.add("add_point", "HU OPACITY", {{"adds a point, of the colour that the function has there", nullptr}}, with_rays);
  e->run = does(add_point);
  e.add("remove_point", "N", {{"removes a point; two remain", nullptr}}, with_rays);
  e->run = does(remove_point);
  e.add("write_transfer", "",
        {{"writes the transfer function into the folder of `--shots`, as `transfer-001.yaml`, and answers that name",
          "schreibt die Transferfunktion in den Ordner --shots"}},
        with_rays);
  e->label = {{"Write", "Schreiben"}};
  e->run = does(write_transfer);
}

}  // namespace trephine::window
