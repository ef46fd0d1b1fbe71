// The protocol without a system: a viewer's socket is a list of what it was sent.
#include "hil/stream/viewers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "protocols/bytes.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

/// Takes a message only when it is told to.
class Socket final : public drivers::WebSocket {
 public:
  void wake() override {}
  void close() override { closed = true; }

  bool closed = false;
};

class ViewersTest : public testing::Test {
 protected:
  ViewersTest() {
    shallow_ = viewers_.add({"/a", "json", "A", "{}", 2, {}});
    deep_ = viewers_.add({"/b", "json", "B", "{}", 100, [] { return std::string("first"); }});
    viewers_.add(StreamService{"/echo", "", "{}", [](std::string_view request, const auto& answer) {
                                 answer(request != "no", std::string(request));
                               }});
    viewers_.on_asset([](std::string_view uri) {
      return uri == "rigwire:x" ? std::make_shared<const std::string>("thing") : nullptr;
    });
  }
  void open() {
    auto answer = viewers_.admit({"GET", "/stream", "", "", "", "", "foxglove.websocket.v1"});
    ASSERT_FALSE(answer.refusal);
    EXPECT_EQ(answer.subprotocol, "foxglove.websocket.v1");
    owner_ = answer.open(socket_);
  }
  void ask(const Json& json) { owner_.received(true, json.dump()); }
  /// All that waits, as the socket takes it.
  std::vector<std::string> take() {
    std::vector<std::string> all;
    for (auto message = owner_.next(); message.bytes; message = owner_.next()) {
      all.push_back(*message.bytes);
    }
    return all;
  }
  /// Payloads of messages of a subscription.
  static std::vector<std::string> payloads(const std::vector<std::string>& frames, char id) {
    std::vector<std::string> all;
    for (const std::string& frame : frames) {
      if (frame.size() > 13 && frame[0] == 1 && frame[1] == id) {
        all.push_back(frame.substr(13));
      }
    }
    return all;
  }

  Viewers viewers_{"pit", "session"};
  Viewers::ChannelId shallow_ = 0;
  Viewers::ChannelId deep_ = 0;
  std::shared_ptr<Socket> socket_ = std::make_shared<Socket>();
  drivers::WebSocket::Owner owner_;
};

