#include "hil/control/showing.h"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <utility>

#include "hil/control/commands.h"
#include "hil/control/desk.h"

namespace rigwire::hil {
namespace {

/// Simulated time before the instant at which viewers are awaited: a turn of any lidar, a picture,
/// a fix.
constexpr Duration kSeenBefore = std::chrono::milliseconds{500};
/// Wall time within which a page has loaded again and subscribed, at most.
constexpr std::chrono::seconds kReturn{20};
constexpr std::chrono::milliseconds kViewerLook{100};

const auto kNobody = [](const Reply& /*reply*/) {};

}  // namespace

void Showing::begin(const Course& course) {
  rerun_.begin_again();
  course_ = course;
  pace_ = FreePace(course.factor);
  again_.reset();
  is_coming_ = false;
  was_looked_at_ = false;
}

void Showing::steer(Desk& desk, Executive& executive, boost::asio::io_context& io,
                    std::function<bool()> is_looked_at) {
  is_looked_at_ = std::move(is_looked_at);
  desk.carry_out(Request{PauseCommand{}, end() - kStart}, kNobody);
  boost::asio::post(io, [this, &desk, &executive, &io] {
    is_coming_ = course_.looked_at || course_.from > executive.now();
    if (!course_.looked_at) {
      if (is_coming_) {
        desk.carry_out(Request{SeekCommand{course_.from - kStart}}, kNobody);
      }
      return;
    }
    const auto wait = [this, &desk, &executive, &io](const Reply& reply) {
      if (reply.outcome == Reply::Outcome::done) {
        go_on_when_looked_at(desk, executive, io, std::chrono::steady_clock::now() + kReturn);
      }
    };
    const Duration earlier = course_.from - kStart - kSeenBefore;
    if (earlier > Duration{0}) {
      pace_.hasten(kStart + earlier);
      desk.carry_out(Request{RunUntilCommand{earlier}}, wait);
    } else {
      wait({});
    }
  });
}

void Showing::go_on_when_looked_at(Desk& desk, Executive& executive, boost::asio::io_context& io,
                                   std::chrono::steady_clock::time_point latest) {
  const auto timer = std::make_shared<boost::asio::steady_timer>(io, kViewerLook);
  timer->async_wait([this, &desk, &executive, &io, latest, timer,
                     at = executive.now()](const boost::system::error_code& error) {
    if (error || !executive.paused() || executive.now() != at) {
      is_coming_ = false;  // it has been sent elsewhere meanwhile
      return;
    }
    // Once more after they are there, so that they have asked for what they want.
    const bool is_there = std::exchange(was_looked_at_, is_looked_at_()) && was_looked_at_;
    if (!is_there && std::chrono::steady_clock::now() < latest) {
      go_on_when_looked_at(desk, executive, io, latest);
      return;
    }
    desk.carry_out(Request{SeekCommand{course_.from - kStart}}, kNobody);
  });
}

void Showing::show_again(SimTime from, bool stands, double factor) {
  again_ = Course{from, stands, factor, is_looked_at_()};
}

}  // namespace rigwire::hil
