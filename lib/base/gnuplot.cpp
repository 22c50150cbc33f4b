// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/gnuplot.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/spawn.h"
#include "base/temporary_folder.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine {

std::string gnuplot_picture(const std::string& terminal, const std::string& script) {
  const TemporaryFolder folder;
  const std::filesystem::path picture = folder.path() / "picture", file = folder.path() / "script.gp";
  write_file(file,
             "set terminal " + terminal + "\nset output '" + picture.string() + "'\nset encoding utf8\n" + script);
  SpawnRequest gnuplot;
  gnuplot.argv = {"gnuplot", file.string()};
  gnuplot.shares_stdout = gnuplot.shares_stderr = true;
  if (wait_for(spawn(gnuplot), until_it_ends_s).code != 0)
    throw Error(ExitCode::internal, "gnuplot", "", "failed, or is not installed (Debian: gnuplot-nox)");
  const std::vector<char> bytes = read_file(picture);
  return {bytes.begin(), bytes.end()};
}

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : printable(text)) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

const char* gnuplot_colour(std::size_t n) {
  constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                     "#e69f00", "#56b4e9", "#8c564b", "#f0e442"};
  return colours[n % (sizeof colours / sizeof *colours)];
}

std::string gnuplot_svg(int width, int height) {
  return fmt::format("svg size {},{} font 'sans,11' background '#ffffff'", width, height);
}
std::string gnuplot_png(int width, int height) {
  return fmt::format("pngcairo size {},{} font 'sans,11'", width, height);
}

}  // namespace trephine
