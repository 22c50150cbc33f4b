// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "session/hand_watch.h"
#include "session/playback.h"

namespace trephine::scene {

/// What bleeds at the bottom of a hole, and from when to when, in a recording's seconds.
struct Bleeding {
  Vec3 source_mm, mouth_mm;
  double width_mm = 5, ml_per_min = 0, begin_s = 0, end_s = 0;
};

/// Bone dust and blood, and the water that washes them away, as they are seen where a drill works. A look alone:
/// nothing that is felt, cut or recorded depends on it. Cells about the place that is drilled hold how much powder and
/// blood lie in them and how wet they are. What bleeds fills its hole from the bottom, lies about the mouth, and from
/// a width on runs down; a tool that takes up empties it, and water thins it. All measures are ours, by eye. Equal
/// ticks give equal cells.
class BoneDust {
 public:
  static constexpr int side = 48;  ///< cells along each axis of the patient
  static constexpr double cell_mm = 0.75;

  /// What a tool did in a tick.
  struct Tick {
    double dt_s = 0.001, time_s = 0;
    bool runs = false, cuts = false;  ///< a drill's pedal is down; and it is pressed on what it removes
    bool takes_up = false;            ///< blood and water, at its tip
    Vec3 tip_mm, axis{0, 0, 1};       ///< as it is shown, from the tip to the tail
    double radius_mm = 2.5;           ///< of its cutter
    double water_ml_per_min = 0;
  };
  /// `other`: what the tool of the other hand took up or rinsed in the same tick; null: there is none.
  void add(const Tick& tick, const Tick* other = nullptr);
  /// From now on; `down` (unit) is where it runs.
  void bleed(std::vector<Bleeding> all, Vec3 down);
  void clear();
  /// Is from now on what another was.
  void become(const BoneDust& other);

  bool any() const { return !dust_.empty(); }
  std::uint64_t version() const { return version_; }  ///< another one where cells changed
  Vec3 first_mm() const;                              ///< the middle of the first cell
  double dust_at(Vec3 place_mm) const;                ///< 0 to 1, of the cell
  double water_at(Vec3 place_mm) const;
  double blood_at(Vec3 place_mm) const;
  /// Three bytes a cell, of powder, of water and of blood, x fastest.
  std::vector<std::uint8_t> texels() const;

 private:
  template <class F>
  void for_box(Vec3 low_mm, Vec3 high_mm, const F& f);
  template <class F>
  void for_ball(Vec3 middle_mm, double radius_mm, const F& f);
  void stay_about(Vec3 place_mm);
  void throw_grain(const Tick& tick);
  void wash(const Tick& tick);
  void take_up(const Tick& tick);
  struct Pool {
    Bleeding of;
    double ml = 0;
  };
  void thin(Pool& pool, double share);
  void well_up(double time_s);
  void dry();
  std::size_t cell(int i, int j, int k) const {
    return std::size_t(i) + side * (std::size_t(j) + side * std::size_t(k));
  }
  double at(const std::vector<float>& of, Vec3 place_mm) const;

  std::vector<float> dust_, water_, blood_;  // empty until something was drilled or bled
  std::vector<Pool> pools_;
  Vec3 down_;
  int base_[3] = {0, 0, 0};  // of the first cell, in cells from the origin
  std::uint64_t grains_ = 0, version_ = 0;
  double owed_ = 0, since_wash_s_ = 0, since_dry_s_ = 0, since_pool_s_ = 0;
};

/// Has a dust follow the frames of a session or of its recording, as they come. The tool in hand, pauses and what is
/// taken back are those of session::HandWatch.
class DustWatch {
 public:
  /// `drilled`: bit n for a shape that drills remove (haptics::drilled_shapes).
  DustWatch(std::shared_ptr<BoneDust> dust, const haptics::RecordingHeader& header, std::uint64_t drilled,
            session::HandWatch::ShapeAt shape_at = {});
  void bleed(std::vector<Bleeding> all, Vec3 down);
  /// `shown`: the dust can be seen. Else none falls, is washed or dries, and all is ready for when it is. `second`: the
  /// other hand's frame of the same tick, where there is one.
  void look(const haptics::ServoFrame& frame, bool shown = true, const haptics::ServoFrame* second = nullptr);
  /// As it is after so many of these frames; of the same ones each time. What it was at some times is kept, so that
  /// going back does not begin anew. `second`: those of the other hand, or none.
  void go_to(const std::vector<haptics::ServoFrame>& frames, std::size_t count,
             const std::vector<haptics::ServoFrame>& second = {});
  const std::shared_ptr<BoneDust>& dust() const { return dust_; }
  std::size_t last_looked() const { return last_looked_; }  ///< at how many frames, by the last go_to()

 private:
  struct Held {
    bool rotates, rinses, takes_up;
    double radius_mm;
  };

  static Held held_of(const haptics::ToolParams& tool, bool cuts);
  BoneDust::Tick tick_of(const Held& held, const haptics::ServoFrame& frame, bool works) const;
  void keep();

  std::shared_ptr<BoneDust> dust_;
  std::vector<Held> held_;      // by the number of the tool
  std::optional<Held> second_;  // of the other hand
  const bool takes_back_;
  const std::uint64_t drilled_;
  const double water_ml_per_min_;
  struct Hands {
    session::HandWatch first;
    std::optional<session::HandWatch> second;
  };
  static Hands hands_of(const haptics::RecordingHeader& header, const session::HandWatch::ShapeAt& shape_at);
  const Hands begin_;
  Hands hands_;
  std::size_t looked_ = 0, last_looked_ = 0;
  struct Kept {
    std::size_t looked;
    Hands hands;
    BoneDust dust;
  };
  std::vector<Kept> kept_;  // of go_to(), in their order
  std::size_t keep_each_ = 4096;
};

/// Of a recording that is shown. It does not ask the volume, which is that of the time shown and not of the frames
/// looked at: so a time has one dust, whatever was shown before it, and a wait for the open is taken to last one tick.
DustWatch dust_watch_of(const session::Playback& playback);

}  // namespace trephine::scene
