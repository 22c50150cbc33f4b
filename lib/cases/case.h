// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/exit_code.h"
#include "base/params.h"
#include "base/report.h"
#include "base/vec3.h"
#include "cases/case_finding.h"
#include "cases/material.h"
#include "voxel/transfer.h"

namespace trephine::cases {

/// The case package: a folder with case.json and what it names; docs/reference/case-package.md specifies it for other
/// programs. Positions are DICOM patient LPS, mm. What these structs declare is what case.json holds, in this order:
/// its reader, writer, checks, schema and reference page come from here.

/// A member that comes raises the minor version where a case may lack it (not_always()), else the major one, and so
/// does what takes a member away or changes what it means. Cases of another major version are refused.
constexpr int case_version_major = 2, case_version_minor = 0;
/// That version as text: "2.0".
std::string case_version();

struct CaseDeviation {
  double max_mm = 0, p99_mm = 0, rms_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = CaseDeviation;
    v.number(&P::max_mm, "max", case_range::length_mm, "The largest.");
    v.number(&P::p99_mm, "p99", case_range::length_mm, "The 99th percentile.");
    v.number(&P::rms_mm, "rms", case_range::length_mm, "The root of the mean square.");
  }
  std::string fault() const;
};

/// How many surfaces of a case may be touched as meshes.
constexpr int max_touched_surfaces = 16;
/// Says why a surface cannot be touched as a mesh with that material; empty where it can.
std::string fault_of_mesh_material(const MaterialParams& material);

struct CaseAnatomy {
  std::string name;
  std::string file;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
  std::uint64_t triangles = 0, points = 0;
  double volume_ml = 0, area_cm2 = 0;
  CaseDeviation deviation;
  double budget_asked_mm = 0, budget_used_mm = 0;
  CaseValues figures;
  std::optional<CaseMaterial> touched_as;
  template <class V>
  static void describe(V& v) {
    using P = CaseAnatomy;
    v.text(&P::name, "name", "Its name, once in the list.").of_form(some_text);
    v.text(&P::file, "file", "Its surface, one of `files`; without it no surface is displayed.")
        .of_form(case_form::file_name)
        .not_always();
    v.numbers(&P::colour_rgb, "colour_rgb", case_range::share, "Colour, sRGB.");
    v.number(&P::opacity, "opacity", case_range::share, "Opacity.");
    v.integer(&P::triangles, "triangles", case_range::count, "Triangles of the surface.");
    v.integer(&P::points, "points", case_range::count, "Points of the surface.");
    v.number(&P::volume_ml, "volume_ml", case_range::finite, "Volume of the surface.");
    v.number(&P::area_cm2, "area_cm2", case_range::not_negative, "Area of the surface.");
    v.group(&P::deviation, "deviation_mm", "Two-sided deviation from the surface before decimation.");
    v.section("budget_mm", "How far the stages were allowed to move the surface, and did.", [](auto& in) {
      in.number(&P::budget_asked_mm, "asked", case_range::length_mm, "The sum over the stages of what was allowed.");
      in.number(&P::budget_used_mm, "used", case_range::length_mm, "The sum over the stages of what was used.");
    });
    v.map(&P::figures, "figures", "What else the stages reported; names end in their unit.").not_always();
    v.group(&P::touched_as, "touched_as",
            "The material of a surface that is touched as a mesh beside the haptic volume, on both of its sides as its "
            "`front` says. Without it the surface is only seen.")
        .not_always();
  }
  std::string fault() const;
};

struct CaseLandmark {
  std::string name;
  Vec3 position_mm;
  double confidence = 1;
  std::string source;
  template <class V>
  static void describe(V& v) {
    using P = CaseLandmark;
    v.text(&P::name, "name", "Its name, once in the list.").of_form(some_text);
    v.numbers(&P::position_mm, "position_mm", case_range::finite, "Where it is.");
    v.number(&P::confidence, "confidence", case_range::share, "How sure that is.");
    v.word(&P::source, "source", {"found", "estimated", "given", "truth"}, "How it is known.");
  }
};

struct CaseTarget {
  std::string name;
  Vec3 position_mm;
  double confidence = 1;
  std::string anatomy;
  template <class V>
  static void describe(V& v) {
    using P = CaseTarget;
    v.text(&P::name, "name", "Its name, once in the list.").of_form(some_text);
    v.numbers(&P::position_mm, "position_mm", case_range::finite, "Where it is.");
    v.number(&P::confidence, "confidence", case_range::share, "How sure that is.");
    v.text(&P::anatomy, "anatomy", "The anatomy in which it lies; may be empty.");
  }
};

