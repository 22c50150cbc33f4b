// SPDX-License-Identifier: GPL-3.0-or-later
// What a teacher signs, and what is said to be signed, is what was read: not what lies at the same path a moment later.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "haptics/recording.h"
#include "lessons/signature.h"
#include "scratch_folder.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

class SignedRecordings : public testing::Test {
 protected:
  SignedRecordings() {
    write_file(key,
               "-----BEGIN PRIVATE KEY-----\nMC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n"
               "-----END PRIVATE KEY-----\n");
    fs::permissions(key, fs::perms::owner_read | fs::perms::owner_write);
    write_file(open_key,
               "-----BEGIN PUBLIC KEY-----\nMCowBQYDK2VwAyEA11qYAYKxCrfVS/7TyWQHOg7hcvPapiMlrwIaaPcHURo=\n"
               "-----END PUBLIC KEY-----\n");
  }
  fs::path recorded(const std::string& name, double time_s) const {
    haptics::RecordingHeader header;
    header.case_token = "head";
    const fs::path file = folder.path() / name;
    haptics::RecordingWriter writer(file, header);
    haptics::ServoFrame frame{};
    frame.time_s = time_s;
    writer.add({frame});
    writer.finish();
    return file;
  }
  const ScratchFolder folder;
  const fs::path key = folder.path() / "teacher.key", open_key = folder.path() / "teacher.pub";
};

TEST_F(SignedRecordings, WhatWasReadIsLookedFor) {
  const fs::path mine = recorded("one.lesson", 1), seen = recorded("seen.lesson", 2);
  lessons::sign_recording(seen, key);
  const haptics::Recording read = haptics::read_recording(mine);
  EXPECT_EQ(read.sha256, sha256_of_file(mine));
  EXPECT_EQ(lessons::signature_of(read.sha256, mine, open_key), lessons::Signature::absent);
  // The signed one takes its place after it was read, and its signature the place beside it.
  fs::rename(seen, mine);
  fs::rename(lessons::signature_file(seen), lessons::signature_file(mine));
  try {
    lessons::require_no_misfit(lessons::signature_of(read.sha256, mine, open_key), mine);
    FAIL() << "a signature of other bytes fits";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "recording_sha256");
  }
  EXPECT_EQ(lessons::signature_of(haptics::read_recording(mine).sha256, mine, open_key), lessons::Signature::fits);
}

TEST_F(SignedRecordings, ALinkInPlaceOfTheSignatureIsReplaced) {
  const fs::path mine = recorded("one.lesson", 1), other = folder.write("marks.txt", "of the teacher");
  fs::create_symlink(other, lessons::signature_file(mine));
  lessons::sign_recording(mine, key);
  EXPECT_FALSE(fs::is_symlink(lessons::signature_file(mine)));
  std::ifstream in(other);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "of the teacher");
  EXPECT_EQ(lessons::signature_of(haptics::read_recording(mine).sha256, mine, open_key), lessons::Signature::fits);
}

}  // namespace
