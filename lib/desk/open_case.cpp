// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/open_case.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/error_text.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/progress.h"
#include "config/corrected_field.h"
#include "grid/sample.h"
#include "head/head_landmarks.h"
#include "library/build_jobs.h"
#include "pipeline/executor.h"
#include "publish/scan_checks.h"
#include "publish/series_hashes.h"

namespace trephine::desk {

CaseGraph graph_of_case(config::CaseConfig config, const Progress& progress) {
  if (config.series.empty()) throw Error(ExitCode::usage, "", "series", "the configuration names none");
  CaseGraph out;
  out.graph = publish::SeriesHashes(progress).graph_of(config);
  publish::require_one_patient(config, publish::names_of_scans(out.graph), progress);
  pipeline::require_allowed(out.graph, false);
  out.config = std::make_shared<const config::CaseConfig>(std::move(config));
  return out;
}

DrawnField drawn_field(const grid::Field& field, const grid::Lattice& scan) {
  float most = 0;
  for (const float v : field.voxels) most = std::max(most, std::abs(v));
  const float scale = most > 0 ? 32767 / most : 1;
  DrawnField out;
  out.place = grid::place_in(field, scan);
  out.samples = grid::Grid<std::int16_t>(static_cast<const grid::Lattice&>(field));
  std::transform(field.voxels.begin(), field.voxels.end(), out.samples.voxels.begin(), [&](float v) {
    const auto n = static_cast<std::int16_t>(std::lround(v * scale));
    return n == 0 && v > 0 ? std::int16_t{1} : n == 0 && v < 0 ? std::int16_t{-1} : n;
  });
  return out;
}

double volume_ml(const DrawnField& field) {
  const auto& v = field.samples.voxels;
  const auto inside = std::count_if(v.begin(), v.end(), [](std::int16_t one) { return one > 0; });
  return double(inside) * field.samples.voxel_volume_mm3() / 1000;
}

int field_node(const CaseGraph& of, const std::string& anatomy) {
  if (const int corrected = of.graph.find(anatomy + ".correct"); corrected >= 0) return corrected;
  const std::string made = config::corrected_field(*of.config, anatomy);
  return made.empty() ? -1 : of.graph.find(made);
}

std::string shape_state(const config::CaseConfig& config, const std::string& anatomy) {
  std::vector<std::string> others = {"scene.", "haptic."};
  for (const config::CaseDrill& hole : config.burr_holes) others.push_back(hole.name + ".");
  for (const config::RecipeAnatomy& any : config.anatomies)
    for (const config::RecipeStep& step : any.steps)
      if (step.type->output != stages::DataKind::field) others.push_back(any.name + "." + step.type->name + ".");
  std::string out;
  for (const config::ValueRow& row : config.values)
    if (std::none_of(others.begin(), others.end(), [&](const auto& begin) { return row.path.rfind(begin, 0) == 0; }))
      out += row.path + " = " + row.value + "\n";
  if (const config::RecipeAnatomy* one = config.find_anatomy(anatomy))
    for (const config::RecipeStep& step : one->steps)
      if (step.type->name == "correct") {
        const std::filesystem::path file = std::get<std::string>(step.params.get(*step.params.set->find("file")));
        std::error_code ignored;
        out += std::filesystem::exists(file, ignored) ? sha256_of_file(file) : "none";
      }
  return out;
}

pipeline::NodeResult computed(const pipeline::Graph& graph, int node, const pipeline::ExecuteOptions& options,
                              pipeline::RunObserver& observer) {
  std::vector<bool> needed(graph.nodes.size(), false);
  needed[std::size_t(node)] = true;
  for (std::size_t i = graph.nodes.size(); i-- > 0;)  // sources stand before their readers
    if (needed[i])
      for (const auto& [port, source] : graph.nodes[i].sources) needed[std::size_t(source)] = true;
  std::vector<int> place(graph.nodes.size(), -1);
  pipeline::Graph part;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (!needed[i]) continue;
    place[i] = int(part.nodes.size());
    part.nodes.push_back(graph.nodes[i]);
    for (auto& [port, source] : part.nodes.back().sources) source = place[std::size_t(source)];
  }
  const int last = place[std::size_t(node)];
  return std::move(pipeline::execute(part, {last}, options, observer)[std::size_t(last)]);
}

std::string fault_of_exception() {
  try {
    throw;
  } catch (const ErrorList& list) {
    return joined(list.all(), "\n", [](const Error& e) { return error_text(e); });
  } catch (const Error& e) {
    return error_text(e);
  } catch (const Cancelled&) {
    return "stopped";
  } catch (const std::exception&) {
    return "not enough memory";
  }
}

