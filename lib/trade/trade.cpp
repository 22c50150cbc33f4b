// SPDX-License-Identifier: GPL-3.0-or-later
#include "trade/trade.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/calibration.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/refusal.h"
#include "base/result.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "json/declared_json.h"
#include "metrics/deviation.h"
#include "phantom/measure_truth.h"
#include "publish/case_content.h"
#include "publish/run_case.h"
#include "publish/scan_checks.h"
#include "publish/scene_limits.h"
#include "stages/data_files.h"
#include "trade/compared.h"
#include "trade/measured.h"
#include "voxel/mismatch.h"

namespace trephine::trade {
namespace fs = std::filesystem;
namespace {

// Raised when the comparison gives other figures for the same surfaces.
constexpr int comparison_version = 2;

TradeDeviation told(const metrics::Deviation& of) {
  TradeDeviation d;
  d.rms_mm = of.both.rms_mm;
  d.p99_mm = of.both.p99_mm;
  d.max_mm = of.both.max_mm;
  d.to_reference_max_mm = of.mesh_to_reference.max_mm;
  d.from_reference_max_mm = of.reference_to_mesh.max_mm;
  d.to_reference_rms_mm = of.mesh_to_reference.rms_mm;
  d.from_reference_rms_mm = of.reference_to_mesh.rms_mm;
  return d;
}

// A point as it is run: without the scene's limits.
struct Prepared {
  PlannedPoint planned;
  config::CaseConfig config;
  std::vector<config::SceneAnatomy> limits;
  pipeline::Graph graph;
  std::string input_sha256;
};

class Sweep {
 public:
  Sweep(const TradeRequest& request, const TradeObserver& observer)
      : request_(request),
        observer_(observer),
        store_(request.out / ".trade" / "measured"),
        cache_(request.out / ".trade" / "stages"),
        repeats_{request.params.repeats_count, request.params.max_repeat_s},
        stages_(store_, {repeats_, &cache_, &cancel_requested(),
                         [this](const std::string& work, double done) { tell(work, done); }}) {
    if (!request.truth.empty()) truth_ = phantom::read_truth(request.truth);
  }

  TradeResult run() {
    const config::CaseConfig plain = read({});
    const TradePlan plan = request_.plan.empty() ? standard_plan(plain.haptic.wanted) : read_trade_plan(request_.plan);
    // All points are prepared before the first is computed, so that a fault in the last one's settings is reported now.
    for (PlannedPoint& p : points_of(plan)) prepared_.push_back(prepare(std::move(p)));
    TradeResult result;
    result.recipe_sha256 = plain.recipe_sha256;
    result.stale = plain.trade.stale;
    result.has_truth = truth_.has_value();
    for (at_ = 0; at_ < prepared_.size(); ++at_) {
      cancel_check();
      result.points.push_back(measure(prepared_[at_]));
      if (at_ == 0 && !result.points[0].total.refused.empty())
        throw refusal(
            "finest",
            "the finest result is refused, so nothing can be measured against it: " + result.points[0].total.refused,
            {"then measure again with `trade`"})
            .in_file(request_.config.string());
    }
    for (PointTrade& p : result.points) compare_volumes(result.points[0], p);
    result.calibration_s = calibration_s();
    result.measured_count = measured_;
    store_.remove_unused();
    cache_.shrink_to(static_cast<std::uint64_t>(request_.params.cache_limit_mb) * 1'000'000);
    return result;
  }

 private:
  void tell(const std::string& work, double done) const {
    if (observer_) observer_(at_, prepared_.size(), work, done);
  }
  // Of the machine that measured last: a sweep that computes nothing says what it said.
  double calibration_s() {
    const char* const key = "calibration";
    if (const Measurement* known = store_.find(key); known && measured_ == 0) return known->median_s();
    Measurement m;
    m.seconds = {calibration_seconds()};
    return store_.keep(key, std::move(m)).median_s();
  }
  static void cancel_check() { Progress({}, &cancel_requested()).check(); }

  config::CaseConfig read(const std::vector<std::string>& settings) const {
    config::ConfigOverrides overrides = request_.overrides;
    overrides.without_rule = true;
    // Settings on the command line hold for every point; a swept path wins over them.
    overrides.set.insert(overrides.set.end(), settings.begin(), settings.end());
    config::CaseConfig config = config::read_case_config(request_.config, overrides);
    if (config.series.empty())
      throw Error(ExitCode::usage, request_.config.string(), "series",
                  "the configuration names none, give --series FOLDER");
    return config;
  }

