#include "hil/record/run_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

/// A log of the caller's own.
struct Heard {
  explicit Heard(LogLevel least)
      : log(least, std::make_shared<spdlog::sinks::ostream_sink_mt>(stream)) {}
  std::ostringstream stream;
  RunLog log;
};

TEST(RunLog, LinesBelowTheLevelAreNotSaid) {
  const std::vector<std::string> all{"rigwire: debug: a\n", "rigwire: info: b\n",
                                     "rigwire: warning: c\n", "rigwire: error: d\n"};
  for (std::size_t least = 0; least < kLogLevels.size(); ++least) {
    Heard heard(static_cast<LogLevel>(least));
    heard.log.debug("a");
    heard.log.info("b");
    heard.log.warning("c");
    heard.log.error("d");
    std::string expected;
    for (std::size_t i = least; i < all.size(); ++i) {
      expected += all[i];
    }
    EXPECT_EQ(heard.stream.str(), expected) << kLogLevels[least];
  }
}

TEST(RunLog, LinesCarryTheTimeThatIsFollowedWhenTheyAreSaid) {
  Heard heard(LogLevel::info);
  SimTime now = kStart;
  heard.log.info("before");
  heard.log.follow([&now] { return now; });
  heard.log.info("first");
  now = kStart + 12'345'600us;
  heard.log.info("then");
  heard.log.follow({});
  heard.log.info("after");
  EXPECT_EQ(heard.stream.str(),
            "rigwire: info: before\nrigwire: 0.000 s: info: first\nrigwire: 12.346 s: info: then\n"
            "rigwire: info: after\n");
}

TEST(RunLog, WhatATerminalWouldObeyIsSpelledOutAndALineStaysOne) {
  Heard heard(LogLevel::info);
  heard.log.info("a\x1b[2Jb\nc{}%v");
  EXPECT_EQ(heard.stream.str(), "rigwire: info: a\\u001b[2Jb\\u000ac{}%v\n");
}

TEST(RunLog, WhoTakesLinesGetsThemWhole) {
  RunLog log(LogLevel::warning);
  std::vector<std::string> taken;
  log.divert([&taken](std::string_view line) {
    taken.emplace_back(line);
    return true;
  });
  log.warning("one");
  log.info("not said");
  log.error("two");
  log.divert({});
  EXPECT_THAT(taken, ElementsAre("rigwire: warning: one", "rigwire: error: two"));
}

TEST(RunLog, OfARigTellsItsTimeAndKeepsTheLastOneWhenItIsGone) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded =
      load_rig(RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml", wires.sets());
  Heard heard(LogLevel::info);
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {}, &heard.log);
    EXPECT_THAT(heard.stream.str(), IsEmpty());
    static_cast<void>(rig.executive().run_free(kStart + 250ms));
    heard.log.info("at work");
    static_cast<void>(rig.executive().run_free(kStart + 500ms));
  }
  heard.log.info("closed");
  EXPECT_EQ(heard.stream.str(),
            "rigwire: 0.250 s: info: at work\nrigwire: 0.500 s: info: closed\n");
}

}  // namespace
}  // namespace rigwire::hil
