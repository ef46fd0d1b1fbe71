// NEO-M8N and ZED-F9P as a client meets them: their texts, their start conversations, the messages
// that they have beyond those of a NEO-7P.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "emulators/ublox/key_store.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/key_values.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/version.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace ubx = protocols::ubx;

class UbloxModernTest : public UbloxReceiverTest {
 protected:
  static UbloxSettings of(const UbloxProfile& profile, std::uint32_t baud) {
    UbloxSettings settings;
    settings.profile = &profile;
    settings.nmea_sentences.clear();
    settings.start_banner = false;
    settings.baud = baud;
    return settings;
  }
  static UbloxSettings f9p(std::vector<std::string> messages = {}) {
    UbloxSettings settings = of(ublox_zed_f9p(), 460'800);
    settings.ubx_messages = std::move(messages);
    return settings;
  }
  struct Item {
    std::string_view name;
    std::uint64_t value;
  };
  /// Says a VALSET as a client does; true when it is acknowledged.
  bool valset(UbloxReceiver& receiver, std::initializer_list<Item> items,
              std::uint8_t layers = ubx::kLayerMaskRam) {
    std::array<std::uint8_t, ubx::kLongestKeyList> room{};
    ubx::KeyListWriter writer(room);
    writer.head(0, layers, 0);
    for (const Item& item : items) {
      const std::size_t index = ubx::key_index(item.name);
      EXPECT_LT(index, ubx::configuration_keys().size()) << item.name;
      EXPECT_TRUE(writer.value({ubx::configuration_keys()[index].id, item.value}));
    }
    const auto payload = writer.payload();
    return acknowledged(receiver, ubx::kCfgValset, {payload.begin(), payload.end()});
  }
  bool acknowledged(UbloxReceiver& receiver, ubx::MessageId id, const Bytes& payload) {
    const std::uint64_t before = receiver.counters().acknowledged;
    say(receiver, id, payload);
    return receiver.counters().acknowledged == before + 1;
  }
  template <class Message>
  std::size_t count() const {
    const auto all = ids();
    return static_cast<std::size_t>(std::ranges::count(all, Message::kId));
  }
};

TEST_F(UbloxModernTest, VersionsAreThoseOfTheRecordings) {
  const auto version = [&](const UbloxProfile& profile) {
    line_.clear();
    UbloxReceiver receiver(of(profile, 38'400), calendar_, line_);
    now_ = kStart;
    run(receiver, kStart + 300ms);
    say(receiver, ubx::MonVerHead::kId, {});
    run(receiver, kStart + 900ms);
    for (const auto& [id, payload] : line_.frames()) {
      if (const auto decoded = ubx::decode_version({id, payload}); decoded.ok()) {
        return *decoded;
      }
    }
    ADD_FAILURE() << "no MON-VER";
    return ubx::Version{};
  };
  line_ = {};
  const auto m8 = version(ublox_neo_m8());
  EXPECT_EQ(m8.software, "EXT CORE 3.01 (107900)");
  EXPECT_EQ(m8.hardware, "00080000");
  EXPECT_EQ(m8.extensions[2], "PROTVER=18.00");
  EXPECT_EQ(m8.extensions[3], "MOD=NEO-M8N-0");
  line_ = {};
  const auto timing = version(ublox_neo_m8t());
  EXPECT_EQ(timing.software, "EXT CORE 3.01 (111141)");
  EXPECT_EQ(timing.extensions[3], "MOD=NEO-M8T-0");
  line_ = {};
  const auto f9 = version(ublox_zed_f9p());
  EXPECT_EQ(f9.hardware, "00190000");
  EXPECT_EQ(f9.extensions[1], "FWVER=HPG 1.50");
  EXPECT_EQ(f9.extensions[2], "PROTVER=27.50");
  EXPECT_EQ(f9.extensions.back(), "SBAS;QZSS");
}

// What ArduPilot's driver writes to a receiver of protocol 27: ports, rates and messages, each list
// to RAM alone or to RAM and battery.
TEST_F(UbloxModernTest, ArduPilotsListsAreTakenAndRule) {
  UbloxReceiver receiver(f9p({"NAV-POSLLH"}), calendar_, line_);
  run(receiver, kStart + 500ms);
  EXPECT_TRUE(valset(receiver, {{"CFG-UART1INPROT-RTCM3X", 1},
                                {"CFG-UART1OUTPROT-NMEA", 0},
                                {"CFG-UART1OUTPROT-RTCM3X", 0}}));
  EXPECT_TRUE(valset(receiver,
                     {{"CFG-RATE-MEAS", 200}, {"CFG-RATE-NAV", 1}, {"CFG-RATE-TIMEREF", 0}},
                     ubx::kLayerMaskRam | ubx::kLayerMaskBattery));
  EXPECT_TRUE(valset(receiver, {{"CFG-SIGNAL-GPS_ENA", 1},
                                {"CFG-SIGNAL-SBAS_ENA", 0},
                                {"CFG-SIGNAL-GAL_ENA", 1},
                                {"CFG-SIGNAL-BDS_ENA", 0},
                                {"CFG-SIGNAL-GLO_ENA", 1}}));
  EXPECT_TRUE(valset(receiver, {{"CFG-TMODE-MODE", 0},
                                {"CFG-MSGOUT-UBX_NAV_PVT_UART1", 1},
                                {"CFG-MSGOUT-UBX_NAV_POSLLH_UART1", 0},
                                {"CFG-MSGOUT-UBX_NAV_TIMEGPS_UART1", 1},
                                {"CFG-MSGOUT-RTCM_3X_TYPE4072_0_UART1", 0},
                                {"CFG-MSGOUT-RTCM_3X_TYPE1077_UART1", 0}}));
  run(receiver, kStart + 1s);
  line_.clear();
  run(receiver, kStart + 3s);
  EXPECT_EQ(receiver.sample_plan().period, 200ms);
  EXPECT_NEAR(static_cast<double>(count<ubx::NavPvt92>()), 10.0, 1.0);
  EXPECT_EQ(count<ubx::NavPosllh>(), 0U);
}

// PX4 asks for a new speed among other things and goes on at it.
TEST_F(UbloxModernTest, Px4ChangesTheSpeedByItems) {
  UbloxSettings settings = f9p();
  settings.baud = 38'400;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  EXPECT_TRUE(valset(receiver, {{"CFG-UART1-BAUDRATE", 115'200},
                                {"CFG-UART1-STOPBITS", 1},
                                {"CFG-UART1-DATABITS", 0},
                                {"CFG-UART1-PARITY", 0},
                                {"CFG-UART1INPROT-UBX", 1},
                                {"CFG-UART1INPROT-RTCM3X", 1},
                                {"CFG-UART1INPROT-NMEA", 0},
                                {"CFG-UART1OUTPROT-UBX", 1},
                                {"CFG-UART1OUTPROT-RTCM3X", 0},
                                {"CFG-UART1OUTPROT-NMEA", 0},
                                {"CFG-USBINPROT-UBX", 1},
                                {"CFG-USBOUTPROT-NMEA", 0}}));
  EXPECT_EQ(receiver.baud(), 115'200U);
  EXPECT_TRUE(valset(receiver, {{"CFG-NAVSPG-FIXMODE", 3},
                                {"CFG-NAVSPG-UTCSTANDARD", 3},
                                {"CFG-NAVSPG-DYNMODEL", 7},
                                {"CFG-NAVHPG-DGNSSMODE", 3},
                                {"CFG-ODO-USE_ODO", 0},
                                {"CFG-RATE-MEAS", 125},
                                {"CFG-MSGOUT-UBX_NAV_PVT_UART1", 1},
                                {"CFG-MSGOUT-UBX_NAV_DOP_UART1", 1},
                                {"CFG-MSGOUT-UBX_NAV_SAT_UART1", 8},
                                {"CFG-MSGOUT-UBX_MON_RF_UART1", 1}}));
  run(receiver, kStart + 1s);
  line_.clear();
  run(receiver, kStart + 3s);
  EXPECT_NEAR(static_cast<double>(count<ubx::NavPvt92>()), 16.0, 1.0);
  EXPECT_NEAR(static_cast<double>(count<ubx::NavSatHead>()), 2.0, 1.0);
  EXPECT_NEAR(static_cast<double>(count<ubx::MonRfHead>()), 16.0, 1.0);
}

