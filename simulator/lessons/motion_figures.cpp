// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/motion_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "base/pi.h"
#include "base/vec3.h"
#include "haptics/haptic_state.h"
#include "haptics/tool_belt.h"

namespace trephine::lessons {
namespace {

constexpr double piece_s = 0.01, moving_mm_per_s = 5, min_movement_s = 0.2;
constexpr double tremor_low_hz = 8, tremor_high_hz = 12;

using haptics::ServoFrame;

double size_of(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
bool is_finite(const ServoFrame& f) {
  for (int a = 0; a < 3; ++a)
    if (!std::isfinite(f.tip_mm[a]) || !std::isfinite(f.proxy_mm[a]) || !std::isfinite(f.force_n[a])) return false;
  return true;
}
// Whether the hand went on from the frame before.
bool goes_on(const ServoFrame& before, const ServoFrame& f) {
  return f.tick == before.tick + 1 &&
         haptics::belt_button::tool(f.buttons) == haptics::belt_button::tool(before.buttons) &&
         !((f.buttons | before.buttons) & haptics::haptic_button::lifted) &&
         !((f.faults | before.faults) & haptics::haptic_fault::device_lost);
}

// A piece of 10 ms: means, and whether it follows on the one before.
struct Piece {
  Vec3 tip_mm;
  bool touching = false, follows = false;
};

std::vector<Piece> pieces_of(const std::vector<ServoFrame>& frames) {
  std::vector<Piece> pieces;
  Piece now;
  double count = 0, begin_s = 0;
  bool broken = true;  // the next piece does not follow
  const auto end = [&](bool whole) {
    if (count > 0 && whole) {
      now.tip_mm = now.tip_mm * (1 / count);
      now.follows = !broken && !pieces.empty();
      pieces.push_back(now);
      broken = false;
    }
    now = {};
    count = 0;
  };
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const ServoFrame& f = frames[n];
    if (!is_finite(f) || (n > 0 && !goes_on(frames[n - 1], f))) {
      end(false);
      broken = true;
      if (!is_finite(f)) continue;
    }
    if (count == 0) begin_s = f.time_s - f.dt_s;
    now.tip_mm = now.tip_mm + Vec3{f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]};
    now.touching = now.touching || f.touched != 0 || f.inside != 0;
    ++count;
    if (f.time_s - begin_s >= piece_s - 1e-9) end(true);
  }
  return pieces;
}

struct Movements {
  double way_mm = 0, straight_mm = 0, arc = 0, seconds = 0;
};
Movements movements_of(const std::vector<Piece>& pieces) {
  Movements out;
  std::vector<double> speed;
  std::size_t begin = 0;
  double way = 0;
  const auto end = [&](std::size_t last) {
    const double seconds = double(speed.size()) * piece_s;
    if (seconds >= min_movement_s - 1e-9) {
      out.way_mm += way;
      out.straight_mm += norm(pieces[last].tip_mm - pieces[begin].tip_mm);
      out.arc += seconds * spectral_arc_length(speed, 1 / piece_s);
      out.seconds += seconds;
    }
    speed.clear();
    way = 0;
  };
  for (std::size_t n = 1; n < pieces.size(); ++n) {
    const double step = norm(pieces[n].tip_mm - pieces[n - 1].tip_mm);
    if (!pieces[n].follows || step <= moving_mm_per_s * piece_s) {
      end(n - 1);
      continue;
    }
    if (speed.empty()) begin = n - 1;
    speed.push_back(step / piece_s);
    way += step;
  }
  if (!pieces.empty()) end(pieces.size() - 1);
  return out;
}

// Mean square of the place between 8 and 12 Hz in whole windows of a second, in um^2.
std::optional<double> tremor_um(const std::vector<Piece>& pieces) {
  constexpr std::size_t window = 100;
  double sum = 0;
  std::size_t windows = 0, run = 0;
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    run = pieces[n].follows ? run + 1 : 1;
    if (run < window) continue;
    run = 0;
    double power = 0;
    const Vec3 from = pieces[n + 1 - window].tip_mm, way = pieces[n].tip_mm - from;
    for (int bin = int(tremor_low_hz); bin <= int(tremor_high_hz); ++bin)
      for (int axis = 0; axis < 3; ++axis) {
        std::complex<double> total = 0;
        for (std::size_t k = 0; k < window; ++k) {
          // A Hann window, so that a steady way leaks nothing into the band.
          const double hann = 1 - std::cos(2 * pi * double(k) / double(window));
          const Vec3 p = pieces[n + 1 - window + k].tip_mm - from - way * (double(k) / double(window - 1));
          total += hann * p[axis] * std::polar(1.0, -2 * pi * double(bin) * double(k) / double(window));
        }
        power += 2 * std::norm(total) / double(window * window) / 1.5;  // 1.5: the window's mean square
      }
    sum += power * 1e6;
    ++windows;
  }
  if (windows == 0) return std::nullopt;
  return std::sqrt(sum / double(windows));
}

}  // namespace

