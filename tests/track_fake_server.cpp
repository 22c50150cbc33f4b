// SPDX-License-Identifier: GPL-3.0-or-later
// A tracker's server for tests/program/track.sh: it sends two tools and a head, and does what lines of its input say;
// each is answered by "ok" once a frame of it was sent.
//
//   track_fake_server print FILE CASE                writes a print's record
//   track_fake_server tracking FILE CASE ERROR_MM    where all is, as if it had been found with that error at the
//   target track_fake_server serve NOISE_MM                 prints its port, then obeys:
//     pivot X Y Z, spin X Y Z, mark N, hold N, at X Y Z (tip in the case), go X Y Z AX AY AZ (there, 40 mm/s, with that
//     axis), good, mirrored, swapped, silent, unwell, gone, back, quit
#include <csignal>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>

#include "track/tracking_file.h"
#include "track_fake.h"

using namespace track_fake;

namespace {

struct Doing {
  std::string what = "at", spoilt = "good";
  int mark = 0;
  Vec3 at{0, 0, 300}, from, axis{0, 0, 1};
  double since_s = 0;
};

Theatre a_catheter() {
  Theatre t;
  t.tip_mm = {1, 6, -118};
  return t;
}

class Acting {
 public:
  explicit Acting(double noise_mm) : noise_mm_(noise_mm) {}
  std::vector<Bytes> frame(double now_s) {
    const std::scoped_lock lock(mutex_);
    ++n_;
    if (doing_.spoilt == "silent") return {};
    if (doing_.spoilt == "unwell") return {status(13, now_s)};
    if (doing_.since_s == 0) doing_.since_s = now_s;
    RigidMap pointer = body(pointer_, now_s), catheter = body(catheter_, now_s);
    if (doing_.spoilt == "swapped") std::swap(pointer, catheter);
    if (doing_.spoilt == "mirrored") pointer.turn.column[0] = -pointer.turn.column[0];
    return {transform("Pointer", pointer, now_s), tdata({{"Catheter", catheter}}, now_s),
            transform("Head", seen(pointer_.reference_to_tracker, noise_mm_, random_), now_s), status(1, now_s)};
  }
  Doing doing() {
    const std::scoped_lock lock(mutex_);
    return doing_;
  }
  void act(const Doing& doing) {
    const std::scoped_lock lock(mutex_);
    doing_ = doing;
    n_ = 0;
  }

 private:
  RigidMap body(const Theatre& t, double now_s) {
    Vec3 tip = doing_.at, axis{0, 0, 1};
    double spin = 0;
    const double tilt = doing_.what == "pivot" ? 0.5 * std::sin(0.11 * n_) : 0.02 * std::sin(0.7 * n_);
    axis = {std::sin(tilt) * std::cos(0.05 * n_), std::sin(tilt) * std::sin(0.05 * n_), std::cos(tilt)};
    if (doing_.what == "go") {
      const Vec3 way = doing_.at - doing_.from;
      tip = doing_.from + way * std::min(1.0, 40 * (now_s - doing_.since_s) / std::max(1e-9, norm(way)));
      axis = doing_.axis;
    }
    if (doing_.what == "spin") spin = 1.6 * std::sin(0.05 * n_);
    if (doing_.what == "mark" || doing_.what == "hold") {
      const lesson::PrintMark& mark = print_.marks[std::size_t(doing_.mark - 1)];
      tip = on_mark(mark, doing_.what == "hold" ? 9 : (n_ * 7) % 97, 97);
      axis = -mark.post;
    }
    return seen(t.body_at(tip, axis, spin), noise_mm_, random_);
  }
  const double noise_mm_;
  const lesson::PrintRecord print_ = a_print();
  const Theatre pointer_, catheter_ = a_catheter();
  std::mutex mutex_;
  Doing doing_;
  Random random_{7};
  int n_ = 0;
};

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  if (what == "print" && count == 5) {
    lesson::PrintRecord print = a_print();
    print.case_token = words[3];
    print.case_sha256 = words[4];
    std::ofstream(words[2]) << lesson::to_json(print);
    return 0;
  }
  if (what == "tracking" && count == 6) {
    const Theatre is = a_catheter();
    track::Tracking t;
    t.case_token = words[3];
    t.case_sha256 = words[5];
    t.print_sha256 = std::string(64, 'a');
    t.program = "test";
    t.reference = "Head";
    t.reference_to_case = rows_of(inverse(is.case_to_reference));
    t.target_error_mm = std::stod(words[4]);
    track::TrackedTool tool;
    tool.body = "Catheter";
    tool.tip_mm = is.tip_mm;
    tool.axis = is.axis;
    tool.tip_error_mm = 0.2;
    t.tools = {tool};
    std::ofstream(words[2]) << track::to_json(t);
    return 0;
  }
  if (what != "serve" || count != 3) return 2;
  Acting acting(std::stod(words[2]));
  Server server;
  const auto begin = [&] { server.start([&](double now_s) { return acting.frame(now_s); }, 2); };
  begin();
  std::cout << server.port() << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream in(line);
    Doing doing = acting.doing();
    std::string word;
    in >> word;
    if (word == "quit") break;
    if (word == "gone") {
      server.stop();
    } else if (word == "back") {
      begin();
    } else if (word == "go") {
      doing.what = word;
      doing.from = doing.at;
      doing.since_s = 0;
      in >> doing.at.x >> doing.at.y >> doing.at.z >> doing.axis.x >> doing.axis.y >> doing.axis.z;
    } else if (word == "pivot" || word == "spin" || word == "mark" || word == "hold" || word == "at") {
      doing.what = word;
      if (word == "mark" || word == "hold") in >> doing.mark;
      if (word != "mark" && word != "hold") in >> doing.at.x >> doing.at.y >> doing.at.z;
    } else {
      doing.spoilt = word;
    }
    acting.act(doing);
    std::cout << "ok" << std::endl;
  }
}
