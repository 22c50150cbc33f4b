// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

#include "itk/volume_message.h"

namespace trephine {

/// The geometry that a MINC 2 file says, read from its HDF5 attributes without libminc and turned from MINC's RAS to
/// LPS: ITK 5.2 hands MINC's coordinates over as if they were LPS, which would exchange left and right, front and back.
/// Throws Error 65: not MINC 2, not three dimensions in space, irregular spacing, units that are not mm, a
/// start, step or direction that is missing.
ItkVolume minc_geometry(const std::string& file);

/// Writes a MINC 2 file: voxels as they are, without scaling, dates, history and the name of the user, which libminc
/// writes into each file. Throws Error 74.
void write_minc(const std::string& file, const ItkVolume& head, ItkSample sample, std::string_view voxels);

}  // namespace trephine
