// SPDX-License-Identifier: GPL-3.0-or-later
#include "trade/trade.h"

#include <iostream>

#include "base/log.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"

namespace trephine::tools {
const cli::OwnCommand trade_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "trade";
  c.summary = "measures what accuracy costs in a case: seconds, triangles, bytes";
  c.description =
      "Makes the configuration's case many times with other parameters, each stage timed alone and repeated. Every "
      "result is compared with the finest one and, for a phantom, with the truth. Stages that two points share are "
      "computed once; a sweep that was stopped continues where it was. OUT gets plots, trade.csv and trade.json. With "
      "accuracy, budget or profile, `trade:` in a configuration chooses a point of trade.json.";
  c.examples = {"trephine trade configs/sample.yaml --out trade",
                "trephine trade configs/ct_head.yaml --series head/dicom --truth head/truth/truth.json --out trade",
                "trephine trade configs/sample.yaml --plan configs/trade/quick.yaml --out trade --repeats-count 1"};
  const cli::Argument config = cli::positional_argument("config", Kind::in_file, "Configuration of the case (.yaml).");
  const cli::Argument out = cli::required_argument("out", Kind::out_folder, "Folder for the results.");
  cli::Argument set =
      cli::argument("set", Kind::text, "Override of all points, as for `run`; swept parameters win over it.");
  cli::Argument root =
      cli::argument("root", Kind::in_folder, "A further folder that paths in the configuration may lead to.");
  set.repeated = root.repeated = true;
  c.arguments = {
      config,
      out,
      cli::argument("plan", Kind::in_file,
                    "What is swept (.yaml). Without it, bounds, counts, smoothing and voxel sizes are swept."),
      cli::argument("series", Kind::in_scan, "Folder of the CT series; overrides the configuration's."),
      cli::argument("truth", Kind::in_file, "Truth of a phantom (truth.json)."),
      cli::argument("landmarks", Kind::in_file, "Landmarks that a person placed, as for `run`."),
      set,
      root};
  c.groups = {cli::ParameterGroup::of<trade::TradeParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    trade::TradeRequest request;
    request.config = parsed.path("config");
    request.plan = parsed.path("plan");
    request.out = parsed.path("out");
    request.truth = parsed.path("truth");
    request.overrides.series = parsed.path("series");
    request.overrides.landmarks = parsed.path("landmarks");
    request.overrides.set = parsed.all("set");
    for (const std::string& r : parsed.all("root")) request.overrides.roots.emplace_back(r);
    request.params = parsed.params<trade::TradeParams>();
    request.program_version = TREPHINE_VERSION;
    trade::TradeResult result;
    {
      cli::ProgressDisplay display(parsed.quiet);
      display.start("sweep");
      std::string shown;
      result = trade::measure_trade(request,
                                    [&](std::size_t point, std::size_t count, const std::string& work, double done) {
                                      if (work != shown) {
                                        if (!shown.empty()) display.finish(shown);
                                        display.start(shown = work);
                                      }
                                      display.report(work, done);
                                      display.report("sweep", double(point) / double(count));
                                    });
      if (!shown.empty()) display.finish(shown);
      display.finish("sweep", std::to_string(result.points.size()) + " points, " +
                                  std::to_string(result.measured_count) + " measurements made");
    }
    for (const std::string& why : result.stale) log_warning(why);
    trade::write_trade(result, request.out, request.program_version);
    if (!parsed.quiet)
      std::cout << "\n" << trade::trade_table(result) << "\n" << (request.out / "trade.json").string() << "\n";
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
