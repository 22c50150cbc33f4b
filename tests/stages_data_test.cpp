// SPDX-License-Identifier: GPL-3.0-or-later
// Stage data as files.
#include <gtest/gtest.h>

#include "grid/nrrd.h"
#include "scratch_folder.h"
#include "stages/data_files.h"

namespace trephine {
namespace {

TEST(StageData, AVolumeIsNoFieldForContour) {
  const ScratchFolder folder;
  Lattice l;
  l.size = {4, 4, 4};
  const auto kind = [&](const char* name) { return kind_of(load_field_or_volume(folder.path() / name)); };
  write_nrrd(folder.path() / "hu.nrrd", HuVolume(Grid<std::int16_t>(l, 40)), {{"content", "HU"}});
  write_nrrd(folder.path() / "foreign.nrrd", HuVolume(Grid<std::int16_t>(l, 40)));
  write_nrrd(folder.path() / "resampled.nrrd", HuVolume(Grid<float>(l, 40)), {{"content", "HU"}});
  write_nrrd(folder.path() / "field.nrrd", Field(l, 1), {{"content", "field"}});
  write_nrrd(folder.path() / "mask.nrrd", Mask(l, 1));
  for (const char* name : {"hu.nrrd", "foreign.nrrd", "resampled.nrrd"})
    EXPECT_EQ(kind(name), DataKind::volume) << name;
  for (const char* name : {"field.nrrd", "mask.nrrd"}) EXPECT_EQ(kind(name), DataKind::field) << name;
}

}  // namespace
}  // namespace trephine
