// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the fuzzers' first corpus: fuzz_corpus FOLDER makes FOLDER/scanner, FOLDER/decoder and FOLDER/archive, from
// small phantom series in every encoding, files by hand, and mutants of all of them. Always the same files.
#include <cstdio>
#include <fstream>
#include <sstream>

#include "../dicom_enhanced.h"
#include "../dicom_mutator.h"
#include "../zip_writer.h"
#include "base/child.h"
#include "phantom/phantom.h"

using namespace trephine;
using namespace trephine::phantom;
namespace fs = std::filesystem;

namespace {

std::string slurp(const fs::path& p) {
  std::ifstream in(p, std::ios::binary);
  std::ostringstream s;
  s << in.rdbuf();
  return s.str();
}

void put(const fs::path& folder, const std::string& name, const std::string& bytes) {
  fs::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
}

std::vector<std::pair<std::string, std::string>> seeds(const fs::path& scratch) {
  std::vector<std::pair<std::string, std::string>> all;
  phantom::ScanParams p;
  p.columns_count = p.rows_count = 16;
  p.slices_count = 3;
  p.field_of_view_mm = 200;
  p.contents = phantom::Contents::fiducials;
  const auto scanned = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  for (const auto& [name, encoding] : {std::pair{"raw", phantom::Encoding::none},
                                       {"rle", phantom::Encoding::rle},
                                       {"jpeg_ls", phantom::Encoding::jpeg_ls},
                                       {"jpeg_2000", phantom::Encoding::jpeg_2000}}) {
    phantom::SeriesParams series;
    series.encoding = encoding;
    phantom::write_series(scratch, scanned, p, series, "fuzz");
    for (const char* file : {"slice_0001.dcm", "slice_0003.dcm"})
      all.emplace_back(std::string(name) + "_" + file, slurp(scratch / file));
  }
  fs::remove_all(scratch);
  synthetic::Scan s;
  s.columns = 9;
  s.rows = 7;
  s.slices = 4;
  s.syntax = "1.2.840.10008.1.2";
  all.emplace_back("implicit", synthetic::file_bytes(s.slice(1), s.syntax));
  s.syntax = "1.2.840.10008.1.2.1";
  all.emplace_back("enhanced", synthetic::file_bytes(synthetic::enhanced(s, {0, 1, 2, 3}, false)));
  all.emplace_back("enhanced_defined", synthetic::file_bytes(synthetic::enhanced(s, {3, 1, 2, 0}, true)));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  run_child_if_asked(argc, argv);
  if (argc != 2) {
    std::fputs("usage: fuzz_corpus FOLDER\n", stderr);
    return 64;
  }
  const fs::path folder = argv[1];
  const auto all = seeds(folder / "scratch");
  std::vector<synthetic::ZipMember> members;
  std::uint64_t number = 0;
  for (const auto& [name, bytes] : all) {
    members.push_back({"FOLDER/" + name, bytes, members.size() % 2 == 0});
    for (const char* target : {"scanner", "decoder"}) {
      put(folder / target, name, bytes);
      const std::size_t pixels = bytes.find(std::string("\xe0\x7f\x10\0", 4));
      // A child for each input is slow: few, so that most of the time goes to new ones.
      for (int i = 0; i < (std::string(target) == "scanner" ? 40 : 4); ++i)
        put(folder / target, name + "_" + std::to_string(i), synthetic::mutant_of(bytes, pixels, ++number));
    }
  }
  const std::string zip = synthetic::zip_bytes(members);
  put(folder / "archive", "whole", zip);
  members.resize(2);
  put(folder / "archive", "two", synthetic::zip_bytes(members));
  members[1].flags = 1;
  put(folder / "archive", "encrypted", synthetic::zip_bytes(members));
  for (int i = 0; i < 10; ++i)
    put(folder / "archive", "mutant_" + std::to_string(i), synthetic::mutant_of(zip, zip.size() / 2, ++number));
  return 0;
}
