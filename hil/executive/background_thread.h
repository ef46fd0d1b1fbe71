// Work beside the loop, in the processor time that the loop leaves.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <functional>
#include <string>
#include <thread>

namespace rigwire::hil {

/// Lowers the priority of the calling thread, and of threads that it starts, below that of the rest
/// of the program: on a busy machine its work waits, and wires do not. Real-time priority (`chrt`)
/// is for the wires alone.
void yield_to_the_loop();

/// Runs an io_context on a thread that yields to the loop, from construction to destruction. What
/// has been posted by then is done; what comes later stays in the io_context.
class BackgroundThread {
 public:
  /// Calls `failed`, on that thread, for an exception that leaves a handler; the thread continues.
  BackgroundThread(boost::asio::io_context& io,
                   std::function<void(const std::string& what)> failed);
  ~BackgroundThread();
  BackgroundThread(const BackgroundThread&) = delete;
  BackgroundThread& operator=(const BackgroundThread&) = delete;

 private:
  boost::asio::io_context& io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
  std::thread thread_;
};

}  // namespace rigwire::hil
