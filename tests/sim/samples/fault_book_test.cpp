#include "sim/samples/fault_book.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rigwire
