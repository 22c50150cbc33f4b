// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "contact/contact_samples.h"
#include "contact/known_normals.h"
#include "contact/round_edge.h"
#include "haptics/tool.h"

namespace trephine::haptics {

/// Exactly round parts about one axis in a haptic volume: a ball, a rod with round ends, a burr's ball on its neck.
/// Surfaces near them are discs: one at each place where the surface crosses an edge between voxel centres, with the
/// surface's smooth normal there, and as wide as neighbouring discs need to leave no gap. A ball's distance to each is
/// exact; a rod's is too, but for discs that its middle line passes beside, where it is at most 0.01 of a disc's radius
/// too large.
///
/// Poses are given by the centre, which is the foremost end of the first part's middle line, and the axis. The surface
/// is looked up again when an end has moved by half a voxel, and where begin_frame() finds that voxels may have
/// changed. Only the constructor allocates.
class RoundBody {
 public:
  /// `parts`: at least one.
  RoundBody(const contact::ContactVolume& contact, std::vector<RoundPart> parts);
  /// Their middle lines from the centre.
  const std::vector<RoundPart>& parts() const { return parts_; }
  /// From the tip to the centre.
  double centre_mm() const { return centre_mm_; }
  /// A ball alone: it may turn as it likes.
  bool is_ball() const { return parts_.size() == 1 && parts_[0].to_mm == parts_[0].from_mm; }
  /// From the centre to the last place of the middle lines.
  double length_mm() const { return length_mm_; }
  double smallest_radius_mm() const { return smallest_radius_mm_; }

  /// Must be called once in each frame: what was learnt of the volume is forgotten where it was loosened since.
  void begin_frame();

  /// Whether this frame has done as much as that share of what one may: a rod moves and turns in many steps, and
  /// where the hand is fast the next frames go on. A ball is never busy.
  bool busy(double share) const {
    return !is_ball() && calls_ > share * least_calls && double(spent_) > share * most_spent;
  }

  /// Other work of this frame, in facets: a disc takes as long as five.
  void spend(int facets) { spent_ += facets / 5; }

  /// The disc into which a part reaches deepest, of those whose crossing stops it; for a ball alone, of those that are
  /// crossed from `inside`. The contact's point lies on the disc, and its normal points from there to the middle line;
  /// where several discs are touched about as deep and face about the same way, it is their mean.
  struct Touch {
    bool hit = false;
    double depth_mm = 0;
    double radius_mm = 0;   ///< of the part
    double along_mm = 0;    ///< where on the middle line, from the centre
    double pressed_mm = 0;  ///< the middle of all places of the line that touch as deep, for a rod may lie on it;
                            ///< set_on_edge() moves it with along_mm
    contact::Contact contact;
    /// The contact with a second shape that faces the same way, where the tool is nearly as deep in it (within a
    /// quarter of a voxel); and its weight in what is felt, 0 to 1/2: the larger, the less the depths differ.
    contact::Contact beside;
    double beside_share = 0;
  };
  Touch deepest(Vec3 centre_mm, Vec3 axis, int inside, const contact::TouchableFaces& faces);
  /// Where that is at an edge, a rim or a corner, its normal becomes what the faces there say, and its point and its
  /// places along the line those where the line passes the edge.
  void set_on_edge(Touch& touch, Vec3 axis);
  /// Whether it reaches any surface of one of these shapes (bit n: shape n).
  bool reaches(Vec3 centre_mm, Vec3 axis, std::uint64_t shapes);

 private:
  struct Near {
    int sample;
    double depth_mm, along_mm;
    Vec3 normal, face;  // towards the tool; the disc's own
    std::uint8_t from, into;
    bool front;
  };
  void find_beside(Touch& t) const;
  void smooth_normal(Touch& t) const;
  // What was found around a line, and the places once more as floats, which are compared quickly.
  struct Samples {
    std::vector<contact::SurfaceSample> at;
    std::vector<float> place[3];  // from from_mm
    int count = 0;
    Vec3 from_mm, end_mm;
    bool known = false;
    void resize(std::size_t size);
    void found(int number, Vec3 from, Vec3 end);
    bool around(Vec3 from, Vec3 end, double reach_mm) const;
    void squares_from_line(Vec3 from, Vec3 axis, double begin, double end, float* out) const;
  };
  void look(Vec3 centre_mm, Vec3 axis);
  bool look_in_wide(Vec3 centre_mm, Vec3 end_mm);
  void find_within(Vec3 centre_mm, Vec3 axis);
  Vec3 normal_of(const contact::SurfaceSample& sample);
  const contact::ContactVolume& contact_;
  std::vector<RoundPart> parts_;
  double centre_mm_, length_mm_ = 0, smallest_radius_mm_, largest_radius_mm_, disc_mm_, margin_mm_;
  double reach_mm_, wider_mm_;  // of a look; how much further a wide one reaches
  // What deepest() looks at, and more of it, from which the next looks are taken as long as no voxel changes.
  Samples samples_, wide_;
  std::vector<Near> near_;  // of this call: what may be as deep as the deepest, in the order of the samples
  int near_count_ = 0;
  std::vector<float> squares_;  // of distances
  std::vector<char> within_;    // bit m: in reach of part m
  int looks_ = 0;               // since voxels were seen to change
  std::uint32_t seen_ = 0;
  // In parts of 0.05 us, as counted work takes them.
  static constexpr int least_calls = 6, spent_by_look = 500, spent_in_wide = 120, spent_by_normal = 5;
  static constexpr double most_spent = 2000;
  contact::KnownNormals normals_;
  contact::KnownSamples known_;
  contact::RoundEdge edge_;
  int calls_ = 0;
  std::int64_t spent_ = 0;
  int frames_ = 0, edge_frames_ = 0;
};

}  // namespace trephine::haptics