TEST_F(UbloxModernTest, OlderReceiversRefuseItems) {
  UbloxReceiver receiver(of(ublox_neo_m8(), 9600), calendar_, line_);
  run(receiver, kStart + 500ms);
  EXPECT_FALSE(valset(receiver, {{"CFG-RATE-MEAS", 200}}));
  EXPECT_EQ(receiver.counters().refused, 1U);
}

TEST_F(UbloxModernTest, CarrierSolutionShowsInPvtAndStatusOfAnF9pOnly) {
  for (const CarrierSolution carrier :
       {CarrierSolution::none, CarrierSolution::floating, CarrierSolution::fixed}) {
    for (const UbloxProfile* profile : {&ublox_zed_f9p(), &ublox_neo_m8()}) {
      line_ = {};
      now_ = kStart;
      UbloxSettings settings = of(*profile, 115'200);
      settings.ubx_messages = {"NAV-PVT", "NAV-STATUS"};
      UbloxReceiver receiver(settings, calendar_, line_);
      run(receiver, kStart + 3s, [&](GnssSample& sample) {
        sample.carrier = carrier;
        sample.differential = carrier != CarrierSolution::none;
        if (sample.differential) {
          sample.differential_age_s = 3.0;
        }
      });
      const unsigned expected = profile->carrier_solution ? static_cast<unsigned>(carrier) : 0U;
      const auto pvt = decoded<ubx::NavPvt92>();
      const auto status = decoded<ubx::NavStatus>();
      ASSERT_FALSE(pvt.empty());
      ASSERT_FALSE(status.empty());
      EXPECT_EQ(pvt.back().flags >> 6U, expected) << profile->name;
      EXPECT_EQ(status.back().flags2 >> 6U, expected) << profile->name;
      EXPECT_EQ(pvt.back().flags & 3U, carrier == CarrierSolution::none ? 1U : 3U);
      if (profile->carrier_solution && carrier != CarrierSolution::none) {
        EXPECT_EQ(pvt.back().flags3 >> 1U & 0xFU, 3U) << "between 2 and 5 s";
      }
    }
  }
}

TEST_F(UbloxModernTest, PrecisePositionIsWithinHalfATenthOfAMillimetre) {
  for (const double longitude_deg : {-179.9999999994, -7.75104561234, 0.0, 179.99999999949}) {
    line_ = {};
    now_ = kStart;
    UbloxReceiver receiver(f9p({"NAV-HPPOSLLH", "NAV-HPPOSECEF", "NAV-POSECEF"}), calendar_, line_);
    GnssSample last;
    run(receiver, kStart + 2500ms, [&](GnssSample& sample) {
      sample.latitude_deg = -49.42401234567;
      sample.longitude_deg = longitude_deg;
      sample.ellipsoid_height_m = -412.34567;
      sample.geoid_separation_m = 17.1;
      sample.horizontal_accuracy_m = 0.0142;
      last = sample;
    });
    const auto geodetic = decoded<ubx::NavHpposllh>();
    ASSERT_FALSE(geodetic.empty());
    const ubx::NavHpposllh& m = geodetic.back();
    EXPECT_NEAR(m.latitude_e7deg * 1e-7 + m.latitude_rest_e9deg * 1e-9, last.latitude_deg,
                0.5001e-9);
    EXPECT_NEAR(m.longitude_e7deg * 1e-7 + m.longitude_rest_e9deg * 1e-9, last.longitude_deg,
                0.5001e-9);
    EXPECT_NEAR(m.ellipsoid_height_mm * 1e-3 + m.ellipsoid_height_rest_e4m * 1e-4,
                last.ellipsoid_height_m, 0.5001e-4);
    EXPECT_NEAR(m.mean_sea_level_height_mm * 1e-3 + m.mean_sea_level_height_rest_e4m * 1e-4,
                last.ellipsoid_height_m - last.geoid_separation_m, 0.5001e-4);
    EXPECT_EQ(m.horizontal_accuracy_e4m, 142U);
    const auto fine = decoded<ubx::NavHpposecef>();
    const auto coarse = decoded<ubx::NavPosecef>();
    ASSERT_FALSE(fine.empty());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(fine.back().position_cm[axis] * 1e-2 + fine.back().position_rest_e4m[axis] * 1e-4,
                  coarse.back().position_cm[axis] * 1e-2, 0.5001e-2);
    }
  }
}

