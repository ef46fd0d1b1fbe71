// Bootstrap registers: those that every GigE Vision device has at the same addresses. Of a device
// with one network interface and one stream channel; registers of what is optional in the standard
// and not offered here (message channel, actions, IEEE 1588, second link) are left out.
//
// Sources: Aravis 0.8.26 (src/arvgvcpprivate.h, src/arvgvdevice.c), Wireshark 4.0 (packet-gvcp.c:
// addresses and bits).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rigwire::protocols::gige_vision {

enum class Access : std::uint8_t { read_only, write_only, read_write };

/// Addresses.
namespace bootstrap {
inline constexpr std::uint32_t kVersion = 0x0000;
inline constexpr std::uint32_t kDeviceMode = 0x0004;
inline constexpr std::uint32_t kMacHigh = 0x0008;
inline constexpr std::uint32_t kMacLow = 0x000C;
inline constexpr std::uint32_t kIpCapability = 0x0010;
inline constexpr std::uint32_t kIpConfiguration = 0x0014;
inline constexpr std::uint32_t kCurrentAddress = 0x0024;
inline constexpr std::uint32_t kCurrentMask = 0x0034;
inline constexpr std::uint32_t kCurrentGateway = 0x0044;
inline constexpr std::uint32_t kManufacturerName = 0x0048;
inline constexpr std::uint32_t kModelName = 0x0068;
inline constexpr std::uint32_t kDeviceVersion = 0x0088;
inline constexpr std::uint32_t kManufacturerInformation = 0x00A8;
inline constexpr std::uint32_t kSerialNumber = 0x00D8;
inline constexpr std::uint32_t kUserDefinedName = 0x00E8;
inline constexpr std::uint32_t kFirstUrl = 0x0200;
inline constexpr std::uint32_t kSecondUrl = 0x0400;
inline constexpr std::uint32_t kInterfaceCount = 0x0600;
inline constexpr std::uint32_t kPersistentAddress = 0x064C;
inline constexpr std::uint32_t kPersistentMask = 0x065C;
inline constexpr std::uint32_t kPersistentGateway = 0x066C;
inline constexpr std::uint32_t kLinkSpeed = 0x0670;
inline constexpr std::uint32_t kMessageChannelCount = 0x0900;
inline constexpr std::uint32_t kStreamChannelCount = 0x0904;
inline constexpr std::uint32_t kActionSignalCount = 0x0908;
inline constexpr std::uint32_t kActiveLinkCount = 0x0910;
inline constexpr std::uint32_t kStreamCapability = 0x092C;
inline constexpr std::uint32_t kMessageCapability = 0x0930;
inline constexpr std::uint32_t kCapability = 0x0934;
inline constexpr std::uint32_t kHeartbeatTimeout = 0x0938;
inline constexpr std::uint32_t kTickFrequencyHigh = 0x093C;
inline constexpr std::uint32_t kTickFrequencyLow = 0x0940;
inline constexpr std::uint32_t kTimestampControl = 0x0944;
inline constexpr std::uint32_t kTimestampHigh = 0x0948;
inline constexpr std::uint32_t kTimestampLow = 0x094C;
inline constexpr std::uint32_t kConfiguration = 0x0954;
inline constexpr std::uint32_t kStreamConfiguration = 0x0960;
inline constexpr std::uint32_t kControlPrivilege = 0x0A00;
inline constexpr std::uint32_t kPrimaryPort = 0x0A04;
inline constexpr std::uint32_t kPrimaryAddress = 0x0A14;
inline constexpr std::uint32_t kStreamPort = 0x0D00;
inline constexpr std::uint32_t kStreamPacketSize = 0x0D04;
inline constexpr std::uint32_t kStreamPacketDelay = 0x0D08;
inline constexpr std::uint32_t kStreamDestination = 0x0D18;
inline constexpr std::uint32_t kStreamSourcePort = 0x0D1C;
inline constexpr std::uint32_t kStreamChannelCapability = 0x0D20;
inline constexpr std::uint32_t kStreamChannelConfiguration = 0x0D24;
}  // namespace bootstrap

/// What a discovery acknowledge carries: the registers from 0 on.
inline constexpr std::size_t kDiscoverySize = bootstrap::kUserDefinedName + 16;
static_assert(kDiscoverySize == 0xF8);

