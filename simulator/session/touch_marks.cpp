// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/touch_marks.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/refusal.h"

namespace trephine::session {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double share = 0.4;        // of width and height, from the middle to a mark
constexpr double restless_mm = 1.5;  // a touch that moved farther is none
constexpr double before_mm = 20;     // how far before the screen the last place lies at least
constexpr int max_tries = 3;
const char* const names[] = {"upper left", "upper right", "lower right", "lower left", "middle"};

// A device whose button says when it is at a mark.
class Toucher {
 public:
  Toucher(device::Device& device, const RegisterParams& p, const std::atomic<bool>& stop)
      : device_(device), p_(p), stop_(stop), due_(Clock::now()) {}

  // The mean place of a touch: the button was up, and is then held.
  Vec3 touch(const std::string& what) {
    for (int tries = 0; tries < max_tries; ++tries) {
      double waited_s = 0;
      while (tick().buttons & 1) wait(waited_s, what);
      while (!(tick().buttons & 1)) wait(waited_s, what);
      Vec3 sum, low = at_, high = at_;
      int count = 0;
      for (double t = 0; t < p_.touch_s; t += 1 / p_.register_hz) {
        if (!(tick().buttons & 1)) break;
        sum += at_;
        ++count;
        for (int n = 0; n < 3; ++n) low[n] = std::min(low[n], at_[n]), high[n] = std::max(high[n], at_[n]);
      }
      if (count >= std::max(1, int(0.9 * p_.touch_s * p_.register_hz)) && norm(high - low) <= restless_mm)
        return sum / double(count);
    }
    throw refusal("marks", what + ": was not held still for long enough", {"hold it still, or lower `touch_s`"});
  }

 private:
  void wait(double& waited_s, const std::string& what) {
    waited_s += 1 / p_.register_hz;
    if (waited_s > p_.touch_wait_s) throw refusal("marks", what + ": nobody touched it", {"raise `touch_wait_s`"});
  }
  device::DeviceReading tick() {
    if (stop_.load(std::memory_order_relaxed)) throw Cancelled();
    if (p_.in_real_time) {
      due_ += std::chrono::nanoseconds(std::llround(1e9 / p_.register_hz));
      if (Clock::now() > due_ + std::chrono::milliseconds(5)) due_ = Clock::now();
      std::this_thread::sleep_until(due_);
    }
    device::DeviceReading r;
    const bool there = device_.read(begun_ ? 1 / p_.register_hz : 0, r);
    begun_ = true;
    device_.send({});
    if (!there || !is_finite(r.tip_mm)) throw Error(ExitCode::io, "", "device", "is lost");
    at_ = r.tip_mm;
    return r;
  }

  device::Device& device_;
  const RegisterParams& p_;
  const std::atomic<bool>& stop_;
  Clock::time_point due_;
  Vec3 at_;
  bool begun_ = false;
};

}  // namespace

std::vector<Vec3> screen_marks(const RegisterParams& p) {
  const double x = share * p.screen_width_mm, y = share * p.screen_height_mm;
  return {{-x, y, 0}, {x, y, 0}, {x, -y, 0}, {-x, -y, 0}, {0, 0, 0}};
}

std::string marks_sheet(const RegisterParams& p, const std::string& flip) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Marks to be touched</title>\n<style>\n"
      "html, body { margin: 0; height: 100%; background: #000; overflow: hidden }\n"
      "svg { width: 100vw; height: 100vh; transform: " +
      (flip.empty() ? "none" : flip) +
      " }\ntext { fill: #fff; font: 8px sans-serif } path { stroke: #fff; stroke-width: .6 }\n</style></head><body>\n";
  out += fmt::format("<svg viewBox=\"{} {} {} {}\" preserveAspectRatio=\"none\">\n", -p.screen_width_mm / 2,
                     -p.screen_height_mm / 2, p.screen_width_mm, p.screen_height_mm);
  const std::vector<Vec3> marks = screen_marks(p);
  for (std::size_t n = 0; n < marks.size(); ++n)
    out += fmt::format("<path d=\"M{0} {1}h16m-8 -8v16\"/><text x=\"{2}\" y=\"{3}\">{4}</text>\n", marks[n].x - 8,
                       -marks[n].y, marks[n].x + 3, -marks[n].y - 3, n + 1);
  return out + "</svg></body></html>\n";
}

device::ScreenRegistration register_screen(device::Device& device, const RegisterParams& p,
                                           const std::atomic<bool>& stop,
                                           const std::function<void(const std::string&)>& say) {
  Toucher toucher(device, p, stop);
  const std::vector<Vec3> marks = screen_marks(p);
  std::vector<Vec3> touched;
  for (std::size_t n = 0; n < marks.size(); ++n) {
    const std::string what = fmt::format("mark {} ({})", n + 1, names[n]);
    say(fmt::format("touch {} as you see it, and hold button 1 for {:g} s", what, p.touch_s));
    touched.push_back(toucher.touch(what));
  }
  device::ScreenRegistration r = device::fit_screen(touched, marks, p.fit_scale);
  r.height_mm = p.screen_height_mm;
  std::size_t worst = 0;
  for (std::size_t n = 0; n < marks.size(); ++n) {
    const double off = norm(r.before_screen(touched[n]) - marks[n]);
    if (off > norm(r.before_screen(touched[worst]) - marks[worst])) worst = n;
  }
  if (r.worst_mm > p.largest_residual_mm)
    throw refusal("marks",
                  fmt::format("mark {} ({}) lies {:.1f} mm from where it was touched, and at most {:g} mm are allowed "
                              "(RMS of all {:.1f} mm): was it touched, and are width and height those of the picture?",
                              worst + 1, names[worst], r.worst_mm, p.largest_residual_mm, r.rms_mm),
                  {"touch them again, measure `screen_width_mm` and `screen_height_mm`, or raise "
                   "`largest_residual_mm`"});
  say("draw the tool at least 20 mm from the screen towards you, and hold button 1 again");
  const double towards = r.before_screen(toucher.touch("the place before the screen")).z;
  if (towards < before_mm)
    throw refusal("marks",
                  fmt::format("the last place lies {:.0f} mm before the screen, not {:g}: the marks are those of a "
                              "mirror image, so the picture is not mirrored as the bench needs it, or nobody drew the "
                              "tool back",
                              towards, before_mm),
                  {"draw the tool back, or set another `mirror`"});
  return r;
}

}  // namespace trephine::session