class OpenCase::Watcher : public pipeline::RunObserver {
 public:
  explicit Watcher(OpenCase& of) : of_(of) {}
  void started(const std::string& node) override { of_.set_doing(node, 0); }
  void progressed(const std::string& node, double fraction) override { of_.set_doing(node, fraction); }

 private:
  OpenCase& of_;
};

OpenCase::OpenCase(const DeskLibrary& library, DeskCase one, const OpenCase* before)
    : library_(library), one_(std::move(one)) {
  if (before && before->scan()) {
    now_.has_scan = true;
    now_.fields = before->now().fields;
    now_.landmarks = before->now().landmarks;
    scan_ = before->scan();
    config_ = before->config();
    for (const std::string& name : now_.fields) fields_[name] = before->field(name);
  }
  thread_ = std::thread([this] {
    std::string fault;
    try {
      work();
    } catch (...) {
      fault = fault_of_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    now_.state = fault.empty() ? State::ready : State::failed;
    now_.fault = fault;
    now_.doing.clear();
  });
}

OpenCase::~OpenCase() {
  cancel_ = true;
  thread_.join();
}

void OpenCase::set_doing(const std::string& what, double fraction) {
  const std::lock_guard<std::mutex> lock(mutex_);
  now_.doing = what;
  now_.fraction = fraction;
}

void OpenCase::work() {
  const Progress progress({}, &cancel_);
  set_doing("series", 0);
  const CaseGraph of = graph_of_case(config::read_case_config(one_.text_file(), library_.overrides_of(one_)), progress);
  const pipeline::Graph& graph = of.graph;
  std::map<std::string, std::string>
      states;  // as they are before anything is computed: what is saved meanwhile is not in it
  for (const config::RecipeAnatomy& anatomy : of.config->anatomies)
    states[anatomy.name] = shape_state(*of.config, anatomy.name);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    config_ = of.config;
  }
  const pipeline::StageCache cache(library_.options().library / library::library_cache_name);
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  options.cancel = &cancel_;
  Watcher watcher(*this);
  std::shared_ptr<const grid::HuVolume> scan;
  {
    scan = std::get<std::shared_ptr<const grid::HuVolume>>(computed(graph, graph.scan, options, watcher).data);
    const std::lock_guard<std::mutex> lock(mutex_);
    scan_ = scan;
    now_.has_scan = true;
  }
  std::vector<std::string> made_now;
  for (const config::RecipeAnatomy& anatomy : of.config->anatomies) {
    const int node = field_node(of, anatomy.name);
    if (node < 0) continue;
    try {
      const pipeline::NodeResult made = computed(graph, node, options, watcher);
      const auto* field = std::get_if<std::shared_ptr<const grid::Field>>(&made.data);
      if (!field || !*field) continue;
      auto one = std::make_shared<const DrawnField>(drawn_field(**field, grid::lattice_of(*scan)));
      const std::lock_guard<std::mutex> lock(mutex_);
      fields_[anatomy.name] = std::move(one);
      states_[anatomy.name] = states[anatomy.name];
      made_now.push_back(anatomy.name);
      if (std::find(now_.fields.begin(), now_.fields.end(), anatomy.name) == now_.fields.end())
        now_.fields.push_back(anatomy.name);
    } catch (const Error& e) {  // the others can be looked at all the same
      const std::lock_guard<std::mutex> lock(mutex_);
      now_.warnings.push_back(anatomy.name + ": " + error_text(e));
    }
  }
  std::vector<cases::CaseLandmark> landmarks = of.config->landmarks;
  if (const config::RecipeStep* step = of.config->landmarks_step())
    if (const int node = graph.find(step->type->name); node >= 0) try {
        const auto found =
            std::get<std::shared_ptr<const head::HeadLandmarks>>(computed(graph, node, options, watcher).data);
        landmarks = found->landmarks;
      } catch (const Error& e) {  // a hole that cannot be placed is mended by looking at them; without them by the scan
        const std::lock_guard<std::mutex> lock(mutex_);
        now_.warnings.push_back("landmarks: " + error_text(e));
      }
  const std::lock_guard<std::mutex> lock(mutex_);
  now_.landmarks = std::move(landmarks);
  for (const std::string& name : now_.fields)  // of the case as it was before
    if (std::find(made_now.begin(), made_now.end(), name) == made_now.end()) fields_.erase(name);
  now_.fields = std::move(made_now);
}