  Prepared prepare(PlannedPoint planned) {
    Prepared p;
    p.config = with_field("point " + planned.name, [&] { return read(planned.settings); });
    p.planned = std::move(planned);
    publish::require_face_policy(p.config);
    p.limits = p.config.scene;
    for (config::SceneAnatomy& a : p.config.scene) a.max_deviation_mm = 0, a.max_triangles = 0;
    p.config.trade = {};
    if (p.config.case_token.empty()) p.config.case_token = "trade";
    p.input_sha256 = input_hash({p.config.series, p.config.import});
    p.graph =
        pipeline::make_graph(p.config, p.input_sha256,
                             [this](const std::string&, const dicom::SeriesChoice& scan) { return input_hash(scan); });
    pipeline::require_allowed(p.graph, request_.params.allow_external);
    check_patients(p);
    return p;
  }

  // Names a choice of series, whatever its files hold.
  static std::string key_of(const dicom::SeriesChoice& series) {
    Sha256 hash;
    hash.text(series.folder_or_file.string());
    const AnyParams import = AnyParams::make<dicom::ImportParams>(series.params);
    for (const Parameter& p : import.set->parameters) hash.text(to_text(import.get(p)));
    return hash.hex();
  }

  std::string input_hash(const dicom::SeriesChoice& series) {
    std::string& known = input_hashes_[key_of(series)];
    if (known.empty())
      known = dicom::hash_of_series_input(series.folder_or_file, series.params, Progress({}, &cancel_requested()));
    return known;
  }

  // Points rarely differ in their scans, so each set of them is looked at once.
  void check_patients(const Prepared& p) {
    const std::vector<std::string> scans = publish::names_of_scans(p.graph);
    std::string which = key_of({p.config.series, p.config.import});
    for (const std::string& name : scans) {
      const config::CaseScan& s = *p.config.find_scan(name);
      which +=
          '\n' + name + '\n' + key_of({s.series, s.import.as<dicom::ImportParams>()}) + '\n' + s.same_patient_reason;
    }
    if (!patients_checked_.insert(which).second) return;
    for (const std::string& w : publish::require_one_patient(p.config, scans, Progress({}, &cancel_requested())))
      log_warning(w);
  }

  PointTrade measure(const Prepared& p) {
    PointTrade out;
    out.planned = p.planned;
    out.total.name = p.planned.name;
    out.total.settings = p.planned.settings;
    stages_.forget();
    const auto refusal = stages_.measure(p.graph);
    measured_ += stages_.take_measured_count();
    if (refusal) {
      out.total.refused = refusal->node + ": " + refusal->why;
      return out;
    }
    publish::require_modalities(p.config, p.graph, outcomes(p));
    for (const pipeline::Node& node : p.graph.nodes) add_stage(out, node.name, *store_.find(node.key));
    const Measurement& published = publish(p);
    if (!published.refused.empty()) {
      out.total.refused = published.refused;
      return out;
    }
    add_stage(out, "publish", published);
    const auto sizes = json::value_of_json<Published>(published.values);
    out.total.bytes = static_cast<std::int64_t>(sizes.bytes);
    for (std::size_t i = 0; i < p.graph.anatomies.size(); ++i) add_anatomy(p, i, sizes.anatomies.at(i), out);
    if (p.config.haptic.wanted)
      for (const config::SceneShape& shape : p.config.haptic.shapes) add_shape(p, shape.name, out);
    return out;
  }

  static void add_stage(PointTrade& out, const std::string& name, const Measurement& m) {
    out.stages.push_back({name, m.median_s(), m.spread_s(), m.peak_memory_mb});
    out.total.seconds += m.median_s();
    out.total.peak_memory_mb = std::max(out.total.peak_memory_mb, m.peak_memory_mb);
  }

  // Of every node, without data.
  std::vector<pipeline::NodeResult> outcomes(const Prepared& p) {
    std::vector<pipeline::NodeResult> results(p.graph.nodes.size());
    for (std::size_t i = 0; i < results.size(); ++i)
      static_cast<stages::StageOutcome&>(results[i]) =
          stages::parse_outcome_json(store_.find(p.graph.nodes[i].key)->values, *p.graph.nodes[i].type);
    return results;
  }

