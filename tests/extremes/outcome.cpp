// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome.h"

#include <time.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>
#include <thread>

#include "base/error.h"
#include "base/text.h"
#include "grid/grid.h"
#include "meshing/validity.h"

namespace trephine::extremes {
namespace {

// Of the processor, so that a busy machine is no fault; and by the wall, for what sleeps.
constexpr double limit_cpu_s = 120, limit_wall_s = 400;

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// Ends the process with a word where a case hangs.
class TimeLimit {
 public:
  explicit TimeLimit(std::string name) : name_(std::move(name)), thread_([this] { watch(); }) {}
  ~TimeLimit() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      over_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }

 private:
  void watch() {
    const double cpu_began_s = cpu_s();
    const auto began = std::chrono::steady_clock::now();
    std::unique_lock<std::mutex> lock(mutex_);
    while (!wake_.wait_for(lock, std::chrono::milliseconds(200), [this] { return over_; })) {
      const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      if (cpu_s() - cpu_began_s < limit_cpu_s && wall_s < limit_wall_s) continue;
      std::fprintf(stderr, "FAULT: hangs: %s\n", name_.c_str());
      _exit(1);
    }
  }
  std::string name_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread thread_;
};

// Numbers of more than six digits, as some errors give them, rounded: the same on every machine.
std::string steady(const std::string& text) {
  std::string out;
  for (std::size_t n = 0; n < text.size();) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", n), text.size());
    const std::string word = text.substr(n, end - n);
    if (word.size() > 7 && word.find('.') != std::string::npos && word.back() != '.')
      out += rounded(std::strtod(word.c_str(), nullptr));
    else
      out += word;
    if (end < text.size()) out += text[end];
    n = end + 1;
  }
  return out;
}

std::string of_error(const Error& e) {
  static const std::set<ExitCode> documented = {ExitCode::usage,         ExitCode::bad_input, ExitCode::no_input,
                                                ExitCode::cannot_create, ExitCode::io,        ExitCode::busy,
                                                ExitCode::bad_config,    ExitCode::quality,   ExitCode::privacy};
  const std::string line = e.line("");
  const std::string what = e.what();
  if (documented.count(e.code()) == 0) return "FAULT: exit " + std::to_string(int(e.code())) + ": " + line;
  if (what.empty()) return "FAULT: exit " + std::to_string(int(e.code())) + " without a word";
  for (const char c : line)
    if (c == '\n' || c == '\r') return "FAULT: an error of several lines: " + printable(line);
  if (line.size() > 1500) return "FAULT: an error's line of " + std::to_string(line.size()) + " bytes";
  std::string text = "exit " + std::to_string(int(e.code())) + ": " +
                     steady(printable((e.field().empty() ? "" : e.field() + ": ") + what));
  if (text.size() > 200) text = text.substr(0, 200) + " ...";
  return text;
}

std::string of_mesh(const surface::TriMesh& mesh) {
  const meshing::Validity v = meshing::check_validity(mesh);
  if (!v.valid()) return "FAULT: not valid: " + v.text();
  if (!v.float32) return "FAULT: float32 does not hold the points";
  if (!mesh.normals.empty())
    for (const Vec3& n : mesh.normals)
      if (!(std::fabs(norm(n) - 1) < 1e-6)) return "FAULT: a normal that is no unit vector";
  return grouped_text(static_cast<long long>(mesh.triangles.size())) + " triangles, " + rounded(v.volume_mm3) +
         " mm3, valid";
}

std::string of_field(const grid::Field& field, bool warned) {
  std::size_t inside = 0;
  for (const float v : field.voxels) {
    if (!std::isfinite(v)) return "FAULT: a voxel that is not finite";
    inside += v > 0;
  }
  if (inside == 0 && !warned) return "FAULT: nothing inside, without a word";
  return rounded(double(inside) * field.voxel_volume_mm3()) + " mm3 inside";
}

// HU of 16 bits are whole and stay so.
std::string hu_text(double hu) { return std::fabs(hu) < 4e4 ? std::to_string(std::lround(hu)) : rounded(hu); }

std::string of_volume(const grid::HuVolume& volume) {
  return std::visit(
      [](const auto& g) -> std::string {
        double low = 1e300, high = -1e300;
        for (const auto v : g.voxels) {
          if (!std::isfinite(double(v))) return "FAULT: a voxel that is not finite";
          low = std::min(low, double(v));
          high = std::max(high, double(v));
        }
        if (g.voxels.empty()) return "FAULT: no voxel";
        std::string size;
        for (const int n : g.size) size += (size.empty() ? "" : " x ") + std::to_string(n);
        return size + " voxels, " + hu_text(low) + " to " + hu_text(high) + " HU";
      },
      volume);
}

