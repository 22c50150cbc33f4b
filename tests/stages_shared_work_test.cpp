// SPDX-License-Identifier: GPL-3.0-or-later
// What the stages of a run share is made once, by whoever asks first.
#include "stages/shared_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/error.h"
#include "sampled_grid.h"
#include "stages/cranial_cavity_of.h"
#include "stages/stage.h"

namespace trephine {
namespace {

std::shared_ptr<const int> number(int n) { return std::make_shared<const int>(n); }

// The inputs of a stage whose ports have the data of these nodes.
stages::StageInputs inputs_of(stages::SharedWork* shared, std::map<std::string, std::string> key_by_port) {
  stages::StageInputs in;
  in.shared = shared;
  in.key_by_port = std::move(key_by_port);
  return in;
}

TEST(SharedWork, OneOfManyThreadsMakesIt) {
  stages::SharedWork shared;
  std::atomic<int> made{0}, waiting{0};
  std::vector<std::thread> threads;
  std::vector<std::shared_ptr<const int>> got(4);
  for (std::size_t n = 0; n < got.size(); ++n)
    threads.emplace_back([&, n] {
      const stages::StageInputs in = inputs_of(&shared, {{"volume", "a"}});
      ++waiting;
      got[n] = in.once<int>("cavity", {"volume"}, Progress(), [&] {
        while (waiting < 4) std::this_thread::yield();
        return number(++made);
      });
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(made, 1);
  for (const auto& g : got) EXPECT_EQ(g, got[0]);
}

TEST(SharedWork, OtherDataAnotherNameOrAnotherTypeAreMadeAnew) {
  stages::SharedWork shared;
  int made = 0;
  const auto make = [&] { return number(++made); };
  const stages::StageInputs one = inputs_of(&shared, {{"volume", "a"}, {"skull", "s"}}),
                            other = inputs_of(&shared, {{"volume", "b"}, {"skull", "s"}}),
                            without = inputs_of(&shared, {{"volume", "a"}});
  EXPECT_EQ(*one.once<int>("cavity", {"volume", "skull"}, Progress(), make), 1);
  EXPECT_EQ(*one.once<int>("cavity", {"volume", "skull"}, Progress(), make), 1);
  EXPECT_EQ(*other.once<int>("cavity", {"volume", "skull"}, Progress(), make), 2);
  EXPECT_EQ(*without.once<int>("cavity", {"volume", "skull"}, Progress(), make), 3);
  EXPECT_EQ(*one.once<int>("place", {"volume", "skull"}, Progress(), make), 4);
  EXPECT_EQ(
      *one.once<double>("cavity", {"volume", "skull"}, Progress(), [] { return std::make_shared<const double>(0.5); }),
      0.5);
  // A stage that runs alone shares nothing.
  const stages::StageInputs alone = inputs_of(nullptr, {{"volume", "a"}, {"skull", "s"}});
  EXPECT_EQ(*alone.once<int>("cavity", {"volume", "skull"}, Progress(), make), 5);
}

TEST(SharedWork, AFailureIsNotKeptAndACancelledStageDoesNotWait) {
  stages::SharedWork shared;
  const stages::StageInputs in = inputs_of(&shared, {{"volume", "a"}});
  const auto fails = []() -> std::shared_ptr<const int> {
    throw Error(ExitCode::quality, "", "cranial cavity", "none");
  };
  EXPECT_THROW(in.once<int>("cavity", {"volume"}, Progress(), fails), Error);
  EXPECT_EQ(*in.once<int>("cavity", {"volume"}, Progress(), [] { return number(7); }), 7);

  std::atomic<bool> began{false}, end{false}, stop{true};
  std::thread maker([&] {
    in.once<int>("slow", {"volume"}, Progress(), [&] {
      began = true;
      while (!end) std::this_thread::yield();
      return number(1);
    });
  });
  while (!began) std::this_thread::yield();
  EXPECT_THROW(in.once<int>("slow", {"volume"}, Progress({}, &stop), [] { return number(2); }), Cancelled);
  end = true;
  maker.join();
}

// What speaks against a usual head is sought in the cavity out of which the zones are cut.
TEST(SharedWork, FindingsUseTheCavityOfTheZones) {
  grid::Lattice l;
  l.size = {72, 72, 72};
  l.spacing_mm = {2, 2, 2};
  const Vec3 centre{71, 71, 71};
  const auto of_radius = [&](const auto& value) {
    return std::make_shared<const grid::Field>(sampled(l, [&](Vec3 p) { return value(norm(p - centre)); }));
  };
  stages::SharedWork shared;
  stages::StageInputs in = inputs_of(&shared, {{"volume", "a"}, {"skull", "s"}, {"brain", "b"}});
  in.by_port["volume"] = std::make_shared<const grid::HuVolume>(*of_radius([](double r) {
    return r < 54 ? 33.0 : r < 61 ? 1000.0 : r < 66 ? 40.0 : -1000.0;
  }));
  in.by_port["skull"] = of_radius([](double r) { return 3.5 - std::abs(r - 57.5); });
  in.by_port["brain"] = of_radius([](double r) { return 54 - r; });
  const stages::StageType& findings = *stages::find_stage("findings");
  findings.run(findings.make_params(), in, Progress());
  const auto cavity = in.once<stages::CranialCavity>("cranial cavity", {"volume", "skull"}, Progress(),
                                                     []() -> std::shared_ptr<const stages::CranialCavity> {
                                                       ADD_FAILURE() << "the stage made none that others share";
                                                       return std::make_shared<const stages::CranialCavity>();
                                                     });
  EXPECT_NEAR(double(cavity->value.count()) * 8 / (4.0 / 3 * M_PI * 54 * 54 * 54), 1, 0.05);
}

}  // namespace
}  // namespace trephine
