// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"

namespace trephine::lesson {

/// What a CT after a procedure shows of it, in the case's frame (LPS, mm): outcome.json, which `trephine outcome`
/// writes and `trephine-sim score-outcome` judges. It names no patient, file, date or host.

/// found: it may be judged. doubtful: it was seen, and what it is or where is not sure. none: nothing was seen.
enum class Sighting { none, doubtful, found };
const char* to_text(Sighting sighting);

struct OutcomePlace {
  Vec3 at_mm;
  template <class V>
  static void describe(V& v) {
    v.numbers(&OutcomePlace::at_mm, "at_mm", Range{-1e5, 1e5}, "LPS.");
  }
};

/// How the scan was laid on the case.
struct OutcomeRegistration {
  Sighting sighting = Sighting::none;
  std::vector<std::string> doubts;
  std::array<double, 12> transform{};
  double residual_mm = 0, mirrored_residual_mm = 0, widening_mm = 0, overlap_ratio = 0, matched_ratio = 0,
         scale_ratio = 0;
  std::int64_t points_count = 0, marks_count = 0;
  double target_error_mm = 0, next_level_residual_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeRegistration;
    v.choice(&P::sighting, "sighting", {{"found", Sighting::found}, {"doubtful", Sighting::doubtful}},
             "Whether the scan surely lies where it is laid.");
    v.words(&P::doubts, "doubts", "Why it is doubtful: shape, mirrored, scale, overlap, marks, level.");
    v.numbers(&P::transform, "transform", Range{-1e5, 1e5},
              "Rows of the matrix from a place of the case to the scan, each with its offset, mm.");
    v.number(&P::residual_mm, "residual_mm", Range{0, 1e3},
             "Root mean square of how far the bone lies off, of the nearest four fifths.");
    v.number(&P::mirrored_residual_mm, "mirrored_residual_mm", Range{0, 1e3}, "The same of the mirrored case.");
    v.number(&P::widening_mm, "widening_mm", Range{-1e3, 1e3},
             "By how much all bone is wider in the scan: its blur and its edge are others.");
    v.number(&P::overlap_ratio, "overlap_ratio", Range{0, 1}, "Share of the case's bone that lies in the scan.");
    v.number(&P::matched_ratio, "matched_ratio", Range{0, 1}, "Share of that which has an edge of bone within 2 mm.");
    v.number(&P::scale_ratio, "scale_ratio", Range{0, 1}, "By how much it would still stretch along an axis.");
    v.integer(&P::points_count, "points_count", Range{0, 1e9}, "Places of the bone by which it was laid.");
    v.integer(&P::marks_count, "marks_count", Range{0, 99},
              "Marks of a print by which it was laid; residual_mm is theirs then.")
        .not_always();
    v.number(&P::target_error_mm, "target_error_mm", Range{0, 1e3},
             "Of marks: the expected error where the procedure aims, the largest of the targets.")
        .not_always();
    v.number(&P::next_level_residual_mm, "next_level_residual_mm", Range{0, 1e3},
             "Of a spine: residual_mm where every vertebra is shifted by a level or more, the best of these.")
        .not_always();
  }
};

/// A hole in the bone that the case does not have.
struct OutcomeHole {
  std::string side;
  Vec3 outer_mm, inner_mm, out;
  double diameter_mm = 0, area_mm2 = 0, bone_mm = 0, confidence = 0, error_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeHole;
    v.word(&P::side, "side", {"left", "right", "middle"}, "The patient's side.");
    v.numbers(&P::outer_mm, "outer_mm", Range{-1e5, 1e5}, "Its middle at the outer table.");
    v.numbers(&P::inner_mm, "inner_mm", Range{-1e5, 1e5}, "Its middle at the inner table.");
    v.numbers(&P::out, "out", Range{-1.000001, 1.000001}, "Its axis, of length 1, out of the head.");
    v.number(&P::diameter_mm, "diameter_mm", Range{0, 1e3}, "Of the circle of its area.");
    v.number(&P::area_mm2, "area_mm2", Range{0, 1e6}, "Across its axis.");
    v.number(&P::bone_mm, "bone_mm", Range{0, 100}, "Thickness of the case's bone there, along its axis.");
    v.number(&P::confidence, "confidence", Range{0, 1}, "From 0.5 on it counts as found.");
    v.number(&P::error_mm, "error_mm", Range{0, 1e3},
             "Standard error of the registration there, by leaving parts of the head out.");
  }
};

