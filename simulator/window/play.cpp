// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/play.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <future>
#include <optional>
#include <thread>

#include "base/cpu_time.h"
#include "base/error.h"
#include "base/png.h"
#include "base/rank.h"
#include "base/secret.h"
#include "base/write_file.h"
#include "window/controls.h"
#include "window/glfw_window.h"
#include "window/hud.h"
#include "window/reduction.h"
#include "window/remote.h"

namespace trephine::window {
namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

constexpr std::size_t kept_times = 200;
constexpr double cast_ms = 120;  // of rays while the view moves: at least five pictures a second with the rest
constexpr std::uint64_t first_pictures = 3;  // that compile shaders

double median(std::deque<double> values) { return values.empty() ? 0 : median_of(values); }

class Loop {
 public:
  Loop(Player& player, GlfwWindow& window, const WindowParams& params, const PlayOptions& options)
      : player_(player),
        window_(window),
        params_(params),
        hud_(window, params.letters, params.language),
        software_(player.view().stage().driver().software),
        reduction_(params.target_ms, options.view, params.fine_mm, software_) {
    screen_.panels_shown = params.panels;
    screen_.language = params.language;
    screen_.metal = params.xray_metal;
    screen_.mirror = params.mirror;
    window.set_mirror(params.mirror);
    screen_.hand = options.hand;
    reduce();
  }

  // One picture. Returns false where the window is to be closed.
  bool turn(double wait_s, Remote* remote, HeadReceiver* head) {
    const std::vector<InputEvent>& events = window_.events(wait_s);
    const auto begin = Clock::now();
    const double cpu_begin_ms = process_cpu_ms();
    const double wall_s = std::min(1.0, std::chrono::duration<double>(begin - last_).count());
    last_ = begin;
    int &width = screen_.cursor.width, &height = screen_.cursor.height;
    window_.width_height(width, height);
    controls_.apply(events, player_, screen_, hud_.has_mouse(), hud_.has_keys());
    controls_.hold(wall_s, player_, screen_);
    if (remote) remote->poll([&](const std::string& line) { return answer_line(line, player_, screen_); });
    if (head) head->poll(player_.head_mm);
    if (const auto place = window_.place()) player_.window_place = *place;
    player_.step(wall_s);
    if (player_.stages() != stages_) reduce();
    if (width > 0 && height > 0) {
      picture(width, height);
      mirrored_.flip(screen_.mirror, width, height);
    }
    window_.swap();
    if (window_.reset()) throw Error(ExitCode::io, "", "OpenGL", "the graphics driver was reset");
    const double ms = 1000 * since(begin), cpu_ms = process_cpu_ms() - cpu_begin_ms;
    keep(times_, ms);
    keep(cpu_times_, cpu_ms);
    shown_.ms = ms;
    shown_.per_s = wall_s > 0 ? 0.9 * shown_.per_s + 0.1 / std::max(wall_s, ms / 1000) : 0;
    ++pictures_;
    if (width > 0 && height > 0)  // a window that shows nothing is quick for no reason
      adapt(software_ ? software_cost_ms(ms, cpu_ms, std::thread::hardware_concurrency()) : ms);
    if (pictures_ > first_pictures) longest_ms_ = std::max(longest_ms_, 1000 * since(begin));
    return !window_.closed() && !player_.quits();
  }

  double typical_ms() const { return median(times_); }
  double typical_cpu_ms() const { return median(cpu_times_); }
  double last_ms() const { return times_.empty() ? 0 : times_.back(); }
  std::uint64_t pictures() const { return pictures_; }
  double longest_ms() const { return longest_ms_; }
  const std::string& reduced() const { return reduced_; }

 private:
  static void keep(std::deque<double>& times, double ms) {
    times.push_back(ms);
    if (times.size() > kept_times) times.pop_front();
  }

  void reduce() {
    stages_ = player_.stages();
    player_.view().stage().set_quality(reduction_.view(), reduction_.scale(), reduction_.coarse(), cast_ms);
    told_reduced_ = false;
    if (!player_.view().stage().coarse_comes()) tell_reduced();
  }

  // While coarser triangles come, pictures say nothing of what is reduced.
  void adapt(double ms) {
    if (player_.view().stage().coarse_comes() || (player_.lesson() && player_.lesson()->judging())) return;
    tell_reduced();
    if (player_.view().stage().renderer().rays().scale() > 0) return;  // rays fit themselves to the time they have
    if (pictures_ > first_pictures && reduction_.look(ms)) reduce();
  }

  void tell_reduced() {
    if (std::exchange(told_reduced_, true)) return;
    shown_.reduced = reduction_.text(params_.language);
    reduced_ = reduction_.text(texts::Language::english);
  }

  void picture(int width, int height) {
    player_.view().stage().draw(
        player_.view().camera, width, height, [](render::Eye eye) { render::bind_screen(eye); }, player_.head_mm);
    if (player_.takes_shot()) take_shot(width, height);
    const scene::ViewParams::Stereo stereo = player_.view().stage().view().stereo;
    if (stereo != scene::ViewParams::Stereo::side_by_side && stereo != scene::ViewParams::Stereo::top_bottom)
      hud_.draw(player_, screen_, shown_);
  }

