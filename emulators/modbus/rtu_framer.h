// Finds the frames of a Modbus RTU line by its silences, in modelled time.
//
// What a pseudo-terminal hands over has no timing: bytes come in lumps, as fast as the client wrote
// them. The model: the bytes received at an instant lie on the line back to back, from that instant
// on or, if that is later, from where the byte before ended. Framing works from those times.
//
// - A frame ends with 3.5 characters of silence; it is handed on at that instant.
// - With strict gaps it is as the standard says: more than 1.5 characters of silence inside, a byte
//   that collides with our own answer, a wrong check or a wrong length spoil everything up to the
//   next silence.
// - Without, the framer forgives what a program on a pseudo-terminal cannot help, and no more:
//   * a request written in several parts: what is no frame at its silence waits for the rest, at
//     most `gap_tolerance` after its last byte;
//   * noise, then a request: a frame that begins where a lump began is found;
//   * a request right behind another one, without a silence: a row of frames that begins and ends
//     with lumps is taken as such.
//   Bytes sent while an answer is on the line lie behind it.
// A good frame between two silences is handed on at the same instant either way.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fields/rules.h"
#include "protocols/modbus/rtu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct RtuFramerSettings {
  protocols::modbus::RtuTiming timing{};
  bool strict_gaps = false;
  Duration gap_tolerance = std::chrono::milliseconds(200);  ///< 0 .. 5 s; without strict gaps.
};
void visit(fields::Visitor& v, RtuFramerSettings& p);

/// Receives what the framer finds, from within its calls.
class RtuListener {
 public:
  virtual ~RtuListener() = default;
  /// A frame with a right check, for any unit; its last silence was over at `now`.
  virtual void frame(SimTime now, const protocols::modbus::RtuFrame& frame) = 0;
  /// Bytes that were none.
  virtual void communication_error(SimTime now) = 0;
};

class RtuFramer {
 public:
  /// Characters that a client's side holds back while the line is busy; what it writes beyond is
  /// lost.
  static constexpr std::uint64_t kBacklogMaximum = 4096;

  /// `listener` must outlive the framer.
  RtuFramer(const RtuFramerSettings& settings, RtuListener& listener);

  /// Bytes at `now`; with `in_error` they are not understood (wrong speed or parity), and without
  /// `new_lump` they go on where the bytes of the call before ended. Returns how many found a place
  /// on the line. Precondition: advance(now).
  std::size_t receive(SimTime now, std::span<const std::uint8_t> bytes, bool in_error,
                      bool new_lump);
  /// Our own answer is on the line until then.
  void occupy(SimTime until) { occupied_until_ = until; }
  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// End of the last byte on the line, the server's or the client's.
  [[nodiscard]] SimTime line_free() const;

 private:
  static constexpr std::size_t kRunMaximum = 4 * protocols::modbus::kRtuFrameMaximum;
  static constexpr std::size_t kLumpsMaximum = 64;

  [[nodiscard]] std::span<const std::uint8_t> run() const { return std::span(bytes_).first(size_); }
  void mark_lump();
  void resolve(SimTime now);
  /// Hands on the frames that begin where the run or a lump began, and keeps what lies behind the
  /// last.
  void search(SimTime now);
  /// End of a row of frames that begins at `begin` and ends with the run or where a lump began; 0
  /// when there is none.
  [[nodiscard]] std::size_t row_end(std::size_t begin) const;
  /// End of a frame that begins at `begin`: the end of the run if that is one, else the nearest;
  /// 0 when there is none.
  [[nodiscard]] std::size_t frame_end(std::size_t begin) const;
  void keep_from(std::size_t begin);
  void clear();

  RtuFramerSettings settings_;
  RtuListener& listener_;
  // Characters since the line was last at rest, so that no rounding adds up.
  SimTime burst_start_{};
  std::uint64_t burst_characters_ = 0;
  SimTime occupied_until_{};
  std::array<std::uint8_t, kRunMaximum> bytes_{};
  std::size_t size_ = 0;
  std::array<std::size_t, kLumpsMaximum> lumps_{};  ///< Where later lumps of the run begin.
  std::size_t lump_count_ = 0;
  bool spoiled_ = false;  ///< Nothing of this run can be used.
  bool waiting_ = false;  ///< No frame found yet; the rest may still come.
};

}  // namespace rigwire::emulators
