// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>
#include <list>

#include "base/write_file.h"
#include "cases/load_case.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "publish/case_lock.h"
#include "publish/case_pictures.h"

namespace trephine::tools {
namespace {
namespace fs = std::filesystem;

std::vector<publish::CasePicture> side_pictures(const fs::path& folder, const Progress& progress) {
  const cases::LoadedCase loaded = cases::load_case(folder);
  std::list<surface::TriMesh> felt;
  std::vector<publish::PictureAnatomy> shown;
  for (std::size_t n = 0; n < loaded.surfaces.size(); ++n)
    if (const cases::CaseAnatomy& a = loaded.manifest.anatomies[n]; !loaded.surfaces[n].triangles.empty())
      shown.push_back({a.name, &loaded.surfaces[n], a.colour_rgb, a.opacity});
  if (loaded.has_haptic()) publish::show_felt(loaded.manifest, loaded.haptic, felt, shown, progress);
  return publish::make_side_pictures(shown, progress);
}

}  // namespace

const cli::OwnCommand pictures_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "pictures";
  c.summary = "draws each surface of a case from six sides";
  c.description =
      "Writes ANATOMY_sides.png for every surface of the case, and for every shape that is felt and has none, as the "
      "simulator shows it. `run` makes them with --report full; this makes them for a case that has none. The case is "
      "checked as a simulator checks it. The next run of the case takes them away, since they are of this one.";
  c.examples = {"trephine pictures library/head-01", "trephine pictures library/head-01 --output pictures"};
  const cli::Argument folder = cli::positional_argument("case", Kind::in_folder, "The case's folder.");
  c.arguments = {folder,
                 cli::argument("output", Kind::out_folder, "Write them into this folder, instead of CASE/report.")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const fs::path folder = parsed.path("case");
    const fs::path out = parsed.has("output") ? parsed.path("output") : folder / "report";
    // Beside its case they belong to what the folder holds now, so no run may change that meanwhile.
    const auto lock = parsed.has("output") ? nullptr : std::make_unique<publish::CaseLock>(folder);
    cli::ProgressDisplay display(parsed.quiet);
    const std::vector<publish::CasePicture> pictures = side_pictures(folder, display.start("pictures"));
    make_output_folder(out);
    for (const publish::CasePicture& p : pictures) write_file(out / p.name, p.png);
    display.finish("pictures", "");
    if (!parsed.quiet)
      for (const publish::CasePicture& p : pictures) std::cout << (out / p.name).string() << "\n";
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
