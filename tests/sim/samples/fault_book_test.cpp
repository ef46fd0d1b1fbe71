#include "sim/samples/fault_book.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

namespace rigwire {
namespace {

using std::chrono::seconds;

struct Loud {
  int level = 0;
};
struct Silent {};
struct Fault {
  FaultPeriod when;
  std::variant<Loud, Silent> what;
};

SimTime at(int second) {
  return kStart + seconds{second};
}

const std::vector<Fault> kList{{{seconds{1}, seconds{4}}, Loud{1}},
                               {{seconds{2}, seconds{2}}, Loud{2}},
                               {{seconds{3}, seconds{7}}, Silent{}}};

std::string levels(const FaultBook<Fault>& book, int second) {
  std::string text;
  book.each(at(second), [&](const Fault& fault) {
    const Loud* loud = std::get_if<Loud>(&fault.what);
    text += loud != nullptr ? std::to_string(loud->level) : "s";
  });
  return text;
}

TEST(FaultBook, AFaultHoldsFromItsBeginUpToItsEnd) {
  const FaultBook<Fault> book(kList);
  EXPECT_EQ(book.first<Silent>(at(3) - Duration{1}), nullptr);
  EXPECT_NE(book.first<Silent>(at(3)), nullptr);
  EXPECT_NE(book.first<Silent>(at(10) - Duration{1}), nullptr);
  EXPECT_EQ(book.first<Silent>(at(10)), nullptr);
  EXPECT_EQ(FaultBook<Fault>().first<Silent>(at(5)), nullptr);
}

TEST(FaultBook, OfSeveralTheOrderOfTheListDecides) {
  const FaultBook<Fault> book(kList);
  EXPECT_EQ(book.first<Loud>(at(3))->level, 1);
  EXPECT_EQ(levels(book, 0), "");
  EXPECT_EQ(levels(book, 3), "12s");
  EXPECT_EQ(levels(book, 4), "1s");
}

TEST(FaultBook, NextChangeIsTheNextEdgeOfThatKind) {
  const FaultBook<Fault> book(kList);
  EXPECT_EQ(book.next_change<Loud>(kStart), at(1));
  EXPECT_EQ(book.next_change<Loud>(at(1)), at(2));
  EXPECT_EQ(book.next_change<Loud>(at(2)), at(4));
  EXPECT_EQ(book.next_change<Loud>(at(5)), kNever);
  EXPECT_EQ(book.next_change<Silent>(at(3)), at(10));
}

TEST(FaultBook, OneBegunInTheRunEndsWhenToldAndOnlyOnce) {
  FaultBook<Fault> book(kList);
  const auto id = book.add({{seconds{20}, seconds{100}}, Loud{3}});
  EXPECT_EQ(book.first<Loud>(at(25))->level, 3);
  EXPECT_TRUE(book.end(id, at(30)));
  EXPECT_NE(book.first<Loud>(at(30) - Duration{1}), nullptr) << "the past stands";
  EXPECT_EQ(book.first<Loud>(at(30)), nullptr);
  EXPECT_FALSE(book.end(id, at(31))) << "over";
  EXPECT_FALSE(book.end(id + 1, at(31))) << "no such fault";
  ASSERT_EQ(book.list().size(), 4U);
  EXPECT_EQ(book.list()[3].fault.when, (FaultPeriod{seconds{20}, seconds{10}}));
}

TEST(FaultBook, OneEndedBeforeItsBeginNeverHolds) {
  FaultBook<Fault> book(kList);
  EXPECT_TRUE(book.end(book.list()[2].id, at(2)));
  EXPECT_EQ(book.first<Silent>(at(3)), nullptr);
  EXPECT_EQ(book.first<Silent>(at(2)), nullptr);
  EXPECT_EQ(levels(book, 3), "12");
}

/// "1" where it holds, second by second from 0.
std::string held(const FaultPeriod& when, int seconds_long) {
  std::string text;
  for (int second = 0; second < seconds_long; ++second) {
    text += when.holds(at(second)) ? '1' : '0';
  }
  return text;
}

TEST(FaultPeriod, UntilIsAnInstantAndForALength) {
  EXPECT_EQ(held({.at = seconds{2}, .length = seconds{3}}, 8), "00111000");
  EXPECT_EQ(held({.at = seconds{2}, .until = seconds{3}}, 8), "00100000");
  EXPECT_EQ(held({.at = seconds{2}}, 8), "00111111") << "to the end of the run";
}

TEST(FaultPeriod, RepetitionsHaveALengthOrAShareOfTheirPeriod) {
  EXPECT_EQ(held({.at = seconds{1}, .length = seconds{2}, .every = seconds{4}}, 13),
            "0110011001100");
  EXPECT_EQ(held({.at = seconds{1}, .every = seconds{4}, .duty = 0.5}, 13), "0110011001100");
  EXPECT_EQ(held({.at = seconds{1}, .length = seconds{5}, .every = seconds{4}, .duty = 0.5}, 13),
            "0110010000000")
      << "with duty, `for` is of all repetitions";
  EXPECT_EQ(
      held({.at = seconds{1}, .length = seconds{2}, .until = seconds{6}, .every = seconds{4}}, 13),
      "0110010000000");
}

TEST(FaultPeriod, AnEdgeLiesWhereItTurns) {
  const FaultPeriod loose{
      .at = seconds{1}, .until = seconds{11}, .every = seconds{4}, .duty = 0.25};
  std::vector<SimTime> edges;
  for (SimTime t = kStart; t != kNever; t = loose.next_edge(t)) {
    edges.push_back(t);
  }
  EXPECT_EQ(edges,
            (std::vector<SimTime>{kStart, at(1), at(2), at(5), at(6), at(9), at(10), at(11)}));
  for (const SimTime edge : edges) {
    EXPECT_EQ(loose.holds(edge), edge == at(1) || edge == at(5) || edge == at(9));
  }
}

/// 2000 repetitions: the share that happens is the probability within four standard deviations.
TEST(FaultPeriod, EachRepetitionHappensWithItsProbability) {
  FaultPeriod when{.length = std::chrono::milliseconds{500},
                   .every = seconds{1},
                   .probability = 0.3,
                   .stream = 7};
  const std::string first = held(when, 2000);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(first, '1')), 600.0, 82.0);
  EXPECT_EQ(held(when, 2000), first) << "drawn anew";
  when.stream = 8;
  EXPECT_NE(held(when, 2000), first) << "the run's seed changes nothing";
}

