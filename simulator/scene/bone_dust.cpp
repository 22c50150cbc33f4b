// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/bone_dust.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "base/splitmix64.h"
#include "haptics/suction.h"

namespace trephine::scene {
namespace {

constexpr double stays_within_mm = 9;                 // of the cells' middle
constexpr double grains_per_s = 1000, grain = 0.8;    // while it cuts; of a cell's room
constexpr double near_radii = 0.7, far_radii = 1.9;   // where grains fall, in radii of the cutter from its axis
constexpr double column_mm = 12, wets_beyond_mm = 7;  // above the tip; beyond the cutter
constexpr double usual_ml_per_min = 40, washes_per_s = 1.2, wets_per_s = 3;  // at that flow
constexpr double wash_each_s = 0.02, dry_each_s = 1, dries_in_s = 40;

constexpr double takes_up_mm = 4, takes_up_per_s = 9;  // about the tip; of what is there
constexpr double pool_each_s = 0.1;
constexpr double widest_pool_mm = haptics::takes_within_mm, run_mm = 2.2;  // beyond it runs down, so thick
constexpr double rinse_ml_per_min = 120;                                   // of a syringe of saline

constexpr std::size_t most_kept = 24;

double unit_of(std::uint64_t n) { return double(splitmix64_mixed(n * splitmix64_step) >> 11) * 0x1p-53; }

// Whether a tool is at what bleeds, or so far above it.
bool reaches(const Bleeding& b, Vec3 tip_mm, double above_mm) {
  return std::min(norm(b.mouth_mm - tip_mm), norm(b.source_mm - tip_mm)) < widest_pool_mm + above_mm;
}

}  // namespace

Vec3 BoneDust::first_mm() const { return Vec3{double(base_[0]), double(base_[1]), double(base_[2])} * cell_mm; }

void BoneDust::clear() {
  dust_.clear();
  water_.clear();
  blood_.clear();
  for (Pool& pool : pools_) pool.ml = 0;
  grains_ = 0;
  owed_ = since_wash_s_ = since_dry_s_ = since_pool_s_ = 0;
  ++version_;
}

void BoneDust::become(const BoneDust& other) {
  const std::uint64_t version = version_;
  *this = other;
  version_ = version + 1;
}

double BoneDust::at(const std::vector<float>& of, Vec3 p) const {
  if (of.empty()) return 0;
  int at[3];
  for (int a = 0; a < 3; ++a) {
    at[a] = int(std::lround(p[a] / cell_mm)) - base_[a];
    if (at[a] < 0 || at[a] >= side) return 0;
  }
  return double(of[cell(at[0], at[1], at[2])]);
}
double BoneDust::dust_at(Vec3 p) const { return at(dust_, p); }
double BoneDust::water_at(Vec3 p) const { return at(water_, p); }
double BoneDust::blood_at(Vec3 p) const { return at(blood_, p); }

void BoneDust::bleed(std::vector<Bleeding> all, Vec3 down) {
  down_ = down;
  std::vector<Pool> pools;
  for (const Bleeding& b : all) {
    const auto same = std::find_if(pools_.begin(), pools_.end(), [&](const Pool& p) {
      return p.of.begin_s == b.begin_s && p.of.ml_per_min == b.ml_per_min;
    });
    pools.push_back({b, same == pools_.end() ? 0 : same->ml});
  }
  pools_ = std::move(pools);
}

void BoneDust::add(const Tick& t, const Tick* other) {
  if (t.runs && t.cuts) {
    stay_about(t.tip_mm);
    for (owed_ += t.dt_s * grains_per_s; owed_ >= 1; owed_ -= 1) throw_grain(t);
  }
  const bool bleeds =
      std::any_of(pools_.begin(), pools_.end(), [&](const Pool& p) { return p.of.begin_s <= t.time_s; });
  if (bleeds && !any())
    stay_about(std::min_element(pools_.begin(), pools_.end(), [](const Pool& a, const Pool& b) {
                 return a.of.begin_s < b.of.begin_s;
               })->of.mouth_mm);
  if (!any()) return;
  since_pool_s_ = bleeds ? since_pool_s_ + t.dt_s : 0;
  if (since_pool_s_ >= pool_each_s) well_up(t.time_s);
  since_wash_s_ += t.dt_s;
  since_dry_s_ += t.dt_s;
  if (since_wash_s_ >= wash_each_s) {
    for (const Tick* of : {&t, other}) {
      if (of && of->runs) wash(*of);
      if (of && of->takes_up) take_up(*of);
    }
    since_wash_s_ = 0;
  }
  if (since_dry_s_ >= dry_each_s) dry();
}

// The cells go along with the drill, in whole cells; what they leave behind is forgotten.
void BoneDust::stay_about(Vec3 p) {
  int base[3];
  bool stays = any();
  for (int a = 0; a < 3; ++a) {
    base[a] = int(std::lround(p[a] / cell_mm)) - side / 2;
    stays = stays && std::abs(base[a] - base_[a]) * cell_mm <= stays_within_mm;
  }
  if (stays) return;
  std::vector<float> dust(std::size_t(side) * side * side), water(dust.size()), blood(dust.size());
  for (int k = 0; k < side && any(); ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const int from[3] = {i + base[0] - base_[0], j + base[1] - base_[1], k + base[2] - base_[2]};
        if (std::any_of(from, from + 3, [](int n) { return n < 0 || n >= side; })) continue;
        dust[cell(i, j, k)] = dust_[cell(from[0], from[1], from[2])];
        water[cell(i, j, k)] = water_[cell(from[0], from[1], from[2])];
        blood[cell(i, j, k)] = blood_[cell(from[0], from[1], from[2])];
      }
  dust_ = std::move(dust);
  water_ = std::move(water);
  blood_ = std::move(blood);
  std::copy(base, base + 3, base_);
}

// A grain lies somewhere about the drill, at any height above its tip: where a surface is there, it is seen on it.
void BoneDust::throw_grain(const Tick& t) {
  const double turn = 2 * M_PI * unit_of(3 * grains_), far = unit_of(3 * grains_ + 1), up = unit_of(3 * grains_ + 2);
  ++grains_;
  const Mat3 frame = haptics::frame_along(t.axis);
  const double radius = t.radius_mm * (near_radii + far_radii * far * far);
  const Vec3 p = (t.tip_mm + t.axis * (up * column_mm) + frame.column[0] * (radius * std::cos(turn)) +
                  frame.column[1] * (radius * std::sin(turn))) /
                 cell_mm;
  int low[3];
  double share[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = int(std::floor(p[a]));
    share[a] = p[a] - low[a];
    low[a] -= base_[a];
    if (low[a] < 0 || low[a] + 1 >= side) return;
  }
  for (int n = 0; n < 8; ++n) {
    double part = grain;
    for (int a = 0; a < 3; ++a) part *= n >> a & 1 ? share[a] : 1 - share[a];
    float& of = dust_[cell(low[0] + (n & 1), low[1] + (n >> 1 & 1), low[2] + (n >> 2 & 1))];
    of = std::min(1.0f, of + float(part));
  }
  ++version_;
}

// Calls `f` with the number and the middle of each cell of a box.
template <class F>
void BoneDust::for_box(Vec3 low_mm, Vec3 high_mm, const F& f) {
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    from[a] = std::max(0, int(std::ceil(low_mm[a] / cell_mm)) - base_[a]);
    to[a] = std::min(side - 1, int(std::floor(high_mm[a] / cell_mm)) - base_[a]);
  }
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int i = from[0]; i <= to[0]; ++i)
        f(cell(i, j, k), first_mm() + Vec3{double(i), double(j), double(k)} * cell_mm);
}