struct CaseBurrHole {
  std::string name;
  Vec3 position_mm;
  Vec3 direction;
  double diameter_mm = 0;
  std::vector<std::string> cut;
  CaseValues figures;  ///< bone_thickness_mm, "skull.removed_mesh_mm3", "skull.removed_haptic_mm3", ...
  template <class V>
  static void describe(V& v) {
    using P = CaseBurrHole;
    v.text(&P::name, "name", "Its name, once in the list.").of_form(some_text);
    v.numbers(&P::position_mm, "position_mm", case_range::finite, "The middle of the hole on the bone's surface.");
    v.numbers(&P::direction, "direction", Range{-1.000001, 1.000001}, "Its axis, of length 1, into the head.");
    v.number(&P::diameter_mm, "diameter_mm", case_range::above_zero, "Its width.");
    v.list(&P::cut, "cut", "The anatomies from whose surface and haptic shape it was cut.");
    v.map(&P::figures, "figures", "What was measured: the bone's thickness, the volumes removed, ...").not_always();
  }
  std::string fault() const;
};

/// How far the felt surface lies from the displayed one: along the normals of the displayed surface within the haptic
/// region, positive where the felt surface lies outside.
struct CaseMismatch {
  double bias_mm = 0, rms_mm = 0, p99_mm = 0, max_mm = 0;
  double missed_ratio = 0;
  std::uint64_t samples = 0;
  template <class V>
  static void describe(V& v) {
    using P = CaseMismatch;
    v.number(&P::bias_mm, "bias_mm", case_range::finite, "The mean; positive where what is felt lies outside.");
    v.number(&P::rms_mm, "rms_mm", case_range::length_mm, "The root of the mean square.");
    v.number(&P::p99_mm, "p99_mm", case_range::length_mm, "The 99th percentile.");
    v.number(&P::max_mm, "max_mm", case_range::length_mm, "The largest.");
    v.number(&P::missed_ratio, "missed_ratio", case_range::share, "Share of the samples near which nothing is felt.");
    v.integer(&P::samples, "samples", Range{1, 9e15}, "How many places were measured.");
  }
  std::string fault() const;
};

/// What a scene says of a shape that is felt, and the case keeps as it is. A new value stands here, and where it is
/// used.
struct ShapeParams {
  bool cuttable = false;
  std::optional<voxel::TransferFunction> transfer;
  template <class V>
  static void describe(V& v) {
    v.flag(&ShapeParams::cuttable, "cuttable", "Whether a tool of the simulator may remove the shape.");
    v.group(
         &ShapeParams::transfer, "transfer",
         "With encoding hu: how the shape is seen by ray casting, and what of it is touched. Without it, it is opaque "
         "in its window, and has the colour of its material.")
        .not_always();
  }
};

struct CaseShape : ShapeParams {
  std::string name;
  int number = 1;
  std::int16_t window_low = 0, window_high = 0;
  CaseMaterial material;
  std::string displayed = "surface";
  double volume_ml = 0;
  CaseMismatch mismatch;  ///< 0 samples where it is displayed from the volume, which has no mismatch by construction
  template <class V>
  static void describe(V& v) {
    using P = CaseShape;
    v.text(&P::name, "name", "Name of the anatomy, once in the list.").of_form(case_form::shape_name);
    v.integer(&P::number, "number", Range{1, 32}, "Its number in the volume; numbers ascend.");
    v.integers(&P::window_low, &P::window_high, "window", Range{-32768, 32767},
               "The lowest and the highest raw value that is its own; windows are disjoint.");
    v.template all_of<ShapeParams>();
    v.word(&P::displayed, "displayed", {"surface", "haptic"},
           "`surface`: by the GLB file of the anatomy of that name; `haptic`: by the present state of the volume, as a "
           "surface at occupancy 1/2.");
    v.number(&P::volume_ml, "volume_ml", case_range::not_negative,
             "The volume that it fills: the sum over all voxels of clamp(1/2 + 2 (o - 1/2), 0, 1), where o is the "
             "decoded occupancy from 0 to 1 (including its share of voxels that hold two shapes), times the volume of "
             "a voxel. In encoding `hu`: the volume of the voxels in its window.");
    v.group(&P::material, "material", "How it feels.");
    v.only_where(v.group(&P::mismatch, "mismatch",
                         "How far what is felt lies from what is seen, along the normals of the displayed surface "
                         "within the haptic region; missing where the shape is displayed from the volume, because then "
                         "the two are the same."),
                 [](const P& s) { return s.mismatch.samples > 0; });
  }
  std::string fault() const { return window_low > window_high ? "window: its low end is above its high end" : ""; }
};