  // Makes and checks the case's files without writing them.
  const Measurement& publish(const Prepared& p) {
    const std::vector<int> wanted = publish::wanted_nodes(p.graph, false);
    Sha256 hash;
    hash.text("trade publish").integer(comparison_version);
    for (const int node : wanted) hash.text(p.graph.nodes[std::size_t(node)].key);
    const std::string key = hash.hex();
    if (const Measurement* known = store_.find(key); known && repeats_.suffice(*known)) return *known;
    tell("publish", 0);
    ++measured_;
    std::vector<pipeline::NodeResult> results = outcomes(p);
    for (const int node : wanted) results[std::size_t(node)].data = stages_.data(p.graph, node);
    return store_.keep(key, measure_work(repeats_, [&] {
                         const publish::CaseContent content = publish::make_case_content(
                             p.config, p.graph, results, "trephine " + request_.program_version, p.input_sha256, {},
                             Progress([this](double done) { tell("publish", done); }, &cancel_requested()));
                         Published out;
                         for (const publish::CaseContent::File& f : content.files) out.bytes += f.bytes.size();
                         for (const publish::AnatomyResult& a : content.anatomies)
                           out.anatomies.push_back({a.triangles_after, static_cast<std::int64_t>(a.bytes_after),
                                                    a.volume_ml, a.deviation_max_mm});
                         return json::json_of_value(out);
                       }));
  }

  // A comparison that is made once for all the points that share its two sides.
  template <class Compare>
  auto compared(const std::string& what, const std::vector<std::string>& keys, const Compare& compare) {
    using R = decltype(compare());
    Sha256 hash;
    hash.text("trade " + what).integer(comparison_version).integer(request_.params.sample_count);
    for (const std::string& k : keys) hash.text(k);
    const std::string key = hash.hex();
    if (const Measurement* known = store_.find(key); known && known->refused.empty())
      return json::value_of_json<R>(known->values);
    tell(what, 0);
    ++measured_;
    const R result = compare();
    Measurement m;
    m.values = json::json_of_value(result);
    store_.keep(key, std::move(m));
    return result;
  }

  surface::TriMesh mesh(const Prepared& p, int node) {
    return *std::get<std::shared_ptr<const surface::TriMesh>>(stages_.data(p.graph, node));
  }
  static const std::string& key_of(const Prepared& p, int node) { return p.graph.nodes[std::size_t(node)].key; }

  void add_anatomy(const Prepared& p, std::size_t index, const PublishedAnatomy& published, PointTrade& out) {
    const pipeline::Graph::Anatomy& nodes = p.graph.anatomies[index];
    const Prepared& finest = prepared_[0];
    const int reference = finest.graph.anatomies[index].surface;
    AnatomyTrade a;
    a.name = nodes.name;
    a.triangles_count = published.triangles;
    a.bytes = published.bytes;
    a.volume_ml = published.volume_ml;
    metrics::DeviationParams params;
    params.sample_count = request_.params.sample_count;
    if (key_of(p, nodes.surface) != key_of(finest, reference))
      a.to_finest = told(compared("deviation", {key_of(p, nodes.surface), key_of(finest, reference)}, [&] {
        return metrics::measure_deviation(mesh(p, nodes.surface), mesh(finest, reference), params);
      }));
    if (truth_) add_truth(p, nodes, a);
    if (const int mismatch = p.graph.find_stage<voxel::MismatchParams>(); mismatch >= 0) {
      const auto measured = stages::parse_outcome_json(store_.find(key_of(p, mismatch))->values,
                                                       *p.graph.nodes[std::size_t(mismatch)].type);
      if (const auto* m = find_item(result_as<voxel::MismatchResult>(measured.result).shapes, a.name))
        a.mismatch_rms_mm = m->rms_mm;
    }
    out.total.triangles_count += a.triangles_count;
    out.total.deviation_max_mm = std::max(out.total.deviation_max_mm, a.to_finest.max_mm);
    out.total.deviation_p99_mm = std::max(out.total.deviation_p99_mm, a.to_finest.p99_mm);
    out.total.deviation_rms_mm = std::max(out.total.deviation_rms_mm, a.to_finest.rms_mm);
    const config::SceneAnatomy& limit = p.limits[index];
    if (out.beyond_scene.empty() && limit.max_triangles > 0 && a.triangles_count > limit.max_triangles)
      out.beyond_scene = a.name + ": " + std::to_string(a.triangles_count) + " triangles, the scene allows " +
                         std::to_string(limit.max_triangles);
    if (const double moved_mm = published.deviation_max_mm;
        out.beyond_scene.empty() && limit.max_deviation_mm > 0 && moved_mm > limit.max_deviation_mm)
      out.beyond_scene = a.name + ": " + to_text(ParameterValue(moved_mm)) +
                         " mm from the unreduced surface, the scene allows " +
                         to_text(ParameterValue(limit.max_deviation_mm));
    out.anatomies.push_back(std::move(a));
  }

