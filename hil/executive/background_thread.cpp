#include "hil/executive/background_thread.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <boost/asio/post.hpp>
#include <exception>
#include <utility>

#include "fields/failure_text.h"

namespace rigwire::hil {

void yield_to_the_loop() {
  const int policy = ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  if (policy == SCHED_FIFO || policy == SCHED_RR) {
    const sched_param none{};
    (void)::sched_setscheduler(0, SCHED_OTHER, &none);
  }
  constexpr int kNiceness = 10;
  const auto self = static_cast<id_t>(::gettid());
  (void)::setpriority(PRIO_PROCESS, self, ::getpriority(PRIO_PROCESS, self) + kNiceness);
}

BackgroundThread::BackgroundThread(boost::asio::io_context& io,
                                   std::function<void(const std::string& what)> failed)
    : io_(io), work_(io.get_executor()) {
  thread_ = std::thread([this, failed = std::move(failed)] {
    yield_to_the_loop();
    while (!io_.stopped()) {
      try {
        io_.run();
      } catch (const std::exception& error) {
        failed(fields::failure_text(error, "what it keeps"));
      }
    }
  });
}

BackgroundThread::~BackgroundThread() {
  boost::asio::post(io_, [this] { io_.stop(); });
  thread_.join();
}

}  // namespace rigwire::hil