/// The haptic volume (voxel/haptic_volume.h).
struct CaseHaptic {
  std::string file;  ///< empty: the case has none
  std::string hardness_file;
  std::string encoding = "occupancy";
  std::array<int, 3> size{0, 0, 0};
  Vec3 spacing_mm{1, 1, 1};
  std::vector<CaseShape> shapes;
  template <class V>
  static void describe(V& v) {
    using P = CaseHaptic;
    v.text(&P::file, "file", "The volume, one of `files`.").of_form(case_form::file_name);
    v.text(&P::hardness_file, "hardness_file", "The hardness, one of `files`, on the same voxels.")
        .of_form(case_form::file_name)
        .not_always();
    v.word(&P::encoding, "encoding", {"occupancy", "hu"}, "What a voxel's value means.");
    v.integers(&P::size, "size", case_range::voxels, "Voxels along the volume's axes, as in the file.");
    v.numbers(&P::spacing_mm, "spacing_mm", case_range::above_zero, "Size of a voxel along the volume's axes.");
    v.list(&P::shapes, "shapes", "Its shapes, by ascending number.");
  }
};

struct CaseCt {
  std::string file;  ///< empty: the case has none
  std::array<int, 3> size{0, 0, 0};
  Vec3 spacing_mm{1, 1, 1};
  template <class V>
  static void describe(V& v) {
    using P = CaseCt;
    v.text(
         &P::file, "file",
         "The volume, one of `files`: NRRD, int16 HU, gzip, cropped to what is shown and felt, after the face policy.")
        .of_form(case_form::file_name);
    v.integers(&P::size, "size", case_range::voxels, "Voxels along the volume's axes, as in the file.");
    v.numbers(&P::spacing_mm, "spacing_mm", case_range::above_zero, "Size of a voxel along the volume's axes.");
  }
};

struct CaseMissing {
  std::string anatomy;
  std::string why;
  template <class V>
  static void describe(V& v) {
    v.text(&CaseMissing::anatomy, "anatomy", "What the scene calls it.").of_form(some_text);
    v.text(&CaseMissing::why, "why", "What refused it.");
  }
};

struct CaseStandIn {
  std::string anatomy, by, why;
  template <class V>
  static void describe(V& v) {
    using P = CaseStandIn;
    v.text(&P::anatomy, "anatomy", "What the scene calls it; what stands for it has this name in the case.")
        .of_form(some_text);
    v.text(&P::by, "by", "The anatomy of the recipe that stands for it, such as `simple_brain`.").of_form(some_text);
    v.text(&P::why, "why", "What refused it.");
  }
};

struct CaseFile {
  std::string name;    ///< relative, "meshes/skull-0123456789abcdef.glb"
  std::string sha256;  ///< 64 lower-case digits
  std::uint64_t bytes = 0;
  template <class V>
  static void describe(V& v) {
    using P = CaseFile;
    v.text(&P::name, "name", "Relative, at most one folder deep.").of_form(case_form::file_name);
    v.text(&P::sha256, "sha256", "SHA-256 of its content.").of_form(case_form::sha256);
    v.integer(&P::bytes, "bytes", Range{0, 17179869184.0}, "Size of its content.");
  }
};