// Calls `f` with the number of each cell of a ball.
template <class F>
void BoneDust::for_ball(Vec3 middle_mm, double radius_mm, const F& f) {
  const Vec3 reach{radius_mm, radius_mm, radius_mm};
  for_box(middle_mm - reach, middle_mm + reach, [&](std::size_t at, Vec3 p) {
    const Vec3 off = p - middle_mm;
    if (dot(off, off) <= radius_mm * radius_mm) f(at);
  });
}

// Water flows over the cutter and out of the hole: it wets what it reaches, and takes powder with it.
void BoneDust::wash(const Tick& t) {
  const double flow = t.water_ml_per_min / usual_ml_per_min * since_wash_s_;
  if (!(flow > 0)) return;
  const float stays = float(std::exp(-washes_per_s * flow)), dry = float(std::exp(-wets_per_s * flow));
  const Vec3 end = t.tip_mm + t.axis * column_mm;
  const double reach = t.radius_mm + wets_beyond_mm;
  Vec3 low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = std::min(t.tip_mm[a], end[a]) - reach;
    high[a] = std::max(t.tip_mm[a], end[a]) + reach;
  }
  for_box(low, high, [&](std::size_t at, Vec3 p) {
    const Vec3 off = p - t.tip_mm, beside = off - t.axis * std::clamp(dot(off, t.axis), 0.0, column_mm);
    if (dot(beside, beside) > reach * reach) return;
    dust_[at] *= stays;
    blood_[at] *= stays;
    water_[at] = 1 - (1 - water_[at]) * dry;
  });
  for (Pool& pool : pools_)
    if (reaches(pool.of, t.tip_mm, wets_beyond_mm)) thin(pool, double(stays));
  ++version_;
}

