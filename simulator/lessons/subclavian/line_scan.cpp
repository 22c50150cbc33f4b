// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/line_scan.h"

#include "base/error.h"
#include "lessons/scan_way.h"

namespace trephine::lessons {
namespace {

// The one that was asked for; nothing where the scan shows none there.
const lesson::OutcomeLine* line_for(const lesson::OutcomeRecord& record, const std::string& task) {
  const auto first = [&](const std::string& side) -> const lesson::OutcomeLine* {
    for (const lesson::OutcomeLine& l : record.lines)
      if (l.side == side) return &l;
    return nullptr;
  };
  const lesson::OutcomeLine *right = first("right"), *left = first("left");
  if (!task.empty())
    if (const lesson::OutcomeLine* asked = task == "left" ? left : right) return asked;
  if (right && left && task.empty())
    throw Error(ExitCode::usage, "", "--task", "the CT shows a line on each side; name one: right, left");
  return right ? right : left;
}

}  // namespace

std::shared_ptr<LessonFacts> line_facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                const std::string& task) {
  auto facts = std::make_shared<SubclavianFacts>();
  facts->from_scan = true;
  facts->end = LessonEnd::finished;
  const lesson::OutcomeLine* line = line_for(record, task);
  if (!line) return facts;
  facts->seen = line->sighting;
  if (line->sighting != lesson::Sighting::found || line->course.size() < 2) return facts;
  const ChestShapes shapes = chest_shapes_of(loaded.manifest);
  const voxel::HapticDecoder decoder(loaded.haptic);
  VeinPass pass;
  pass.entry_mm = line->skin_mm;
  pass.tip_mm = line->vein_mm;
  pass.out = -line->axis;
  pass.in_place = true;
  for (const Vec3& p : way_inwards(line->course, line->tip_mm))
    pass.path.push_back({0, p, shape_about(decoder, loaded.manifest.haptic, p)});
  for (const VeinPassPoint& p : pass.path)  // at which moment nobody knows
    for (const auto& [shape, time_s] : {std::pair<int, double*>{shapes.vein, &facts->vein_s},
                                        std::pair<int, double*>{shapes.artery, &facts->artery_s},
                                        std::pair<int, double*>{shapes.pleura, &facts->pleura_s},
                                        std::pair<int, double*>{shapes.lung, &facts->lung_s}})
      if (shape != 0 && p.inside == shape) *time_s = 0;
  facts->inside = pass.path.back().inside;
  facts->passes = {pass};
  return facts;
}

texts::Phrase unseen_line(const SubclavianFacts& facts) {
  if (!facts.from_scan || !facts.passes.empty()) return "";
  return facts.seen == lesson::Sighting::doubtful ? "what the CT shows of a line is doubtful"
                                                  : "the CT shows no line there";
}

}  // namespace trephine::lessons