struct CaseManifest {
  int version_major = case_version_major, version_minor = case_version_minor;
  std::string case_token;
  Vec3 center_mm;
  std::vector<CaseAnatomy> anatomies;
  std::vector<CaseMissing> missing;
  std::vector<CaseStandIn> stand_ins;
  std::vector<CaseLandmark> landmarks;
  std::vector<CaseTarget> targets;
  std::vector<CaseBurrHole> burr_holes;
  CaseHaptic haptic;
  CaseCt ct;
  std::vector<CaseFinding> findings;
  CaseValues figures;  ///< of the patient: class, evans_index_ratio, midline_shift_mm, ...
  std::string face_policy = "keep", face_reason;
  std::string program_version;  ///< "trephine 0.2.0"
  std::string input_sha256;
  CaseValues parameters;  ///< "skull.decimate.max_deviation_mm"
  std::vector<CaseFile> files;
  template <class V>
  static void describe(V& v) {
    using P = CaseManifest;
    v.text(&P::case_token, "case", "The name of the case, which says nothing about the patient.")
        .of_form(case_form::token);
    v.constant("frame", "LPS", "DICOM patient coordinates: x to the patient's left, y posterior, z superior.");
    v.constant("unit", "mm", "Of all positions and distances.");
    v.numbers(&P::center_mm, "center_mm", case_range::finite,
              "The point that the vertices of the GLB files are about.");
    v.list(&P::anatomies, "anatomies", "The anatomies.");
    v.list(&P::missing, "missing", "Anatomies that the scene asked for and could do without (`may_be_missing`).")
        .not_always();
    v.list(&P::stand_ins, "stand_ins",
           "Anatomies for which another of the recipe stands (`stand_in`): they show less than their names promise.")
        .not_always();
    v.only_where(v.group(&P::haptic, "haptic", "The haptic volume and its shapes."),
                 [](const P& m) { return !m.haptic.file.empty(); });
    v.only_where(v.group(&P::ct, "ct", "The CT, where the scene asks for it (`ct:`)."),
                 [](const P& m) { return !m.ct.file.empty(); });
    v.list(&P::landmarks, "landmarks", "Landmarks of the patient.");
    v.list(&P::targets, "targets", "What a procedure aims at.");
    v.list(&P::burr_holes, "burr_holes", "Holes that were cut.");
    v.list(&P::findings, "findings",
           "What a person should look at before the case is used: measured, not diagnosed. A case without findings is "
           "not healthy because of that.")
        .not_always();
    v.map(&P::figures, "figures",
          "What was measured on the patient, by name; `class` is `normal`, `hydrocephalic`, `shifted`, `small`, "
          "`uncertain` (the ventricles cannot be whole, or a sure finding concerns them: the warnings in `run.json` "
          "say why) or `unknown`; "
          "`evans_index_ratio` is absent where a frontal horn is missing or a thread.")
        .not_always();
    v.section("face", "What was done about the patient's face.", [](auto& in) {
      in.word(&P::face_policy, "policy", {"none", "keep", "crop", "deface"},
              "What was done; `none` where the scene says nothing.");
      in.text(&P::face_reason, "reason", "The reason that was given for the policy.");
    });
    v.section("provenance", "What the case was made from, and how.", [](auto& in) {
      in.text(&P::program_version, "program", "The program, with its version.").of_form(some_text);
      in.text(&P::input_sha256, "input_sha256", "The hash of what was read, without identifiers.")
          .of_form(case_form::sha256);
      in.map(&P::parameters, "parameters",
             "Effective values by path; for a program that a recipe names (`external`) also `said_version` and "
             "`output_sha256`, for a correction by hand (`correct`) `added_ml`, `removed_ml` and `already_ratio`.");
    });
    v.list(&P::files, "files", "Every other file of the case, by name.");
  }
  std::string fault() const;

  const CaseAnatomy* find_anatomy(std::string_view name) const;
  const CaseFile* find_file(std::string_view name) const;
};

/// Throws Error with that code (64 from a flag, 78 from a config) unless the token is [a-z0-9][a-z0-9_-]{0,63}.
void validate_case_token(const std::string& token, ExitCode code);

/// A line for each two holes that break into each other: their entries lie nearer than half of both widths.
std::vector<std::string> overlapping_holes(const std::vector<CaseBurrHole>& holes);

/// The bytes of case.json: keys in fixed order, shortest numbers, files sorted by name, and at the end a checksum of
/// everything before it. It holds no time, host or path unless the caller put one into a value. Throws Error 70 where
/// the manifest contradicts itself (an anatomy's file that is not listed, repeated names, numbers that are not finite).
std::string to_json(const CaseManifest& manifest);
/// Checks the version, then the checksum, then parses. Of a newer minor version it takes the parts that it knows.
/// Throws Error 65.
CaseManifest parse_case_json(std::string_view json);

/// Reads case.json and checks size and SHA-256 of every file that it names, without parsing them. Throws Error naming
/// the file: 66 where one is missing, 65 where one is damaged or the major version is another (both are named).
CaseManifest read_case(const std::filesystem::path& case_folder);

/// The bytes of one of the case's files, checked again, so that the parsed bytes are the checked ones.
std::string read_case_file(const std::filesystem::path& case_folder, const CaseFile& file);

/// The name of a file by its content: "meshes/skull", ".glb" and bytes give meshes/skull-<first 16 digits of the
/// SHA-256>.glb.
CaseFile describe_case_file(const std::string& stem, const std::string& extension, std::string_view bytes);

/// Writes the bytes under their content name, unless the file exists already; synced. Throws Error 73 and 74.
CaseFile write_case_file(const std::filesystem::path& case_folder, const std::string& stem,
                         const std::string& extension, std::string_view bytes);

/// Renames case.json into place as the last step: before it the old case is complete, after it the new one. Throws
/// Error 70 where a file that the manifest names is missing or has another size; 73 and 74. Files of the old case stay
/// until remove_unnamed_case_files.
void publish_case(const std::filesystem::path& case_folder, const CaseManifest& manifest);

/// Removes files with a content name that case.json does not name, and temporary files of dead processes; returns how
/// many. Call it only under the case's lock, because another run may be about to name them. A reader of the older case
/// that misses a file gets the Error 66 of read_case or read_case_file, which names the file; it should read case.json
/// again.
int remove_unnamed_case_files(const std::filesystem::path& case_folder);

}  // namespace trephine::cases
