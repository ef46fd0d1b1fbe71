// An emulated CANopen node under test, with a client that speaks SDO to it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>

#include "emulators/device.h"
#include "emulators/nonvolatile_memory.h"
#include "protocols/bytes.h"
#include "protocols/canopen/identifiers.h"
#include "protocols/canopen/sdo.h"
#include "recorder.h"

namespace rigwire::emulators {

using namespace std::chrono_literals;

/// `Device` is a CanDevice made from settings, memory and output. Who derives feeds it.
template <class Device>
struct CanopenRig {
  static constexpr std::uint8_t kNode = 0x20;

  template <class Settings>
  explicit CanopenRig(const Settings& settings) : device(settings, memory, output) {}
  virtual ~CanopenRig() = default;
  CanopenRig(const CanopenRig&) = delete;
  CanopenRig& operator=(const CanopenRig&) = delete;

  /// One sample of what stands at present.
  virtual void feed(SimTime instant) = 0;

  void run(Duration span) {
    const SimTime end = now + span;
    for (SimTime next = device.sample_plan().next_after(now); next <= end;
         next = device.sample_plan().next_after(next)) {
      feed(next);
    }
    now = end;
    device.advance(now);
  }
  void receive(std::uint32_t id, std::span<const std::uint8_t> payload) {
    device.receive(now, protocols::canopen::make_frame(id, payload));
  }
  void command(protocols::canopen::NetworkCommand command, std::uint8_t node = kNode) {
    device.receive(now, protocols::canopen::make_network_request({command, node}));
  }
  void boot() { run(300ms); }
  void start() {
    boot();
    command(protocols::canopen::NetworkCommand::start);
  }
  /// The eight bytes that answer a request.
  protocols::can::Frame ask(const protocols::canopen::SdoPayload& request) {
    const std::size_t before = output.frames.size();
    receive(0x600U + kNode, request);
    EXPECT_GT(output.frames.size(), before);
    const protocols::can::Frame frame = output.frames[before].second;
    EXPECT_EQ(frame.id, 0x580U + kNode);
    return frame;
  }
  std::uint32_t read(std::uint16_t index, std::uint8_t sub = 0) {
    const auto frame = ask(protocols::canopen::make_upload({index, sub}));
    EXPECT_EQ(frame.data[0] & 0xF3, 0x43 & 0xF3) << std::hex << index;
    return protocols::load_little<std::uint32_t>(frame.data, 4);
  }
  /// The abort code, 0 when the write was taken.
  std::uint32_t write(std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                      std::size_t bytes) {
    std::array<std::uint8_t, 4> data{};
    protocols::store_little<std::uint32_t>(data, 0, value);
    const auto frame =
        ask(protocols::canopen::make_download({index, sub}, std::span(data).first(bytes)));
    return frame.data[0] == 0x60 ? 0U : protocols::load_little<std::uint32_t>(frame.data, 4);
  }

  SimTime now = kStart;
  test::FrameRecorder output;
  VolatileMemory memory;
  Device device;
};

}  // namespace rigwire::emulators
