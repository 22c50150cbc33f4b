// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "base/error.h"
#include "base/png.h"
#include "base/write_file.h"
#include "cases/load_case.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "fluoro/fluoroscope.h"

namespace trephine::commands {
namespace {

struct PictureParams {
  int size_px = 512;
  std::array<double, 3> needle_tip_mm{0, 0, 0}, needle_tail_mm{0, 0, 0};
  double needle_diameter_mm = 1.27;
  fluoro::MetalShown metal = fluoro::MetalShown::bright;
  template <class V>
  static void describe(V& v) {
    using P = PictureParams;
    v.integer(&P::size_px, "size_px", Range{16, 4096}, "Pixels of the picture's side.");
    v.numbers(&P::needle_tip_mm, "needle_tip_mm", Range{-1e5, 1e5}, "The tip of a needle in the picture, LPS.");
    v.numbers(&P::needle_tail_mm, "needle_tail_mm", Range{-1e5, 1e5}, "Its tail; where it is the tip, there is none.");
    v.number(&P::needle_diameter_mm, "needle_diameter_mm", Range{0.01, 50}, "Its diameter.");
    v.choice(&P::metal, "metal", {{"bright", fluoro::MetalShown::bright}, {"dark", fluoro::MetalShown::dark}},
             "How bone and metal are shown: bright, as on a film, or dark, as on most C-arms.");
  }
};

ExitCode run_fluoro(const cli::ParsedCommand& parsed) {
  const PictureParams& p = parsed.params<PictureParams>();
  const cases::LoadedCase loaded = cases::load_case(parsed.path("case"), cases::LoadParts{true});
  fluoro::CArmParams arm = parsed.params<fluoro::CArmParams>();
  fluoro::Fluoroscope scope = with_file(parsed.text("case"), [&] { return fluoro::Fluoroscope(loaded.ct); });
  if (!parsed.given.count("centre_mm")) {
    const Vec3 c = scope.volume().centre_mm();
    arm.centre_mm = {c.x, c.y, c.z};
  }
  std::vector<fluoro::MetalRod> metal;
  if (p.needle_tip_mm != p.needle_tail_mm)
    metal.push_back({{p.needle_tip_mm[0], p.needle_tip_mm[1], p.needle_tip_mm[2]},
                     {p.needle_tail_mm[0], p.needle_tail_mm[1], p.needle_tail_mm[2]},
                     p.needle_diameter_mm});
  const auto begin = std::chrono::steady_clock::now();
  const fluoro::FluoroPicture picture = scope.picture(arm, p.size_px, metal);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  write_file(parsed.path("output"), png_of(picture.size, picture.size, 1, fluoro::shown_grey(picture, p.metal)));
  std::cout << fmt::format("{}: {} x {} pixels in {:.3f} s\n", parsed.text("output"), picture.size, picture.size,
                           seconds);
  if (!metal.empty()) {
    const auto at = fluoro::CArm(arm, p.size_px).project(metal[0].tip_mm);
    std::cout << fmt::format("the needle's tip is at pixel {:.2f}, {:.2f}\n", at[0], at[1]);
  }
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand fluoro_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "fluoro";
  c.summary = "makes a fluoroscopic picture of a case's CT, with a needle in it";
  c.description =
      "Follows X-rays through the CT that the case holds (a scene asks for it by `ct: {}`), for any place of a C-arm, "
      "and adds a needle by the length of each ray in it. Bone and metal are bright, or dark with --metal dark. "
      "docs/validation/fluoroscopy.md says how good the "
      "pictures are.";
  const cli::Argument folder = cli::positional_argument("case", Kind::in_folder, "Folder of the case.");
  const cli::Argument output = cli::required_argument("output", Kind::out_file, "Write the picture (.png) here.");
  c.arguments = {folder, output};
  c.groups = {cli::ParameterGroup::of<fluoro::CArmParams>("The C-arm"),
              cli::ParameterGroup::of<PictureParams>("The picture")};
  c.examples = {"trephine-sim fluoro library/sample --view lateral --output lateral.png",
                "trephine-sim fluoro library/spine --view free --orbit-deg 30 --needle-tip-mm 0,10,20 --needle-tail-mm "
                "0,100,20 --output needle.png"};
  c.run = run_fluoro;
  return c;
});

}  // namespace trephine::commands