double spectral_arc_length(const std::vector<double>& speed, double rate_hz) {
  constexpr double max_hz = 10, min_amplitude = 0.05;
  std::size_t length = 1;
  while (length < speed.size()) length *= 2;
  length *= 16;
  const std::size_t bins = std::min(length / 2, std::size_t(std::floor(max_hz * double(length) / rate_hz))) + 1;
  std::vector<double> amplitude(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::complex<double> turn = std::polar(1.0, -2 * pi * double(bin) / double(length));
    std::complex<double> total = 0;
    for (std::size_t k = speed.size(); k-- > 0;) total = total * turn + speed[k];
    amplitude[bin] = std::abs(total);
  }
  const double most = *std::max_element(amplitude.begin(), amplitude.end());
  std::size_t last = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    amplitude[bin] /= most;
    if (amplitude[bin] >= min_amplitude) last = bin;
  }
  double arc = 0;
  for (std::size_t bin = 1; bin <= last; ++bin)
    arc += std::hypot(1 / double(last), amplitude[bin] - amplitude[bin - 1]);
  return -arc;
}

std::vector<std::pair<std::string, double>> motion_figures(const std::vector<ServoFrame>& frames) {
  std::vector<std::pair<std::string, double>> out;
  const std::vector<Piece> pieces = pieces_of(frames);
  double path = 0, idle = 0;
  for (std::size_t n = 1; n < pieces.size(); ++n) {
    if (!pieces[n].follows) continue;
    const double step = norm(pieces[n].tip_mm - pieces[n - 1].tip_mm);
    path += step;
    if (step <= moving_mm_per_s * piece_s && !pieces[n].touching) idle += piece_s;
  }
  double tissue = 0, force = 0, tissue_force = 0, contact_force = 0, contact_s = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const ServoFrame& f = frames[n];
    if (!is_finite(f)) continue;
    const double newtons = size_of(f.force_n);
    force += newtons * f.dt_s;
    if (f.touched != 0) contact_force += newtons * f.dt_s, contact_s += f.dt_s;
    if (f.inside == 0) continue;
    tissue_force += newtons * f.dt_s;
    if (n > 0 && frames[n - 1].inside != 0 && is_finite(frames[n - 1]) && goes_on(frames[n - 1], f))
      tissue += std::sqrt(std::pow(f.proxy_mm[0] - frames[n - 1].proxy_mm[0], 2) +
                          std::pow(f.proxy_mm[1] - frames[n - 1].proxy_mm[1], 2) +
                          std::pow(f.proxy_mm[2] - frames[n - 1].proxy_mm[2], 2));
  }
  const Movements m = movements_of(pieces);
  out.emplace_back("path_mm", path);
  out.emplace_back("tissue_path_mm", tissue);
  if (m.way_mm > 0) out.emplace_back("economy_ratio", m.straight_mm / m.way_mm);
  if (m.seconds > 0) out.emplace_back("smoothness_sparc", m.arc / m.seconds);
  out.emplace_back("idle_s", idle);
  if (const std::optional<double> tremor = tremor_um(pieces)) out.emplace_back("tremor_um", *tremor);
  out.emplace_back("force_integral_n_s", force);
  out.emplace_back("tissue_force_integral_n_s", tissue_force);
  if (contact_s > 0) out.emplace_back("contact_force_n", contact_force / contact_s);
  return out;
}

std::vector<ExpertBand> expert_bands(const std::vector<std::vector<std::pair<std::string, double>>>& experts) {
  std::vector<std::pair<std::string, std::vector<double>>> values;
  for (const auto& figures : experts)
    for (const auto& [name, value] : figures) {
      const std::string& wanted = name;
      auto at = std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == wanted; });
      if (at == values.end()) at = values.insert(values.end(), {name, {}});
      at->second.push_back(value);
    }
  std::vector<ExpertBand> bands;
  for (auto& [name, v] : values) {
    std::sort(v.begin(), v.end());
    const double beside = v.size() >= 10 ? 0.1 * double(v.size() - 1) : 0;
    const auto at = [&, &sorted = v](double place) {
      const std::size_t low = std::size_t(place), high = std::min(low + 1, sorted.size() - 1);
      return sorted[low] + (place - double(low)) * (sorted[high] - sorted[low]);
    };
    bands.push_back({name, v.size(), at(beside), at(double(v.size() - 1) - beside)});
  }
  return bands;
}