// To print a value takes as much stack as it is deep.
TEST_F(ViewersTest, AMessageOfThirtyThousandLevelsIsRefusedAndTakesNoStack) {
  open();
  (void)take();
  const std::string deep(30'000, '[');
  owner_.received(true, R"({"op":"subscribe","subscriptions":[{"id":)" + deep +
                            std::string(30'000, ']') + "}]}");
  const auto told = take();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told.front(), HasSubstr("nested deeper than 24 levels"));
  ask({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", shallow_}}}}});
  EXPECT_TRUE(take().empty());
}

TEST_F(ViewersTest, WhoOffersNoneOfTheProtocolsIsRefused) {
  const auto answer = viewers_.admit({"GET", "/stream", "", "", "", "", "chat, foxglove"});
  ASSERT_TRUE(answer.refusal);
  EXPECT_EQ(answer.refusal->status, 400);
  EXPECT_THAT(answer.refusal->body, HasSubstr("foxglove.sdk.v1"));
}

TEST_F(ViewersTest, OfSeveralOffersTheFirstKnownIsTaken) {
  const auto answer =
      viewers_.admit({"GET", "/", "", "", "", "", "x, foxglove.websocket.v1 , foxglove.sdk.v1"});
  EXPECT_EQ(answer.subprotocol, "foxglove.sdk.v1");
}

TEST_F(ViewersTest, AViewerIsToldWhatThereIs) {
  open();
  const auto told = take();
  ASSERT_EQ(told.size(), 3U);
  const Json info = Json::parse(told[0]);
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["capabilities"], (Json{"time", "services", "assets"}));
  const Json channels = Json::parse(told[1])["channels"];
  EXPECT_EQ(channels[0]["topic"], "/a");
  EXPECT_EQ(channels[1]["schemaName"], "B");
  EXPECT_EQ(Json::parse(told[2])["services"][0]["name"], "/echo");
}

TEST_F(ViewersTest, OnlySubscribersAreSentMessages) {
  open();
  take();
  EXPECT_FALSE(viewers_.wanted(shallow_));
  viewers_.put(shallow_, 5, "lost");
  ask({{"op", "subscribe"}, {"subscriptions", {{{"id", 7}, {"channelId", shallow_}}}}});
  EXPECT_TRUE(viewers_.wanted(shallow_));
  viewers_.put(shallow_, 5, "kept");
  EXPECT_THAT(payloads(take(), 7), ElementsAre("kept"));
  ask({{"op", "unsubscribe"}, {"subscriptionIds", {7}}});
  EXPECT_FALSE(viewers_.wanted(shallow_));
}

TEST_F(ViewersTest, WhoSubscribesIsToldTheFirstMessage) {
  open();
  take();
  ask({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", deep_}}}}});
  EXPECT_THAT(payloads(take(), 1), ElementsAre("first"));
}

TEST_F(ViewersTest, OfASlowViewersMessagesTheOldestAreDroppedAndItIsTold) {
  open();
  take();
  ask({{"op", "subscribe"},
       {"subscriptions",
        {{{"id", 1}, {"channelId", shallow_}}, {{"id", 2}, {"channelId", deep_}}}}});
  take();
  for (int i = 0; i < 5; ++i) {
    viewers_.put(shallow_, 0, "a" + std::to_string(i));
    viewers_.put(deep_, 0, "b" + std::to_string(i));
  }
  viewers_.tick(0);
  const auto frames = take();
  EXPECT_THAT(payloads(frames, 1), ElementsAre("a3", "a4"));
  EXPECT_THAT(payloads(frames, 2), ElementsAre("b0", "b1", "b2", "b3", "b4"));
  EXPECT_EQ(viewers_.figures().dropped, 3U);
  EXPECT_EQ(Json::parse(frames.front())["level"], 1);
  EXPECT_THAT(frames.front(), HasSubstr("3 messages were dropped"));
}

TEST_F(ViewersTest, WhatWaitsForOneViewerIsBounded) {
  open();
  take();
  ask({{"op", "subscribe"}, {"subscriptions", {{{"id", 2}, {"channelId", deep_}}}}});
  take();
  const std::string large(Viewers::kMostBytes / 4, 'x');
  for (int i = 0; i < 10; ++i) {
    viewers_.put(deep_, 0, large);
  }
  EXPECT_EQ(payloads(take(), 2).size(), 3U);
  EXPECT_EQ(viewers_.figures().dropped, 7U);
}

TEST_F(ViewersTest, WhoAsksMoreThanItReadsLosesItsConnection) {
  open();
  for (std::size_t i = 0; i <= Viewers::kMostAnswers; ++i) {
    ask({{"op", "nonsense"}});
  }
  EXPECT_TRUE(socket_->closed);
}

TEST_F(ViewersTest, ServicesAnswerOrFail) {
  open();
  take();
  using namespace std::string_literals;
  owner_.received(false, "\x02\x00\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{}"s);
  EXPECT_EQ(take(), std::vector{"\x03\x00\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{}"s});
  owner_.received(false, "\x02\x00\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00jsonno"s);
  owner_.received(false, "\x02\x01\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{}"s);
  owner_.received(false, "\x02\x00\x00\x00\x00\x09\x00\x00\x00\x03\x00\x00\x00xml{}"s);
  const auto failures = take();
  ASSERT_EQ(failures.size(), 3U);
  for (const std::string& failure : failures) {
    EXPECT_EQ(Json::parse(failure)["op"], "serviceCallFailure");
    EXPECT_EQ(Json::parse(failure)["callId"], 9);
  }
}

TEST_F(ViewersTest, AssetsAreSentOrRefused) {
  open();
  take();
  ask({{"op", "fetchAsset"}, {"uri", "rigwire:x"}, {"requestId", 3}});
  ask({{"op", "fetchAsset"}, {"uri", "file:///etc/passwd"}, {"requestId", 4}});
  const auto frames = take();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0], protocols::foxglove::asset_frame(3, "thing"));
  EXPECT_EQ(frames[1][5], 1);
}

TEST_F(ViewersTest, WhatIsNoRequestIsComplainedOfAndChangesNothing) {
  open();
  take();
  for (const char* const text : {"", "[]", "{", R"({"op":5})", R"({"op":"subscribe"})",
                                 R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})",
                                 R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})",
                                 R"({"op":"subscribe","subscriptions":[5]})",
                                 R"({"op":"unsubscribe","subscriptionIds":[8]})",
                                 R"({"op":"fetchAsset","uri":5,"requestId":1})"}) {
    owner_.received(true, text);
    const auto told = take();
    ASSERT_EQ(told.size(), 1U) << text;
    EXPECT_EQ(Json::parse(told[0])["level"], 2) << text;
  }
  EXPECT_FALSE(viewers_.wanted(shallow_));
}