void BoneDust::take_up(const Tick& t) {
  const float stays = float(std::exp(-takes_up_per_s * since_wash_s_));
  for_ball(t.tip_mm, takes_up_mm, [&](std::size_t at) {
    blood_[at] *= stays;
    water_[at] *= stays;
  });
  for (Pool& pool : pools_)
    if (reaches(pool.of, t.tip_mm, 0))
      thin(pool, std::max(0.0, 1 - haptics::taken_ml_per_s * since_wash_s_ / std::max(pool.ml, 1e-6)));
  ++version_;
}

// Its level falls to that share: what is left of it wells up again.
void BoneDust::thin(Pool& pool, double share) {
  const auto fade = [&](std::size_t at) { blood_[at] *= float(share); };
  for_ball(pool.of.mouth_mm, widest_pool_mm, fade);
  for_ball(pool.of.source_mm, pool.of.width_mm, fade);
  pool.ml *= share;
}

// It fills the hole; what is more is a ball about its mouth, and of that what is more than the widest runs down.
void BoneDust::well_up(double time_s) {
  for (Pool& pool : pools_) {
    if (time_s >= pool.of.begin_s && time_s < pool.of.end_s) pool.ml += pool.of.ml_per_min / 60 * since_pool_s_;
    if (!(pool.ml > 0)) continue;
    const Vec3 up = pool.of.mouth_mm - pool.of.source_mm;
    const double wide_mm = 0.5 * pool.of.width_mm, deep_mm = norm(up),
                 hole_ml = 1e-3 * pi * wide_mm * wide_mm * deep_mm;
    const auto fill = [&](std::size_t at) { blood_[at] = 1; };
    const double filled = hole_ml > 0 ? std::min(1.0, pool.ml / hole_ml) : 1;
    for (double far = 0; far <= filled * deep_mm; far += cell_mm)
      for_ball(pool.of.source_mm + up * (far / std::max(deep_mm, 1e-9)), wide_mm + cell_mm, fill);
    const double whole_mm = std::cbrt(3e3 * std::max(0.0, pool.ml - hole_ml) / (4 * pi)),
                 radius_mm = std::min(whole_mm, widest_pool_mm);
    for_ball(pool.of.mouth_mm, radius_mm, fill);
    const double runs_mm = std::min((whole_mm - radius_mm) * 12, side * cell_mm);
    for (double far = 0; far < runs_mm; far += run_mm)
      for_ball(pool.of.mouth_mm + down_ * (radius_mm + far), run_mm, fill);
  }
  since_pool_s_ = 0;
  ++version_;
}

void BoneDust::dry() {
  const float stays = float(std::exp(-since_dry_s_ / dries_in_s));
  for (float& w : water_) w *= stays;
  since_dry_s_ = 0;
  ++version_;
}

std::vector<std::uint8_t> BoneDust::texels() const {
  std::vector<std::uint8_t> out(3 * dust_.size());
  for (std::size_t n = 0; n < dust_.size(); ++n) {
    out[3 * n] = std::uint8_t(dust_[n] * 255 + 0.5f);
    out[3 * n + 1] = std::uint8_t(water_[n] * 255 + 0.5f);
    out[3 * n + 2] = std::uint8_t(blood_[n] * 255 + 0.5f);
  }
  return out;
}

DustWatch::Hands DustWatch::hands_of(const haptics::RecordingHeader& h, const session::HandWatch::ShapeAt& shape_at) {
  Hands hands{session::HandWatch(h, shape_at), std::nullopt};
  if (h.second) hands.second.emplace(*h.second, shape_at);
  return hands;
}

