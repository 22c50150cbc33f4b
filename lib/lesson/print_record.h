// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"

namespace trephine::lesson {

/// What was printed of a case: NAME-print.json, beside the parts. It names no patient.

struct PrintPart {
  std::string name, file;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  std::int64_t triangles_count = 0;
  double volume_ml = 0, smallest_wall_mm = 0;
  std::array<double, 3> size_mm{};
  template <class V>
  static void describe(V& v) {
    using P = PrintPart;
    v.text(&P::name, "name", "Its name, once in the list.").is_required();
    v.text(&P::file, "file", "Its surface.").is_required();
    v.numbers(&P::colour_rgb, "colour_rgb", Range{0, 1}, "Colour, sRGB.");
    v.integer(&P::triangles_count, "triangles_count", Range{0, 1e9}, "Triangles.");
    v.number(&P::volume_ml, "volume_ml", Range{0, 1e6}, "Volume of its material.");
    v.number(&P::smallest_wall_mm, "smallest_wall_mm", Range{0, 1e4},
             "The largest ball within it that touches its thinnest place, measured on its surface; above the letters "
             "that are engraved.");
    v.numbers(&P::size_mm, "size_mm", Range{0, 1e5}, "Of its box.");
  }
};

/// Two parts that lie beside each other.
struct PrintGap {
  std::string a, b;
  double smallest_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = PrintGap;
    v.text(&P::a, "a", "One part.").is_required();
    v.text(&P::b, "b", "The other.").is_required();
    v.number(&P::smallest_mm, "smallest_mm", Range{-1e4, 1e4},
             "Least distance of their surfaces, below 0 where they cut.");
  }
};

/// A sphere of the skull by which a scan of the print is laid on the case.
struct PrintMark {
  std::int64_t number = 1;
  Vec3 at_mm, case_mm, post;
  double diameter_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = PrintMark;
    v.integer(&P::number, "number", Range{1, 99}, "Its number.");
    v.numbers(&P::at_mm, "at_mm", Range{-1e5, 1e5}, "Its middle, in the parts' frame.");
    v.numbers(&P::case_mm, "case_mm", Range{-1e5, 1e5}, "The same in the case's frame, LPS.");
    v.numbers(&P::post, "post", Range{-1.000001, 1.000001},
              "Unit, in the case's frame: from its middle to the post on which it stands.");
    v.number(&P::diameter_mm, "diameter_mm", Range{1, 100}, "Its diameter.");
  }
};

struct PrintTarget {
  std::string name;
  Vec3 case_mm;
  template <class V>
  static void describe(V& v) {
    v.text(&PrintTarget::name, "name", "What a procedure aims at.").is_required();
    v.numbers(&PrintTarget::case_mm, "case_mm", Range{-1e5, 1e5}, "In the case's frame, LPS.");
  }
};

struct PrintRecord {
  int trephine_print = 1;
  std::string case_token, case_sha256, program;
  std::array<double, 12> case_to_print{};
  double wall_mm = 0, gap_mm = 0, smallest_wall_mm = 0, smallest_gap_mm = 0, gel_ml = 0;
  std::vector<PrintPart> parts;
  std::vector<PrintGap> gaps;
  std::vector<PrintMark> marks;
  std::vector<PrintTarget> targets;
  template <class V>
  static void describe(V& v) {
    using P = PrintRecord;
    v.integer(&P::trephine_print, "trephine_print", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::case_token, "case", "The name of the case.").is_required();
    v.text(&P::case_sha256, "case_sha256", "SHA-256 of its case.json.").is_required();
    v.text(&P::program, "program", "The program, with its version.").is_required();
    v.numbers(&P::case_to_print, "case_to_print", Range{-1e5, 1e5},
              "Rows of the matrix from a place of the case (LPS, mm) to the parts' frame, each with its offset. The "
              "frame has x to the left, y to the back, z up, and the cut at 0.");
    v.number(&P::wall_mm, "wall_mm", Range{0, 100}, "The least wall that was asked for.");
    v.number(&P::gap_mm, "gap_mm", Range{0, 100}, "The gap that was asked for.");
    v.number(&P::smallest_wall_mm, "smallest_wall_mm", Range{0, 1e4}, "The smallest wall of all parts, measured.");
    v.number(&P::smallest_gap_mm, "smallest_gap_mm", Range{-1e4, 1e4}, "The smallest gap of all pairs, measured.");
    v.number(&P::gel_ml, "gel_ml", Range{0, 1e5}, "What fills the skull down to the base, beside the ventricles.");
    v.list(&P::parts, "parts", "The parts.");
    v.list(&P::gaps, "gaps", "Pairs of parts that lie beside each other.");
    v.list(&P::marks, "marks", "The spheres.");
    v.list(&P::targets, "targets", "What a procedure aims at.");
  }
};

std::string to_json(const PrintRecord& record);
/// Throws Error 65 naming the field.
PrintRecord parse_print(std::string_view json);
/// The same of a file; throws 65 and 66 with its name.
PrintRecord read_print(const std::filesystem::path& file);

}  // namespace trephine::lesson
