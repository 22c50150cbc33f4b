// SPDX-License-Identifier: GPL-3.0-or-later
#include "page/case_page.h"

#include <iostream>

#include "base/text.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "publish/case_lock.h"

namespace trephine::tools {
namespace {
namespace fs = std::filesystem;

// Beside its case the page belongs to what the folder holds now, so no run may change that meanwhile.
fs::path write_beside_case(const fs::path& folder, const page::PageParams& params, const Progress& progress) {
  const publish::CaseLock lock(folder);
  const std::string page = page::make_case_page(folder, params, progress);
  make_output_folder(folder / "report");
  write_file(folder / "report" / page::page_file, page);
  return folder / "report" / page::page_file;
}

}  // namespace

const cli::OwnCommand page_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "page";
  c.summary = "makes the page of a case, which shows it in a browser";
  c.description =
      "Writes one HTML file that opens by a double click in Chromium, Firefox or Safari and needs no server, no "
      "network "
      "and no other file: the surfaces in 3D beside slices with the surfaces' exact cuts, landmarks, warnings, "
      "figures. "
      "`run` makes the same page; this makes it again, or for a case that has none. The case is checked as a simulator "
      "checks it. Deviations and warnings are shown where the case's report folder holds them.";
  c.examples = {"trephine page library/head-01", "trephine page library/head-01 --output head-01.html",
                "trephine page library/head-01 --max-mb 12"};
  const cli::Argument folder = cli::positional_argument("case", Kind::in_folder, "The case's folder.");
  c.arguments = {folder,
                 cli::argument("output", Kind::out_file, "Write the page here, instead of CASE/report/view.html.")};
  c.groups = {cli::ParameterGroup::of<page::PageParams>("Page")};
  c.run = [](const cli::ParsedCommand& parsed) {
    fs::path written = parsed.path("output");
    {
      cli::ProgressDisplay display(parsed.quiet);
      const Progress progress = display.start("page");
      if (written.empty())
        written = write_beside_case(parsed.path("case"), parsed.params<page::PageParams>(), progress);
      else
        write_file(written, page::make_case_page(parsed.path("case"), parsed.params<page::PageParams>(), progress));
      display.finish("page", "");
    }
    if (!parsed.quiet)
      std::cout << written.string() << "  " << grouped_text(static_cast<long long>(fs::file_size(written)))
                << " bytes\n";
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
