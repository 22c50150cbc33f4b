// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "base/error.h"
#include "base/joined.h"
#include "base/progress.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/compare_graphics.h"
#include "haptics/drilling.h"
#include "haptics/recording.h"
#include "peers/comparison.h"
#include "peers/loaded_peer.h"
#include "session/felt_case.h"

namespace trephine::commands {
namespace {

// The one that is named; else the first that can be drilled, which bone is; else the first.
const voxel::HapticShape& shape_to_feel(const session::FeltCase& felt) {
  if (!felt.felt_shape.empty()) {
    const voxel::HapticShape* named = felt.loaded.haptic.find_shape(felt.felt_shape);
    if (!named)
      throw Error(ExitCode::usage, "", "--shape",
                  felt.felt_shape + " is felt as a mesh, and the algorithms are compared in the haptic volume");
    return *named;
  }
  const std::uint64_t drilled = haptics::drilled_shapes(felt.loaded.manifest.haptic);
  for (const voxel::HapticShape& shape : felt.loaded.haptic.shapes)
    if (drilled >> shape.number & 1) return shape;
  return felt.loaded.haptic.shapes.front();
}

std::vector<peers::AlgorithmKind> kinds_of(const cli::ParsedCommand& parsed) {
  std::vector<peers::AlgorithmKind> all = peers::all_algorithms();
  for (const std::string& library : parsed.all("peer")) {
    peers::AlgorithmKind loaded = peers::load_peer(library);
    for (const peers::AlgorithmKind& kind : all)
      if (kind.name == loaded.name)
        throw Error(ExitCode::usage, library, "--peer", "is named " + loaded.name + ", as another one is");
    all.push_back(std::move(loaded));
  }
  const std::vector<std::string> wanted = parsed.all("algorithm");
  if (wanted.empty()) return all;
  std::vector<peers::AlgorithmKind> chosen = {all.front()};  // ours, beside which the others are seen
  for (const std::string& name : wanted) {
    const auto same = [&](const peers::AlgorithmKind& kind) { return kind.name == name; };
    const auto found = std::find_if(all.begin(), all.end(), same);
    if (found == all.end()) {
      throw Error(ExitCode::usage, "", "--algorithm",
                  "there is no " + name + ", but " + joined(all, ", ", &peers::AlgorithmKind::name));
    }
    if (std::none_of(chosen.begin(), chosen.end(), same)) chosen.push_back(*found);
  }
  return chosen;
}

std::vector<haptics::ServoFrame> poses_of(const cli::ParsedCommand& parsed, const session::FeltCase& felt) {
  if (!parsed.has("recording")) return {};
  haptics::Recording recording = haptics::read_recording(parsed.path("recording"));
  haptics::require_seal(recording, parsed.path("recording"));
  if (recording.header.case_sha256 != felt.case_sha256)
    throw Error(ExitCode::bad_input, parsed.text("recording"), "case_sha256",
                "was made with another case.json than the case's");
  if (recording.frames.empty()) throw Error(ExitCode::bad_input, parsed.text("recording"), "frames", "has none");
  return std::move(recording.frames);
}

ExitCode run_compare(const cli::ParsedCommand& parsed) {
  const peers::CompareParams& params = parsed.params<peers::CompareParams>();
  params.counts();
  peers::Comparison comparison;
  comparison.kinds = kinds_of(parsed);
  session::FeltCase felt(parsed.path("case"), parsed.text("shape"));
  const std::vector<haptics::ServoFrame> poses = poses_of(parsed, felt);
  const contact::ContactVolume contact(felt.loaded.haptic);
  const voxel::HapticShape& shape = shape_to_feel(felt);
  comparison.case_token = felt.loaded.manifest.case_token;
  comparison.shape = shape.name;
  const peers::DrawMesh draw = params.graphics ? mesh_drawer(comparison.renderer, comparison.renderer_fault) : nullptr;
  if (!params.graphics) comparison.renderer_fault = "--no-graphics";
  const auto say = [](const std::string& line) { std::cout << line << "\n" << std::flush; };
  say(fmt::format("case {}, shape {}", comparison.case_token, comparison.shape));
  if (!comparison.renderer_fault.empty()) say("nothing is drawn: " + comparison.renderer_fault);
  peers::compare(comparison, contact, shape.number, params, parsed.params<peers::PeerParams>(),
                 parsed.params<device::HandPathParams>(), poses, draw, say, Progress({}, &cancel_requested()));
  peers::write_comparison(comparison, parsed.path("out"), TREPHINE_VERSION);
  for (const peers::Claim& claim : peers::claims_of(comparison))
    say(fmt::format("{}: {} ({})", peers::name_of(claim.verdict), claim.claim, claim.here));
  say("written: " + (parsed.path("out") / "compare.md").string());
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand compare_command([] {
  cli::Command c;
  c.name = "compare";
  c.summary = "compares haptic algorithms on a case, as in chapter 4 of the dissertation";
  c.description =
      "Runs our proxy, the dissertation's own walk, and algorithms of others, each written anew from its paper, on one "
      "shape of the case: servo time by number of polygons, forces of varied hands in a closed loop and of one "
      "recording's poses, thin walls, and the client thread's time by number of polygons. The folder gets compare.md "
      "with what holds of the dissertation's claims, compare.json, a CSV for each table, and the figures "
      "(docs/how-to/compare-algorithms.md). Exit code 78 says that the path meets no surface.\n\n"
      "Times are CPU times of the thread that is measured. Forces, falls and meshes are the same at each run.";
  cli::Argument recording = cli::argument("recording", cli::Argument::Kind::in_file,
                                          "Recording of a session with the case, for the open loop; else our own "
                                          "algorithm's with the average hand.");
  cli::Argument peer = cli::argument("peer", cli::Argument::Kind::in_file,
                                     "Shared library of a further algorithm (simulator/peers/peer_abi.h).");
  cli::Argument algorithm = cli::argument("algorithm", cli::Argument::Kind::text,
                                          "Only this algorithm beside ours; may be given more than once.");
  peer.repeated = algorithm.repeated = true;
  c.arguments = {cli::positional_argument("case", cli::Argument::Kind::in_folder, "Folder of the case."),
                 cli::required_argument("out", cli::Argument::Kind::out_folder, "Folder for tables, figures and page."),
                 cli::argument("shape", cli::Argument::Kind::text,
                               "The shape that is felt; without it, the first that can be drilled."),
                 recording,
                 peer,
                 algorithm};
  c.groups = {cli::ParameterGroup::of<peers::CompareParams>("Experiments"),
              cli::ParameterGroup::of<peers::PeerParams>("Algorithms"),
              cli::ParameterGroup::of<device::HandPathParams>("The hand's path")};
  c.examples = {"trephine-sim compare library/sample --out comparison",
                "trephine-sim compare library/sample --out comparison --triangles 10000,100000 --repetitions 5 "
                "--algorithm god_object --no-graphics"};
  c.run = run_compare;
  return c;
});

}  // namespace trephine::commands