// Nearer to the band than this part of its edge a hand is as good as in it: few experts make a band that is narrow by
// chance.
constexpr double beyond_ratio = 0.05;

std::vector<std::string> motion_advice(const std::vector<std::pair<std::string, double>>& figures,
                                       const std::vector<ExpertBand>& bands, texts::Language language) {
  using texts::Wording;
  struct Words {
    const char* name;
    Wording sentence;  // with places for the value and for the experts' two
    Wording too_high, too_low;
  };
  static const Words words[] = {
      {"path_mm",
       {{"Your hand moved {} mm; experts' lie between {} and {}.",
         "Ihre Hand legte {} mm zurück; bei Erfahrenen {} bis {}."}},
       {{"Plan the way before you move.", "Planen Sie den Weg, bevor Sie sich bewegen."}},
       {{"", ""}}},
      {"tissue_path_mm",
       {{"Your tool went {} mm through tissue; experts' lie between {} and {}.",
         "Ihr Instrument ging {} mm durch Gewebe; bei Erfahrenen {} bis {}."}},
       {{"Aim in the open and go in once, without searching.",
         "Zielen Sie außen und gehen Sie einmal hinein, ohne zu suchen."}},
       {{"", ""}}},
      {"economy_ratio",
       {{"Your movements were straight by a ratio of {}; experts' lie between {} and {}.",
         "Ihre Bewegungen waren zu einem Anteil von {} gerade; bei Erfahrenen {} bis {}."}},
       {{"", ""}},
       {{"Go from place to place on one line.", "Gehen Sie auf einer Linie von Ort zu Ort."}}},
      {"smoothness_sparc",
       {{"The smoothness of your movements was {}; experts' lie between {} and {}.",
         "Die Glätte Ihrer Bewegungen war {}; bei Erfahrenen {} bis {}."}},
       {{"", ""}},
       {{"Move slowly and without stops; support the hand.",
         "Bewegen Sie sich langsam und ohne Halt; stützen Sie die Hand."}}},
      {"idle_s",
       {{"Your hand was at rest for {} s; experts' lie between {} and {}.",
         "Ihre Hand ruhte {} s; bei Erfahrenen {} bis {}."}},
       {{"Know the next step before the last one ends.", "Kennen Sie den nächsten Schritt, bevor der letzte endet."}},
       {{"", ""}}},
      {"tremor_um",
       {{"Your tremor was {} um; experts' lie between {} and {}.", "Ihr Tremor war {} um; bei Erfahrenen {} bis {}."}},
       {{"Support the wrist, and hold the tool nearer to its tip.",
         "Stützen Sie das Handgelenk, und halten Sie das Instrument näher an der Spitze."}},
       {{"", ""}}},
      {"force_integral_n_s",
       {{"You pressed for {} N s; experts' lie between {} and {}.", "Sie drückten {} N s; bei Erfahrenen {} bis {}."}},
       {{"Press less, or for less long.", "Drücken Sie schwächer oder kürzer."}},
       {{"", ""}}},
      {"tissue_force_integral_n_s",
       {{"You pressed within tissue for {} N s; experts' lie between {} and {}.",
         "Sie drückten im Gewebe {} N s; bei Erfahrenen {} bis {}."}},
       {{"Let the tool find its way.", "Lassen Sie das Instrument seinen Weg finden."}},
       {{"", ""}}},
      {"contact_force_n",
       {{"In contact you pressed with {} N; experts' lie between {} and {}.",
         "Bei Berührung drückten Sie mit {} N; bei Erfahrenen {} bis {}."}},
       {{"Touch more lightly.", "Berühren Sie leichter."}},
       {{"", ""}}}};
  std::vector<std::string> out;
  for (const ExpertBand& band : bands)
    for (const auto& [name, value] : figures)
      for (const Words& w : words) {
        if (name != band.name || name != w.name) continue;
        const char* advice = (value > band.high + beyond_ratio * std::abs(band.high) ? w.too_high
                              : value < band.low - beyond_ratio * std::abs(band.low) ? w.too_low
                                                                                     : Wording{{"", ""}})
                                 .of(language);
        if (*advice == '\0') continue;
        const auto plain = [](double v) {
          return std::abs(v) >= 100 ? fmt::format("{:.0f}", v) : fmt::format("{:.3g}", v);
        };
        out.push_back(
            fmt::format(fmt::runtime(w.sentence.of(language)), plain(value), plain(band.low), plain(band.high)) + " " +
            advice);
      }
  return out;
}

}  // namespace trephine::lessons
