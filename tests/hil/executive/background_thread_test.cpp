#include "hil/executive/background_thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace rigwire::hil {
namespace {

using testing::ElementsAre;

void fail_on(const std::string& what) {
  FAIL() << what;
}

TEST(BackgroundThread, WhatIsPostedBeforeItsEndIsDoneOnIt) {
  boost::asio::io_context io;
  std::vector<std::thread::id> done;
  const auto note = [&] { done.push_back(std::this_thread::get_id()); };
  boost::asio::post(io, note);
  {
    const BackgroundThread thread(io, fail_on);
    boost::asio::post(io, note);
  }
  ASSERT_EQ(done.size(), 2U);
  EXPECT_EQ(done[0], done[1]);
  EXPECT_NE(done[0], std::this_thread::get_id());
  boost::asio::post(io, note);
  EXPECT_EQ(io.poll(), 0U);  // it has stopped
}

TEST(BackgroundThread, IsNicerThanWhoMadeIt) {
  boost::asio::io_context io;
  int niceness = 0;
  boost::asio::post(io,
                    [&] { niceness = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())); });
  { const BackgroundThread thread(io, fail_on); }
  const int own = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
  EXPECT_EQ(niceness, std::min(own + 10, 19));
}

TEST(BackgroundThread, AnExceptionIsToldAndWhatFollowsIsDone) {
  boost::asio::io_context io;
  std::vector<std::string> told;
  boost::asio::post(io, [] { throw std::runtime_error("first"); });
  boost::asio::post(io, [&] { told.emplace_back("then"); });
  {
    const BackgroundThread thread(io, [&](const std::string& what) { told.push_back(what); });
  }
  EXPECT_THAT(told, ElementsAre("first", "then"));
}

}  // namespace
}  // namespace rigwire::hil
