// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
namespace trephine::tetra {

/// The request: the version of the program, size and border in mm, then how many surfaces there are and each one's
/// points (world) and triangles, that with the least volume first. The answer: points, tetrahedra, their regions,
/// borders, between, how many were joined; region n is surface n - 1.
constexpr const char* tetra_worker = "tetra-mesh";
constexpr const char* tetra_build = TREPHINE_VERSION " 1";  // the number changes with the messages

}  // namespace trephine::tetra