std::string of_haptic(const voxel::HapticVolume& volume) {
  voxel::check_haptic_volume(volume);
  std::size_t filled = 0;
  for (const auto v : volume.voxels.voxels) filled += v != voxel::haptic_empty;
  if (filled == 0) return "FAULT: nothing to feel, without a word";
  return grouped_text(static_cast<long long>(volume.voxels.count())) + " voxels, " +
         grouped_text(static_cast<long long>(filled)) + " filled";
}

std::string of_landmarks(const head::HeadLandmarks& found, bool warned) {
  for (const cases::CaseLandmark& l : found.landmarks)
    if (!is_finite(l.position_mm) || !(l.confidence >= 0 && l.confidence <= 1))
      return "FAULT: landmark " + l.name + " is not finite";
  if (found.landmarks.empty() && !warned) return "FAULT: no landmark, without a word";
  return std::to_string(found.landmarks.size()) + " landmarks";
}

// What only measures: its first figures.
std::string of_figures(const Report& report) {
  std::string text = std::to_string(report.figures.size()) + " figures";
  int shown = 0;
  for (const auto& [name, value] : report.figures)
    if (const auto* d = std::get_if<double>(&value))
      if (++shown <= 4) text += (shown == 1 ? ": " : ", ") + name + " " + rounded(*d);
  return text;
}

std::string of_data(const stages::StageData& data, bool warned) {
  const auto null = [](const auto& p) {
    if constexpr (std::is_same_v<std::decay_t<decltype(p)>, std::monostate>)
      return false;
    else
      return !p;
  };
  if (std::visit(null, data)) return "FAULT: no result";
  if (const auto* d = std::get_if<std::shared_ptr<const surface::TriMesh>>(&data)) return of_mesh(**d);
  if (const auto* d = std::get_if<std::shared_ptr<const grid::Field>>(&data)) return of_field(**d, warned);
  if (const auto* d = std::get_if<std::shared_ptr<const grid::HuVolume>>(&data)) return of_volume(**d);
  if (const auto* d = std::get_if<std::shared_ptr<const voxel::HapticVolume>>(&data)) return of_haptic(**d);
  if (const auto* d = std::get_if<std::shared_ptr<const head::HeadLandmarks>>(&data)) return of_landmarks(**d, warned);
  if (const auto* d = std::get_if<std::shared_ptr<const std::vector<boolean::Cutter>>>(&data)) {
    for (const boolean::Cutter& c : **d) boolean::check_cutter(c, ExitCode::internal);
    return std::to_string((*d)->size()) + " cutters, " + rounded(boolean::volume_mm3((*d)->front())) + " mm3";
  }
  return "";
}

}  // namespace

std::string rounded(double v) {
  if (std::fabs(v) < 1e-9) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return to_text(std::strtod(text, nullptr));
}

std::string describe(const stages::StageData& data, const Report& report) {
  for (const auto& [name, value] : report.figures) {
    const auto finite = [](const ParameterValue& v) {
      if (const auto* d = std::get_if<double>(&v)) return std::isfinite(*d);
      if (const auto* list = std::get_if<std::vector<double>>(&v))
        for (const double d : *list)
          if (!std::isfinite(d)) return false;
      return true;
    };
    if (!finite(value)) return "FAULT: " + name + " is not finite";
  }
  std::string text = of_data(data, !report.warnings.empty());
  if (text.empty()) text = of_figures(report);
  if (const auto* by = report.find("stopped_by")) text += "; stopped by " + std::get<std::string>(*by);
  if (const auto* d = report.find("deviation_max_mm")) text += ", " + rounded(std::get<double>(*d)) + " mm at most";
  if (!report.warnings.empty()) text += "; warns: " + report.warnings.front();
  return text;
}

std::string outcome_of(const std::string& name, const std::function<std::string()>& f) {
  const TimeLimit limit(name);
  try {
    return f();
  } catch (const Error& e) {
    return of_error(e);
  } catch (const Cancelled&) {
    return "FAULT: cancelled by nobody";
  } catch (const std::exception& e) {
    return std::string("FAULT: throws ") + e.what();
  }
}

std::string outcome_of_stage(const stages::StageType& stage, const AnyParams& params,
                             const stages::StageInputs& inputs) {
  const stages::StageOutcome made = stage.run(params, inputs, {});
  return describe(made.data, made.report());
}

}  // namespace trephine::extremes
