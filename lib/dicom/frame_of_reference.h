// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "dicom/import.h"

namespace trephine::dicom {

/// Whether positions in two series mean the same places, by FrameOfReferenceUID: two reconstructions of one scan have
/// one. Nothing where one of them does not say (a volume file). The UIDs leave nothing behind. Throws as
/// compare_patients does. (import.cpp)
std::optional<bool> of_one_frame(const SeriesChoice& a, const SeriesChoice& b, const Progress& progress = {});

}  // namespace trephine::dicom
