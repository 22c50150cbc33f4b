// SPDX-License-Identifier: GPL-3.0-or-later
// What is read of a folder lies in that folder, whatever symbolic links it holds.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>

#include "base/open_beneath.h"
#include "dicom_import_samples.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;
using namespace import_samples;

TEST(DicomLinks, ALinkOutOfTheFolderIsNotReadAndToldOf) {
  const ScratchFolder outside, folder;
  small().write(outside);
  small().write(folder);
  const dicom::ImportResult plain = dicom::import_series(folder.path(), {});
  EXPECT_EQ(count(printed(plain.folder), "skipped_links_count"), -1);
  // A slice that is elsewhere: the folder's own five are a series of their own.
  const fs::path slice = folder.path() / "slice1005.dcm";
  fs::remove(slice);
  for (const fs::path& target : {outside.path() / "slice1005.dcm", fs::path("/proc/self/environ"), fs::path("gone")}) {
    fs::create_symlink(target, slice);
    const dicom::ImportResult r = dicom::import_series(folder.path(), {});
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(r.volume).size[2], 5) << target;
    EXPECT_EQ(count(printed(r.folder), "skipped_links_count"), 1);
    ASSERT_FALSE(printed(r.folder).warnings.empty());
    EXPECT_NE(printed(r.folder).warnings[0].find("symbolic link"), std::string::npos);
    EXPECT_NE(dicom::hash_of_series_input(folder.path(), {}), plain.input_sha256);
    fs::remove(slice);
  }
  // Within the folder a link is as good as a file.
  fs::create_directory(folder.path() / "below");
  fs::copy_file(outside.path() / "slice1005.dcm", folder.path() / "below" / "x");
  fs::create_symlink("below/x", slice);
  const dicom::ImportResult r = dicom::import_series(folder.path(), {});
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(r.volume).size[2], 6);
  EXPECT_EQ(r.input_sha256 == plain.input_sha256, false) << "the slice is there twice";
}

TEST(OpenBeneath, OpensNothingElsewhere) {
  const ScratchFolder outside, folder;
  outside.write("secret", "s");
  folder.write("file", "f");
  fs::create_directory(folder.path() / "below");
  fs::create_symlink("../file", folder.path() / "below" / "inside");
  fs::create_directory_symlink(outside.path(), folder.path() / "out");
  fs::create_directory_symlink("round", folder.path() / "round");
  const auto opens = [&](const fs::path& p) {
    const int fd = open_beneath(folder.path(), p);
    if (fd < 0) return errno;
    ::close(fd);
    return 0;
  };
  EXPECT_EQ(opens("file"), 0);
  EXPECT_EQ(opens("below/../file"), 0);
  EXPECT_EQ(opens("below/inside"), 0);
  EXPECT_EQ(opens("out/secret"), EXDEV);
  EXPECT_EQ(opens("../" + outside.path().filename().string() + "/secret"), EXDEV);
  EXPECT_EQ(opens(outside.path() / "secret"), EXDEV);
  EXPECT_EQ(opens("round/x"), ELOOP);
  EXPECT_EQ(opens("none"), ENOENT);
}

}  // namespace
}  // namespace trephine
