// SPDX-License-Identifier: GPL-3.0-or-later
// A case whose checksums are right but whose case.json says something else: refused where the specification forbids it,
// and what is accepted means what it says.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "case_samples.h"
#include "cases/load_case.h"

namespace trephine {
namespace {

using case_samples::MemoryCase;
using Json = nlohmann::ordered_json;

const std::string head = "{\n \"format\": \"trephine-case 2.0\",";

Json body_of(const MemoryCase& c) {
  Json j = Json::parse(c.files.at("case.json"));
  j.erase("format");
  j.erase("checksum");
  return j;
}
void seal_with(MemoryCase& c, const Json& body) {
  const std::string text = body.dump(1);
  std::string out = head + text.substr(1, text.size() - 3);
  out += ",\n \"checksum\": \"" + sha256_of_bytes(out) + "\"\n}\n";
  c.files["case.json"] = out;
}
/// "" where it loads, else the field.
std::string refusal(const MemoryCase& c) {
  try {
    cases::load_case_through(c.reader());
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input) << e.line("");
    return e.field().empty() ? "?" : e.field();
  }
  return "";
}
std::string with(const MemoryCase& good, const char* pointer, const Json& value) {
  MemoryCase c = good;
  Json body = body_of(c);
  body[Json::json_pointer(pointer)] = value;
  seal_with(c, body);
  return refusal(c);
}
MemoryCase sample() {
  MemoryCase c = case_samples::minimal_case();
  c.manifest.figures = {
      {"class", std::string("normal")}, {"evans_index_ratio", 0.27}, {"faults_count", std::int64_t{0}}};
  c.manifest.anatomies[0].figures = {{"smooth.volume_ml", 2.5}};
  c.seal();
  return c;
}

TEST(CaseMeaning, WhatTheSpecificationForbidsIsRefused) {
  const MemoryCase good = sample();
  EXPECT_EQ(with(good, "/face/policy", "keep"), "");
  EXPECT_EQ(with(good, "/face/policy", "blur"), "face.policy");
  EXPECT_EQ(with(good, "/face/policy", ""), "face.policy");
  EXPECT_EQ(with(good, "/landmarks/0/name", ""), "landmarks[0].name");
  EXPECT_EQ(with(good, "/targets/0/name", ""), "targets[0].name");
  EXPECT_EQ(with(good, "/burr_holes/0/name", ""), "burr_holes[0].name");
  EXPECT_EQ(with(good, "/anatomies/0/name", ""), "anatomies[0].name");
  EXPECT_EQ(with(good, "/landmarks/0/source", "guessed"), "landmarks.nasion.source");
  const std::string material = "/haptic/shapes/0/material", at = "haptic.shapes.outer.material";
  EXPECT_EQ(with(good, (material + "/name").c_str(), ""), at + ".name");
  for (const auto& [key, value] : {std::pair<const char*, double>{"/front/stiffness_n_per_mm", 1000},
                                   {"/front/stiffness_n_per_mm", 0},
                                   {"/front/damping_n_s_per_mm", 5},
                                   {"/front/static_friction_ratio", 9},
                                   {"/front/dynamic_friction_ratio", 0.41},
                                   {"/front/pop_through_n", 99},
                                   {"/back/damping_n_s_per_mm", -1},
                                   {"/drag_n_s_per_mm", 2},
                                   {"/shaft_friction_n_per_mm", 2},
                                   {"/rest_ratio", 0},
                                   {"/relaxation_s", 101},
                                   {"/tip_force_n", 21},
                                   {"/removal_energy_j_per_mm3", 11}})
    EXPECT_EQ(with(good, (material + key).c_str(), value).rfind(at + ".", 0), 0u) << key;
  EXPECT_EQ(with(good, "/anatomies/0/deviation_mm/max", 1e5), "anatomies.outer.deviation_mm.max");
  EXPECT_EQ(with(good, "/anatomies/0/deviation_mm/p99", 0.3), "anatomies.outer.deviation_mm.p99");
  EXPECT_EQ(with(good, "/anatomies/0/deviation_mm/rms", 0.3), "anatomies.outer.deviation_mm.rms");
  EXPECT_EQ(with(good, "/anatomies/0/budget_mm/used", -0.1), "anatomies.outer.budget_mm.used");
  EXPECT_EQ(with(good, "/haptic/shapes/0/mismatch/p99_mm", 0.3), "haptic.shapes.outer.mismatch.p99_mm");
  EXPECT_EQ(with(good, "/figures/evans_index_ratio", "0.27"), "figures.evans_index_ratio");
  EXPECT_EQ(with(good, "/figures/evans_index_ratio", true), "figures.evans_index_ratio");
  EXPECT_EQ(with(good, "/figures/faults_count", 0.5), "figures.faults_count");
  EXPECT_EQ(with(good, "/figures/faults_count", -1), "figures.faults_count");
  EXPECT_EQ(with(good, "/figures/class", "well"), "figures.class");
  EXPECT_EQ(with(good, "/figures/class", 3), "figures.class");
  EXPECT_EQ(with(good, "/anatomies/0/figures/smooth.volume_ml", Json::array({1, 2})),
            "anatomies.outer.figures.smooth.volume_ml");
  EXPECT_EQ(with(good, "/burr_holes/0/figures/bone_thickness_mm", "thick"),
            "burr_holes.entry.figures.bone_thickness_mm");
  EXPECT_EQ(with(good, "/provenance/input_sha256", "none"), "provenance.input_sha256");
  EXPECT_EQ(with(good, "/provenance/program", ""), "provenance.program");
}

// Every value of case.json in turn is something else; what still loads, writes the same again.
TEST(CaseMeaning, WhatIsAcceptedMeansWhatItSays) {
  const MemoryCase good = sample();
  const Json body = body_of(good);
  const std::vector<Json> others = {0,
                                    -1,
                                    1,
                                    2.5,
                                    -0.25,
                                    1e9,
                                    1e300,
                                    true,
                                    false,
                                    nullptr,
                                    "",
                                    "another",
                                    "a\nb",
                                    Json::array(),
                                    Json::object(),
                                    Json::array({1, 2, 3}),
                                    1 << 20,
                                    -32768,
                                    18446744073709551615u,
                                    "meshes/../case.json"};
  int tried = 0, accepted = 0;
  const Json flat = body.flatten();
  for (const auto& [pointer, old] : flat.items())
    for (const Json& other : others) {
      MemoryCase c = good;
      Json changed = body;
      changed[Json::json_pointer(pointer)] = other;
      seal_with(c, changed);
      ++tried;
      try {
        const cases::LoadedCase loaded = cases::load_case_through(c.reader());
        Json again = Json::parse(cases::to_json(loaded.manifest));
        again.erase("format");
        again.erase("checksum");
        EXPECT_TRUE(nlohmann::json(again) == nlohmann::json(changed)) << pointer << ": " << other;
        ++accepted;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::bad_input) << pointer << ": " << other << ": " << e.line("");
      }
    }
  EXPECT_GT(tried, 1500);
  EXPECT_GT(accepted, 100) << "positions, names, figures";
  EXPECT_LT(accepted, tried / 3);
}

}  // namespace
}  // namespace trephine
