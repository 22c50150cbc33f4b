// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/write_file.h"
#include "peers/comparison.h"

namespace trephine::peers {
namespace {

using Json = nlohmann::ordered_json;

// A figure of the forces' tables, once for CSV and JSON.
struct Column {
  const char* name;
  double (*of)(const RunFigures&);
};
constexpr Column force_columns[] = {{"anomaly_ratio", [](const RunFigures& f) { return f.force.anomaly_ratio; }},
                                    {"zero_force_ratio", [](const RunFigures& f) { return f.force.zero_force_ratio; }},
                                    {"most_step_n", [](const RunFigures& f) { return f.force.max_step_n; }},
                                    {"sigma_n_per_s", [](const RunFigures& f) { return f.force.sigma_n_per_s; }},
                                    {"mean_lag_mm", [](const RunFigures& f) { return f.force.mean_lag_mm; }},
                                    {"most_lag_mm", [](const RunFigures& f) { return f.force.max_lag_mm; }},
                                    {"fallen_ratio", [](const RunFigures& f) { return f.fallen_ratio; }},
                                    {"falls", [](const RunFigures& f) { return double(f.falls); }},
                                    {"mean_force_n", [](const RunFigures& f) { return f.force.mean_force_n; }},
                                    {"most_force_n", [](const RunFigures& f) { return f.force.most_force_n; }},
                                    {"judged_frames", [](const RunFigures& f) { return double(f.force.frames); }}};

double rounded(double v) { return std::round(v * 1e6) / 1e6; }

std::string servo_csv(const Comparison& c) {
  std::string text = "algorithm,triangles,mean_us,median_us,p99_us,most_us,touching_ratio\n";
  for (const ServoRow& r : c.servo)
    text += fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.4f}\n", r.algorithm, r.triangles, r.times.mean_us,
                        r.times.median_us, r.times.p99_us, r.times.most_us, r.times.touching_ratio);
  return text;
}

std::string forces_csv(const Comparison& c) {
  std::string text = "algorithm,triangles,loop,hand";
  for (const Column& column : force_columns) text += std::string(",") + column.name;
  text += "\n";
  for (const ForceRow& r : c.forces) {
    text += fmt::format("{},{},{},{}", r.algorithm, r.triangles, r.closed ? "closed" : "open", r.hand);
    for (const Column& column : force_columns) text += fmt::format(",{:.6g}", column.of(r.figures));
    text += "\n";
  }
  return text;
}

std::string client_csv(const Comparison& c) {
  std::string text = "algorithm,triangles_shown,haptics_ms,graphics_ms\n";
  for (const ClientRow& r : c.client)
    text += fmt::format("{},{},{:.4f},{}\n", r.algorithm, r.triangles, r.haptics_ms,
                        r.graphics_ms ? fmt::format("{:.3f}", *r.graphics_ms) : "");
  return text;
}

std::string falls_csv(const Comparison& c) {
  std::string text = "algorithm,wall,mm_a_tick,pokes,falls\n";
  for (const FallRow& r : c.falls)
    text += fmt::format("{},{},{:g},{},{}\n", r.algorithm, r.wall, r.mm_a_tick, r.pokes, r.falls);
  return text;
}

std::string meshes_csv(const Comparison& c) {
  std::string text = "asked,triangles,mean_off_mm,most_off_mm\n";
  for (const MeshRow& r : c.meshes)
    text += fmt::format("{},{},{:.4f},{:.4f}\n", r.asked, r.triangles, r.mean_off_mm, r.most_off_mm);
  return text;
}