TEST_F(UbloxModernTest, EpochComesInTheOrderOfARealF9pAndEndsWithEoe) {
  UbloxReceiver receiver(
      f9p({"NAV-EOE", "NAV-DOP", "NAV-SAT", "NAV-PVT", "NAV-HPPOSLLH", "NAV-TIMEGPS", "NAV-COV"}),
      calendar_, line_);
  run(receiver, kStart + 1500ms);
  line_.clear();
  run(receiver, kStart + 2500ms);
  const std::vector<ubx::MessageId> expected{
      ubx::NavPvt92::kId,   ubx::NavHpposllh::kId, ubx::NavSatHead::kId, ubx::NavDop::kId,
      ubx::NavTimegps::kId, ubx::NavCov::kId,      ubx::NavEoe::kId};
  EXPECT_EQ(ids(), expected);
  for (const auto& [id, payload] : line_.frames()) {
    if (id == ubx::NavSatHead::kId) {
      const auto satellites = ubx::decode_blocks<ubx::NavSatHead, ubx::NavSatBlock>({id, payload});
      ASSERT_TRUE(satellites.ok());
      ASSERT_EQ(satellites->size(), 8U);
      EXPECT_EQ((*satellites)[2].satellite, 3);
      EXPECT_NE((*satellites)[2].flags & ubx::kSatUsed, 0U);
      EXPECT_EQ((*satellites)[2].cn0_dbhz, 40);
    }
  }
}

