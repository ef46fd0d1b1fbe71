// rigwire-bench as it is called, and `rigwire bench`, which becomes it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Result {
  int code = -1;
  std::string output;  ///< Standard output and error.
};

/// Bounded: `timeout` ends a program that does not.
Result call(const std::string& command) {
  Result result;
  FILE* pipe = ::popen(("timeout 60 " + command + " 2>&1 </dev/null").c_str(), "r");
  if (pipe == nullptr) {
    return result;
  }
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.output.append(buffer.data(), count);
  }
  const int status = ::pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

const std::string kBuild = RIGWIRE_BINARY_DIR;

TEST(BenchProgram, lists_its_suites_and_refuses_others) {
  const Result list = call(kBuild + "/rigwire-bench --list");
  EXPECT_EQ(list.code, 0);
  EXPECT_THAT(list.output, HasSubstr("excavator"));
  const Result unknown = call(kBuild + "/rigwire-bench excavtor");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("did you mean excavator?"));
  EXPECT_EQ(call(kBuild + "/rigwire-bench --jsno").code, 2);
}

TEST(BenchProgram, a_suite_that_cannot_be_written_says_so) {
  const Result result = call(kBuild + "/rigwire-bench encoding --json /nowhere/figures.json");
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.output, HasSubstr("cannot write /nowhere/figures.json"));
}

TEST(BenchVerb, is_the_program_beside_rigwire) {
  EXPECT_EQ(call(kBuild + "/rigwire bench --list").output,
            call(kBuild + "/rigwire-bench --list").output);
  EXPECT_EQ(call(kBuild + "/rigwire bench excavtor").code, 2);
  EXPECT_THAT(call(kBuild + "/rigwire bench --help").output, HasSubstr("rigwire-bench"));
}

/// A folder in which `rigwire` stands, with or without its companion.
class BesideRigwire : public testing::Test {
 protected:
  BesideRigwire() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::filesystem::create_hard_link(kBuild + "/rigwire", folder_ / "rigwire");
  }
  ~BesideRigwire() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ = std::filesystem::path(kBuild) / "tests" / "bench" /
                                  testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(BesideRigwire, arguments_and_exit_code_are_passed_on_as_they_are) {
  std::ofstream(folder_ / "rigwire-bench") << "#!/bin/sh\n"
                                              "for word in \"$@\"; do echo \"<$word>\"; done\n"
                                              "exit 7\n";
  std::filesystem::permissions(folder_ / "rigwire-bench", std::filesystem::perms::owner_all);
  const Result result =
      call((folder_ / "rigwire").string() + " bench lidar --json 'a file' '$HOME; *' --list");
  EXPECT_EQ(result.output, "<lidar>\n<--json>\n<a file>\n<$HOME; *>\n<--list>\n");
  EXPECT_EQ(result.code, 7);
}

TEST_F(BesideRigwire, without_its_companion_bench_says_what_to_build) {
  const Result result = call((folder_ / "rigwire").string() + " bench lidar");
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.output, StartsWith("rigwire: cannot start " + folder_.string()));
  EXPECT_THAT(result.output, HasSubstr("build it: scripts/build.sh release rigwire-bench"));
}

}  // namespace
