// The list of what happened: its numbers, its bounds, and what the truth knows before the wires.
#include "hil/record/run_events.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hil/record/contact_watch.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

void tell(RunEvents& events, SimTime at, const std::string& text) {
  events.tell(at, EventKind::notice, LogLevel::info, "gnss", text);
}

std::vector<std::string> texts(const RunEvents::Excerpt& excerpt) {
  std::vector<std::string> all;
  for (const RunEvent& event : excerpt.events) {
    all.push_back(event.text);
  }
  return all;
}

TEST(RunEvents, AnAskerIsToldWhatIsNewAndNothingTwice) {
  RunEvents events;
  EXPECT_EQ(events.since(0).last, 0U);
  tell(events, kStart + 1s, "a");
  tell(events, kStart + 2s, "b");
  const RunEvents::Excerpt first = events.since(0);
  EXPECT_EQ(texts(first), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(first.events[0].number, 1U);
  EXPECT_EQ(first.last, 2U);
  tell(events, kStart + 3s, "c");
  EXPECT_EQ(texts(events.since(first.last)), std::vector<std::string>{"c"});
  EXPECT_TRUE(events.since(3).events.empty());
  EXPECT_TRUE(events.since(99).events.empty());
}

TEST(RunEvents, WhatIsKeptNoLongerIsCountedForWhoDidNotSeeIt) {
  RunEvents events;
  for (std::size_t i = 0; i < RunEvents::kKept + 10; ++i) {
    tell(events, kStart, std::to_string(i));
  }
  EXPECT_EQ(events.since(0).lost, 10U);
  EXPECT_EQ(events.since(0).events.size(), RunEvents::kKept);
  EXPECT_EQ(events.since(0).events.front().number, 11U);
  EXPECT_EQ(events.since(4).lost, 6U);
  EXPECT_EQ(events.since(10).lost, 0U);
  EXPECT_EQ(events.since(RunEvents::kKept + 9).events.size(), 1U);
}

TEST(RunEvents, WhatTheTruthTellsWaitsForTheWires) {
  RunEvents events;
  events.tell_ahead(kStart + 6ms, EventKind::contact_begun, LogLevel::info, "boom", "touch");
  tell(events, kStart + 2ms, "before");
  EXPECT_EQ(events.next_event(), kStart + 6ms);
  EXPECT_EQ(texts(events.since(0)), std::vector<std::string>{"before"});
  events.advance(kStart + 6ms);
  EXPECT_EQ(texts(events.since(0)), (std::vector<std::string>{"before", "touch"}));
  EXPECT_EQ(events.next_event(), kNever);
}

TEST(RunEvents, BothListenersHearUntilTheyAreGone) {
  RunEvents events;
  std::vector<std::string> recorder;
  std::vector<std::string> desk;
  events.inform([&](const RunEvent& event) { recorder.push_back(event.text); });
  events.inform_desk([&](const RunEvent& event) { desk.push_back(event.text); });
  tell(events, kStart, "a");
  events.inform({});
  tell(events, kStart, "b");
  EXPECT_EQ(recorder, std::vector<std::string>{"a"});
  EXPECT_EQ(desk, (std::vector<std::string>{"a", "b"}));
}

class ContactWatchTest : public testing::Test {
 protected:
  void look(Duration at, bool touching, std::string_view with = "rock") {
    TruthRecord record;
    record.time = kStart + at;
    ContactTruth& contact = record.contact.emplace();
    contact.touching = touching;
    contact.body = touching ? "bucket" : "";
    contact.with = touching ? with : "";
    contact.force_W = {3000.0, 0.0, 4000.0};
    watch_.record(record);
  }
  std::vector<RunEvent> told() {
    events_.advance(kStart + 1000s);
    return events_.since(0).events;
  }

  RunEvents events_;
  ContactWatch watch_{events_};
};

TEST_F(ContactWatchTest, ABouncingContactIsOne) {
  look(0ms, false);
  look(10ms, true);
  look(20ms, false);
  look(60ms, true);
  look(70ms, false);
  look(150ms, false);
  look(170ms, false);
  look(180ms, false);
  const auto events = told();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, EventKind::contact_begun);
  EXPECT_EQ(events[0].at, kStart + 10ms);
  EXPECT_EQ(events[0].where, "bucket");
  EXPECT_EQ(events[0].text, "bucket hits rock with 5.00 kN");
  EXPECT_EQ(events[1].kind, EventKind::contact_ended);
  EXPECT_EQ(events[1].at, kStart + 170ms) << "0.1 s after the last touch that was seen";
}

TEST_F(ContactWatchTest, AnotherObstacleIsAnotherContact) {
  look(10ms, true, "rock");
  look(20ms, true, "trunk");
  const auto events = told();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1].kind, EventKind::contact_ended);
  EXPECT_EQ(events[1].text, "bucket is clear of rock");
  EXPECT_EQ(events[2].text, "bucket hits trunk with 5.00 kN");
}

}  // namespace
}  // namespace rigwire::hil
