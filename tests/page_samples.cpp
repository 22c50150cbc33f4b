// SPDX-License-Identifier: GPL-3.0-or-later
// page_samples FOLDER: cases for the tests that look at pages in a browser (tests/browser).
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>

#include "base/write_file.h"
#include "case_samples.h"
#include "grid/nrrd.h"
#include "page/page_notes.h"

namespace {

using namespace trephine;
namespace fs = std::filesystem;

// A ball of its own in the patient's left half, and nothing on the right.
void add_marker(case_samples::MemoryCase& c, double towards_left_mm) {
  surface::TriMesh mesh = case_samples::ball(9, 12);
  mesh.origin_mm = c.manifest.center_mm + Vec3{towards_left_mm, 0, 0};
  cases::GlbParams glb;
  glb.center_mm = c.manifest.center_mm;
  glb.name = "marker";
  const std::string bytes = cases::make_glb(mesh, glb);
  cases::CaseAnatomy a;
  a.name = "marker";
  a.colour_rgb = {0.1, 0.9, 0.2};
  a.file = cases::describe_case_file("meshes/marker", ".glb", bytes).name;
  a.triangles = mesh.triangles.size();
  a.points = mesh.points_mm.size();
  a.volume_ml = surface::volume_mm3(mesh) / 1000;
  a.area_cm2 = surface::area_mm2(mesh) / 100;
  c.manifest.files.push_back(cases::describe_case_file("meshes/marker", ".glb", bytes));
  c.files[a.file] = bytes;
  c.manifest.anatomies.push_back(a);
}

// 100 HU less for each 10 mm towards the left, bone within the middle, and something dense on the left.
void add_ct(case_samples::MemoryCase& c) {
  grid::Lattice lattice;
  lattice.size = {100, 110, 90};
  lattice.spacing_mm = {2, 1.8, 2.2};
  lattice.origin_mm = c.manifest.center_mm - Vec3{99, 98.1, 97.9};
  grid::Grid<std::int16_t> grid(lattice, -1000);
  for (int k = 0; k < lattice.size[2]; ++k)
    for (int j = 0; j < lattice.size[1]; ++j)
      for (int i = 0; i < lattice.size[0]; ++i) {
        const Vec3 p = lattice.to_world_mm({double(i), double(j), double(k)}) - c.manifest.center_mm;
        if (norm(p) < 80) grid.at(i, j, k) = std::int16_t(norm(p) < 40 ? 1200 : 60 - p.x / 2);
        if (norm(p - Vec3{58, 0, 0}) < 9) grid.at(i, j, k) = 2500;
      }
  const std::string bytes = grid::encode_nrrd(grid::HuVolume(grid), {}, grid::NrrdEncoding::gzip);
  c.manifest.files.push_back(cases::describe_case_file("ct", ".nrrd", bytes));
  c.manifest.ct = {c.manifest.files.back().name, grid.size, grid.spacing_mm};
  c.files[c.manifest.ct.file] = bytes;
}

// Deviations that a test can work out from a point's position, about the case's centre; none in a patch.
std::vector<float> deviations(const surface::TriMesh& mesh) {
  std::vector<float> out;
  for (const Vec3 p : mesh.points_mm)
    out.push_back(norm(p - Vec3{0, -30, 0}) < 25 ? std::numeric_limits<float>::quiet_NaN()
                                                 : float(0.4 * std::sin(p.x / 15) + 0.1 * std::cos(p.z / 9)));
  return out;
}

void write_case(const fs::path& folder, case_samples::MemoryCase c) {
  c.manifest.case_token = folder.filename().string();
  c.seal();
  c.write(folder);
  const cases::LoadedCase loaded = cases::load_case_through(c.reader());
  page::PageNotes notes;
  notes.warnings = {{"import: a slice is missing", "look"},
                    {"<b onclick=alert(1)>bold</b></script><script>document.title='taken'</script>", "wrong"}};
  notes.trade = {{{"draft", 3, 0.4, 20000, ""}, {"bound/0.8", 9, 0.2, 60000, ""}, {"fine", 31, 0.1, 200000, ""}},
                 "bound/0.8",
                 "standard",
                 "the knee"};
  make_output_folder(folder / "report");
  write_file(folder / "report" / page::page_notes_file, page::page_notes_json(notes));
  const cases::CaseAnatomy& inner = c.manifest.anatomies[1];
  write_file(folder / "report" / page::deviation_file_name(c.manifest, inner),
             page::encode_deviation(deviations(loaded.surfaces[1])));
}

void write_cases(const fs::path& out) {
  case_samples::MemoryCase c = case_samples::make_case({{"outer", 80, 60}, {"inner", 40, 50}}, 64);
  c.manifest.anatomies[0].colour_rgb = {0.9, 0.6, 0.5};
  c.manifest.anatomies[1].colour_rgb = {0.3, 0.4, 0.9};
  c.manifest.figures = {
      {"class", std::string("normal")}, {"evans_index_ratio", 0.2625}, {"verdict", std::string("skull: good")}};
  c.manifest.landmarks.push_back({"kocher_right", {-24.25, -50.5, 371.125}, 0.4, "estimated"});
  c.manifest.landmarks.push_back({"<img src=x onerror=\"document.title='taken'\">", {20, -20, 330}, 1, "given"});
  add_marker(c, 58);
  write_case(out / "felt", c);
  add_ct(c);
  write_case(out / "marked", c);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  try {
    write_cases(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "page_samples: %s\n", e.what());
    return 70;
  }
}
