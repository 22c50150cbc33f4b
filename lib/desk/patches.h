// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "desk/hand_work.h"
#include "desk/open_case.h"
#include "grid/grid.h"
#include "segmentation/edit_list.h"

namespace trephine::desk {

constexpr std::uint8_t added_byte = 1, removed_byte = 2;

/// What a person painted of one anatomy, as a box of bytes on the scan's voxels; 0: nothing.
struct Painted {
  std::string anatomy;
  grid::Mask voxels;
};

/// The painted bytes of a page: six little-endian int32 (first voxel and size, i j k), then a byte a voxel, i fastest.
/// Throws Error 65 where they are something else, or lie beyond the scan; 64 where nothing is painted.
grid::Mask decode_painted(std::string_view bytes, const grid::Lattice& scan);

/// What such a page takes: the same form. `voxels` lies on the scan's voxels.
std::string encode_painted(const grid::Mask& voxels, const grid::Lattice& scan);

/// Takes out of what is painted what is so already: voxels to be added that lie inside of the field, and voxels to be
/// removed that lie outside. Returns how many.
std::size_t drop_what_is_so(grid::Mask& painted, const DrawnField& field, const grid::Lattice& scan);

/// What the person says of a change.
struct Said {
  std::string by, why, base_sha256;
};

/// Saves the patch as a file of its own in CASE.desk/, writes into the journal who painted it and why, and lets the
/// case's configuration name all patches of the anatomy together (CASE.desk/ANATOMY.nrrd, in which a later patch has
/// the last word). A correction that the configuration named before becomes the first patch. Takes the lock. Throws
/// what save_change throws.
/// Returns what it says of it.
std::string save_patch(DeskLibrary& library, const std::string& token, const Painted& painted, const Said& said);

/// The same of an edit that is no patch: the one that `edit` holds. Where one of them counts, the configuration names a
/// list of all edits and patches, in the order in which they were saved (CASE.desk/ANATOMY.json).
/// Returns its number in the journal, by which it is switched off again.
int save_edit(DeskLibrary& library, const std::string& token, const std::string& anatomy,
              const segmentation::EditList& edit, const Said& said);

/// Lets a patch or an edit count, or not.
void switch_patch(DeskLibrary& library, const std::string& token, int id, bool on, const Said& said);

}  // namespace trephine::desk
