// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/executor.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "pipeline/expected_time.h"
#include "pipeline/run_order.h"
#include "pipeline/spilled_data.h"
#include "stages/data_files.h"

namespace trephine::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Executor {
 public:
  Executor(const Graph& graph, const std::vector<int>& wanted, const ExecuteOptions& options, RunObserver& observer)
      : graph_(graph),
        options_(options),
        observer_(observer),
        expected_(graph, options.seconds_before),
        order_(graph, [&](int node) { return options.asked.count(node) > 0; }),
        results_(graph.nodes.size()),
        tasks_(graph.nodes.size()) {
    std::optional<Error> refused;
    int refused_node = -1;
    // The result of every node is wanted, so a node whose result is not in the cache runs again.
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
      if (const auto made = options_.known.find(graph.nodes[i].key); made != options_.known.end()) {
        results_[i] = made->second;
        expected_.learn(int(i), results_[i].data,
                        results_[i].state == NodeResult::State::computed ? results_[i].seconds : 0);
        continue;
      }
      auto known = options_.cache ? options_.cache->load_outcome(graph.nodes[i].key, *graph.nodes[i].type)
                                  : StageCache::Outcome{};
      if (known.refusal) {
        if (refused && !comes_before(int(i), refused_node)) continue;
        refused = Error(*known.refusal).in_stage(graph.nodes[i].name);
        refused_node = int(i);
        continue;
      }
      tasks_[i].unknown = !known.made;
      if (known.made) static_cast<stages::StageOutcome&>(results_[i]) = std::move(*known.made);
    }
    if (refused) throw *refused;
    for (const int w : wanted) {
      demand(w);
      ++tasks_[w].readers;  // the caller
    }
    for (const auto& [node, hold] : options_.asked) try {
        if (tasks_[node].done) hold(results_[node]);
      } catch (const Error&) {
        fail(node, std::current_exception(), false);
      }
    // Starts with the last node: when a node's turn comes, all its readers have been counted, and a node without
    // readers is dropped.
    for (std::size_t i = tasks_.size(); i-- > 0;) {
      const bool kept = !options_.keep.empty() && graph.nodes[i].output != stages::DataKind::nothing && !is_known(i);
      if (tasks_[i].unknown || kept) demand(static_cast<int>(i));
      if (tasks_[i].readers == 0) drop(int(i));
    }
  }

  std::vector<NodeResult> run() {
    tell_plan();
    {
      Workers workers(*this);
      const auto count = std::min(static_cast<std::size_t>(std::max(1, thread_count())), tasks_.size());
      for (std::size_t i = 0; i < count; ++i) workers.threads.emplace_back([this] { work(); });
      std::unique_lock<std::mutex> lock(mutex_);
      while (!(running_ == 0 && (stop_ || next_ready() < 0))) {
        wake_.wait_for(lock, std::chrono::milliseconds(100));
        if (options_.cancel && *options_.cancel) stop_all();
      }
      finished_ = true;
    }
    if (failed_ >= 0) {
      lay_aside();
      if (options_.made) *options_.made = std::move(results_);
      std::rethrow_exception(tasks_[failed_].error);
    }
    if (stop_) throw Cancelled{};
    lay_aside();
    return std::move(results_);
  }

 private:
  struct Task {
    bool unknown = false, needed = false, started = false, done = false;
    int readers = 0;
    int users = 0;  // readers that run
    std::exception_ptr error;
    std::atomic<bool> stop{false};  // ends it while it runs
  };

  // The threads are stopped and joined however the scope is left: at the end of the work, or because a thread could not
  // be made.
  struct Workers {
    explicit Workers(Executor& e) : executor(e) {}
    ~Workers() {
      {
        const std::lock_guard<std::mutex> lock(executor.mutex_);
        if (!executor.finished_) executor.stop_all();
      }
      executor.wake_.notify_all();
      for (std::thread& t : threads) t.join();
    }
    Executor& executor;
    std::vector<std::thread> threads;
  };

  bool comes_before(int i, int other) const { return order_.comes_before(i, other); }

  void stop_all() {
    stop_ = true;
    for (Task& t : tasks_) t.stop = true;
  }

  // Of what is not done yet.
  void tell_plan() {
    std::vector<char> to_do(tasks_.size());
    for (std::size_t i = 0; i < tasks_.size(); ++i) to_do[i] = tasks_[i].needed && !tasks_[i].done;
    observer_.planned(expected_.plan(to_do));
  }

  bool is_known(std::size_t i) const { return options_.known.count(graph_.nodes[i].key) > 0; }

  void demand(int i) {
    Task& task = tasks_[i];
    if (task.needed) return;
    task.needed = true;
    if (is_known(i) &&
        (results_[i].data.index() != 0 || results_[i].spilled || graph_.nodes[i].output == stages::DataKind::nothing)) {
      task.started = task.done = true;
      return;
    }
    if (load_cached(i)) return;
    for (const auto& [port, source] : graph_.nodes[i].sources) {
      demand(source);
      ++tasks_[source].readers;
    }
  }

  // Entries are verified before anything runs, so a damaged entry counts as missing.
  bool load_cached(int i) {
    if (!options_.cache) return false;
    const auto start = Clock::now();
    if (tasks_[i].unknown) return false;
    auto data = options_.cache->load_data(graph_.nodes[i].key, graph_.nodes[i].output);
    if (!data) return false;
    NodeResult& result = results_[i];
    result.data = std::move(*data);
    result.state = NodeResult::State::cached;
    result.kept = true;
    result.seconds = seconds_since(start);
    tasks_[i].started = tasks_[i].done = true;
    expected_.learn(i, result.data);
    finish_output(i);
    return true;
  }

  int next_ready() const {
    int best = -1;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      const Task& t = tasks_[i];
      if (!t.needed || t.started || (failed_ >= 0 && !comes_before(int(i), failed_))) continue;
      const auto& sources = graph_.nodes[i].sources;
      const bool ready =
          std::all_of(sources.begin(), sources.end(), [&](const auto& s) { return tasks_[s.second].done; });
      if (ready && (best < 0 || comes_before(int(i), best))) best = static_cast<int>(i);
    }
    return best;
  }

  void work() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!finished_ && !stop_) {
      const int i = next_ready();
      if (i < 0) {
        wake_.wait(lock);
        continue;
      }
      tasks_[i].started = true;
      ++running_;
      for (const auto& [port, source] : graph_.nodes[i].sources) ++tasks_[source].users;
      lock.unlock();
      std::exception_ptr error;
      try {
        lay_aside();
        with_stage(graph_.nodes[i].name, [&] { bring_back(graph_.nodes[i]); });
        run_node(i);
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      --running_;
      finish(i, error);
      wake_.notify_all();
    }
  }

  void finish(int i, const std::exception_ptr& error) {
    for (const auto& [port, source] : graph_.nodes[i].sources) --tasks_[source].users;
    if (error) {
      bool can_do_without = false;
      try {
        std::rethrow_exception(error);
      } catch (const Cancelled&) {
        // Stopped because another failed: no error of its own. Or because the user asked for it.
        if (!tasks_[i].stop) stop_all();
        return;
      } catch (const Error& e) {
        can_do_without = graph_.nodes[i].may_be_missing && e.code() == ExitCode::quality;
      } catch (...) {
      }
      fail(i, error, can_do_without);
      return;
    }
    tasks_[i].done = true;
    expected_.learn(i, results_[i].data, results_[i].seconds);
    tell_plan();
    for (const auto& [port, source] : graph_.nodes[i].sources)
      if (--tasks_[source].readers == 0) drop(source);
    if (tasks_[i].readers == 0) drop(i);
    malloc_trim(0);  // gives freed memory back, so that it does not count for the next stage
  }

  // Only what comes before it in order may still fail instead of it, and goes on. What comes after it is not begun;
  // what runs is of use to a run that does without the failed one, and else is stopped.
  void fail(int i, const std::exception_ptr& error, bool can_do_without) {
    tasks_[i].error = error;
    if (failed_ < 0 || comes_before(i, failed_)) failed_ = i;
    if (can_do_without) return;
    for (std::size_t n = 0; n < tasks_.size(); ++n)
      if (comes_before(i, int(n))) tasks_[n].stop = true;
  }

  void drop(int i) {
    results_[i].data = {};
    results_[i].spilled = {};
  }

  // Of what is done and waits for a reader that does not run yet, lays the large ones on disk. The data are shared, so
  // a reader that begins meanwhile is not disturbed: then they stay in memory too.
  void lay_aside() {
    if (options_.spill.empty()) return;
    const std::lock_guard<std::mutex> one_at_a_time(spill_mutex_);
    for (std::size_t i = 0; i < tasks_.size() && !spill_failed_; ++i) {
      std::unique_lock<std::mutex> lock(mutex_);
      const auto waits = [&] { return tasks_[i].done && tasks_[i].readers > 0 && tasks_[i].users == 0; };
      if (!waits() || !SpilledData::takes(results_[i].data)) continue;
      auto spilled = results_[i].spilled;
      const stages::StageData data = results_[i].data;
      lock.unlock();
      if (!spilled) spilled = SpilledData::write(data, options_.spill);
      spill_failed_ = !spilled;
      lock.lock();
      results_[i].spilled = spilled;
      if (spilled && waits()) results_[i].data = {};
    }
  }

  void bring_back(const Node& node) {
    const std::lock_guard<std::mutex> one_at_a_time(spill_mutex_);
    for (const auto& [port, source] : node.sources)
      if (results_[source].data.index() == 0 && !lattice_does(node, port))
        results_[source].data = results_[source].loaded();
  }

  static bool lattice_does(const Node& node, const std::string& port) {
    const stages::Port* declared = node.type->find_port(port);
    return declared && declared->lattice_does && declared->lattice_does(node.params);
  }

  // Another reader may bring the voxels back meanwhile.
  stages::StageData input_of(const Node& node, const std::string& port, int source) {
    if (!lattice_does(node, port)) return results_[source].data;
    const std::lock_guard<std::mutex> not_changed(spill_mutex_);
    return results_[source].data.index() == 0 ? results_[source].spilled->lattice() : results_[source].data;
  }

  void run_node(int i) {
    const Node& node = graph_.nodes[i];
    NodeResult& result = results_[i];
    observer_.started(node.name);
    const auto start = Clock::now();
    try {
      with_stage(node.name, [&] { compute(node, result); });
    } catch (const Error& e) {
      // A wrong use of parameters is a usage error in a single tool, but in a run it is a wrong configuration.
      if (e.code() != ExitCode::usage) throw;
      throw Error(e).recoded(ExitCode::bad_config);
    }
    result.state = NodeResult::State::computed;
    result.seconds = seconds_since(start);
    store(node, result);
    finish_output(i);
    if (const auto asked = options_.asked.find(i); asked != options_.asked.end()) asked->second(result);
  }

  // The cache only saves time: a case does not fail because the cache's disk is full.
  void store(const Node& node, NodeResult& result) {
    if (!options_.cache) return;
    into_cache([&] {
      const bool worth = worth_storing(result.data, result.seconds);
      options_.cache->store(node.key, node.output,
                            {worth ? result.data : stages::StageData{}, result.result, result.warnings},
                            result.seconds);
      result.kept = worth;
    });
  }

  template <class F>
  void into_cache(F&& store) {
    if (cache_failed_) return;
    try {
      store();
    } catch (const Error& e) {
      if (!cache_failed_.exchange(true))
        log_warning("the cache keeps nothing more of this run: " + e.file() + ": " + e.what());
    }
  }

  void finish_output(int i) {
    const Node& node = graph_.nodes[i];
    const NodeResult& result = results_[i];
    if (!options_.keep.empty() && node.output != stages::DataKind::nothing)
      stages::save_data(options_.keep / (node.name + stages::file_extension(node.output)), result.data);
    observer_.finished(node.name, result.state == NodeResult::State::cached, result.seconds, result);
  }

  void compute(const Node& node, NodeResult& result) {
    const Progress progress([this, &node](double f) { observer_.progressed(node.name, f); },
                            &tasks_[std::size_t(&node - graph_.nodes.data())].stop);
    stages::StageInputs inputs;
    inputs.shared = &shared_;
    for (const auto& [port, source] : node.sources) {
      inputs.by_port[port] = input_of(node, port, source);
      inputs.key_by_port[port] = graph_.nodes[source].key;
    }
    try {
      static_cast<stages::StageOutcome&>(result) = compute_node(node, std::move(inputs), progress);
    } catch (const Error& e) {
      if (e.code() == ExitCode::quality && e.file().empty()) store_refusal(node, e);
      throw;
    }
  }

  void store_refusal(const Node& node, const Error& refusal) {
    if (options_.cache) into_cache([&] { options_.cache->store_refusal(node.key, refusal); });
  }

  const Graph& graph_;
  const ExecuteOptions& options_;
  RunObserver& observer_;
  ExpectedTime expected_;
  RunOrder order_;
  std::vector<NodeResult> results_;
  std::vector<Task> tasks_;
  stages::SharedWork shared_;
  std::mutex mutex_;
  std::mutex spill_mutex_;     // taken before mutex_
  bool spill_failed_ = false;  // what the disk did not take once is not written again before each stage
  std::condition_variable wake_;
  std::atomic<bool> stop_{false}, cache_failed_{false};
  bool finished_ = false;
  int running_ = 0;
  int failed_ = -1;  // of the nodes that failed, the first in order
};

}  // namespace

stages::StageData NodeResult::loaded() const { return data.index() == 0 && spilled ? spilled->read() : data; }

std::vector<NodeResult> execute(const Graph& graph, const std::vector<int>& wanted, const ExecuteOptions& options,
                                RunObserver& observer) {
  require_allowed(graph, options.allow_external);
  return Executor(graph, wanted, options, observer).run();
}

}  // namespace trephine::pipeline