  // A folder that cannot be written is no reason to end somebody's session.
  void take_shot(int width, int height) {
    const std::filesystem::path file = player_.next_file("picture", ".png");
    try {
      const scene::Picture seen = render::read_picture(width, height);
      write_file(file, png_of(seen.width, seen.height, 3, seen.rgb));
      const fluoro::MadeFluoro* xray = player_.xrays() ? player_.xrays()->last() : nullptr;
      if (xray && (player_.live() || player_.shots()->shown() >= 0))
        write_file(file.parent_path() / (file.stem().string() + "-xray.png"),
                   png_of(xray->picture.size, xray->picture.size, 1,
                          fluoro::shown_grey(xray->picture, screen_.metal, player_.xrays()->flipped)));
      screen_.answer = texts::Note{texts::NoteId::verbatim, {file.string()}};
    } catch (const Error& e) {
      if (e.file().empty()) throw;  // what the driver said
      player_.notes.add({texts::NoteId::file_not_written, {e.file(), e.what()}});
    }
  }

  Player& player_;
  GlfwWindow& window_;
  const WindowParams params_;
  Controls controls_;
  Screen screen_;
  Hud hud_;
  const bool software_;
  Reduction reduction_;
  render::MirroredScreen mirrored_;
  PictureTimes shown_;
  std::deque<double> times_, cpu_times_;
  double longest_ms_ = 0;
  std::string reduced_;
  bool told_reduced_ = false;
  std::uint64_t pictures_ = 0;
  int stages_ = 0;
  Clock::time_point last_ = Clock::now();
};

}  // namespace

PlayOutcome play(const PlayOptions& options, const WindowParams& params, int remote_port, Clock::time_point begun,
                 const std::atomic<bool>& stop, const std::function<void(const std::string& line)>& say) {
  const bool quad = options.view.stereo == scene::ViewParams::Stereo::quad_buffer;
  // The case is loaded while the window opens.
  auto loading = std::async(std::launch::async, [&] { return std::make_unique<Player>(options, stop); });
  std::optional<GlfwWindow> window;
  std::optional<Remote> remote;
  std::optional<HeadReceiver> head;
  try {
    const std::string secret = random_secret();
    if (remote_port >= 0) {
      remote.emplace(remote_port, secret);
      say(fmt::format("remote on port {}, token {}", remote->port(), secret));
    }
    if (options.head_port >= 0) {
      head.emplace(options.head_port, secret);
      say(fmt::format("head on port {}, token {}", head->port(), secret));
    }
    window.emplace("trephine-sim", params.window_width, params.window_height, true, quad, params.screen_number);
    render::driver_facts();
  } catch (...) {
    loading.wait();
    throw;
  }
  if (!options.playback.empty() && loading.wait_for(std::chrono::milliseconds(500)) != std::future_status::ready)
    say("running the recording, to show any of its times");
  const std::unique_ptr<Player> player = loading.get();
  if (quad && !window->has_quad_buffers()) {
    say(std::string("stereo: the driver has no buffer for each eye, so the picture is ") +
        (options.lesson ? "flat: side by side would hide the lesson's panel" : "side by side"));
    player->set_stereo(options.lesson ? scene::ViewParams::Stereo::none : scene::ViewParams::Stereo::side_by_side);
  }
  if (options.session.screen && !window->place() && params.screen_number == 0)
    say("this display does not tell where the window lies: it must fill the screen (--screen-number 1)");
  player->set_stage();
  PlayOutcome outcome;
  outcome.driver = player->view().stage().driver().renderer;
  Loop loop(*player, *window, params, options);
  std::size_t told = 0;
  std::string reduced;
  try {
    double wait_s = 0;
    while (!stop.load(std::memory_order_relaxed) &&
           loop.turn(wait_s, remote ? &*remote : nullptr, head ? &*head : nullptr)) {
      if (loop.pictures() == 1) {
        outcome.first_picture_s = since(begun);
        say(fmt::format("first picture after {:.2f} s, drawn by {}", outcome.first_picture_s, outcome.driver));
      }
      for (const TimedNote& n : player->notes.since(told)) say(texts::text_of(n.note, texts::Language::english));
      if (std::string now = loop.reduced(); now != reduced) {
        reduced = std::move(now);
        say(reduced.empty() ? "reduced: nothing any more" : "reduced: " + reduced);
      }
      wait_s = std::max(0.0, 1 / params.frames_per_s - loop.last_ms() / 1000);
    }
  } catch (...) {
    player->finish();  // what was recorded until then is kept
    throw;
  }
  player->finish();
  for (const TimedNote& n : player->notes.since(told)) say(texts::text_of(n.note, texts::Language::english));
  outcome.seconds = since(begun);
  outcome.pictures = loop.pictures();
  outcome.faults = player->faults();
  outcome.graphics_mb = 1e-6 * double(player->view().stage().renderer().graphics_bytes());
  outcome.picture_ms = loop.typical_ms();
  outcome.picture_cpu_ms = loop.typical_cpu_ms();
  outcome.longest_ms = loop.longest_ms();
  if (const lessons::ScoredLesson* scored = player->lesson() ? player->lesson()->scored() : nullptr) {
    lessons::ReportHead head = scored->head;
    head.language = texts::Language::english;  // as all that the terminal says
    outcome.score = lessons::score_text(head, *scored->facts, scored->score);
  }
  return outcome;
}

}  // namespace trephine::window