DustWatch::DustWatch(std::shared_ptr<BoneDust> dust, const haptics::RecordingHeader& h, std::uint64_t drilled,
                     session::HandWatch::ShapeAt shape_at)
    : dust_(std::move(dust)),
      takes_back_(h.drilling.drill && h.drilling.undo_steps > 0),
      drilled_(h.drilling.drill ? drilled : 0),
      water_ml_per_min_(h.drilling.irrigation_ml_per_min),
      begin_(hands_of(h, shape_at)),
      hands_(begin_) {
  for (const haptics::BeltToolParams& t : h.tools) held_.push_back(held_of(t, t.cuts));
  if (h.tools.empty()) held_.push_back(held_of(h.tool, true));
  if (h.second && !h.second->switch_only) second_ = held_of(h.second->tool, false);
}

DustWatch::Held DustWatch::held_of(const haptics::ToolParams& tool, bool cuts) {
  const haptics::ToolParams whole = haptics::own_tool(tool);
  const haptics::ToolKind& kind = haptics::tool_kind(whole.tool);
  return {cuts && kind.rotates(), kind.rinses, kind.takes_up, 0.5 * whole.tool_diameter_mm};
}

void DustWatch::bleed(std::vector<Bleeding> all, Vec3 down) { dust_->bleed(std::move(all), down); }

BoneDust::Tick DustWatch::tick_of(const Held& held, const haptics::ServoFrame& f, bool works) const {
  BoneDust::Tick tick;
  tick.dt_s = f.dt_s;
  tick.time_s = f.time_s;
  tick.runs = (held.rotates || held.rinses) && works;
  tick.takes_up = held.takes_up && works;
  tick.cuts = tick.runs && held.rotates && f.touched > 0 && (drilled_ >> f.touched & 1);
  tick.tip_mm = {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
  tick.axis = normalized({f.axis[0], f.axis[1], f.axis[2]});
  tick.radius_mm = held.radius_mm;
  tick.water_ml_per_min = held.rinses ? rinse_ml_per_min : water_ml_per_min_;
  return tick;
}

void DustWatch::look(const haptics::ServoFrame& f, bool shown, const haptics::ServoFrame* second) {
  ++looked_;
  session::HandWatch& hand = hands_.first;
  hand.look(f);
  if (second && hands_.second) hands_.second->look(*second, hand);
  const bool pedal = hand.works() && (f.buttons & haptics::Drilling::pedal);
  if (takes_back_ && hand.command() == haptics::belt_command::reset && hand.works() && !pedal && dust_->any())
    dust_->clear();
  if (!shown) return;
  const bool lifted = f.buttons & haptics::haptic_button::lifted;
  const BoneDust::Tick tick = tick_of(held_[hand.tool()], f, pedal && !lifted);
  if (!second || !second_) return dust_->add(tick);
  const bool sucks = hands_.second->works() && (second->buttons & haptics::Drilling::pedal) &&
                     !(second->buttons & haptics::haptic_button::lifted);
  const BoneDust::Tick other = tick_of(*second_, *second, sucks);
  dust_->add(tick, &other);
}

void DustWatch::go_to(const std::vector<haptics::ServoFrame>& frames, std::size_t count,
                      const std::vector<haptics::ServoFrame>& second) {
  const auto after = std::upper_bound(kept_.begin(), kept_.end(), count,
                                      [](std::size_t n, const Kept& kept) { return n < kept.looked; });
  if (after != kept_.begin() && (count < looked_ || std::prev(after)->looked > looked_)) {
    const Kept& kept = *std::prev(after);
    dust_->become(kept.dust);
    hands_ = kept.hands;
    looked_ = kept.looked;
  } else if (count < looked_) {
    dust_->clear();
    looked_ = 0;
    hands_ = begin_;
  }
  last_looked_ = count - looked_;
  while (looked_ < count) {
    look(frames[looked_], true, second.empty() ? nullptr : &second[looked_]);
    if (looked_ % keep_each_ == 0 && (kept_.empty() || kept_.back().looked < looked_)) keep();
  }
}

// Of a long recording fewer, so that what is kept stays below some 20 MB.
void DustWatch::keep() {
  kept_.push_back({looked_, hands_, *dust_});
  if (kept_.size() < most_kept) return;
  keep_each_ *= 2;
  kept_.erase(std::remove_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.looked % keep_each_ != 0; }),
              kept_.end());
}

DustWatch dust_watch_of(const session::Playback& playback) {
  return {std::make_shared<BoneDust>(), playback.header(), haptics::drilled_shapes(playback.loaded().manifest.haptic)};
}

}  // namespace trephine::scene
