#include "emulators/velodyne/web_interface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web_control_stub.h"

namespace rigwire::emulators {
namespace {

using protocols::velodyne::ReturnMode;
using ::testing::HasSubstr;

class VelodyneWebInterfaceTest : public ::testing::Test {
 protected:
  WebResponse get(const std::string& target) { return web_.answer(now_, {"GET", target, ""}); }
  WebResponse post(const std::string& target, const std::string& body) {
    return web_.answer(now_, {"POST", target, body});
  }

  SimTime now_{std::chrono::seconds(7)};
  WebControlStub control_;
  VelodyneWebInterface web_{control_};
};

TEST_F(VelodyneWebInterfaceTest, ServesItsDocuments) {
  for (const char* target : {"/cgi/settings.json", "/cgi/status.json", "/cgi/diag.json",
                             "/cgi/info.json", "/cgi/snapshot.hdl", "/cgi/info.json?t=17"}) {
    const WebResponse response = get(target);
    EXPECT_EQ(response.status, 200) << target;
    // cpprestsdk, which autoware's monitor uses, takes no JSON of another type.
    EXPECT_EQ(response.content_type, "application/json") << target;
    EXPECT_TRUE(response.body.starts_with('{')) << target;
  }
  EXPECT_EQ(get("/").content_type, "text/html; charset=utf-8");
  EXPECT_THAT(get("/").body, HasSubstr("action=\"/cgi/setting/fov\""));
}

TEST_F(VelodyneWebInterfaceTest, TakesSeveralSettingsInOneBody) {
  const WebResponse response = post("/cgi/setting", "laser=Off&rpm=0&returns=dual");
  EXPECT_EQ(response.status, 204);
  EXPECT_TRUE(response.body.empty());
  EXPECT_FALSE(control_.live.laser_on);
  EXPECT_EQ(control_.live.rotor_rpm, 0);
  EXPECT_EQ(control_.live.return_mode, ReturnMode::dual);
  EXPECT_EQ(control_.applied, 1);
  EXPECT_EQ(control_.last_applied, now_);
}

TEST_F(VelodyneWebInterfaceTest, TakesEverySettingOfTheSensor) {
  EXPECT_EQ(post("/cgi/setting/fov", "start=350&end=10").status, 204);
  EXPECT_EQ(post("/cgi/setting/host", "addr=192.168.1.10&dport=2400&tport=2369").status, 204);
  EXPECT_EQ(post("/cgi/setting/net",
                 "addr=10.0.0.2&mask=255.0.0.0&gateway=10.0.0.1&dhcp=on&mac_addr=00-00-00-00-00-00")
                .status,
            204);
  EXPECT_EQ(post("/cgi/setting/phaselock", "enabled=on&offset=9000&offsetInput=90").status, 204);
  VelodyneLiveSettings expected;
  expected.view_start_deg = 350;
  expected.view_end_deg = 10;
  expected.host_address = "192.168.1.10";
  expected.data_port = 2400;
  expected.telemetry_port = 2369;
  expected.net_address = "10.0.0.2";
  expected.net_mask = "255.0.0.0";
  expected.net_gateway = "10.0.0.1";
  expected.net_dhcp = true;
  expected.phase_lock = true;
  expected.phase_lock_offset_centideg = 9000;
  EXPECT_EQ(control_.live, expected);
}

TEST_F(VelodyneWebInterfaceTest, NonsenseIsRefusedAndChangesNothing) {
  const std::pair<const char*, const char*> nonsense[] = {
      {"/cgi/setting", "rpm=601"},
      {"/cgi/setting", "rpm=240"},
      {"/cgi/setting", "rpm=1260"},
      {"/cgi/setting", "rpm=-600"},
      {"/cgi/setting", "rpm=6e2"},
      {"/cgi/setting", "rpm="},
      {"/cgi/setting", "rpm"},
      {"/cgi/setting", "speed=600"},
      {"/cgi/setting", "returns=All"},
      {"/cgi/setting", "laser=maybe"},
      {"/cgi/setting", ""},
      {"/cgi/setting", "rpm=300%"},
      {"/cgi/setting", "returns=Dual&rpm=601"},  // the good field must not count either
      {"/cgi/setting", "{\"rpm\":300}"},
      {"/cgi/setting/fov", "start=360"},
      {"/cgi/setting/host", "addr=localhost"},
      {"/cgi/setting/host", "dport=0"},
      {"/cgi/setting/host", "dport=65536"},
      {"/cgi/setting/net", "mask=24"},
      {"/cgi/setting/phaselock", "enabled=on&offset=36000"},
      {"/cgi/save", "data=reset_system"},
      {"/cgi/reset", "data=submit"},
  };
  for (const auto& [target, body] : nonsense) {
    const WebResponse response = post(target, body);
    EXPECT_EQ(response.status, 400) << target << " " << body;
    EXPECT_EQ(response.content_type, "text/plain");
    EXPECT_FALSE(response.body.empty());
  }
  EXPECT_EQ(post("/cgi/setting", std::string(100'000, '&')).status, 400);
  EXPECT_EQ(post("/cgi/setting", std::string(100'000, 'x')).status, 400);
  EXPECT_EQ(control_.live, VelodyneLiveSettings{});
  EXPECT_EQ(control_.applied, 0);
  EXPECT_EQ(control_.resets, 0);
}

TEST_F(VelodyneWebInterfaceTest, RefusalNamesFieldValueAndWhatIsAllowed) {
  EXPECT_EQ(post("/cgi/setting", "rpm=601").body,
            "rpm is '601'; allowed: 0, or 300 to 1200 in steps of 60\n");
  EXPECT_EQ(post("/cgi/setting/fov", "stop=3").body,
            "no field 'stop' here; there are start, end, pwrsaven\n");
}

TEST_F(VelodyneWebInterfaceTest, SilentRefusalsLookLikeSuccess) {
  VelodyneWebInterface silent(control_, {.silent_refusals = true, .objection = {}});
  EXPECT_EQ(silent.answer(now_, {"POST", "/cgi/setting", "rpm=601"}).status, 204);
  EXPECT_EQ(control_.applied, 0);
}

TEST_F(VelodyneWebInterfaceTest, DestinationThatTheRigForbidsIsRefused) {
  VelodyneWebInterface guarded(
      control_, {.silent_refusals = false, .objection = [](const VelodyneLiveSettings& live) {
                   return live.host_address == "8.8.8.8" ? std::string("not there") : std::string();
                 }});
  const auto post_address = [&](const std::string& address) {
    return guarded.answer(now_, {"POST", "/cgi/setting/host", "addr=" + address}).status;
  };
  EXPECT_EQ(post_address("8.8.8.8"), 403);
  EXPECT_EQ(control_.applied, 0);
  EXPECT_EQ(post_address("127.0.0.1"), 204);
  EXPECT_EQ(control_.applied, 1);
}

TEST_F(VelodyneWebInterfaceTest, WrongMethodNamesTheRightOne) {
  EXPECT_EQ(web_.answer(now_, {"GET", "/cgi/setting", ""}).status, 405);
  EXPECT_EQ(web_.answer(now_, {"GET", "/cgi/setting", ""}).allow, "POST");
  EXPECT_EQ(web_.answer(now_, {"DELETE", "/cgi/info.json", ""}).allow, "GET, HEAD");
  EXPECT_EQ(web_.answer(now_, {"HEAD", "/cgi/info.json", ""}).status, 200);
}

TEST_F(VelodyneWebInterfaceTest, UnknownPathsAreNotFound) {
  for (const char* target : {"", "/cgi", "/cgi/", "/cgi/settings.json/", "/cgi/../cgi/info.json",
                             "//", "/cgi/debug.json", "/etc/passwd", "http://x/cgi/info.json"}) {
    EXPECT_EQ(get(target).status, 404) << target;
    EXPECT_EQ(post(target, "rpm=600").status, 404) << target;
  }
}

TEST_F(VelodyneWebInterfaceTest, UnsavedSettingsEndWithAReset) {
  EXPECT_EQ(post("/cgi/setting", "rpm=300").status, 204);
  EXPECT_EQ(post("/cgi/save", "data=submit").status, 204);
  EXPECT_EQ(post("/cgi/setting", "rpm=1200").status, 204);
  const WebResponse response = post("/cgi/reset", "data=reset_system");
  EXPECT_EQ(response.status, 204);
  EXPECT_TRUE(response.close);
  EXPECT_EQ(control_.live.rotor_rpm, 300);
}

TEST_F(VelodyneWebInterfaceTest, CommandsComeInThreeSpellings) {
  for (const char* body : {"data=submit", "submit", ""}) {  // manual, nebula, scripts
    EXPECT_EQ(post("/cgi/save", body).status, 204) << body;
  }
  for (const char* body : {"data=reset_system", "reset_system", ""}) {
    EXPECT_EQ(post("/cgi/reset", body).status, 204) << body;
  }
  EXPECT_EQ(control_.resets, 3);
}

}  // namespace
}  // namespace rigwire::emulators