TEST_F(ViewersTest, WhoLeavesIsWaitedForNoMore) {
  open();
  ask({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", shallow_}}}}});
  EXPECT_EQ(viewers_.figures().viewers, 1U);
  owner_.closed();
  EXPECT_EQ(viewers_.figures().viewers, 0U);
  EXPECT_FALSE(viewers_.wanted(shallow_));
}

/// Two of them, of which one takes only even numbers.
class ParametersTest : public ViewersTest {
 protected:
  ParametersTest() {
    viewers_.offer({[this](const auto& told) {
                      told({{"even", std::to_string(even_)}, {"unset", ""}});
                    },
                    [this](const auto& wanted, const auto& done) {
                      std::vector<std::string> refused;
                      for (const StreamParameter& one : wanted) {
                        const int value = one.json.empty() ? 1 : std::stoi(one.json);
                        if (one.name == "even" && value % 2 == 0) {
                          even_ = value;
                        } else {
                          refused.push_back(one.name + " takes no " + one.json);
                        }
                      }
                      done(refused);
                    }});
    open();
    take();
  }
  std::vector<Json> answers() {
    std::vector<Json> all;
    for (const std::string& frame : take()) {
      all.push_back(Json::parse(frame));
    }
    return all;
  }

  int even_ = 2;
};

TEST_F(ParametersTest, AreToldByNameOrAllOfThem) {
  ask({{"op", "getParameters"}, {"parameterNames", Json::array()}, {"id", "q"}});
  const auto told = answers();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0],
            (Json{{"op", "parameterValues"},
                  {"parameters",
                   {{{"name", "even"}, {"value", 2}, {"type", "float64"}}, {{"name", "unset"}}}},
                  {"id", "q"}}));
  ask({{"op", "getParameters"}, {"parameterNames", {"odd", "unset"}}});
  const auto some = answers();
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some[0]["level"], 2);
  EXPECT_THAT(some[0]["message"].get<std::string>(), HasSubstr("odd"));
  EXPECT_EQ(some[1]["parameters"], (Json{{{"name", "unset"}}}));
  EXPECT_FALSE(some[1].contains("id"));
}

TEST_F(ParametersTest, WhatIsRefusedIsSaidAndAnsweredWithWhatHolds) {
  ask({{"op", "setParameters"}, {"parameters", {{{"name", "even"}, {"value", 3}}}}, {"id", "s"}});
  const auto told = answers();
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0]["op"], "status");
  EXPECT_EQ(told[0]["message"], "even takes no 3");
  EXPECT_EQ(told[1]["parameters"][0]["value"], 2);
  // Without an id nobody waits for an answer.
  ask({{"op", "setParameters"}, {"parameters", {{{"name", "even"}, {"value", 4}}}}});
  EXPECT_THAT(answers(), ElementsAre());
  EXPECT_EQ(even_, 4);
}

TEST_F(ParametersTest, WhoSubscribesIsToldOfChangesAlone) {
  ask({{"op", "subscribeParameterUpdates"}, {"parameterNames", {"even"}}});
  viewers_.tell_parameters();
  EXPECT_THAT(answers(), ElementsAre());
  even_ = 8;  // by whomever
  viewers_.tell_parameters();
  viewers_.tell_parameters();
  const auto told = answers();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0]["parameters"], (Json{{{"name", "even"}, {"value", 8}, {"type", "float64"}}}));
  ask({{"op", "unsubscribeParameterUpdates"}, {"parameterNames", {"even"}}});
  even_ = 10;
  viewers_.tell_parameters();
  EXPECT_THAT(answers(), ElementsAre());
  ask({{"op", "unsubscribeParameterUpdates"}, {"parameterNames", {"even"}}});
  EXPECT_EQ(answers().at(0)["level"], 2);
}

TEST_F(ParametersTest, WhatIsNoRequestIsSaid) {
  for (const Json& wrong :
       {Json{{"op", "getParameters"}}, Json{{"op", "getParameters"}, {"parameterNames", {1}}},
        Json{{"op", "setParameters"}}, Json{{"op", "setParameters"}, {"parameters", {"even"}}},
        Json{{"op", "setParameters"},
             {"parameters", {{{"name", "even"}, {"value", "AA=="}, {"type", "byte_array"}}}}}}) {
    ask(wrong);
    const auto told = answers();
    ASSERT_EQ(told.size(), 1U) << wrong;
    EXPECT_EQ(told[0]["level"], 2) << wrong;
  }
  EXPECT_EQ(even_, 2);
}

}  // namespace
}  // namespace rigwire::hil
