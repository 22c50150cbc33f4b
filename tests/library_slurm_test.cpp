// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/temporary_folder.h"
#include "cluster/slurm.h"
#include "library/slurm_engine.h"

namespace trephine::library {
namespace {

NinjaJob job(const std::string& name, double memory_mb, std::vector<std::string> after = {}) {
  NinjaJob j;
  j.job.name = name;
  j.job.token = name.substr(name.find('.') + 1);
  j.job.is_phantom = name.rfind("phantom.", 0) == 0;
  j.memory_mb = memory_mb;
  j.after = std::move(after);
  return j;
}

TEST(LibrarySlurm, ReadsWhatSlurmSays) {
  EXPECT_EQ(cluster::parse_submitted("sbatch: warning: late\n123\n"), "123");
  EXPECT_EQ(cluster::parse_submitted("45;cluster\n"), "45");
  EXPECT_EQ(cluster::parse_submitted("sbatch: error: no\n"), "");
  EXPECT_EQ(cluster::parse_max_array("x\nMaxArraySize            = 1001\ny = 2\n"), 1001);
  EXPECT_EQ(cluster::parse_max_array(""), 0);
  const auto tasks =
      cluster::parse_tasks("7|0|RUNNING|n1\n7|1|PENDING|\n8|N/A|PENDING|\n9|2|COMPLETING|n2\nslurm: noise\n||\n");
  ASSERT_EQ(tasks.size(), 4u);
  EXPECT_EQ(tasks[0].index, 0);
  EXPECT_EQ(tasks[0].node, "n1");
  EXPECT_EQ(tasks[1].state, "PENDING");
  EXPECT_EQ(tasks[2].index, -1);
  EXPECT_TRUE(cluster::is_alive(tasks[1]));
  EXPECT_FALSE(cluster::is_alive(tasks[3]));
  const auto why = cluster::parse_tasks("7|0|PENDING||JobHeldUser\n7|1|RUNNING|n1|None\n");
  ASSERT_EQ(why.size(), 2u);
  EXPECT_EQ(why[0].reason, "JobHeldUser");
  EXPECT_EQ(why[0].node, "");
  EXPECT_EQ(why[1].reason, "");
}

TEST(LibrarySlurm, WavesClassesAndChunks) {
  EngineParams engine;
  engine.max_array_count = 2;
  engine.at_once_count = 8;
  LibraryBuildParams params;
  params.case_limit_s = 3600;
  std::vector<NinjaJob> jobs = {job("phantom.p", 100), job("case.a", 300, {"phantom.p"}),
                                job("case.b", 300, {"case.a"})};
  for (int i = 0; i < 5; ++i) jobs.push_back(job("case.c" + std::to_string(i), 300));
  jobs.push_back(job("case.large", 1000));
  const Batch batch = plan_batch(jobs, engine, params);
  EXPECT_EQ(batch.jobs[2].wave, 2);
  EXPECT_EQ(batch.jobs[1].memory_mb, 512);  // with some room above the estimate
  EXPECT_EQ(batch.jobs.back().memory_mb, 2048);
  std::set<std::string> all;
  for (const BatchJob& j : batch.jobs) all.insert(j.name);
  const auto arrays = part_into_arrays(batch, all);
  std::size_t count = 0;
  int wave = 0;
  for (const BatchArray& a : arrays) {
    EXPECT_LE(a.names.size(), 2u);
    EXPECT_GE(a.wave, wave);
    wave = a.wave;
    count += a.names.size();
  }
  EXPECT_EQ(count, jobs.size());
  EXPECT_EQ(part_into_arrays(batch, {"case.c3"}).size(), 1u);
  const auto options = options_of_array(batch, batch.jobs[1], 2, {"5", "6"});
  for (const char* word : {"--array=0-1%8", "--mem=512M", "--time=63", "--dependency=afterany:5:6", "--no-requeue"})
    EXPECT_NE(std::find(options.begin(), options.end(), word), options.end()) << word;
}

TEST(LibrarySlurm, AJobWithoutAClassThatIsLargeEnoughGetsTheLargest) {
  EngineParams engine;
  engine.classes = {{1000, 600, ""}, {4000, 1200, "big"}};
  const Batch batch = plan_batch({job("case.a", 800), job("case.b", 900), job("case.c", 90000)}, engine, {});
  EXPECT_EQ(batch.jobs[0].memory_mb, 1000);
  EXPECT_EQ(batch.jobs[0].time_limit_s, 600);
  EXPECT_EQ(batch.jobs[1].memory_mb, 4000);
  EXPECT_EQ(batch.jobs[2].partition, "big");
}

TEST(LibrarySlurm, WhatMayPassNextTimeIsTriedAgainAndNothingElse) {
  BatchJob j;
  j.name = "case.a";
  Batch batch;
  batch.max_tries = 3;
  const auto final_with = [&](int code, int attempt, int signal = 0) {
    std::map<std::string, TaskRecord> ended;
    ended["case.a"].result.code = code;
    ended["case.a"].result.signal = signal;
    ended["case.a"].attempt = attempt;
    return is_final(batch, j, ended);
  };
  EXPECT_FALSE(is_final(batch, j, {}));
  EXPECT_TRUE(final_with(0, 1));
  EXPECT_TRUE(final_with(80, 1));
  EXPECT_TRUE(final_with(65, 1));
  EXPECT_TRUE(final_with(70, 1));
  EXPECT_FALSE(final_with(70, 1, 9));
  EXPECT_FALSE(final_with(74, 2));
  EXPECT_TRUE(final_with(74, 3));
  EXPECT_TRUE(final_with(66, 1));
  j.needs_phantom = true;
  EXPECT_FALSE(final_with(66, 1));
}

TEST(LibrarySlurm, WhatLackedMemoryOrTimeGetsTheNextClassThatGrantsMoreOfIt) {
  EngineParams engine;
  engine.classes = {{1000, 600, ""}, {4000, 600, "big"}, {4000, 1200, "long"}};
  LibraryBuildParams params;
  params.case_limit_s = 900;
  Batch batch = plan_batch({job("case.a", 800)}, engine, params);
  const auto memory = with_more(batch, batch.jobs[0], Lack::memory);
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->memory_mb, 4000);
  EXPECT_EQ(memory->partition, "big");
  EXPECT_FALSE(with_more(batch, *memory, Lack::memory));
  const auto time = with_more(batch, batch.jobs[0], Lack::time);
  ASSERT_TRUE(time);
  EXPECT_EQ(time->partition, "long");
  EXPECT_EQ(time->time_limit_s, 900);  // not above the limit of a case
  EXPECT_FALSE(with_more(batch, *time, Lack::time));
  EXPECT_FALSE(with_more(batch, batch.jobs[0], Lack::nothing));
  // A record that says so is no end while a class grants more, and is one afterwards.
  std::map<std::string, TaskRecord> ended;
  ended["case.a"].attempt = 1;
  ended["case.a"].result = {70, "stopped after 600 s, its time limit", 600, 0, 0, Lack::time};
  batch.max_tries = 3;
  EXPECT_FALSE(is_final(batch, batch.jobs[0], ended));
  EXPECT_TRUE(is_final(batch, *time, ended));
  batch.max_tries = 1;
  EXPECT_TRUE(is_final(batch, batch.jobs[0], ended));
  // A class with less time is taken only where no other has the memory, and the longest of such.
  batch.classes = {{1000, 600, ""}, {2000, 100, "brief"}, {3000, 300, "short"}, {4000, 700, "large"}};
  EXPECT_EQ(with_more(batch, batch.jobs[0], Lack::memory)->partition, "large");
  batch.classes.pop_back();
  EXPECT_EQ(with_more(batch, batch.jobs[0], Lack::memory)->partition, "short");
  // Without classes memory doubles, and the time limit is the user's.
  engine.classes.clear();
  batch = plan_batch({job("case.a", 800)}, engine, params);
  EXPECT_EQ(with_more(batch, batch.jobs[0], Lack::memory)->memory_mb, 2 * batch.jobs[0].memory_mb);
  EXPECT_FALSE(with_more(batch, batch.jobs[0], Lack::time));
}

TEST(LibrarySlurm, WhatATaskLackedIsWhatItsLastTrySays) {
  Batch batch;
  batch.arrays = {{"7", 0, {"case.a", "case.b", "case.c"}}, {"9", 0, {"case.b"}}};
  const auto lacks = lacks_of(batch, {{"7", 0, "TIMEOUT", "n1"},
                                      {"7", 1, "OUT_OF_MEMORY", "n1"},
                                      {"7", 2, "NODE_FAIL", ""},
                                      {"9", 0, "FAILED", "n2"},
                                      {"7", 9, "TIMEOUT", ""},
                                      {"8", 0, "TIMEOUT", ""}});
  EXPECT_EQ(lacks, (std::map<std::string, Lack>{{"case.a", Lack::time}}));
  const auto tasks =
      cluster::parse_accounts("7_0|TIMEOUT|n1\n7_1|OUT_OF_MEMORY|n2\n7_[2-5]|PENDING|None assigned\n7|FAILED|n1\n");
  ASSERT_EQ(tasks.size(), 3u);
  EXPECT_EQ(lack_of(tasks[1]), Lack::memory);
  EXPECT_EQ(tasks[1].index, 1);
  EXPECT_EQ(tasks[2].index, -1);  // tasks that wait stand together, and lack nothing
  EXPECT_FALSE(cluster::is_alive(tasks[0]));
}

TEST(LibrarySlurm, ABatchIsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const LibraryState state(folder.path());
  state.make_folders();
  Batch batch = new_batch(state);
  batch.jobs = {{"case.a", 1, 512, 60, "big", 2, false, true, "a"}};
  batch.arrays = {{"12", 1, {"case.a"}}};
  batch.options = {"--qos=low"};
  batch.max_tries = 4;
  write_batch(batch);
  LibraryJob words;
  words.name = "case.a";
  words.arguments = {"run", "--series", "/scans/\"x\" y"};
  words.series = "/scans/\"x\" y";
  write_jobs(jobs_file(batch), {words, words});
  const auto all = read_batches(state, true);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].jobs[0].tries, 2);
  EXPECT_EQ(all[0].jobs[0].partition, "big");
  EXPECT_TRUE(all[0].jobs[0].needs_phantom);
  EXPECT_EQ(all[0].arrays[0].names, batch.arrays[0].names);
  EXPECT_EQ(all[0].options, batch.options);
  EXPECT_EQ(read_job(jobs_file(batch), 1).arguments, words.arguments);
  EXPECT_THROW(read_job(jobs_file(batch), 2), Error);
  write_task(batch.folder, task_ended, "case.a", {3, "n1", 10, 20, {74, "full", 1, 2, 3}});
  const auto record = read_task(batch.folder, task_ended, "case.a");
  ASSERT_TRUE(record);
  EXPECT_EQ(record->attempt, 3);
  EXPECT_EQ(record->result.reason, "full");
  // The last job read the batch before it was cancelled, and writes it after that.
  mark_cancelled(batch);
  write_batch(batch);
  EXPECT_TRUE(read_batches(state, true).empty());
  EXPECT_TRUE(read_batches(state, false).at(0).cancelled);
  std::filesystem::remove(batch.folder / "cancelled");
  EXPECT_EQ(read_batches(state, true).size(), 1u);
  batch.finished = true;
  write_batch(batch);
  EXPECT_TRUE(read_batches(state, true).empty());
  EXPECT_EQ(read_batches(state, false).size(), 1u);
}

}  // namespace
}  // namespace trephine::library
