// The device's side of a serial line: the master of a pseudo-terminal, its slave published under a
// path of the user's choice.
//
// - The slave is raw from the start and again whenever the last client has left. Its speed is at
//   first the one given at construction (the device's own, so that a client that sets none is
//   right); what a client sets stays for the next one, as on a real port.
// - on_client() reports a client's presence and speed at most kPresencePeriod after they changed
//   and always before the bytes that come with them. The kernel keeps neither character size nor
//   parity of a pseudo-terminal, so that neither is reported. A client that opens and closes
//   between two checks is reported only when it wrote something.
// - The slave has the group dialout and mode 0660 where this user may give them, as serial lines
//   have: daemons that drop their privileges open it again.
// - While no client has the slave open, what is written is taken and discarded, and what the last
//   client left unread is discarded: the next client starts with fresh bytes. (The kernel would
//   keep up to 16 KiB for it.) A client that closes and another that opens within the same few
//   milliseconds, between two checks of the line, count as one.
// - Several clients at once share the bytes as the kernel deals them out.
// - A client that left the terminal marked exclusive (TIOCEXCL without TIOCNXCL) would shut out
//   every other: unlike on a real port the mark survives the last close. The pair is then replaced
//   by a new one under the same link; slave_name() changes.
// - Nothing blocks. With a client that does not read, the kernel takes about 16 KiB and then
//   refuses; write() then returns less than was offered.
//
// The path is a symbolic link with one owner (drivers/published_link.h). While the io_context's
// LineWatch (drivers/line_watch.h) runs, it puts the link back when it is removed, and counts
// (EndpointStatus::readers) and reports the programs that share the line.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "drivers/line_watch.h"

namespace rigwire::drivers {

class Pty final : public ByteStream {
 public:
  /// Period of the check of an unused line.
  static constexpr std::chrono::milliseconds kPresencePeriod{10};

  /// Opens the pair and publishes the slave at `link`; its parent directories are created. An empty
  /// `link` publishes nothing. `baud` is the slave's speed until a client sets another; the
  /// kernel's 38400 bit/s when not given. Throws EndpointError.
  Pty(boost::asio::io_context& context, std::filesystem::path link,
      std::optional<std::uint32_t> baud = {});
  ~Pty() override;
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  void start(Receiver receiver) override;
  void on_client(ClientWatcher watcher) override { watcher_ = std::move(watcher); }
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] EndpointStatus status() const override;

  /// The speed in bit/s that the slave is set to at this moment, whether or not it is open.
  [[nodiscard]] std::uint32_t client_baud() const;
  /// The slave itself, "/dev/pts/3".
  [[nodiscard]] const std::string& slave_name() const { return slave_name_; }

 private:
  void wait_readable();
  void wait_presence();
  /// Reads what there is, then knows whether the slave is open.
  void drain_master();
  void note_presence(bool present);
  /// Cleans the slave, or replaces the pair when no program can open it any more.
  void prepare_for_next_client();
  void replace_pair();
  /// Reports a changed client to the watcher. Returns false when the watcher has destroyed this
  /// object.
  bool tell_client(bool present);
  [[nodiscard]] bool hung_up() const;

  std::filesystem::path link_;
  std::shared_ptr<WatchedLine> watched_;  ///< Null without a link.
  std::string slave_name_;
  int descriptor_ = -1;  ///< Descriptor of the pty's master; owned by master_.
  boost::asio::posix::stream_descriptor master_;
  boost::asio::steady_timer presence_timer_;
  Receiver receiver_;
  ClientWatcher watcher_;
  LineClient told_;
  std::vector<std::uint8_t> buffer_;
  bool present_ = false;
  bool reading_ = false;  ///< A wait for bytes is pending.
  /// Handlers that the system already queued find out by this that the object has gone.
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
