// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"
#include "voxel/haptic_volume.h"

namespace trephine::contact {

struct FeltLattice;
class KnownSamples;

/// How a segment is followed through a haptic volume, and what counts as the surface there.
struct ContactParams {
  /// exact: visits every cell that the segment meets, one face at a time [Amanatides1987], so that no wall is missed
  /// however thin and slanted it is; the last cell is reached by counting, not by rounding. stepped: the method of
  /// [Rizzi, chapter 3], which samples every `step_ratio` of the smallest voxel side.
  enum class Walk { exact, stepped };
  /// nearest: the surface is that of the boxes of all voxels that are at least half full, as in [Rizzi, chapter 3].
  /// subvoxel: the surface lies where the trilinear occupancy is 1/2, found on the segment. In a cell of eight voxel
  /// centres where that surface would leave a hole in a wall that the boxes close, the boxes are used.
  enum class Surface { subvoxel, nearest };
  Walk walk = Walk::exact;
  Surface surface = Surface::subvoxel;
  double step_ratio = 1;
  template <class V>
  static void describe(V& v) {
    using P = ContactParams;
    v.choice(&P::walk, "walk", {{"exact", Walk::exact}, {"stepped", Walk::stepped}},
             "How the tool's path is followed through the voxels.");
    v.choice(&P::surface, "surface", {{"subvoxel", Surface::subvoxel}, {"nearest", Surface::nearest}},
             "Which surface is felt: that of half occupancy, or the voxels' boxes.");
    v.number(&P::step_ratio, "step_ratio", Range{0.01, 1},
             "Step of the stepped walk as a share of the smallest voxel side.");
  }
};

/// A front face is met from outside its shape, a back face from inside.
enum class ContactFace { front, back };

/// Which faces of which shapes stop a segment: bit n stands for shape n.
struct TouchableFaces {
  std::uint64_t front = ~std::uint64_t{0}, back = ~std::uint64_t{0};
};

struct Contact {
  bool hit = false;
  bool passed = false;   ///< before the hit or the end, it went from one shape to another where nothing stops it
  bool refused = false;  ///< a coordinate was not finite or beyond 1e9 mm; nothing was walked
  Vec3 point_mm;         ///< where the surface is crossed; without a hit, the end
  Vec3 normal;           ///< unit, towards the side that the segment comes from; zero without a hit
  ContactFace face = ContactFace::front;
  int shape = 0;           ///< the shape whose face it is; 0 without a hit
  int from = 0, into = 0;  ///< shapes before and behind the crossing, 0 for none; without a hit, both are the end's
  double along = 1;        ///< position on the segment, 0 to 1
};

/// A box in lattice coordinates that lies in one shape entirely, as cross() found it: a way inside it need not be
/// walked. It is valid until voxels change.
struct ContactBox {
  Vec3 low{1, 1, 1}, high;
  bool holds(Vec3 p) const {
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x < high.x && p.y < high.y && p.z < high.z;
  }
};

/// A place where the surface between two shapes (0: none) crosses the way between two neighbouring voxel centres.
struct SurfaceSample {
  Vec3 point_mm, normal;  ///< normal: unit, towards the side of `low`; zero until somebody asks for it
  std::uint8_t low = 0, high = 0;
};

/// The haptic volume as the hand meets it [Rizzi, chapter 3], with the interface of OpenHaptics' intersectSurface: one
/// walk serves any number of shapes. Each point of space belongs to one shape or to none, and a contact is a crossing
/// from one to another. It is the front of the shape that is entered, if that is touchable, else the back of the shape
/// that is left. Where shapes meet they share one surface; the part of a voxel that no shape fills is empty.
///
/// Only the constructor allocates, locks or throws, and the object may be used from several threads. After loosen(),
/// voxels may be lowered at the same time (they are read through relaxed atomics); the lattice and the shapes may not
/// change.
class ContactVolume {
 public:
  /// The volume must outlive the object. With the encoding `occupancy` the constructor calls settle() for the whole
  /// volume, which marks partly filled voxels without another shape nearby as bare; no voxel means anything else then.
  explicit ContactVolume(voxel::HapticVolume& volume, ContactParams params = {});
  ~ContactVolume();

