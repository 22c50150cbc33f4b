// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "peers/experiment.h"

namespace trephine::peers {

struct CompareParams {
  std::string triangles = "10000,25000,53000,100000,185000,270000,500000,1000000,1500000";
  int servo_ticks = 10000, client_pictures = 10, repetitions = 30, pokes = 300;
  double hand_seconds = 5, speed_mm_per_s = 20;
  bool graphics = true;
  template <class V>
  static void describe(V& v) {
    using P = CompareParams;
    v.text(&P::triangles, "triangles", "Numbers of polygons of the meshes, with commas, ascending.");
    v.integer(&P::servo_ticks, "servo_ticks", Range{100, 10000000}, "Ticks that are measured for each servo time.");
    v.integer(&P::client_pictures, "client_pictures", Range{1, 10000},
              "Pictures that are measured for each client time.");
    v.integer(&P::repetitions, "repetitions", Range{1, 1000},
              "Varied hands that follow the path with each algorithm; each takes the next of the meshes.");
    v.integer(&P::pokes, "pokes", Range{1, 100000}, "Pokes through each thin wall at each speed.");
    v.number(&P::hand_seconds, "hand_seconds", Range{1, 600}, "How long each hand follows the path.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{0.1, 2000}, "Speed along the path where times are measured.");
    v.flag(&P::graphics, "graphics", "Draw the meshes without a window, and measure it.");
  }
  /// The numbers of `triangles`. Throws Error 64 where it is no ascending list of 1 to 64 numbers from 100 to 20
  /// million.
  std::vector<std::size_t> counts() const;
};

struct MeshRow {
  std::size_t asked = 0, triangles = 0;
  double mean_off_mm = 0, most_off_mm = 0;  ///< of the felt surface's points from the mesh
};
/// `triangles`: of the mesh that is felt, 0 where voxels are.
struct ServoRow {
  std::string algorithm;
  std::size_t triangles = 0;
  TickTimes times;
};
struct ForceRow {
  std::string algorithm;
  std::size_t triangles = 0;
  int hand = 0;
  bool closed = true;  ///< the hand feels the force; else one recording's poses
  RunFigures figures;
};
/// `triangles`: of the mesh that is shown, also where voxels are felt.
struct ClientRow {
  std::string algorithm;
  std::size_t triangles = 0;
  double haptics_ms = 0;
  std::optional<double> graphics_ms;
};
struct FallRow {
  std::string algorithm, wall;
  double mm_a_tick = 0;
  int pokes = 0, falls = 0;
};

/// What the experiments of [Rizzi, chapter 4] give here.
struct Comparison {
  std::string case_token, shape;
  std::size_t felt_triangles = 0;  ///< of the shape's own surface
  std::vector<AlgorithmKind> kinds;
  std::vector<MeshRow> meshes;
  std::vector<ServoRow> servo;
  std::vector<ForceRow> forces;
  std::vector<ClientRow> client;
  std::vector<FallRow> falls;
  std::string renderer, renderer_fault;  ///< what drew; or why nothing did
  double load = 0;                       ///< of the machine, at the end
  int cores = 0;
};

/// CPU time of drawing a mesh once, ms, of all of the process's threads.
using DrawMesh = std::function<double(const surface::TriMesh&)>;

/// The volume is that of `contact`; the shape is felt. `draw` may be empty. `recording` are poses for the open loop;
/// empty: those of the average hand with our own algorithm. `say` gets a line for each part that is done.
void compare(Comparison& out, const contact::ContactVolume& contact, int shape, const CompareParams& params,
             const PeerParams& peers, const device::HandPathParams& path,
             const std::vector<haptics::ServoFrame>& recording, const DrawMesh& draw,
             const std::function<void(const std::string&)>& say, const Progress& progress);

/// What chapter 4 (or 3) claims, and whether it holds here.
struct Claim {
  std::string where, claim, here;
  enum class Verdict { holds, fails, too_few_hands, not_measured } verdict = Verdict::not_measured;
};
const char* name_of(Claim::Verdict verdict);  ///< "does not hold", "too few hands to decide"
/// Below so many hands nothing is said of what is rare.
constexpr int min_hands = 10;
std::vector<Claim> claims_of(const Comparison& comparison);

/// Mean, and range, of a figure over the closed loops of an algorithm.
struct Spread {
  double mean = 0, least = 0, most = 0;
  int runs = 0;
};
Spread spread_of(const Comparison& c, const std::string& algorithm, bool closed,
                 const std::function<double(const RunFigures&)>& figure);
/// Whether it touched in nine of ten ticks. Else its time is that of ticks that touch nothing, which says nothing.
inline bool keeps_contact(const ServoRow& row) { return row.times.touching_ratio >= 0.9; }
/// The least and the largest mesh's row of an algorithm, of a servo's those that keep contact; null where there is
/// none.
const ServoRow* servo_of(const Comparison& c, const std::string& algorithm, bool largest);
const ClientRow* client_of(const Comparison& c, const std::string& algorithm, bool largest);

/// What speaks against an algorithm, a phrase each [Rizzi, Table IV]: ticks above 1 ms or that grow with the polygons,
/// anomalies of the force and frames without, walls that are poked through, time of the client thread.
std::vector<std::string> issues_of(const Comparison& comparison, const std::string& algorithm);
/// Of all algorithms, as a table of Markdown.
std::string issue_table(const Comparison& comparison);

/// servo.csv, forces.csv, client.csv, falls.csv, meshes.csv, compare.json, compare.md, and the figures as .png and .svg
/// by gnuplot. Throws as write_file does; without gnuplot it warns, and the page has no pictures.
void write_comparison(const Comparison& comparison, const std::filesystem::path& out, const std::string& version);
std::string comparison_page(const Comparison& comparison, const std::vector<std::string>& pictures);
/// Draws into the folder; returns the names of the pictures, none where gnuplot is missing.
std::vector<std::string> plot_comparison(const Comparison& comparison, const std::filesystem::path& out);

}  // namespace trephine::peers
