// The server's side of SDO transfers: expedited and segmented, one transfer at a time, every
// refusal with the standard's abort code. Which objects there are is not its business.
//
// Source: CiA 301 V4.2.0, 7.2.4.3. A new initiate command ends the transfer before it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/canopen/sdo.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// What an object's value is on the wire.
struct SdoValue {
  static constexpr std::size_t kCapacity = 64;  ///< Bytes of the longest string.
  std::array<std::uint8_t, kCapacity> bytes{};
  std::uint8_t length = 0;
  /// In place of them: a domain, which must stay as it is while the node lives.
  std::span<const std::uint8_t> domain{};

  [[nodiscard]] std::span<const std::uint8_t> content() const {
    return domain.empty() ? std::span(bytes).first(length) : domain;
  }
};

class SdoObjects {
 public:
  virtual ~SdoObjects() = default;
  [[nodiscard]] virtual std::optional<protocols::canopen::SdoAbort> read(
      protocols::canopen::ObjectAddress address, SdoValue& value) const = 0;
  /// `data` is what the client sent; not `sized`: it did not say how many of them count.
  [[nodiscard]] virtual std::optional<protocols::canopen::SdoAbort> write(
      SimTime now, protocols::canopen::ObjectAddress address, std::span<const std::uint8_t> data,
      bool sized) = 0;
};

class SdoServer {
 public:
  /// The answer to one request of eight bytes; nothing when none is due (the client aborts).
  [[nodiscard]] std::optional<protocols::canopen::SdoPayload> answer(
      SimTime now, const protocols::canopen::SdoRequest& request, SdoObjects& objects);
  void reset() { transfer_ = Transfer::none; }

 private:
  enum class Transfer : std::uint8_t { none, upload, download };

  [[nodiscard]] protocols::canopen::SdoPayload abort(protocols::canopen::SdoAbort code);
  [[nodiscard]] protocols::canopen::SdoPayload upload(const SdoObjects& objects);
  [[nodiscard]] protocols::canopen::SdoPayload upload_segment(bool toggle);
  [[nodiscard]] protocols::canopen::SdoPayload download_segment(
      SimTime now, const protocols::canopen::SdoRequest& request, SdoObjects& objects);

  Transfer transfer_ = Transfer::none;
  protocols::canopen::ObjectAddress object_;
  SdoValue value_;
  std::uint32_t announced_ = 0;
  std::size_t done_ = 0;  ///< Bytes transferred so far.
  bool toggle_ = false;   ///< Toggle bit of the next segment.
};

}  // namespace rigwire::emulators
