// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <string_view>

#include "grid/grid.h"

namespace trephine::grid::detail {

/// NIfTI-1 says a volume's place in single precision. For the sources of this room only.

/// The number that was meant by a float: itself where it has few digits, as 0.478515625; else the decimal with the
/// fewest digits that is stored as this float, as 0.4785156 is: what the DICOM said that the file was made of.
double meant(float stored);
inline double meant(double stored) { return stored; }

/// The affine (RAS, mm, row by row) as NIfTI-1's sform holds it.
std::array<std::array<float, 4>, 3> sform_of(const Lattice& lattice);

/// The extension (a comment, ecode 6, with the four bytes before it) that says the place with all digits: 240 bytes or
/// more, a multiple of 16 and 4. Other programs pass it by.
std::string place_extension(const Lattice& lattice);

/// Takes spacing, origin and direction from such an extension where they, rounded to single precision, are what the
/// sform holds to the last bit; so a program that moved the volume and kept the extension is not misread.
void take_place_extension(std::string_view extensions, const std::array<std::array<float, 4>, 3>& sform,
                          Lattice& lattice);

}  // namespace trephine::grid::detail