std::string json_text(const Comparison& c, const std::string& version) {
  Json j = {{"trephine_compare", 1},
            {"version", version},
            {"case", c.case_token},
            {"shape", c.shape},
            {"felt_triangles", c.felt_triangles},
            {"cores", c.cores},
            {"load", rounded(c.load)}};
  j["renderer"] = c.renderer.empty() ? Json() : Json(c.renderer);
  for (const AlgorithmKind& k : c.kinds)
    j["algorithms"].push_back(
        {{"name", k.name}, {"title", k.title}, {"from", k.from}, {"feels", k.feels_mesh ? "triangles" : "voxels"}});
  j["meshes"] = j["servo"] = j["forces"] = j["client"] = j["falls"] = j["claims"] = Json::array();
  for (const MeshRow& r : c.meshes)
    j["meshes"].push_back({{"asked", r.asked},
                           {"triangles", r.triangles},
                           {"mean_off_mm", rounded(r.mean_off_mm)},
                           {"most_off_mm", rounded(r.most_off_mm)}});
  for (const ServoRow& r : c.servo)
    j["servo"].push_back({{"algorithm", r.algorithm},
                          {"triangles", r.triangles},
                          {"mean_us", rounded(r.times.mean_us)},
                          {"median_us", rounded(r.times.median_us)},
                          {"p99_us", rounded(r.times.p99_us)},
                          {"most_us", rounded(r.times.most_us)},
                          {"touching_ratio", rounded(r.times.touching_ratio)}});
  for (const ForceRow& r : c.forces) {
    Json row = {{"algorithm", r.algorithm},
                {"triangles", r.triangles},
                {"loop", r.closed ? "closed" : "open"},
                {"hand", r.hand}};
    for (const Column& column : force_columns) row[column.name] = rounded(column.of(r.figures));
    j["forces"].push_back(std::move(row));
  }
  for (const ClientRow& r : c.client)
    j["client"].push_back({{"algorithm", r.algorithm},
                           {"triangles_shown", r.triangles},
                           {"haptics_ms", rounded(r.haptics_ms)},
                           {"graphics_ms", r.graphics_ms ? Json(rounded(*r.graphics_ms)) : Json()}});
  for (const FallRow& r : c.falls)
    j["falls"].push_back({{"algorithm", r.algorithm},
                          {"wall", r.wall},
                          {"mm_a_tick", r.mm_a_tick},
                          {"pokes", r.pokes},
                          {"falls", r.falls}});
  for (const Claim& claim : claims_of(c))
    j["claims"].push_back(
        {{"where", claim.where}, {"claim", claim.claim}, {"here", claim.here}, {"verdict", name_of(claim.verdict)}});
  return j.dump(1) + "\n";
}

std::string grouped(std::size_t n) {
  std::string text = std::to_string(n);
  for (int at = int(text.size()) - 3; at > 0; at -= 3) text.insert(std::size_t(at), ",");
  return text;
}

std::string table_head(const std::vector<std::string>& columns) {
  std::string head = "|", line = "|";
  for (const std::string& column : columns) {
    head += " " + column + " |";
    line += "---|";
  }
  return head + "\n" + line + "\n";
}

std::string servo_table(const Comparison& c) {
  std::vector<std::string> columns = {"algorithm"};
  for (const MeshRow& m : c.meshes) columns.push_back(grouped(m.triangles));
  std::string text = table_head(columns);
  for (const AlgorithmKind& kind : c.kinds) {
    text += "| " + kind.title + " |";
    for (const MeshRow& m : c.meshes) {
      const ServoRow* row = nullptr;
      for (const ServoRow& r : c.servo)
        if (r.algorithm == kind.name && r.triangles == (kind.feels_mesh ? m.triangles : 0)) row = &r;
      const std::string times =
          row ? fmt::format("{:.2f} / {:.2f} / {:.1f}", row->times.mean_us, row->times.median_us, row->times.p99_us)
              : "";
      text += !row || keeps_contact(*row) ? " " + times + " |" : " (" + times + ") |";
    }
    text += "\n";
  }
  return text;
}

