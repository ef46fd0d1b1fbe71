#include "hil/executive/crossing.h"

#include <gtest/gtest.h>

#include <string>

namespace rigwire::hil {
namespace {

TEST(Crossing, OnOneThreadCallsArePlain) {
  boost::asio::io_context io;
  const Crossing crossing(io, io);
  std::string heard;
  crossing.go([&, back = crossing.back([&](const std::string& text) { heard = text; })] {
    back(std::string("answer"));
  });
  EXPECT_EQ(heard, "answer");
}

TEST(Crossing, BetweenTwoEachIsCalledWhereItBelongs) {
  boost::asio::io_context here;
  boost::asio::io_context there;
  const Crossing crossing(here, there);
  std::string asked;
  std::string heard;
  crossing.go([&, back = crossing.back([&](const std::string& text) { heard = text; })] {
    std::string answer = "answer";
    asked = "asked";
    back(answer);
    answer = "changed since";
  });
  here.poll();
  EXPECT_EQ(asked, "");
  there.poll();
  EXPECT_EQ(asked, "asked");
  EXPECT_EQ(heard, "");
  here.restart();
  here.poll();
  EXPECT_EQ(heard, "answer");
}

}  // namespace
}  // namespace rigwire::hil