struct RegisterRow {
  std::string_view name;
  std::uint32_t address = 0;
  std::uint32_t length = 4;
  Access access = Access::read_only;
};

/// In order of their addresses.
inline constexpr std::array kBootstrapRegisters{
    RegisterRow{"Version", bootstrap::kVersion, 4, Access::read_only},
    RegisterRow{"Device mode", bootstrap::kDeviceMode, 4, Access::read_only},
    RegisterRow{"MAC address, high", bootstrap::kMacHigh, 4, Access::read_only},
    RegisterRow{"MAC address, low", bootstrap::kMacLow, 4, Access::read_only},
    RegisterRow{"IP configurations, supported", bootstrap::kIpCapability, 4, Access::read_only},
    RegisterRow{"IP configuration, current", bootstrap::kIpConfiguration, 4, Access::read_write},
    RegisterRow{"IP address, current", bootstrap::kCurrentAddress, 4, Access::read_only},
    RegisterRow{"Subnet mask, current", bootstrap::kCurrentMask, 4, Access::read_only},
    RegisterRow{"Gateway, current", bootstrap::kCurrentGateway, 4, Access::read_only},
    RegisterRow{"Manufacturer name", bootstrap::kManufacturerName, 32, Access::read_only},
    RegisterRow{"Model name", bootstrap::kModelName, 32, Access::read_only},
    RegisterRow{"Device version", bootstrap::kDeviceVersion, 32, Access::read_only},
    RegisterRow{"Manufacturer information", bootstrap::kManufacturerInformation, 48,
                Access::read_only},
    RegisterRow{"Serial number", bootstrap::kSerialNumber, 16, Access::read_only},
    RegisterRow{"User-defined name", bootstrap::kUserDefinedName, 16, Access::read_write},
    RegisterRow{"First URL", bootstrap::kFirstUrl, 512, Access::read_only},
    RegisterRow{"Second URL", bootstrap::kSecondUrl, 512, Access::read_only},
    RegisterRow{"Network interfaces", bootstrap::kInterfaceCount, 4, Access::read_only},
    RegisterRow{"IP address, persistent", bootstrap::kPersistentAddress, 4, Access::read_write},
    RegisterRow{"Subnet mask, persistent", bootstrap::kPersistentMask, 4, Access::read_write},
    RegisterRow{"Gateway, persistent", bootstrap::kPersistentGateway, 4, Access::read_write},
    RegisterRow{"Link speed, Mbit/s", bootstrap::kLinkSpeed, 4, Access::read_only},
    RegisterRow{"Message channels", bootstrap::kMessageChannelCount, 4, Access::read_only},
    RegisterRow{"Stream channels", bootstrap::kStreamChannelCount, 4, Access::read_only},
    RegisterRow{"Action signals", bootstrap::kActionSignalCount, 4, Access::read_only},
    RegisterRow{"Active links", bootstrap::kActiveLinkCount, 4, Access::read_only},
    RegisterRow{"Stream channels, capability", bootstrap::kStreamCapability, 4, Access::read_only},
    RegisterRow{"Message channel, capability", bootstrap::kMessageCapability, 4, Access::read_only},
    RegisterRow{"GVCP capability", bootstrap::kCapability, 4, Access::read_only},
    RegisterRow{"Heartbeat timeout, ms", bootstrap::kHeartbeatTimeout, 4, Access::read_write},
    RegisterRow{"Tick frequency, high", bootstrap::kTickFrequencyHigh, 4, Access::read_only},
    RegisterRow{"Tick frequency, low", bootstrap::kTickFrequencyLow, 4, Access::read_only},
    RegisterRow{"Timestamp control", bootstrap::kTimestampControl, 4, Access::write_only},
    RegisterRow{"Timestamp, high", bootstrap::kTimestampHigh, 4, Access::read_only},
    RegisterRow{"Timestamp, low", bootstrap::kTimestampLow, 4, Access::read_only},
    RegisterRow{"GVCP configuration", bootstrap::kConfiguration, 4, Access::read_write},
    RegisterRow{"GVSP configuration", bootstrap::kStreamConfiguration, 4, Access::read_write},
    RegisterRow{"Control channel privilege", bootstrap::kControlPrivilege, 4, Access::read_write},
    RegisterRow{"Primary application, port", bootstrap::kPrimaryPort, 4, Access::read_only},
    RegisterRow{"Primary application, address", bootstrap::kPrimaryAddress, 4, Access::read_only},
    RegisterRow{"Stream channel port", bootstrap::kStreamPort, 4, Access::read_write},
    RegisterRow{"Stream channel packet size", bootstrap::kStreamPacketSize, 4, Access::read_write},
    RegisterRow{"Stream channel packet delay", bootstrap::kStreamPacketDelay, 4,
                Access::read_write},
    RegisterRow{"Stream channel destination", bootstrap::kStreamDestination, 4, Access::read_write},
    RegisterRow{"Stream channel source port", bootstrap::kStreamSourcePort, 4, Access::read_only},
    RegisterRow{"Stream channel, its capability", bootstrap::kStreamChannelCapability, 4,
                Access::read_only},
    RegisterRow{"Stream channel, its configuration", bootstrap::kStreamChannelConfiguration, 4,
                Access::read_write},
};
static_assert(std::ranges::is_sorted(kBootstrapRegisters, {}, &RegisterRow::address));