/// A piece of bone that is missing, much wider than what a burr makes.
struct OutcomeOpening {
  std::string side;
  Vec3 middle_mm, out;
  double area_cm2 = 0, longest_mm = 0, bone_mm = 0, confidence = 0, error_mm = 0;
  std::vector<OutcomePlace> border;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeOpening;
    v.word(&P::side, "side", {"left", "right", "middle"}, "The patient's side, of its middle.");
    v.numbers(&P::middle_mm, "middle_mm", Range{-1e5, 1e5}, "Its middle at the outer table of the case's bone.");
    v.numbers(&P::out, "out", Range{-1.000001, 1.000001}, "Of length 1, out of the head there.");
    v.number(&P::area_cm2, "area_cm2", Range{0, 1e4}, "Of the outer table that is missing.");
    v.number(&P::longest_mm, "longest_mm", Range{0, 1e3},
             "Between the two places of its border that lie farthest apart.");
    v.number(&P::bone_mm, "bone_mm", Range{0, 100}, "Median thickness of the case's bone there.");
    v.number(&P::confidence, "confidence", Range{0, 1}, "From 0.5 on it counts as found.");
    v.number(&P::error_mm, "error_mm", Range{0, 1e3},
             "Standard error of the registration in its middle, by leaving parts of the head out.");
    v.list(&P::border, "border", "Places of the outer table along its border, each the farthest in one direction.");
  }
};

/// A dense, thin and long thing in the head that leads to the bone.
struct OutcomeCourse {
  std::string side;
  Vec3 tip_mm, inner_mm, outer_mm, axis;
  std::vector<OutcomePlace> course;
  double length_mm = 0, width_mm = 0, bend_mm = 0, mean_hu = 0, seen_mm = 0, confidence = 0, error_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeCourse;
    v.word(&P::side, "side", {"left", "right", "middle"}, "The patient's side where it passes the bone.");
    v.numbers(&P::tip_mm, "tip_mm", Range{-1e5, 1e5}, "Its end in the head.");
    v.numbers(&P::inner_mm, "inner_mm", Range{-1e5, 1e5}, "Where it passes the inner table of the case's bone.");
    v.numbers(&P::outer_mm, "outer_mm", Range{-1e5, 1e5}, "Where it passes the outer table.");
    v.numbers(&P::axis, "axis", Range{-1.000001, 1.000001},
              "Unit direction of the straight line through it, towards the tip.");
    v.list(&P::course, "course", "Its middle line, from the tip to the outer table, about every millimetre.");
    v.number(&P::length_mm, "length_mm", Range{0, 1e4}, "Along it from the inner table to the tip.");
    v.number(&P::width_mm, "width_mm", Range{0, 100}, "Full width at half height, which the scan's blur widens.");
    v.number(&P::bend_mm, "bend_mm", Range{0, 1e3}, "How far it lies off that line at most.");
    v.number(&P::mean_hu, "mean_hu", Range{-1e5, 1e5}, "Of its middle line.");
    v.number(&P::seen_mm, "seen_mm", Range{0, 1e4}, "Length that was seen; the rest up to the bone is that line.");
    v.number(&P::confidence, "confidence", Range{0, 1}, "From 0.5 on it counts as found.");
    v.number(&P::error_mm, "error_mm", Range{0, 1e3},
             "Standard error of the registration at the tip, by leaving parts of the head out.");
  }
};

