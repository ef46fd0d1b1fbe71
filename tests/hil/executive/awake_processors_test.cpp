#include "hil/executive/awake_processors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <set>
#include <string>

#include "hil/files/private_folder.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Threads of this process that run with SCHED_IDLE.
std::set<pid_t> threads_of_idle_priority() {
  std::set<pid_t> all;
  for (const auto& entry : fs::directory_iterator("/proc/self/task")) {
    const auto thread = static_cast<pid_t>(std::stoi(entry.path().filename().string()));
    if (::sched_getscheduler(thread) == SCHED_IDLE) {
      all.insert(thread);
    }
  }
  return all;
}

TEST(AwakeProcessors, EachThatTheProcessMayUseHasAThreadOfIdlePriorityOfItsOwn) {
  cpu_set_t own;
  ASSERT_EQ(::sched_getaffinity(0, sizeof own, &own), 0);
  const AwakeProcessors awake;
  EXPECT_EQ(awake.processors(), static_cast<std::size_t>(CPU_COUNT(&own)));
  const std::set<pid_t> threads = threads_of_idle_priority();
  EXPECT_EQ(threads.size(), awake.processors());
  cpu_set_t covered;
  CPU_ZERO(&covered);
  for (const pid_t thread : threads) {
    cpu_set_t one;
    ASSERT_EQ(::sched_getaffinity(thread, sizeof one, &one), 0);
    EXPECT_EQ(CPU_COUNT(&one), 1);
    CPU_OR(&covered, &covered, &one);
  }
  EXPECT_TRUE(CPU_EQUAL(&covered, &own));
}

TEST(AwakeProcessors, WhatTheyUseIsTold) {
  const AwakeProcessors awake;
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (awake.cpu_seconds() < 0.02 && std::chrono::steady_clock::now() < end) {
    ::usleep(1000);
  }
  EXPECT_GE(awake.cpu_seconds(), 0.02);
}

TEST(AwakeProcessors, EndWithIt) {
  { const AwakeProcessors awake; }
  EXPECT_TRUE(threads_of_idle_priority().empty());
}

class LimitOfProcessors : public testing::Test {
 protected:
  void put(const std::string& group, const std::string& text) const {
    fs::create_directories(root / group);
    std::ofstream(root / group / "cpu.max") << text;
  }
  [[nodiscard]] std::optional<double> limit(const std::string& membership) const {
    std::ofstream(folder.path() / "cgroup") << membership;
    return limit_of_processors(folder.path() / "cgroup", root);
  }

  PrivateFolder folder{"cgroup"};
  fs::path root = folder.path() / "groups";
};

TEST_F(LimitOfProcessors, IsTheLeastOfAGroupAndThoseThatItIsIn) {
  put("", "max 100000\n");
  put("rigs", "150000 100000\n");
  put("rigs/one", "400000 100000\n");
  EXPECT_EQ(limit("0::/rigs/one\n"), 1.5);
  EXPECT_EQ(limit("0::/rigs\n"), 1.5);
  EXPECT_EQ(limit("0::/\n"), std::nullopt);
}

TEST_F(LimitOfProcessors, IsFoundInAContainerWhoseGroupIsTheRoot) {
  put("", "50000 100000\n");
  EXPECT_EQ(limit("0::/\n"), 0.5);
}

TEST_F(LimitOfProcessors, IsNoneWithoutGroupsOrWithThoseOfTheFirstVersion) {
  EXPECT_EQ(limit(""), std::nullopt);
  EXPECT_EQ(limit("0::/gone\n"), std::nullopt);
  EXPECT_EQ(limit("4:cpu,cpuacct:/\n"), std::nullopt);
  EXPECT_EQ(limit_of_processors(folder.path() / "none", root), std::nullopt);
}

TEST_F(LimitOfProcessors, IsNoneWhereTheFileSaysNothing) {
  put("empty", "");
  put("odd", "some 100000\n");
  put("zero", "100000 0\n");
  EXPECT_EQ(limit("0::/empty\n"), std::nullopt);
  EXPECT_EQ(limit("0::/odd\n"), std::nullopt);
  EXPECT_EQ(limit("0::/zero\n"), std::nullopt);
}

}  // namespace
}  // namespace rigwire::hil