OpenCase::Now OpenCase::now() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return now_;
}
std::shared_ptr<const grid::HuVolume> OpenCase::scan() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return scan_;
}
std::shared_ptr<const DrawnField> OpenCase::field(const std::string& anatomy) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = fields_.find(anatomy);
  return found == fields_.end() ? nullptr : found->second;
}
std::shared_ptr<const config::CaseConfig> OpenCase::config() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return config_;
}

void require_open(const OpenCase& one, const std::string& anatomy) {
  if (one.now().state == OpenCase::State::opening && !one.field(anatomy))
    throw Error(ExitCode::no_input, "", anatomy,
                "is still being opened: nothing is edited before its outline is there; wait for it");
}

bool OpenCase::is_current(const std::string& anatomy, const config::CaseConfig& now) const {
  const std::string state = shape_state(now, anatomy);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = states_.find(anatomy);
  return found != states_.end() && found->second == state;
}

namespace {

template <class T>
std::int16_t rounded(T v) {
  return static_cast<std::int16_t>(std::clamp(std::lround(double(v)), -32767L, 32767L));
}

/// Calls take(sample) for each voxel of a plane, the lower axis fastest.
template <class T, class Take>
void for_plane(const grid::Grid<T>& grid, int axis, int index, const Take& take) {
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const std::size_t step[3] = {1, std::size_t(grid.size[0]), std::size_t(grid.size[0]) * std::size_t(grid.size[1])};
  for (int b = 0; b < grid.size[std::size_t(v)]; ++b) {
    const T* at = grid.voxels.data() + std::size_t(index) * step[axis] + std::size_t(b) * step[v];
    for (int a = 0; a < grid.size[std::size_t(u)]; ++a, at += step[u]) take(*at);
  }
}

void append(std::string& bytes, std::int16_t v) { bytes.append(reinterpret_cast<const char*>(&v), sizeof v); }

void require_plane(const grid::Lattice& lattice, int axis, int index) {
  if (axis < 0 || axis > 2 || index < 0 || index >= lattice.size[std::size_t(axis)])
    throw Error(ExitCode::usage, "", "index", "the scan has no such plane");
}

}  // namespace

std::string slice_bytes(const grid::HuVolume& scan, int axis, int index) {
  const grid::Lattice& lattice = grid::lattice_of(scan);
  require_plane(lattice, axis, index);
  std::string out;
  out.reserve(lattice.count() / std::size_t(lattice.size[std::size_t(axis)]) * 2);
  std::visit([&](const auto& grid) { for_plane(grid, axis, index, [&](auto v) { append(out, rounded(v)); }); }, scan);
  return out;
}

std::string slice_bytes(const DrawnField& field, int axis, int index) {
  if (axis < 0 || axis > 2) throw Error(ExitCode::usage, "", "axis", "must be 0, 1 or 2");
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2, at = index - field.place.begin[std::size_t(axis)];
  std::int32_t head[4] = {0, 0, 0, 0};
  const bool is_in = at >= 0 && at < field.samples.size[std::size_t(axis)];
  if (is_in) {
    head[0] = field.place.begin[std::size_t(u)];
    head[1] = field.place.begin[std::size_t(v)];
    head[2] = field.samples.size[std::size_t(u)];
    head[3] = field.samples.size[std::size_t(v)];
  }
  std::string out(reinterpret_cast<const char*>(head), sizeof head);
  if (is_in) for_plane(field.samples, axis, at, [&](std::int16_t s) { append(out, s); });
  return out;
}

std::string plane_bytes(const grid::HuVolume& scan, Vec3 corner_mm, Vec3 right_mm, Vec3 down_mm, int side) {
  const auto finite = [](Vec3 p) { return std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6 && std::abs(p.z) < 1e6; };
  if (side < 1 || side > 1024 || !finite(corner_mm) || !finite(right_mm) || !finite(down_mm))
    throw Error(ExitCode::usage, "", "plane", "must have 1 to 1024 places a side, within a kilometre");
  std::string out;
  out.reserve(std::size_t(side) * std::size_t(side) * 2);
  std::visit(
      [&](const auto& grid) {
        for (int b = 0; b < side; ++b)
          for (int a = 0; a < side; ++a)
            append(out,
                   rounded(grid::sampled(grid, grid.to_index(corner_mm + right_mm * double(a) + down_mm * double(b)),
                                         grid::value_beyond(-32768))));
      },
      scan);
  return out;
}

}  // namespace trephine::desk
