// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
namespace trephine::tetra {

/// The request: the version of the program, size and border in mm, then how many surfaces there are and each one's
/// points (world) and triangles, that with the least volume first. The answer: points, tetrahedra, their regions,
/// borders, between, how many were joined; region n is surface n - 1.
constexpr const char* tetra_worker = "tetra-mesh";
extern const char* const tetra_build;  ///< in tetra_mesh.cpp, of which both sides are linked

}  // namespace trephine::tetra