std::string force_table(const Comparison& c, bool closed) {
  std::string text =
      table_head({"algorithm", "runs", "anomaly coefficient: mean (least to most)", "frames without force",
                  "largest change, N", "sigma, N/s", "lag, mm", "fallen through: share, times"});
  for (const AlgorithmKind& kind : c.kinds) {
    const auto of = [&](const char* name) {
      for (const Column& column : force_columns)
        if (std::string(column.name) == name) return spread_of(c, kind.name, closed, column.of);
      return Spread{};
    };
    const Spread anomaly = of("anomaly_ratio"), falls = of("falls");
    text += fmt::format(
        "| {} | {} | {:.5f} ({:.5f} to {:.5f}) | {:.4f} | {:.3f} | {:.2f} | {:.3f} | {:.4f}, {:.0f} |\n", kind.title,
        anomaly.runs, anomaly.mean, anomaly.least, anomaly.most, of("zero_force_ratio").mean, of("most_step_n").most,
        of("sigma_n_per_s").mean, of("mean_lag_mm").mean, of("fallen_ratio").mean, falls.mean * falls.runs);
  }
  return text;
}

std::string client_table(const Comparison& c) {
  std::vector<std::string> columns = {"haptics, ms a picture"};
  for (const MeshRow& m : c.meshes) columns.push_back(grouped(m.triangles));
  std::string text = table_head(columns);
  std::string graphics = "| *graphics* |";
  for (const AlgorithmKind& kind : c.kinds) {
    text += "| " + kind.title + " |";
    for (const ClientRow& r : c.client) {
      if (r.algorithm != kind.name) continue;
      text += fmt::format(" {:.3f} |", r.haptics_ms);
      if (&kind == &c.kinds.front()) graphics += r.graphics_ms ? fmt::format(" {:.1f} |", *r.graphics_ms) : " |";
    }
    text += "\n";
  }
  return text + graphics + "\n";
}

std::string fall_table(const Comparison& c) {
  std::vector<double> speeds;
  std::vector<std::pair<std::string, std::string>> lines;  // algorithm and wall
  for (const FallRow& r : c.falls) {
    if (std::find(speeds.begin(), speeds.end(), r.mm_a_tick) == speeds.end()) speeds.push_back(r.mm_a_tick);
    const std::pair<std::string, std::string> line{r.algorithm, r.wall};
    if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  std::vector<std::string> columns = {"algorithm", "wall"};
  for (const double mm : speeds) columns.push_back(fmt::format("{:g} mm a tick", mm));
  std::string text = table_head(columns);
  for (const auto& [algorithm, wall] : lines) {
    std::string title = algorithm;
    for (const AlgorithmKind& kind : c.kinds)
      if (kind.name == title) title = kind.title;
    text += "| " + title + " | " + wall + " |";
    for (const double mm : speeds) {
      std::string cell;
      for (const FallRow& r : c.falls)
        if (r.algorithm == algorithm && r.wall == wall && r.mm_a_tick == mm) cell = std::to_string(r.falls);
      text += " " + cell + " |";
    }
    text += "\n";
  }
  return text;
}

std::string picture(const std::vector<std::string>& pictures, const std::string& name, const std::string& what) {
  for (const std::string& p : pictures)
    if (p == name) return "\n![" + what + "](" + name + ")\n";
  return "";
}

}  // namespace

