// The desk on an executive whose truth is a clock: what each command does, when it is answered, and
// what is refused.
#include "hil/control/desk.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clockwork.h"
#include "hil/control/control_server.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using test::Clockwork;
using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::json;

class DeskTest : public testing::Test {
 protected:
  struct Answered {
    Reply::Outcome outcome;
    Json json;
  };

  /// The answer will stand under the number that is returned.
  std::size_t ask(const std::string& text) {
    answers_.emplace_back();
    const std::size_t number = answers_.size() - 1;
    desk_.carry_out(text, "test", [this, number](const Reply& reply) {
      EXPECT_FALSE(answers_[number].has_value()) << "answered twice";
      answers_[number] = {reply.outcome, Json::parse(reply.json)};
      if (then_) {
        std::exchange(then_, nullptr)();
      }
    });
    return number;
  }
  /// Asks for one after the other, each when the one before is answered, then stops.
  void script(std::vector<std::string> texts) {
    boost::asio::post(io_, [this, texts = std::move(texts)] { next(texts, 0); });
    outcome_ = executive_.run_free(kStart + 1000s);
  }
  void next(const std::vector<std::string>& texts, std::size_t at) {
    if (at == texts.size()) {
      executive_.stop();
      return;
    }
    then_ = [this, texts, at] {
      boost::asio::post(io_, [this, texts, at] { next(texts, at + 1); });
    };
    ask(texts[at]);
  }
  const Json& answer(std::size_t number) {
    EXPECT_TRUE(answers_.at(number).has_value());
    static const Json kNone = Json::object();
    return answers_[number] ? answers_[number]->json : kNone;
  }

  RigFaults faults_;  ///< Nothing here can have faults.
  boost::asio::io_context io_;
  Clockwork truth_;
  Executive executive_{io_, truth_};
  Desk desk_{io_,
             executive_,
             {"pit",
              7,
              "abc",
              {ClockMode::Kind::step, 1.0},
              truth_.state_quantities(),
              [this] {
                RigStatus status;
                DeviceStatus& gnss = status.devices.emplace_back();
                gnss.name = "gnss";
                gnss.frames = 3;
                status.faults.push_back({"gnss", "jamming", kStart, kNever});
                return status;
              },
              faults_}};
  std::vector<std::optional<Answered>> answers_;
  std::function<void()> then_;
  RunOutcome outcome_;
};