TEST(FaultPeriod, WhatWaitsHasNotBegunAndWhatIsCutThenNeverDid) {
  FaultPeriod when{.at = seconds{1}, .length = seconds{3}, .when = {"boom", true, 0.5}};
  EXPECT_EQ(held(when, 8), "00000000");
  EXPECT_EQ(when.begin(), kNever);
  EXPECT_EQ(when.next_edge(at(0)), kNever);
  when.cut(at(3));
  EXPECT_EQ(held(when, 8), "00000000");
}

TEST(FaultPeriod, ARepetitionThatIsCutHoldsUpToThere) {
  FaultPeriod when{.at = seconds{1}, .length = seconds{2}, .every = seconds{4}};
  when.cut(at(6));
  EXPECT_EQ(held(when, 13), "0110010000000");
}

struct Growing {
  double level = 4.0;
  Duration ramp = seconds{2};

  void grow(double share) { level *= share; }
};
struct GrowingFault {
  FaultPeriod when;
  std::variant<Growing, Silent> what;
};

TEST(FaultBook, AMagnitudeGrowsEvenlyInEachRepetition) {
  const FaultBook<GrowingFault> book(
      {{{.at = seconds{1}, .length = seconds{3}, .every = seconds{5}}, Growing{}}});
  const auto level = [&](int second) {
    const auto found = book.first_grown<Growing>(at(second));
    return found ? found->level : -1.0;
  };
  for (const int begin : {1, 6, 11}) {
    EXPECT_EQ(level(begin), 0.0);
    EXPECT_EQ(level(begin + 1), 2.0);
    EXPECT_EQ(level(begin + 2), 4.0);
    EXPECT_EQ(level(begin + 3), -1.0) << "over";
  }
}

/// A fault each ten seconds for weeks: the book stays small, and says what it forgot.
TEST(FaultBook, OfManyTheOldestThatAreOverAreForgotten) {
  FaultBook<Fault> book({{{seconds{0}}, Silent{}}});
  constexpr int kMany = 100'000;
  FaultBook<Fault>::Id last = 0;
  for (int i = 0; i < kMany; ++i) {
    last =
        book.add({{.at = seconds{10 * i}, .length = seconds{1}, .ordered = at(10 * i)}, Loud{i}});
    ASSERT_LE(book.list().size(), FaultBook<Fault>::kKept);
  }
  EXPECT_EQ(book.forgotten() + book.list().size(), kMany + 1U);
  EXPECT_EQ(last, kMany + 1U) << "a number is given twice";
  EXPECT_EQ(std::get<Loud>(book.find(last).what).level, kMany - 1);
  EXPECT_NE(book.first<Silent>(at(10 * kMany)), nullptr) << "what still holds was forgotten";
  EXPECT_FALSE(book.has(2));
  EXPECT_FALSE(book.end(2, at(10 * kMany)));
}

}  // namespace
}  // namespace rigwire
