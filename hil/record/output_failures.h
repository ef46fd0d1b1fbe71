// What a run promised to write and could not: said once for each file, at once; the run goes on and
// ends with exit code 1.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <utility>

namespace rigwire::hil {

class OutputFailures {
 public:
  /// `say` is called on the thread that failed and must not wait for anybody.
  explicit OutputFailures(std::function<void(const std::string&)> say) : say_(std::move(say)) {}
  OutputFailures(const OutputFailures&) = delete;
  OutputFailures& operator=(const OutputFailures&) = delete;

  /// From any thread.
  void report(const std::string& what) {
    any_ = true;
    say_(what);
  }
  [[nodiscard]] bool any() const { return any_; }

 private:
  std::function<void(const std::string&)> say_;
  std::atomic<bool> any_{false};
};

}  // namespace rigwire::hil
