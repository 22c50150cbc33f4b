// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/status.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text.h"
#include "base/text_table.h"
#include "cluster/slurm.h"
#include "library/catalogue.h"
#include "library/slurm_engine.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

class Looking {
 public:
  explicit Looking(const fs::path& library) : state_(library) {}

  LibraryStatus look(const std::optional<LibraryBuildRequest>& configured) {
    json_["jobs"] = Json::array();
    for (const Batch& batch : read_batches(state_, true)) look_at(batch);
    if (configured) find_stale(*configured);
    last_failures();
    tell();
    return std::move(out_);
  }

 private:
  void look_at(const Batch& batch) {
    ++batches_;
    const auto tasks = cluster::tasks_of_slurm(batch.slurm_name());
    out_.answers = out_.answers && tasks.has_value();
    std::map<std::string, cluster::SlurmTask> in_slurm;  // by the job's name
    for (const cluster::SlurmTask& t : tasks.value_or(std::vector<cluster::SlurmTask>{}))
      for (const BatchArray& a : batch.arrays)
        if (cluster::is_alive(t) && a.slurm == t.array && t.index >= 0 &&
            static_cast<std::size_t>(t.index) < a.names.size())
          in_slurm[a.names[static_cast<std::size_t>(t.index)]] = t;
    const auto ended = ended_tasks(batch);
    for (const BatchJob& j : batch.jobs) {
      known_.insert(j.name);
      const auto task = in_slurm.find(j.name);
      if (task != in_slurm.end()) {
        const bool waits = task->second.state == "PENDING";
        ++(waits ? out_.waiting : out_.running);
        add(j, waits ? "waits" : "runs", task->second.node, waits ? task->second.reason : "");
      } else if (is_final(batch, j, ended)) {
        const JobResult& r = ended.at(j.name).result;
        ++(r.code == 0 ? out_.built : out_.failed);
        add(j, r.code == 0 ? "built" : "failed", ended.at(j.name).node,
            r.code == 0 ? "" : std::to_string(r.code) + "  " + r.reason);
      } else if (!tasks) {
        add(j, "not known", "", "Slurm's controller does not answer");
      } else {
        ++out_.lost;
        const auto r = ended.find(j.name);
        add(j, "lost", r == ended.end() ? "" : r->second.node,
            r == ended.end() ? "left no result, and Slurm knows it no more"
                             : std::to_string(r->second.result.code) + "  " + r->second.result.reason);
      }
    }
  }

  void add(const BatchJob& j, const std::string& how, const std::string& node, const std::string& why) {
    json_["jobs"].push_back({{"job", j.name}, {"state", how}, {"node", node}, {"tries", j.tries}, {"reason", why}});
    if (how != "built") cells_.push_back({j.name, how, node, to_text(j.tries), printable(why)});
  }

  void find_stale(const LibraryBuildRequest& request) {
    const LibraryConfig config = read_library_config(request.config, request.overrides);
    PlanOptions options;
    options.pictures = request.params.pictures;
    options.program_version = request.program_version;
    options.write = false;
    const LibraryPlan plan = make_plan(config, state_, options, Progress({}, &cancel_requested()));
    json_["stale"] = Json::object();
    for (const PlannedCase& c : plan.cases) {
      if (c.fault || c.reasons.empty() || known_.count("case." + c.token)) continue;
      ++out_.stale;
      json_["stale"][c.token] = c.reasons;
      cells_.push_back({"case." + c.token, "stale", "", "", printable(c.reasons.front())});
    }
    json_["stale_count"] = out_.stale;
  }

  // Of cases that no open batch has.
  void last_failures() {
    std::error_code error;
    const std::string ending = ".result.json";
    std::vector<std::string> tokens;
    for (fs::directory_iterator it(state_.folder() / "cases", error), end; !error && it != end; it.increment(error)) {
      const std::string name = it->path().filename().string();
      if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
        tokens.push_back(name.substr(0, name.size() - ending.size()));
    }
    std::sort(tokens.begin(), tokens.end());
    json_["failed_before"] = Json::object();
    for (const std::string& token : tokens) {
      if (known_.count("case." + token)) continue;
      const auto r = read_result(state_, token);
      if (!r || r->code == 0) continue;
      ++failed_before_;
      json_["failed_before"][token] = {{"code", r->code}, {"reason", r->reason}};
      cells_.push_back({"case." + token, "failed", "", "", std::to_string(r->code) + "  " + printable(r->reason)});
    }
  }

  void tell() {
    Json counts = {{"running", out_.running}, {"waiting", out_.waiting}, {"built", out_.built},
                   {"failed", out_.failed},   {"lost", out_.lost},       {"batches", batches_},
                   {"answers", out_.answers}};
    counts.update(json_);
    out_.json = counts.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    if (batches_ == 0)
      out_.table = "no cluster works on this library\n";
    else
      out_.table = std::to_string(out_.running) + " running, " + std::to_string(out_.waiting) + " waiting, " +
                   std::to_string(out_.built) + " built, " + std::to_string(out_.failed) + " failed, " +
                   std::to_string(out_.lost) + " lost, in " + std::to_string(batches_) +
                   (batches_ == 1 ? " batch\n" : " batches\n");
    if (!out_.answers) out_.table += "Slurm's controller does not answer: what runs and what waits is not known\n";
    if (batches_ > 0 && out_.answers && out_.running + out_.waiting == 0)
      out_.table += "nothing of it waits or runs: `trephine library build` goes on with it\n";
    if (!cells_.empty()) {
      cells_.insert(cells_.begin(), {"job", "state", "node", "tries", ""});
      out_.table += text_table(cells_, "lllrl");
    }
  }

  const LibraryState state_;
  LibraryStatus out_;
  Json json_;
  std::vector<std::vector<std::string>> cells_;
  std::set<std::string> known_;
  int batches_ = 0, failed_before_ = 0;
};

}  // namespace

LibraryStatus status_of_library(const fs::path& library, const std::optional<LibraryBuildRequest>& configured) {
  std::error_code error;
  if (!fs::is_directory(library, error))
    throw Error(ExitCode::no_input, library.string(), "", "is no library's folder");
  return Looking(fs::absolute(library).lexically_normal()).look(configured);
}

}  // namespace trephine::library
