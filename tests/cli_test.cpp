// SPDX-License-Identifier: GPL-3.0-or-later
// One declaration: the command line with all its faults at once, help, reference, schema, completion, exit codes.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "cli/command.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

enum class Way { quick, exact };
struct SampleParams {
  double max_deviation_mm = 0.2;
  int triangles_count = 80000;
  bool keep_border = true;
  Way way = Way::exact;
  std::string note;
  std::array<double, 3> origin_mm{1, 2.5, -3};
  template <class V>
  static void describe(V& v) {
    using P = SampleParams;
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 5}, "Largest distance.");
    v.integer(&P::triangles_count, "triangles_count", Range{4}, "Triangles wanted.");
    v.flag(&P::keep_border, "keep_border", "Keep the border.");
    v.choice(&P::way, "way", {{"quick", Way::quick}, {"exact", Way::exact}}, "How.");
    v.text(&P::note, "note", "A note | a remark.");
    v.numbers(&P::origin_mm, "origin_mm", Range{-100, 100}, "Where.");
  }
};

class Cli : public testing::Test {
 protected:
  using Kind = cli::Argument::Kind;
  Cli() {
    program_.name = "prog";
    program_.version = "1.2.3";
    program_.summary = "Does things";
    cli::Command c;
    c.name = "reduce";
    c.summary = "Reduce a surface";
    c.description = "A paragraph.\n\nAnother one.";
    c.arguments = {{"config", Kind::in_file, "The config.", true, true, false, {}},
                   {"series", Kind::in_folder, "The series.", false, false, false, {}},
                   {"out", Kind::out_file, "The result.", true, false, false, {}},
                   {"set", Kind::text, "An override.", false, false, true, {}}};
    c.groups = {cli::ParameterGroup::of<SampleParams>("Reduction")};
    c.examples = {"prog reduce a.yaml --out b.vtp"};
    c.run = [this](const cli::ParsedCommand& p) {
      parsed_ = p;
      return action_ ? action_() : ExitCode::ok;
    };
    program_.commands.push_back(c);
    c.name = "other";
    program_.commands.push_back(c);
    config_ = scratch_.write("a.yaml", "x").string();
    out_ = (scratch_.path() / "b.vtp").string();
  }
  ~Cli() override { set_thread_count(0); }

  int run(std::vector<std::string> words) {
    words.insert(words.begin(), "prog");
    std::vector<char*> argv;
    for (auto& w : words) argv.push_back(w.data());
    argv.push_back(nullptr);
    lines_.clear();
    const LogSink before = set_log_sink([this](const std::string& line) { lines_.push_back(line); });
    testing::internal::CaptureStdout();
    const int code = cli::run_program(
        program_.name.c_str(), [this] { return program_; }, static_cast<int>(words.size()), argv.data());
    stdout_ = testing::internal::GetCapturedStdout();
    set_log_sink(before);
    return code;
  }
  int reduce(std::vector<std::string> words) {
    words.insert(words.begin(), {"reduce", config_, "--out", out_});
    return run(words);
  }
  // The one line that comes with exit code 64, without its beginning.
  std::string usage_fault(const std::vector<std::string>& words) {
    EXPECT_EQ(reduce(words), 64);
    EXPECT_EQ(lines_.size(), 1u);
    const std::string who = "prog reduce: ";
    if (lines_.size() != 1 || lines_[0].compare(0, who.size(), who) != 0) return "";
    return lines_[0].substr(who.size());
  }
  const SampleParams& params() const { return parsed_.params<SampleParams>(); }

  ScratchFolder scratch_;
  cli::Program program_;
  cli::ParsedCommand parsed_;
  std::function<ExitCode()> action_;
  std::string config_, out_, stdout_;
  std::vector<std::string> lines_;
};

// A core file would hold what the program holds of a patient, in the folder where it was started.
TEST_F(Cli, AProgramLeavesNoCoreFile) {
  rlimit before{}, within{};
  ASSERT_EQ(::getrlimit(RLIMIT_CORE, &before), 0);
  const rlimit most{before.rlim_max, before.rlim_max};
  ::setrlimit(RLIMIT_CORE, &most);
  action_ = [&] {
    ::getrlimit(RLIMIT_CORE, &within);
    return ExitCode::ok;
  };
  EXPECT_EQ(reduce({}), 0);
  EXPECT_LE(within.rlim_cur, 1u);
  ::setrlimit(RLIMIT_CORE, &before);
}

