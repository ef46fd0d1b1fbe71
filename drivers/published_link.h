// A symbolic link to a pseudo-terminal under a path of the user's choice, owned by one process.
//
// - The link atomically replaces a link that is dangling or older than the terminal that it names
//   (left by a process that was killed). Anything else belongs to others and stays: a file, a link
//   to something that is no pseudo-terminal, a link that a running program keeps.
// - Ownership is an advisory lock (flock) on the file ".NAME.lock" beside the link, whatever
//   namespaces the owners live in, as long as they share the directory. The kernel releases the
//   lock however the process ends; a lock file that was left behind blocks no later owner.
// - look() puts back a link that was removed, or that names a terminal which has gone. What
//   another program has put in its place stays, and is reported.
// - A folder that other users could change is refused, and so is a path below /dev, where devices
//   are.
// - May be used from two threads.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

namespace rigwire::drivers {

/// Throws EndpointError that says what is wrong with the line at that path, and the remedy.
[[noreturn]] void refuse_line(const std::filesystem::path& path, const std::string& what,
                              const std::string& mend);
/// The remedy for a descriptor that the system would not open.
[[nodiscard]] std::string mend_of(int error, const std::string& otherwise);
/// Returns why other users could replace a link at that path, or nothing when they cannot: a folder
/// above it is theirs or can be written by them. Clients would then open a terminal of theirs.
[[nodiscard]] std::string danger_of_link(const std::filesystem::path& link);

class PublishedLink {
 public:
  /// Takes the name; its parent directories are created. Throws EndpointError when another running
  /// process has it, when something that is no leftover is in its place, or when the place is none
  /// for a link.
  explicit PublishedLink(std::filesystem::path path);
  ~PublishedLink();
  PublishedLink(const PublishedLink&) = delete;
  PublishedLink& operator=(const PublishedLink&) = delete;

  /// From now on the link names `terminal`. Throws EndpointError.
  void publish(const std::string& terminal);
  /// Removes the link, where it is still ours, and gives the name back.
  void withdraw();
  /// Checks that the link is in place; puts it back where it may. Returns a message to report that
  /// was not reported before, else an empty text. Never throws.
  [[nodiscard]] std::string look();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Empty before publish() and after withdraw().
  [[nodiscard]] std::string terminal() const;

 private:
  class NameLock;
  enum class State { in_place, missing, taken };

  [[nodiscard]] bool locked();
  [[nodiscard]] std::string news(State state, const std::string& what);

  std::filesystem::path path_;
  std::unique_ptr<NameLock> lock_;
  mutable std::mutex mutex_;
  std::string terminal_;
  State state_ = State::in_place;
};

}  // namespace rigwire::drivers