TEST_F(UbloxModernTest, M8TakesThreeKindsOfSystemsAtMost) {
  UbloxReceiver receiver(of(ublox_neo_m8(), 9600), calendar_, line_);
  run(receiver, kStart + 500ms);
  const auto set = [&](std::initializer_list<GnssSystem> on) {
    Bytes payload{0, 32, 32, 7};
    for (std::uint8_t system = 0; system < 7; ++system) {
      const bool enabled = std::ranges::find(on, static_cast<GnssSystem>(system)) != on.end();
      const std::uint8_t flags = enabled ? 1 : 0;
      payload.insert(payload.end(), {system, 4, 8, 0, flags, 0, 1, 0});
    }
    return acknowledged(receiver, ubx::CfgGnssHead::kId, payload);
  };
  EXPECT_TRUE(set({GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass}));
  EXPECT_TRUE(set({GnssSystem::gps, GnssSystem::galileo, GnssSystem::beidou}));
  EXPECT_FALSE(set({GnssSystem::gps, GnssSystem::glonass, GnssSystem::beidou}));
  EXPECT_FALSE(set({GnssSystem::sbas}));
}

TEST_F(UbloxModernTest, TheFormsOfOlderMessagesFollowTheGeneration) {
  UbloxReceiver receiver(of(ublox_neo_m8(), 9600), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, ubx::CfgNmea::kId, {});
  say(receiver, ubx::CfgGnssHead::kId, {});
  run(receiver, kStart + 900ms);
  for (const auto& [id, payload] : line_.frames()) {
    if (id == ubx::CfgNmea::kId) {
      ASSERT_EQ(payload.size(), 20U);
      EXPECT_EQ(payload[1], 0x40);
      EXPECT_EQ(payload[11], 1) << "version of the longer form";
    }
    if (id == ubx::CfgGnssHead::kId) {
      EXPECT_EQ(payload.size(), 4U + 7 * 8);
    }
  }
}

// Forms as in a recording of a ZED-F9P of HPG 1.12, with this epoch's values.
TEST_F(UbloxModernTest, F9pSpeaksNmea411WithItsCarrierSolution) {
  UbloxSettings settings = f9p();
  settings.nmea_sentences = {"RMC", "VTG", "GGA", "GSA", "GSV"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms, [](GnssSample& sample) {
    sample.carrier = CarrierSolution::fixed;
    sample.differential = true;
  });
  const auto all = line_.sentences();
  const auto starts = [&](std::string_view begin) {
    const auto found =
        std::ranges::find_if(all, [&](const std::string& s) { return s.starts_with(begin); });
    return found == all.end() ? std::string() : *found;
  };
  const std::string rmc = starts("$GNRMC");
  EXPECT_NE(rmc.find(",R,V*"), std::string::npos) << rmc;
  const std::string gga = starts("$GNGGA");
  EXPECT_NE(gga.find(",W,4,07,2.48,"), std::string::npos) << gga << ": one is below 10 degrees";
  const std::string gsa = starts("$GNGSA");
  EXPECT_NE(gsa.find(",5.87,2.48,5.32,1*"), std::string::npos) << gsa << ": system 1";
  const std::string gsv = starts("$GPGSV,2,2,08,");
  EXPECT_NE(gsv.find(",1*"), std::string::npos) << gsv << ": signal 1";
}

}  // namespace
}  // namespace rigwire::emulators
