#include "hil/command_line/status_reporter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "screen.h"

namespace rigwire::hil {
namespace {

using testing::ElementsAre;

const std::vector<std::string> kFirst{"device  rate", "gnss     1.0", "lidar  900.0", "machine"};
const std::vector<std::string> kSecond{"device  rate", "\x1b[33mgnss\x1b[0m     2.0", "machine"};

TEST(LivePicture, a_picture_takes_the_place_of_the_one_before) {
  test::Screen screen(40, 10);
  LivePicture live;
  for (const auto& lines : {kFirst, kSecond, kFirst, kSecond}) {
    const std::string text = live.text(lines);
    live.written(text, text.size());
    screen.feed(text);
  }
  EXPECT_THAT(screen.lines(), ElementsAre("device  rate", "gnss     2.0", "machine"));
}

TEST(LivePicture, a_picture_cut_off_at_any_byte_leaves_no_trace_under_the_next_one) {
  const std::string whole = LivePicture().text(kSecond);
  for (std::size_t cut = 0; cut <= whole.size() + 4; ++cut) {
    test::Screen screen(40, 12);
    screen.feed("what was there before\r\n");
    LivePicture live;
    const auto show = [&](const std::string& text, std::size_t bytes) {
      live.written(text, std::min(bytes, text.size()));
      screen.feed(std::string_view(text).substr(0, bytes));
    };
    show(live.text(kFirst), std::string::npos);
    show(live.text(kSecond), cut);
    show(live.text(kSecond), cut / 2);  // and the next one, too
    show(live.text(kFirst), std::string::npos);
    EXPECT_THAT(screen.lines(), ElementsAre("what was there before", "device  rate", "gnss     1.0",
                                            "lidar  900.0", "machine"))
        << "cut after " << cut;
  }
}

TEST(LivePicture, lines_as_wide_as_the_window_do_not_wrap) {
  test::Screen screen(12, 6);
  LivePicture live;
  for (int i = 0; i < 3; ++i) {
    const std::string text = live.text(kFirst);
    live.written(text, text.size());
    screen.feed(text);
  }
  EXPECT_EQ(screen.wraps(), 0U);
  EXPECT_THAT(screen.lines(),
              ElementsAre("device  rate", "gnss     1.0", "lidar  900.0", "machine"));
}

TEST(LivePicture, what_follows_stands_below_the_last_picture) {
  test::Screen screen(40, 10);
  LivePicture live;
  const std::string text = live.text(kSecond);
  live.written(text, text.size() - 12);
  screen.feed(std::string_view(text).substr(0, text.size() - 12));
  screen.feed(live.rest_of_line() + "ran 2.000 s\r\n");
  EXPECT_THAT(screen.lines(),
              ElementsAre("device  rate", "gnss     2.0", "machine", "ran 2.000 s"));
}

TEST(LivePicture, lines_that_are_said_stand_above_the_picture_and_leave_nothing_of_the_one_before) {
  test::Screen screen(20, 10);
  LivePicture live;
  const auto show = [&](const std::string& text) {
    live.written(text, text.size());
    screen.feed(text);
  };
  show(live.text(kFirst));
  show(live.instead({"a line wider than the screen", "b"}));
  live.leave();
  for (const auto& lines : {kFirst, kSecond, kFirst, kSecond}) {
    show(live.text(lines));
  }
  EXPECT_THAT(screen.lines(), ElementsAre("a line wider than th", "e screen", "b", "device  rate",
                                          "gnss     2.0", "machine"));
}

}  // namespace
}  // namespace rigwire::hil