std::string comparison_page(const Comparison& c, const std::vector<std::string>& pictures) {
  std::string text = fmt::format(
      "# Haptic algorithms compared: case {}, shape {}\n\n"
      "The experiments of chapter 4 of the dissertation, by `trephine-sim compare`. All algorithms feel the same "
      "surface with the same plain spring, without friction and damping; the device gives at most {:g} N. Where "
      "triangles are felt, they are the shape's surface of {} triangles, parted or reduced. Times are CPU times of "
      "the thread; the machine has {} cores and its load was {:.1f}.\n\n"
      "The peers are historical: algorithms of 1995 to 2004, written anew from their papers, as the dissertation "
      "compared "
      "them. They say nothing of libraries of today. {}\n\n## What holds\n\n",
      c.case_token, c.shape, device_most_n, grouped(c.felt_triangles), c.cores, c.load,
      std::any_of(c.kinds.begin(), c.kinds.end(), [](const AlgorithmKind& k) { return k.name.rfind("chai3d", 0) == 0; })
          ? "CHAI3D, given by --peer, is the library itself."
          : "CHAI3D itself is not among them here; --peer gives it.");
  text += table_head({"where", "claim", "here", ""});
  for (const Claim& claim : claims_of(c))
    text += fmt::format("| {} | {} | {} | **{}** |\n", claim.where, claim.claim, claim.here, name_of(claim.verdict));
  text += "\n## Issues of each algorithm (Table IV)\n\n" + issue_table(c);
  text +=
      "\n## Servo loop\n\nTime of a tick in us: mean / median / p99, by polygons. In brackets: it touched in less than "
      "nine ticks of ten, so that most of these are ticks without contact; they are in no figure and no claim. Below "
      "0.1 us the clock tells nothing, and the figure shows 0.1.\n\n" +
      servo_table(c);
  text += picture(pictures, "servo_polygons.png", "Servo time by polygons (figure 11)");
  text += picture(pictures, "servo_voxels.png", "Servo time of what feels voxels (figure 12)");
  text += "\nHow far the felt surface's points lie from each mesh:\n\n" +
          table_head({"polygons", "mean, mm", "at most, mm"});
  for (const MeshRow& m : c.meshes)
    text += fmt::format("| {} | {:.3f} | {:.2f} |\n", grouped(m.triangles), m.mean_off_mm, m.most_off_mm);
  text += "\n## Forces\n\nClosed loop: a simulated hand follows its target over the surface and feels the force; " +
          fmt::format("{} varied hands, each on the next of the meshes.\n\n",
                      spread_of(c, c.kinds.front().name, true, force_columns[0].of).runs) +
          force_table(c, true) + picture(pictures, "anomalies.png", "Force anomaly coefficient (figure 17)");
  text += "\nOpen loop: the poses of one recording, on each of the meshes.\n\n" + force_table(c, false);
  text += fmt::format(
      "\nThe coefficient alone is 0 for lost contact and for violent forces alike. A frame counts as "
      "fallen through where there is no force and the device is deeper than {:g} mm within the shape. "
      "The change of force is the largest of all runs, the others are means of runs.\n",
      fall_mm);
  text += fmt::format(
              "\n## Thin walls\n\nPokes straight through, of {}: how often the proxy was beyond the wall. The device "
              "rests up to 60 mm away, then goes at once at that speed, up to 60 degrees from the wall's normal, until "
              "it is 6 mm behind it. 1 mm a tick is 1 m/s, as of a hand that slips; 10 and 100 mm is what a loop that "
              "stood still sees. docs/validation/compare.md says why who falls.\n\n",
              c.falls.empty() ? 0 : c.falls.front().pokes) +
          fall_table(c);
  text += "\n## Client thread\n\n" + client_table(c);
  text += c.renderer.empty() ? "\nNothing was drawn" + (c.renderer_fault.empty() ? "" : ": " + c.renderer_fault) + ".\n"
                             : "\nDrawn by " + c.renderer + "; CPU time of all its threads.\n";
  text += picture(pictures, "client_haptics.png", "Haptics in the client thread (figure 18)");
  text += picture(pictures, "client_combined.png", "Haptics and graphics in the client thread (figure 19)");
  text +=
      "\nWhat the last figure does not show lies beneath another line: its haptics is little beside the graphics.\n";
  return text;
}

void write_comparison(const Comparison& c, const std::filesystem::path& out, const std::string& version) {
  make_output_folder(out);
  write_file(out / "servo.csv", servo_csv(c));
  write_file(out / "forces.csv", forces_csv(c));
  write_file(out / "client.csv", client_csv(c));
  write_file(out / "falls.csv", falls_csv(c));
  write_file(out / "meshes.csv", meshes_csv(c));
  write_file(out / "compare.json", json_text(c, version));
  write_file(out / "compare.md", comparison_page(c, plot_comparison(c, out)));
}

}  // namespace trephine::peers