  const phantom::TruthSurface* truth_of(const std::string& anatomy) {
    const auto known = truth_surfaces_.find(anatomy);
    if (known != truth_surfaces_.end()) return &known->second;
    for (const phantom::Anatomy a : phantom::all_anatomies)
      if (anatomy == phantom::name_of(a)) return &(truth_surfaces_[anatomy] = phantom::truth_surface(*truth_, a));
    return nullptr;
  }

  void add_truth(const Prepared& p, const pipeline::Graph::Anatomy& nodes, AnatomyTrade& out) {
    const bool known = std::any_of(phantom::all_anatomies.begin(), phantom::all_anatomies.end(),
                                   [&](phantom::Anatomy a) { return out.name == phantom::name_of(a); });
    if (!known) return;
    if (truth_sha256_.empty()) truth_sha256_ = sha256_of_file(request_.truth);
    metrics::MeasureParams params;
    params.sample_count = request_.params.sample_count;
    params.validity = false;
    out.to_truth =
        told(*compared("truth " + out.name, {key_of(p, nodes.surface), truth_sha256_}, [&] {
                return phantom::measure_against_truth(mesh(p, nodes.surface), *truth_of(out.name), params).result;
              }).deviation);
    const pipeline::Node& contour = p.graph.nodes[std::size_t(nodes.first_surface)];
    const int field = contour.sources.begin()->second;
    if (p.graph.nodes[std::size_t(field)].output != stages::DataKind::field) return;
    out.dice_ratio = compared("Dice " + out.name, {key_of(p, field), truth_sha256_}, [&] {
                       return phantom::measure_against_truth(
                           *std::get<std::shared_ptr<const grid::Field>>(stages_.data(p.graph, field)),
                           *truth_of(out.name), params.sample_count);
                     }).dice_ratio;
  }

  void add_shape(const Prepared& p, const std::string& name, PointTrade& out) {
    const Prepared& finest = prepared_[0];
    const int haptic = p.graph.result(stages::DataKind::haptic);
    const auto& sources = finest.graph.nodes[std::size_t(finest.graph.result(stages::DataKind::haptic))].sources;
    const auto contour = sources.find("shape." + name);
    if (contour == sources.end()) return;  // the volume holds raw HU
    const Felt felt = compared("felt " + name, {key_of(p, haptic), name, key_of(finest, contour->second)}, [&] {
      const auto felt_in = std::get<std::shared_ptr<const voxel::HapticVolume>>(stages_.data(p.graph, haptic));
      const surface::TriMesh surface = mesh(finest, contour->second);
      const auto mismatch = [&](voxel::FeltSurface which) {
        voxel::MismatchParams params;
        params.sample_count = request_.params.sample_count;
        params.felt = which;
        return voxel::measure_mismatch(surface, *felt_in, *felt_in->find_shape(name), params);
      };
      return Felt{mismatch(voxel::FeltSurface::sub_voxel), mismatch(voxel::FeltSurface::nearest)};
    });
    out.shapes.push_back({name, felt.sub_voxel.rms_mm, felt.sub_voxel.p99_mm, felt.nearest.rms_mm, felt.nearest.p99_mm,
                          felt.sub_voxel.missed_ratio});
  }

  static void compare_volumes(const PointTrade& finest, PointTrade& p) {
    for (std::size_t i = 0; i < p.anatomies.size(); ++i)
      if (const double volume_ml = finest.anatomies[i].volume_ml; volume_ml > 0)
        p.anatomies[i].volume_change_percent = 100 * (p.anatomies[i].volume_ml / volume_ml - 1);
  }

  const TradeRequest& request_;
  const TradeObserver& observer_;
  MeasurementStore store_;
  pipeline::StageCache cache_;
  Repeats repeats_;
  TimedStages stages_;
  std::optional<phantom::Truth> truth_;
  std::string truth_sha256_;
  std::map<std::string, phantom::TruthSurface> truth_surfaces_;
  std::map<std::string, std::string> input_hashes_;
  std::set<std::string> patients_checked_;
  std::vector<Prepared> prepared_;
  std::size_t at_ = 0;
  int measured_ = 0;
};

}  // namespace

std::vector<config::TradePoint> TradeResult::choosable() const {
  std::vector<config::TradePoint> all;
  for (const PointTrade& p : points)
    if (p.total.refused.empty() && p.beyond_scene.empty()) all.push_back(p.total);
  return all;
}

TradeResult measure_trade(const TradeRequest& request, const TradeObserver& observer) {
  make_output_folder(request.out);
  make_output_folder(request.out / ".trade");
  return Sweep(request, observer).run();
}

}  // namespace trephine::trade