TEST_F(Cli, DefaultsAndValues) {
  ASSERT_EQ(reduce({}), 0);
  EXPECT_EQ(params().max_deviation_mm, 0.2);
  EXPECT_TRUE(parsed_.given.empty());
  EXPECT_EQ(parsed_.text("config"), config_);
  EXPECT_EQ(parsed_.path("out"), out_);
  EXPECT_FALSE(parsed_.has("series"));
  EXPECT_FALSE(parsed_.quiet);

  ASSERT_EQ(reduce({"--max-deviation-mm", "1e-2", "--triangles-count=4", "--no-keep-border", "--way", "quick", "--note",
                    "-5 [a,b]", "--origin-mm", "-1,2,-3.5", "--quiet", "--threads", "1", "--set", "a=1", "--set=b=2"}),
            0);
  EXPECT_EQ(params().max_deviation_mm, 0.01);
  EXPECT_EQ(params().triangles_count, 4);
  EXPECT_FALSE(params().keep_border);
  EXPECT_EQ(params().way, Way::quick);
  EXPECT_EQ(params().note, "-5 [a,b]");
  EXPECT_EQ(params().origin_mm, (std::array<double, 3>{-1, 2, -3.5}));
  EXPECT_TRUE(parsed_.quiet);
  EXPECT_EQ(thread_count(), 1);
  EXPECT_EQ(parsed_.all("set"), (std::vector<std::string>{"a=1", "b=2"}));
  EXPECT_EQ(parsed_.given.count("way"), 1u);

  // A second run begins with the defaults again.
  ASSERT_EQ(reduce({"--note="}), 0);
  EXPECT_EQ(params().triangles_count, 80000);
  EXPECT_EQ(params().note, "");
  EXPECT_EQ(parsed_.given.count("note"), 1u);
}

TEST_F(Cli, FlagsBothWays) {
  for (const auto& [word, value] : std::vector<std::pair<std::string, bool>>{{"--keep-border", true},
                                                                             {"--keep-border=true", true},
                                                                             {"--keep-border=false", false},
                                                                             {"--no-keep-border", false}}) {
    ASSERT_EQ(reduce({word}), 0) << word;
    EXPECT_EQ(params().keep_border, value) << word;
  }
  EXPECT_EQ(usage_fault({"--keep-border=maybe"}), "--keep-border: maybe: must be true or false");
  EXPECT_EQ(usage_fault({"--no-keep-border=false"}), "--no-keep-border: takes no value");
  EXPECT_EQ(usage_fault({"--keep-border", "--no-keep-border"}), "--keep-border: was given 2 times");
}

TEST_F(Cli, EachFaultIsOneLine) {
  EXPECT_EQ(usage_fault({"--max-deviation-mm", "7"}), "--max-deviation-mm: 7: must be a number from 0 to 5");
  EXPECT_EQ(usage_fault({"--max-deviation-mm", "0,5"}), "--max-deviation-mm: 0,5: must be a number from 0 to 5");
  EXPECT_EQ(usage_fault({"--max-deviation-mm="}), "--max-deviation-mm: is empty: must be a number from 0 to 5");
  EXPECT_EQ(usage_fault({"--max-deviation-mm", "1", "--max-deviation-mm", "2"}),
            "--max-deviation-mm: was given 2 times");
  EXPECT_EQ(usage_fault({"--max-deviaton-mm", "7"}),
            "--max-deviaton-mm: unknown flag; did you mean --max-deviation-mm?");
  EXPECT_EQ(usage_fault({"--max-deviation", "7"}), "--max-deviation: unknown flag; did you mean --max-deviation-mm?");
  EXPECT_EQ(usage_fault({"--xyz"}), "--xyz: unknown flag");
  EXPECT_EQ(usage_fault({"-o"}), "-o: unknown flag");
  EXPECT_EQ(usage_fault({"--origin-mm", "1,2"}), "--origin-mm: 1,2: must be 3 numbers, each from -100 to 100");
  EXPECT_EQ(usage_fault({"--origin-mm", "1,2,3,"}), "--origin-mm: 1,2,3,: must be 3 numbers, each from -100 to 100");
  EXPECT_EQ(usage_fault({"--way", "exat"}), "--way: exat: must be one of quick, exact; did you mean exact?");
  EXPECT_EQ(usage_fault({"--threads", "-1"}), "--threads: -1: must be a whole number from 0 to 1024");
  EXPECT_EQ(usage_fault({"--series"}), "--series: needs a value");
  EXPECT_EQ(usage_fault({"--series", "--quiet"}), "--series: needs a value; --quiet is none");
  EXPECT_EQ(usage_fault({"--out", out_}), "--out: was given 2 times");
  EXPECT_EQ(usage_fault({"more.yaml"}), "more.yaml: is one word too many");
  EXPECT_EQ(usage_fault({"--", "--odd"}), "--odd: is one word too many");
}