/// A vertebra, laid by its own bone.
struct OutcomeVertebra {
  std::int64_t number = 0;
  std::array<double, 12> transform{};
  double residual_mm = 0;
  std::int64_t points_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeVertebra;
    v.integer(&P::number, "number", Range{0, 99}, "As the case's pedicles count.");
    v.numbers(&P::transform, "transform", Range{-1e5, 1e5},
              "Rows of the matrix from a place of the case to the scan, each with its offset, mm.");
    v.number(&P::residual_mm, "residual_mm", Range{0, 1e3}, "How far its bone lies off, as of the whole.");
    v.integer(&P::points_count, "points_count", Range{0, 1e9}, "Places of the bone by which it was laid.");
  }
};

/// A screw in a vertebra, or a needle, where it lies in the case.
struct OutcomeScrew {
  std::string kind = "screw", pedicle;
  Sighting sighting = Sighting::doubtful;
  std::vector<std::string> doubts;
  Vec3 tip_mm, head_mm, entry_mm, axis;
  double length_mm = 0, diameter_mm = 0, bend_mm = 0, pedicle_off_mm = 0, error_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeScrew;
    v.word(&P::kind, "kind", {"screw", "needle"}, "A needle has no head, is thin and leads out of the patient.");
    v.text(&P::pedicle, "pedicle", "The pedicle that it passes nearest, as the case names it.").is_required();
    v.choice(&P::sighting, "sighting", {{"found", Sighting::found}, {"doubtful", Sighting::doubtful}},
             "Whether it is surely a screw, and surely there.");
    v.words(&P::doubts, "doubts",
            "Why it is doubtful: registration, vertebra, scale, no_head, scan_ends, no_rod, thick_slices, no_pedicle, "
            "two_pedicles, backwards.");
    v.numbers(&P::tip_mm, "tip_mm", Range{-1e5, 1e5}, "Its tip.");
    v.numbers(&P::head_mm, "head_mm", Range{-1e5, 1e5},
              "Where its head begins, on its axis; of a needle where the metal ends.");
    v.numbers(&P::entry_mm, "entry_mm", Range{-1e5, 1e5}, "Where its axis enters the case's bone.");
    v.numbers(&P::axis, "axis", Range{-1.000001, 1.000001}, "Of length 1, towards the tip.");
    v.number(&P::length_mm, "length_mm", Range{0, 1e4}, "From there to the tip.");
    v.number(&P::diameter_mm, "diameter_mm", Range{0, 100}, "Of the shaft.");
    v.number(&P::bend_mm, "bend_mm", Range{0, 1e3}, "How far its middle lies off the axis at most.");
    v.number(&P::pedicle_off_mm, "pedicle_off_mm", Range{0, 1e3}, "How far its axis passes the middle of the pedicle.");
    v.number(&P::error_mm, "error_mm", Range{0, 1e3},
             "Standard error of the vertebra's registration at the tip, by leaving parts of its bone out.");
  }
};

/// A central line, from the skin to its tip.
struct OutcomeLine {
  std::string side;
  Sighting sighting = Sighting::doubtful;
  std::vector<std::string> doubts;
  Vec3 tip_mm, skin_mm, vein_mm, axis;
  std::vector<OutcomePlace> course;
  double length_mm = 0, width_mm = 0, mean_hu = 0, in_vein_mm = 0, in_lung_mm = 0, clavicle_moved_mm = 0,
         confidence = 0, error_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeLine;
    v.word(&P::side, "side", {"left", "right"}, "The patient's side where it passes the skin.");
    v.choice(&P::sighting, "sighting", {{"found", Sighting::found}, {"doubtful", Sighting::doubtful}},
             "Whether it is surely a line, and surely there.");
    v.words(
        &P::doubts, "doubts",
        "Why it is doubtful: registration, clavicle, two_lines, not_to_the_skin, metal, scan_ends, before_air, no_ct, "
        "short, faint.");
    v.numbers(&P::tip_mm, "tip_mm", Range{-1e5, 1e5}, "Its end in the patient.");
    v.numbers(&P::skin_mm, "skin_mm", Range{-1e5, 1e5},
              "Where it passes the case's skin; where it does not, the end of what was seen.");
    v.numbers(&P::vein_mm, "vein_mm", Range{-1e5, 1e5},
              "Where it first meets the case's vein; where it does not, its tip.");
    v.numbers(&P::axis, "axis", Range{-1.000001, 1.000001}, "Unit direction from skin_mm to vein_mm.");
    v.list(&P::course, "course", "Its middle line, from the tip to skin_mm, about every millimetre.");
    v.number(&P::length_mm, "length_mm", Range{0, 1e4}, "Along it, from there to there.");
    v.number(&P::width_mm, "width_mm", Range{0, 100}, "Full width at half height, which the scan's blur widens.");
    v.number(&P::mean_hu, "mean_hu", Range{-1e5, 1e5}, "Of its middle line.");
    v.number(&P::in_vein_mm, "in_vein_mm", Range{0, 1e4}, "Of its length, within the case's vein.");
    v.number(&P::in_lung_mm, "in_lung_mm", Range{0, 1e4}, "And within the case's lung or pleura.");
    v.number(&P::clavicle_moved_mm, "clavicle_moved_mm", Range{0, 1e3},
             "How far the clavicle of that side lies off where the rest of the bone lays it.");
    v.number(&P::confidence, "confidence", Range{0, 1}, "From 0.5 on it counts as found.");
    v.number(&P::error_mm, "error_mm", Range{0, 1e3},
             "Standard error of the registration at the tip, by leaving parts of the chest out.");
  }
};

