// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/trial.h"

#include "base/error.h"
#include "base/progress.h"
#include "base/write_file.h"
#include "desk/draft.h"
#include "library/build_jobs.h"
#include "pipeline/executor.h"

namespace trephine::desk {
namespace {

config::CaseConfig config_with(const DeskLibrary& library, const DeskCase& one,
                               const std::vector<config::YamlChange>& changes) {
  const std::vector<char> text = read_file(one.text_file(), 1 << 20);
  const Draft draft(one.config, config::edited_yaml({text.begin(), text.end()}, changes, one.config.filename()));
  return draft.judged([&](const auto& file) { return config::read_case_config(file, library.overrides_of(one)); });
}

}  // namespace

class Trial::Watcher : public pipeline::RunObserver {
 public:
  explicit Watcher(Trial& of) : of_(of) {}
  void started(const std::string& node) override { progressed(node, 0); }
  void progressed(const std::string& node, double fraction) override {
    const std::lock_guard<std::mutex> lock(of_.mutex_);
    of_.now_.doing = node;
    of_.now_.fraction = fraction;
  }

 private:
  Trial& of_;
};

Trial::Trial(const DeskLibrary& library, DeskCase one, std::shared_ptr<const OpenCase> looked_at, TrialWish wish)
    : library_(library), looked_at_(std::move(looked_at)), config_(config_with(library, one, wish.changes)) {
  thread_ = std::thread([this, wish = std::move(wish)] {
    std::string fault;
    try {
      work(wish);
    } catch (...) {
      fault = fault_of_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    now_.running = false;
    now_.doing.clear();
    now_.fault = fault;
  });
}

Trial::~Trial() {
  cancel_ = true;
  thread_.join();
}

void Trial::work(const TrialWish& wish) {
  const Progress progress({}, &cancel_);
  const CaseGraph of = graph_of_case(std::move(config_), progress);
  std::vector<int> wanted;
  if (!wish.anatomy.empty()) {
    wanted.push_back(field_node(of, wish.anatomy));
    if (wanted.back() < 0)
      throw Error(ExitCode::usage, "", wish.anatomy, "the scene does not need it, so nothing of it is computed");
  }
  if (!wish.step.empty()) {
    wanted.push_back(of.graph.find(wish.step));
    if (wanted.back() < 0) throw Error(ExitCode::usage, "", wish.step, "is no step that this case needs");
  }
  for (std::size_t i = 0; i < of.config->burr_holes.size(); ++i)
    if (wish.hole && *wish.hole == i) wanted.push_back(of.graph.find(of.config->burr_holes[i].name));
  if (wish.hole && wanted.empty())
    throw Error(ExitCode::usage, "", "burr_holes",
                "have no effect: the scene cuts none (`burr_holes` of its anatomies)");
  const pipeline::StageCache cache(library_.options().library / library::library_cache_name);
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  options.cancel = &cancel_;
  Watcher watcher(*this);
  for (const int node : wanted) {
    pipeline::NodeResult made = computed(of.graph, node, options, watcher);
    std::shared_ptr<const DrawnField> drawn;
    if (const auto* field = std::get_if<std::shared_ptr<const grid::Field>>(&made.data); field && *field)
      drawn = std::make_shared<const DrawnField>(drawn_field(**field, grid::lattice_of(*looked_at_->scan())));
    std::optional<std::pair<double, double>> volumes_ml;
    if (const auto before = wish.anatomy.empty() ? nullptr : looked_at_->field(wish.anatomy); before && drawn)
      volumes_ml = {volume_ml(*before), volume_ml(*drawn)};
    const std::lock_guard<std::mutex> lock(mutex_);
    now_.volumes_ml = volumes_ml;
    now_.reports.emplace_back(of.graph.nodes[std::size_t(node)].name, made.report());
    if (drawn) {
      field_ = std::move(drawn);
      now_.has_field = true;
    }
  }
}

Trial::Now Trial::now() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return now_;
}

std::shared_ptr<const DrawnField> Trial::field() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return field_;
}

}  // namespace trephine::desk