TEST_F(Cli, AllFaultsAtOnce) {
  EXPECT_EQ(run({"reduce", "--max-deviation-mm", "7", "--triangles-count", "x"}), 64);
  EXPECT_EQ(lines_, (std::vector<std::string>{
                        "prog reduce: CONFIG: is needed: The config.", "prog reduce: --out: is needed: The result.",
                        "prog reduce: --max-deviation-mm: 7: must be a number from 0 to 5",
                        "prog reduce: --triangles-count: x: must be a whole number of at least 4"}));
}

TEST_F(Cli, PathsAreCheckedFirst) {
  action_ = [] { return ADD_FAILURE(), ExitCode::ok; };
  const std::string missing = (scratch_.path() / "missing").string(), here = scratch_.path().string();
  EXPECT_EQ(run({"reduce", missing, "--out", out_}), 66);
  EXPECT_EQ(lines_, std::vector<std::string>{"prog reduce: " + missing + ": CONFIG: not found"});
  EXPECT_EQ(run({"reduce", here, "--out", out_}), 66);
  EXPECT_EQ(lines_, std::vector<std::string>{"prog reduce: " + here + ": CONFIG: is a folder, a file is needed"});
  EXPECT_EQ(reduce({"--series", config_}), 66);
  EXPECT_EQ(lines_, std::vector<std::string>{"prog reduce: " + config_ + ": --series: is not a folder"});
  EXPECT_EQ(run({"reduce", config_, "--out", missing + "/b.vtp"}), 73);
  EXPECT_EQ(lines_, std::vector<std::string>{"prog reduce: " + missing +
                                             "/b.vtp: --out: cannot be created: its folder: there is no such folder"});
  EXPECT_EQ(run({"reduce", config_, "--out", here}), 73);
  EXPECT_EQ(run({"reduce", missing, "--out", here}), 66);
  EXPECT_EQ(lines_.size(), 2u);

  program_.commands[0].arguments[2].kind = Kind::out_folder;
  EXPECT_EQ(run({"reduce", config_, "--out", config_ + "/x/y"}), 73);
  if (::geteuid() != 0) {  // root may write everywhere
    std::filesystem::permissions(here, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    EXPECT_EQ(run({"reduce", config_, "--out", missing + "/deep"}), 73);
    std::filesystem::permissions(here, std::filesystem::perms::owner_all);
  }
  action_ = nullptr;
  EXPECT_EQ(run({"reduce", config_, "--out", missing + "/deep/er"}), 0);
  EXPECT_EQ(run({"reduce", config_, "--out", "relative"}), 0);
}

TEST_F(Cli, ExitCodes) {
  const std::vector<std::pair<std::function<ExitCode()>, int>> cases = {
      {[] { return ExitCode::quality; }, 80},
      {[]() -> ExitCode { throw Error(ExitCode::bad_input, "a.dcm", "0028,0010", "rows 0"); }, 65},
      {[]() -> ExitCode { throw Cancelled{}; }, 130},
      {[]() -> ExitCode { throw std::bad_alloc(); }, 70},
      {[]() -> ExitCode { throw std::runtime_error("a\nb"); }, 70},
      {[]() -> ExitCode { throw 7; }, 70},
  };
  for (const auto& [action, code] : cases) {
    action_ = action;
    EXPECT_EQ(reduce({}), code);
    EXPECT_EQ(lines_.size(), code == 80 ? 0u : 1u);
    if (code == 65) {
      EXPECT_EQ(lines_.at(0), "prog reduce: a.dcm: 0028,0010: rows 0");
    }
  }
  EXPECT_EQ(run({}), 64);
  EXPECT_EQ(run({"redcue"}), 64);
  EXPECT_EQ(lines_, std::vector<std::string>{"prog: redcue: unknown command; did you mean reduce?"});
  EXPECT_EQ(run({"--vers"}), 64);
}

TEST_F(Cli, HelpAndVersion) {
  EXPECT_EQ(run({"--version"}), 0);
  EXPECT_EQ(stdout_, "prog 1.2.3\n");
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_NE(stdout_.find("  reduce      Reduce a surface\n"), std::string::npos) << stdout_;
  EXPECT_NE(stdout_.find("  completion  prints"), std::string::npos) << stdout_;
  EXPECT_EQ(stdout_.find("Write the reference pages"), std::string::npos);
  EXPECT_EQ(run({"help"}), 0);
  EXPECT_NE(stdout_.find("Usage: prog COMMAND"), std::string::npos);
  EXPECT_EQ(run({"help", "reduce"}), 0);
  EXPECT_NE(stdout_.find("Usage: prog reduce CONFIG"), std::string::npos);
  EXPECT_EQ(run({"help", "redcue"}), 64);
  EXPECT_EQ(run({"help", "reduce", "x"}), 64);
  EXPECT_EQ(run({"reduce", "--wrong", "--help"}), 0);
  for (const char* part : {"Usage: prog reduce CONFIG [--series FOLDER] --out FILE [--set TEXT]... [parameters]\n",
                           "A paragraph.\n\nAnother one.\n",
                           "  --max-deviation-mm NUMBER\n        Largest distance. (number, 0 to 5, default 0.2)\n",
                           "  --[no-]keep-border\n", "  --origin-mm N,N,N\n", "The result. (required)",
                           "(may be repeated)", "Examples:\n  prog reduce a.yaml", "--threads INTEGER"})
    EXPECT_NE(stdout_.find(part), std::string::npos) << part << "\n" << stdout_;
}

TEST_F(Cli, ReferencePages) {
  const auto folder = scratch_.path() / "pages";
  ASSERT_EQ(run({"reference", "--out", folder.string()}), 0);
  std::ifstream file(folder / "reduce.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  for (const char* part :
       {"# prog reduce\n", "| `--max-deviation-mm NUMBER` | number, 0 to 5, default 0.2 | Largest distance. |",
        "A note \\| a remark.", "| `CONFIG` | yes | The config. |"})
    EXPECT_NE(page.find(part), std::string::npos) << part << "\n" << page;
  EXPECT_FALSE(std::filesystem::exists(folder / "reference.md"));

  const auto schema = nlohmann::json::parse(std::ifstream(folder / "parameters.schema.json"));
  const auto& p = schema["$defs"]["reduce"]["properties"];
  EXPECT_EQ(p["max_deviation_mm"],
            nlohmann::json::parse(
                R"({"description":"Largest distance.","type":"number","minimum":0,"maximum":5,"default":0.2})"));
  EXPECT_EQ(p["triangles_count"]["minimum"], 4);
  EXPECT_EQ(p["way"]["enum"], nlohmann::json({"quick", "exact"}));
  EXPECT_EQ(p["way"]["default"], "exact");
  EXPECT_EQ(p["origin_mm"]["minItems"], 3);
  EXPECT_EQ(p["keep_border"]["type"], "boolean");
  EXPECT_FALSE(p["note"].contains("minimum"));
}

TEST_F(Cli, ManPages) {
  program_.files = {{"/etc/prog", "What it reads."}};
  program_.commands[0].description = "It's \xC2\xB5m.\n\n.TH is no macro here, nor is C:\\TH.";
  program_.commands[1].hidden = true;
  const auto folder = scratch_.path() / "man";
  ASSERT_EQ(run({"man", "--out", folder.string()}), 0);
  const auto read = [&](const char* name) {
    std::ifstream file(folder / name);
    return std::string((std::istreambuf_iterator<char>(file)), {});
  };
  const std::string page = read("prog-reduce.1");
  for (const char* part :
       {".TH PROG\\-REDUCE 1 \"\" \"prog 1.2.3\" \"prog manual\"\n.ad l\n.nh\n.SH NAME\nprog\\-reduce \\- Reduce a "
        "surface\n",
        "\n\\fBprog\\ reduce\\fR\nCONFIG\n[\\-\\-series\\ FOLDER]\n\\-\\-out\\ FILE\n",
        "\n.SH DESCRIPTION\nIt\\(aqs \\[u00B5]m.\n.PP\n\\&.TH is no macro here, nor is C:\\(rsTH.\n",
        "\n.TP\n\\fB\\-\\-max\\-deviation\\-mm\\fR \\fINUMBER\\fR\nLargest distance. (number, 0 to 5, default 0.2)\n",
        "\n.TP\n\\fICONFIG\\fR\nThe config. (required)\n", "\nprog reduce a.yaml \\-\\-out b.vtp\n.fi\n",
        "\n.BR prog (1)\n"})
    EXPECT_NE(page.find(part), std::string::npos) << part << "\n" << page;
  const std::string index = read("prog.1");
  for (const char* part :
       {"\n.TP\n\\fBreduce\\fR\nReduce a surface.\n", "\n.TP\n\\fB65\\fR\nBad input data.\n",
        "\n.TP\n\\fI/etc/prog\\fR\nWhat it reads.\n", "\n.BR prog\\-reduce (1),\n.BR prog\\-completion (1)\n"})
    EXPECT_NE(index.find(part), std::string::npos) << part << "\n" << index;
  EXPECT_EQ(index.find("fBother"), std::string::npos);
  EXPECT_EQ(index.find("reference"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "prog-other.1"));
}

TEST_F(Cli, FaultyDeclarationsAreFound) {
  program_.commands[0].arguments.push_back({"way", Kind::text, "Twice.", false, false, false, {}});
  EXPECT_EQ(run({"reference", "--out", (scratch_.path() / "x").string()}), 70);
  EXPECT_EQ(lines_, std::vector<std::string>{"prog reference: reduce --way: declared twice"});
  program_.commands[0].arguments.back() = {"why", Kind::text, "", false, false, false, {}};
  EXPECT_EQ(run({"reference", "--out", (scratch_.path() / "x").string()}), 70);
  program_.commands[0].arguments.back() = {"Why", Kind::text, "Why.", false, false, false, {}};
  EXPECT_EQ(run({"reference", "--out", (scratch_.path() / "x").string()}), 70);
}

TEST_F(Cli, BashCompletes) {
  ASSERT_EQ(run({"completion", "bash"}), 0);
  const std::string script = scratch_.write("completion.bash", stdout_).string();
  const auto complete = [&](const std::string& words) {
    const std::string command = "bash -c 'cd " + scratch_.path().string() + " && source " + script +
                                " && COMP_WORDS=(" + words +
                                "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _prog_completion; echo \"${COMPREPLY[@]}\"'";
    std::string out;
    FILE* pipe = ::popen(command.c_str(), "r");
    char buffer[256];
    while (pipe && std::fgets(buffer, sizeof buffer, pipe)) out += buffer;
    EXPECT_EQ(::pclose(pipe), 0);
    return out;
  };
  EXPECT_EQ(complete("prog red"), "reduce\n");
  EXPECT_EQ(complete("prog reduce --ma"), "--max-deviation-mm\n");
  EXPECT_EQ(complete("prog reduce --way q"), "quick\n");
  EXPECT_EQ(complete("prog reduce --no-k"), "--no-keep-border\n");
  EXPECT_EQ(complete("prog reduce a.y"), "a.yaml\n");
  EXPECT_EQ(complete("prog --v"), "--version\n");
}

// Each shell reads its script, and offers the flag; where the shell is not installed nothing is known of it.
TEST_F(Cli, ZshAndFishComplete) {
  const auto said_by = [&](const std::string& command) {
    std::string out;
    FILE* pipe = ::popen(("cd " + scratch_.path().string() + " && " + command).c_str(), "r");
    char buffer[256];
    while (pipe && std::fgets(buffer, sizeof buffer, pipe)) out += buffer;
    EXPECT_EQ(::pclose(pipe), 0) << command << ": " << out;
    return out;
  };
  const auto is_there = [](const std::string& shell) {
    return std::system(("command -v " + shell + " >/dev/null").c_str()) == 0;
  };
  ASSERT_EQ(run({"completion", "fish"}), 0);
  const std::string fish = scratch_.write("prog.fish", stdout_).string();
  if (is_there("fish")) {
    const auto complete = [&](const std::string& words) {
      return said_by("HOME=. fish --no-config -c 'source " + fish + "; complete -C \"" + words + "\"'");
    };
    EXPECT_EQ(complete("prog red").rfind("reduce\t", 0), 0u) << complete("prog red");
    EXPECT_EQ(complete("prog reduce --max-d").rfind("--max-deviation-mm\t", 0), 0u) << complete("prog reduce --max-d");
    EXPECT_EQ(complete("prog reduce --way q").rfind("quick", 0), 0u) << complete("prog reduce --way q");
  }
  ASSERT_EQ(run({"completion", "zsh"}), 0);
  const std::string zsh = scratch_.write("prog.zsh", stdout_).string();
  if (is_there("zsh")) {  // which itself leaves out what does not begin with the word
    const std::string said = said_by("HOME=. zsh -f -c 'source " + zsh +
                                     "; COMP_WORDS=(prog reduce --way q) COMP_CWORD=3; emulate sh -c _prog_completion; "
                                     "echo $COMPREPLY'");
    EXPECT_NE(said.find("quick"), std::string::npos) << said;
  }
  if (std::getenv("TREPHINE_CHECK")) {
    EXPECT_TRUE(is_there("fish") && is_there("zsh")) << "packages-check.txt names both";
  }
}

}  // namespace
}  // namespace trephine
