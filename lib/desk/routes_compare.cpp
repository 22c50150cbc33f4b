// SPDX-License-Identifier: GPL-3.0-or-later
// A case before its last rebuild, beside what it is now.

#include "base/log.h"
#include "base/progress.h"
#include "base/write_file.h"
#include "cases/load_case.h"
#include "compare/compare_cases.h"
#include "desk/desk_state.h"
#include "desk/json_reply.h"
#include "surface/plane_cut.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

fs::path before_folder(const DeskLibrary& library, const std::string& token) {
  return library.options().library / ".library" / "desk" / (token + ".before");
}

Reply compare(DeskState& desk, const Request& request) {
  const std::string token = request.value("case");
  const fs::path before = before_folder(desk.library, token);
  std::error_code ignored;
  if (token.empty() || !fs::exists(before / "case.json", ignored))
    throw Error(ExitCode::no_input, "", "case",
                "has no earlier version here: the desk keeps what a case was when it builds the case again");
  const Progress progress([](double) {}, &cancel_requested());
  const cases::LoadedCase was = cases::load_case(before), is = cases::load_case(desk.library.options().library / token);
  const compare::CaseComparison made = compare::compare_cases(was, is, {}, progress);
  auto surfaces = std::make_shared<ComparedSurfaces>();
  surfaces->token = token;
  put_surfaces(was, surfaces->was);
  put_surfaces(is, surfaces->is);
  desk.comparisons.keep(std::move(surfaces));
  Json out = Json::parse(compare::comparison_json(made));
  out["text"] = compare::comparison_text(made);
  return json_reply(out);
}

// Where a surface of the comparison, or of the case as it is built, meets a plane of the scan's voxels: four float32 a
// line, its ends in voxels, the lower of the plane's axes first.
Reply cut(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  const std::string which = request.value("which");
  const auto of =
      which == "built" ? desk.comparisons.built(desk.library, request.value("case")) : desk.comparisons.last();
  if (!of || of->token != request.value("case")) throw Error(ExitCode::no_input, "", "case", "was not compared");
  const auto& surfaces = which == "was" ? of->was : of->is;
  const auto found = surfaces.find(request.value("name"));
  const grid::Lattice& lattice = grid::lattice_of(*one->scan());
  const int axis = number_of(request, "axis"), index = number_of(request, "index");
  if (axis < 0 || axis > 2) throw Error(ExitCode::usage, "", "axis", "must be 0, 1 or 2");
  if (found == surfaces.end()) return bytes_reply("");
  Vec3 at;
  at[axis] = index;
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  std::string bytes;
  for (const auto& ends :
       surface::plane_cut(found->second, lattice.to_world_mm(at), lattice.direction.column[std::size_t(axis)]))
    for (const Vec3& end : ends) {
      const Vec3 place = lattice.to_index(end);
      for (const float value : {float(place[u]), float(place[v])})
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  return bytes_reply(std::move(bytes));
}

}  // namespace

void put_surfaces(const cases::LoadedCase& loaded, std::map<std::string, surface::TriMesh>& to) {
  for (std::size_t i = 0; i < loaded.surfaces.size(); ++i) to[loaded.manifest.anatomies[i].name] = loaded.surfaces[i];
}

// The files of a case are named by their content and never written again, so links to them are a copy. Where a file
// system has no links, there is no comparison, and the rebuild goes on.
void keep_before(const DeskLibrary& library, const std::string& token) {
  const fs::path now = library.options().library / token, before = before_folder(library, token);
  std::error_code error;
  if (!fs::exists(now / "case.json", error)) return;
  try {
    const cases::CaseManifest manifest = cases::read_case(now);
    fs::remove_all(before);
    make_private_folder(before.parent_path().parent_path());
    make_private_folder(before.parent_path());
    make_output_folder(before);
    std::vector<std::string> names = {"case.json"};
    for (const auto& file : manifest.files) names.push_back(file.name);
    for (const std::string& name : names) {
      make_output_folder((before / name).parent_path());
      fs::create_hard_link(now / name, before / name);
    }
  } catch (const std::exception& e) {
    log_warning(token + ": what it was is not kept for a comparison");
    fs::remove_all(before, error);
  }
}

Routes compare_routes() {
  return {
      {"api/compare", {"GET", compare}},
      {"api/cut", {"GET", cut}},
  };
}

}  // namespace trephine::desk
