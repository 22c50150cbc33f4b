// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "scene/scene.h"

namespace trephine::render {

/// How coarse surfaces may become, one size after the other, where the program chooses.
constexpr double coarse_sizes_mm[] = {0.5, 1, 1.5, 2.5};

/// How much coarser surfaces are drawn on a machine that is too slow for all triangles.
struct Coarseness {
  double within_mm = 0;  ///< how far a vertex may go; 0: nothing is made coarser
  double fine_mm = 30;   ///< around the tool's tip surfaces stay as they are
};

struct CoarseTriangles {
  std::vector<std::uint32_t> indices;  ///< three a triangle, of the same vertices
  std::vector<std::uint32_t> from;     ///< by triangle: the one that it was
};

/// Triangles between fewer of the same vertices, by a grid of cells [Rossignac1993]: all vertices of a cell become the
/// one that lies nearest to their mean, so none goes further than `within_mm`; triangles that lose their area vanish. A
/// closed surface stays closed, vertices at the same place count as one. It may fold over itself and lose thin parts:
/// it is to be looked at, and nothing else. Throws Cancelled, as all that takes a Progress here does.
CoarseTriangles coarse_triangles(const std::vector<scene::SceneVertex>& vertices,
                                 const std::vector<std::uint32_t>& indices, double within_mm,
                                 const Progress& progress = {});
/// The surface of such triangles, with the vertices that they use; the whole one where no triangle would be left.
scene::SceneSurface coarse_surface(const scene::SceneSurface& whole, double within_mm, const Progress& progress = {});

/// Coarser triangles are used only where at most this share of the triangles is left: else they save too little.
constexpr double worth_ratio = 2.0 / 3;
inline bool is_worth_it(std::size_t left, std::size_t whole) { return double(left) <= worth_ratio * double(whole); }

/// What a coarser surface is, beside the whole one.
struct CoarseFacts {
  std::size_t whole = 0, left = 0;  ///< triangles
  std::size_t places = 0;           ///< vertices of the whole surface: all of them were measured
  double worst_mm = 0;              ///< the largest distance of one of these from the coarser surface
  std::size_t bytes = 0;            ///< that it takes beside the whole one; 0 where it stands in place of it
  /// The name, and these figures but `bytes`, as the notes on coarser surfaces have them.
  std::vector<std::string> values(const std::string& name) const;
};
/// Measures every vertex of the whole surface, exactly; a thin part that vanished counts as far as it is then off. The
/// coarser one has a triangle at least.
CoarseFacts coarse_facts(const scene::SceneSurface& whole, const scene::SceneSurface& coarse,
                         const Progress& progress = {});
CoarseFacts coarse_facts(const std::vector<scene::SceneVertex>& vertices, std::size_t whole_triangles,
                         const std::vector<std::uint32_t>& coarse_indices, const Progress& progress = {});

}  // namespace trephine::render