  /// Forgets what is known of the blocks around the box. It must be called before voxels of the box are lowered, unless
  /// the thread that lowers them also does the walks. Where another thread may call settle() meanwhile, it must be
  /// called again after they were lowered. It takes no lock and does not allocate.
  void loosen(const grid::Box& box);
  /// Looks again for blocks that walks can skip. The box must reach two voxels beyond those that were changed. Only one
  /// thread at a time may call it, one that can spend the time. Another may lower and loosen voxels meanwhile: a block
  /// that was loosened stays unknown, and no voxel gets an older value back.
  void settle(const grid::Box& box);

  /// The shape that holds the point, 0 for none, beyond the lattice, and where a coordinate is not finite.
  int shape_at(Vec3 world_mm) const;
  /// For each of some points of a tool with that tip and frame, a distance within which all is of its shape (0: none),
  /// known at once; 0 where that is not known. It holds until something is loosened.
  void clear_mm(Vec3 tip_mm, const Mat3& frame, const std::vector<Vec3>& points_mm,
                const std::vector<std::uint8_t>& shapes, std::vector<double>& out) const;
  /// The same of a place beside a surface, up to two voxels: it looks at the cells around.
  double clear_beside_mm(Vec3 world_mm, int shape) const;

  /// The first touchable crossing of the segment. The walk takes its start to lie in `start_shape`, whatever the voxels
  /// say. A caller that places a point on a surface says with it on which side of the surface the point is, so that
  /// rounding cannot let the point fall through.
  Contact intersect(Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces = {}) const;
  Contact intersect(Vec3 start_mm, Vec3 end_mm, const TouchableFaces& faces = {}) const {
    return intersect(start_mm, end_mm, shape_at(start_mm), faces);
  }

  /// Like intersect(), but the normal stays zero: for many points of which few contacts matter. A way within the box
  /// `known`, which an earlier call filled in, is not walked; a way that lies in another such box replaces it.
  Contact cross(Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces = {},
                ContactBox* known = nullptr) const;
  /// The normal that intersect() gives to a contact met along `way`.
  Vec3 normal_of(const Contact& contact, Vec3 way) const;

  /// Unit normal of the surface between the two shapes (0: none), from `into` towards `from`: that of the linear
  /// function which fits the occupancy of the 4 x 4 x 4 voxels around best, weighted 1 2 1 along each axis and
  /// interpolated to the point. Voxels count by how far they are from empty and full, so that a plane's normal is
  /// exact; zero where nothing changes.
  Vec3 normal_at(Vec3 world_mm, int from, int into) const;

  /// Unit normal of the sub-voxel surface itself where a segment along `way` met it, from `into` towards `from`. It
  /// changes more from cell to cell than normal_at, but a step perpendicular to it leaves the surface only in second
  /// order. Zero where boxes are felt.
  Vec3 exact_normal(const Contact& contact, Vec3 way) const;

  /// Writes the samples within reach of the line (or point) to `out`, at most `most`, without normals; returns how
  /// many. There is one on each edge between voxel centres whose ends are in different shapes, so they lie about a
  /// voxel apart. `known`: where they are remembered for the next calls.
  int samples_near(Vec3 from_mm, Vec3 to_mm, double reach_mm, SurfaceSample* out, int most,
                   KnownSamples* known = nullptr) const;
  /// How often loosen() was called, modulo 2^32.
  std::uint32_t loosened() const;

  const voxel::HapticVolume& volume() const;
  const ContactParams& params() const;
  double smallest_side_mm() const;

 private:
  std::unique_ptr<FeltLattice> felt_;
};

}  // namespace trephine::contact