// --- Bits and values. ---

inline constexpr std::uint32_t kVersion20 = 0x0002'0000;
/// Most significant byte first; a transmitter with one link; character set UTF-8.
inline constexpr std::uint32_t kDeviceModeTransmitter = 0x8000'0001;

struct IpConfiguration {
  static constexpr std::uint32_t kPersistent = 1U << 0U;
  static constexpr std::uint32_t kDhcp = 1U << 1U;
  static constexpr std::uint32_t kLinkLocal = 1U << 2U;  ///< Cannot be switched off.
};

struct Capability {
  static constexpr std::uint32_t kUserDefinedName = 1U << 31U;
  static constexpr std::uint32_t kSerialNumber = 1U << 30U;
  static constexpr std::uint32_t kHeartbeatDisable = 1U << 29U;
  static constexpr std::uint32_t kLinkSpeed = 1U << 28U;
  static constexpr std::uint32_t kPrimaryApplication = 1U << 27U;  ///< Has its port and address.
  static constexpr std::uint32_t kExtendedStatus = 1U << 22U;      ///< Status codes of version 1.1.
  static constexpr std::uint32_t kPendingAcknowledge = 1U << 5U;
  static constexpr std::uint32_t kPacketResend = 1U << 2U;
  static constexpr std::uint32_t kWriteMemory = 1U << 1U;
  static constexpr std::uint32_t kConcatenation = 1U << 0U;  ///< Several registers in a command.
};

/// Bits of kConfiguration.
struct Configuration {
  static constexpr std::uint32_t kHeartbeatDisable = 1U << 0U;
  static constexpr std::uint32_t kExtendedStatus = 1U << 2U;
};
/// Bits of kStreamConfiguration.
struct StreamConfiguration {
  static constexpr std::uint32_t kExtendedIds = 1U << 30U;
};
/// Bits of kStreamCapability.
struct StreamCapability {
  static constexpr std::uint32_t kSourcePort = 1U << 31U;
  static constexpr std::uint32_t kShortIds = 1U << 30U;
};

struct TimestampControl {
  static constexpr std::uint32_t kReset = 1U << 0U;
  static constexpr std::uint32_t kLatch = 1U << 1U;
};

struct Privilege {
  static constexpr std::uint32_t kExclusive = 1U << 0U;
  static constexpr std::uint32_t kControl = 1U << 1U;
};

/// Bits of kStreamPacketSize; the size is in the low half, with IP and UDP headers.
struct PacketSize {
  static constexpr std::uint32_t kFireTest = 1U << 31U;
  static constexpr std::uint32_t kDoNotFragment = 1U << 30U;
  static constexpr std::uint32_t kBigEndian = 1U << 29U;
  static constexpr std::uint32_t kSize = 0xFFFF;
};

/// Bits of kStreamChannelCapability and kStreamChannelConfiguration.
struct StreamChannel {
  static constexpr std::uint32_t kMultipart = 1U << 6U;
};

}  // namespace rigwire::protocols::gige_vision