struct OutcomeRecord {
  int trephine_outcome = 1;
  std::string case_token, case_sha256, series_sha256, program;
  OutcomeRegistration registration;
  Sighting catheter = Sighting::none, hole = Sighting::none;
  std::vector<std::string> catheter_doubts;
  std::vector<OutcomeCourse> courses;
  std::vector<OutcomeHole> holes;
  std::vector<OutcomeOpening> openings;
  bool holes_beforehand = false;
  std::vector<OutcomeVertebra> vertebrae;
  std::vector<OutcomeScrew> screws;
  std::vector<OutcomeLine> lines;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeRecord;
    const auto sightings = {std::pair<const char*, Sighting>{"none", Sighting::none},
                            {"doubtful", Sighting::doubtful},
                            {"found", Sighting::found}};
    v.integer(&P::trephine_outcome, "trephine_outcome", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::case_token, "case", "The name of the case.").is_required();
    v.text(&P::case_sha256, "case_sha256", "SHA-256 of its case.json.").is_required();
    v.text(&P::series_sha256, "series_sha256", "The hash of the scan that was read, without identifiers.")
        .is_required();
    v.text(&P::program, "program", "The program, with its version.").is_required();
    v.group(&P::registration, "registration", "How the scan was laid on the case.");
    v.choice(&P::catheter, "catheter", sightings, "Whether one catheter surely lies in the head.");
    v.words(&P::catheter_doubts, "catheter_doubts",
            "Why that is doubtful: registration, two_courses, not_to_the_bone, no_hole, faint, short.");
    v.list(&P::courses, "courses", "What may be a catheter, the surest first.");
    v.choice(&P::hole, "hole", sightings, "Whether a hole was made.");
    v.list(&P::holes, "holes", "Gaps of the bone that the case does not have, the largest first.");
    v.list(&P::openings, "openings", "Wider gaps, of a craniectomy, which no burr makes; the largest first.")
        .not_always();
    v.flag(&P::holes_beforehand, "holes_beforehand",
           "The case was drilled before: holes there cannot be known from those of the procedure.");
    v.list(&P::vertebrae, "vertebrae", "Of a spine: the vertebrae that lie in the scan, from the lowest.").not_always();
    v.list(&P::screws, "screws", "Of a spine: screws and needles, by pedicle.").not_always();
    v.list(&P::lines, "lines", "Of a chest: central lines, the surest first.").not_always();
  }
};

std::string to_json(const OutcomeRecord& record);
/// Throws Error 65 naming the field.
OutcomeRecord parse_outcome(std::string_view json);
/// The same of a file; throws 65 and 66 with its name. `sha256`, where given, becomes that of its bytes.
OutcomeRecord read_outcome(const std::filesystem::path& file, std::string* sha256 = nullptr);

}  // namespace trephine::lesson