TEST_F(DeskTest, TimeMovesWhenToldAndStandsWhereItWasSent) {
  script({"{verb: state}", "{verb: run_until, time: 1.5 s}", "{verb: step, length: 1 ns}",
          R"({"verb": "step", "length": "2.5 ms"})", "{verb: state}"});
  EXPECT_EQ(answer(0)["time_ns"], 0);
  EXPECT_EQ(answer(0)["paused"], true);
  EXPECT_EQ(answer(0)["rig"], "pit");
  EXPECT_EQ(answer(1)["time_ns"], 1'500'000'000);
  EXPECT_EQ(answer(2)["time_ns"], 1'500'000'001);
  EXPECT_EQ(answer(3)["time_ns"], 1'502'500'001);
  EXPECT_EQ(answer(4)["paused"], true);
  EXPECT_EQ(outcome_.reached, kStart + 1'502'500'001ns);
}

TEST_F(DeskTest, ARunOfItsOwnIsSentNowhereItHasBeen) {
  script({"{verb: run_until, time: 20 ms}", "{verb: seek, time: 10 ms}", "{verb: seek, time: 1 s}",
          "{verb: state}"});
  EXPECT_EQ(answer(1)["ok"], false);
  EXPECT_THAT(answer(1)["what"].get<std::string>(), HasSubstr("cannot go back"));
  EXPECT_THAT(answer(2)["allowed"].get<std::string>(), HasSubstr("run_until"));
  EXPECT_EQ(answer(3)["time_ns"], 20'000'000);
  EXPECT_EQ(answer(3)["recorded_end_ns"], nullptr);
}

TEST_F(DeskTest, WaitEndsWhereTheQuantityIsAndTimeStandsAsBefore) {
  script({"{verb: wait, quantity: angle, value: 0.25}", "{verb: read}",
          "{verb: wait, quantity: angle, value: 0.1, above: false, limit: 50 ms}",
          "{verb: state}"});
  const auto reached = answer(0)["time_ns"].get<std::int64_t>();
  EXPECT_GE(reached, 248'000'000);
  EXPECT_LE(reached, 254'000'000);
  EXPECT_EQ(answer(0)["paused"], true);
  EXPECT_GT(answer(1)["machine"]["quantities"]["angle"]["value"], 0.25);
  EXPECT_EQ(answer(1)["machine"]["quantities"]["angle"]["unit"], "rad");
  EXPECT_EQ(answer(1)["devices"]["gnss"]["frames"], 3);
  EXPECT_EQ(answer(1)["faults"][0]["end_ns"], nullptr);
  EXPECT_EQ(answer(2)["ok"], false);
  EXPECT_THAT(answer(2)["what"].get<std::string>(), HasSubstr("angle"));
  EXPECT_EQ(answer(3)["time_ns"], reached + 50'000'000);
}

TEST_F(DeskTest, QueuedCommandsActTogetherAtTheirInstantInTheOrderTheyCame) {
  std::vector<std::pair<std::size_t, SimTime>> order;
  const auto note = [&](std::size_t which) {
    return [&, which](const Reply&) { order.emplace_back(which, executive_.now()); };
  };
  desk_.carry_out({ReadCommand{}, 30ms}, note(0));
  desk_.carry_out({StateCommand{}, 20ms}, note(1));
  desk_.carry_out({ReadCommand{}, 20ms}, note(2));
  script({"{verb: run_until, time: 1 s}"});
  EXPECT_THAT(order, ElementsAre(std::pair{1, kStart + 20ms}, std::pair{2, kStart + 20ms},
                                 std::pair{0, kStart + 30ms}));
}

TEST_F(DeskTest, APauseOnTheWayHoldsTheJourneyUntilTimeGoesOn) {
  desk_.carry_out({PauseCommand{}, 10ms}, [&](const Reply& reply) {
    EXPECT_EQ(Json::parse(reply.json)["time_ns"], 10'000'000);
    desk_.carry_out({ResumeCommand{}}, [](const Reply&) {});
  });
  script({"{verb: run_until, time: 20 ms}"});
  EXPECT_EQ(answer(0)["time_ns"], 20'000'000);
}

TEST_F(DeskTest, WhatCannotBeDoneIsRefusedWithWhatIsAllowed) {
  desk_.carry_out({RunUntilCommand{5ms}}, [this](const Reply&) {
    boost::asio::post(io_, [this] {
      ask("{verb: run_until, time: 1 ms}");
      ask("{verb: speed, factor: 2}");
      ask("{verb: wait, quantity: angel, value: 1}");
      ask("{verb: step, length: 0 s}");
      ask("{verb: stepp}");
      ask("{verb: step, length: 1 ms, colour: red}");
      ask("no request");
      ask("{verb: speed, factor: .nan}");
      ask("{verb: step}");
      ask(std::string(1000, '['));
      executive_.stop();
    });
  });
  executive_.run_free(kStart + 1s);
  ASSERT_EQ(answers_.size(), 10U);
  EXPECT_EQ(answers_[0]->outcome, Reply::Outcome::refused);
  EXPECT_EQ(answer(0)["allowed"], "later than 5 ms");
  EXPECT_EQ(answers_[1]->outcome, Reply::Outcome::refused);
  EXPECT_THAT(answer(1)["allowed"].get<std::string>(), HasSubstr("scaled:X"));
  EXPECT_EQ(answer(2)["allowed"], "angle (rad), did you mean angle?");
  for (std::size_t i = 2; i < answers_.size(); ++i) {
    EXPECT_EQ(answers_[i]->outcome, Reply::Outcome::wrong) << i << answer(i);
    EXPECT_FALSE(answer(i)["what"].get<std::string>().empty());
  }
  EXPECT_THAT(answer(4)["what"].get<std::string>(), HasSubstr("step"));
  EXPECT_EQ(answer(5)["path"], "colour");
}

/// Each of these once held up the wires for up to seconds.
TEST_F(DeskTest, ALargeOrTangledRequestIsRefusedWithAShortWord) {
  std::string power = "a: &l0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 7; ++i) {
    power += fmt::format("b{0}: &l{0} [*l{1}, *l{1}, *l{1}, *l{1}, *l{1}, *l{1}]\n", i, i - 1);
  }
  std::string keys;
  for (int i = 0; i < 6000; ++i) {
    keys += fmt::format("k{}: 1, ", i);
  }
  ask("verb: state\n" + power);
  ask("{verb: set, set: {" + keys + "}}");
  ask("{verb: set, set: '{" + keys + "}'}");
  ask("{verb: fault_add, on: gnss, fault: '{type: &a jamming, for: *a}'}");
  ask("{verb: " + std::string(60'000, 's') + "}");
  ask("{verb: state, " + std::string(60'000, 's') + ": 1}");
  ask("{verb: wait, value: 1, quantity: " + std::string(60'000, 'q') + "}");
  ask("{verb: wait, value: 1, quantity: " + std::string(4'000, 'q') + "}");
  ask("{verb: set, set: {boom: " + std::string(60'000, '1') + "}}");
  ask("{verb: set, on: " + std::string(4'000, 'o') + ", set: {boom: 1}}");
  for (std::size_t i = 0; i < answers_.size(); ++i) {
    ASSERT_TRUE(answers_[i].has_value()) << i;
    EXPECT_EQ(answers_[i]->outcome, Reply::Outcome::wrong) << i;
    EXPECT_LT(answers_[i]->json.dump().size(), 4000U) << i;
  }
  EXPECT_THAT(answer(0)["what"].get<std::string>(), HasSubstr("an anchor or an alias"));
  EXPECT_THAT(answer(1)["what"].get<std::string>(), HasSubstr("too many keys"));
  EXPECT_THAT(answer(2)["what"].get<std::string>(), HasSubstr("too many keys"));
  EXPECT_THAT(answer(3)["what"].get<std::string>(), HasSubstr("an anchor or an alias"));
  EXPECT_EQ(answer(6)["allowed"], "at most 4096 bytes");
}

/// A client that has gone keeps no place, what it asked for is still to be done.
TEST_F(DeskTest, CommandsThatWaitForTheirInstantHaveALimit) {
  const std::size_t first = answers_.size();
  for (std::size_t i = 0; i < Desk::kMaxQueued; ++i) {
    ask("{verb: state, at: 1 s}");
  }
  EXPECT_FALSE(answers_.back().has_value());
  ask("{verb: state, at: 2 s}");
  ASSERT_TRUE(answers_.back().has_value());
  EXPECT_EQ(answers_.back()->outcome, Reply::Outcome::refused);
  EXPECT_EQ(answers_.back()->json["allowed"], "at most 1024");
  ask("{verb: state}");
  EXPECT_EQ(answers_.back()->outcome, Reply::Outcome::done) << "what is at once is";
  desk_.carry_out({RunUntilCommand{2s}}, [this](const Reply&) { executive_.stop(); });
  executive_.run_free(kStart + 1000s);
  EXPECT_EQ(executive_.now(), kStart + 2s);
  EXPECT_EQ(answer(first)["time_ns"], 1'000'000'000);
}

TEST(EventsDesk, OneMoreWhoWaitsForEventsEndsTheWaitOfTheOldest) {
  boost::asio::io_context io;
  RigFaults faults;
  RunEvents events;
  Clockwork truth;
  Executive executive(io, truth);
  GovernedRun run{"pit", 7, "abc", {}, truth.state_quantities(), [] { return RigStatus{}; },
                  faults};
  run.events = &events;
  Desk desk(io, executive, run);
  std::vector<Json> replies;
  for (std::size_t i = 0; i < Desk::kMaxListeners; ++i) {
    desk.carry_out({EventsCommand{0, true}},
                   [&](const Reply& reply) { replies.push_back(Json::parse(reply.json)); });
  }
  EXPECT_TRUE(replies.empty());
  bool answered = false;
  desk.carry_out({EventsCommand{0, true}}, [&](const Reply&) { answered = true; });
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0]["ok"], true);
  EXPECT_TRUE(replies[0]["events"].empty());
  EXPECT_EQ(replies[0]["last"], 0);
  EXPECT_FALSE(answered);
  desk.end();
  EXPECT_TRUE(answered);
}

TEST_F(DeskTest, OneJourneyAtATimeAndTheRunsEndAnswersAll) {
  const auto on_its_way = answers_.size();
  ask("{verb: run_until, time: 2 s}");
  ask("{verb: step, length: 1 s}");
  ask("{verb: state, at: 5 s}");
  EXPECT_EQ(answers_[on_its_way + 1]->outcome, Reply::Outcome::refused);
  EXPECT_FALSE(answers_[on_its_way].has_value());
  executive_.run_free(kStart + 1s);
  desk_.end();
  EXPECT_EQ(answers_[on_its_way]->outcome, Reply::Outcome::ended);
  EXPECT_EQ(answers_[on_its_way + 2]->outcome, Reply::Outcome::ended);
  ask("{verb: state}");
  EXPECT_EQ(answers_.back()->outcome, Reply::Outcome::ended);
}

TEST(PacedDesk, PauseAndSpeedActOnTheWallsClock) {
  boost::asio::io_context io;
  RigFaults faults;
  Clockwork truth;
  Executive executive(io, truth);
  Desk desk(io, executive,
            {"pit", 7, "abc", {}, truth.state_quantities(), [] { return RigStatus{}; }, faults});
  std::vector<Json> replies;
  const auto note = [&](const Reply& reply) { replies.push_back(Json::parse(reply.json)); };
  desk.carry_out({SpeedCommand{100.0}, 20ms}, note);
  desk.carry_out({PauseCommand{}, 1s}, [&](const Reply& reply) {
    note(reply);
    desk.carry_out({ResumeCommand{}}, note);
  });
  desk.carry_out({StopCommand{}, 2s}, note);
  PacedSettings settings;
  settings.overrun_limit = 10s;
  const RunOutcome outcome = executive.run_paced(settings, kStart + 60s);
  EXPECT_EQ(outcome.reached, kStart + 2s);
  ASSERT_EQ(replies.size(), 4U);
  EXPECT_EQ(replies[0]["clock"], "scaled:100");
  EXPECT_EQ(replies[1]["time_ns"], 1'000'000'000);
  EXPECT_EQ(replies[1]["paused"], true);
  EXPECT_EQ(replies[2]["paused"], false);
}

TEST(ControlEndpoint, IsAPathOrALoopbackPort) {
  EXPECT_EQ(parse_control_endpoint("unix:/tmp/x")->path, "/tmp/x");
  EXPECT_EQ(parse_control_endpoint("127.0.0.1:0")->port, 0);
  EXPECT_EQ(parse_control_endpoint("127.1.2.3:65535")->address, "127.1.2.3");
  for (const char* text :
       {"", "unix:", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:1x", "0.0.0.0:80",
        "192.168.0.1:80", "/tmp/x", "localhost:80"}) {
    EXPECT_FALSE(parse_control_endpoint(text).has_value()) << text;
  }
}

TEST(ControlApi, HasEveryVerbWithItsKeys) {
  const Json api = Json::parse(control_api());
  const std::string request = api["components"]["schemas"]["Request"].dump();
  Command command;
  for (const fields::Named& verb : fields::detail::AlternativesOf(command).names()) {
    EXPECT_THAT(request, HasSubstr(std::string(verb.name)));
  }
  EXPECT_THAT(request, HasSubstr("quantity"));
}

}  // namespace
}  // namespace rigwire::hil
