// curl and Python's urllib, unmodified, on the web interface of a running lidar; and the request
// sequences of two drivers, as their sources have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/udp_socket.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;

/// A VLP-16 on level ground, in real time.
class LidarWebClients : public testing::Test {
 protected:
  void SetUp() override {
    const auto rig = wires_.folder / "rig.yaml";
    std::ofstream(rig) << "machine: {include: " RIGWIRE_SOURCE_DIR
                          "/configs/machines/gator_855d.yaml}\n"
                          "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
                          "devices:\n  lidar:\n    type: velodyne-vlp-16\n    serial: '42'\n"
                       << "    port: " << wires_.lidar_port
                       << "\n    position_port: " << wires_.lidar_port + 1
                       << "\n    web: {port: " << web_port_
                       << "}\n    mount: {link: body, position: [0 m, 0 m, 2 m]}\n";
    rig_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{RIGWIRE_BINARY_DIR "/rigwire", "run", rig.string(), "--status",
                                 "none"},
        wires_.folder / "rig.log");
    socket_ = std::make_unique<drivers::UdpSocket>(
        io_, drivers::UdpSettings{.bind = drivers::UdpEndpoint{"127.0.0.1", wires_.lidar_port}});
    socket_->start([this](std::span<const std::uint8_t> bytes) {
      packet_.assign(bytes.begin(), bytes.end());
    });
    ASSERT_TRUE(eventually([this] { return curl({url("/cgi/info.json")}).code == 0; }))
        << rig_->output();
  }

  struct Answer {
    int code = -1;  ///< The program's exit status.
    std::string text;
  };
  Answer run(const std::vector<std::string>& command) {
    ChildProcess program(command, wires_.folder / "client.log");
    const int code = program.wait().value_or(-1);
    return {code, program.output()};
  }
  Answer curl(const std::vector<std::string>& arguments) {
    std::vector<std::string> command{"curl", "--silent", "--show-error", "--max-time", "200"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run(command);
  }
  /// The status that curl was told.
  std::string status_of(const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"--output", "/dev/null", "--write-out", "%{http_code}"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return curl(all).text;
  }
  [[nodiscard]] std::string url(const std::string& path) const {
    return "http://127.0.0.1:" + std::to_string(web_port_) + path;
  }
  Json settings() { return Json::parse(curl({url("/cgi/settings.json")}).text); }
  /// Whether packets with that return mode come within some seconds.
  bool streams(std::uint8_t return_mode) {
    return eventually([&] {
      io_.restart();
      io_.run_for(10ms);
      return packet_.size() == 1206 && packet_[1204] == return_mode;
    });
  }

  test::PrivateWires wires_;
  std::uint16_t web_port_ = test::free_port(SOCK_STREAM);
  boost::asio::io_context io_;
  std::vector<std::uint8_t> packet_;
  std::unique_ptr<drivers::UdpSocket> socket_;
  std::unique_ptr<ChildProcess> rig_;
};

TEST_F(LidarWebClients, CurlReadsAndSets) {
  EXPECT_TRUE(streams(0x37));
  for (const char* path :
       {"settings.json", "status.json", "diag.json", "info.json", "snapshot.hdl"}) {
    const Answer answer = curl({"--fail", url(std::string("/cgi/") + path)});
    EXPECT_EQ(answer.code, 0) << path;
    EXPECT_TRUE(Json::accept(answer.text)) << path;
  }
  // The manual's own examples, and several fields in one body.
  EXPECT_EQ(status_of({"--data", "rpm=300", url("/cgi/setting")}), "204");
  EXPECT_EQ(status_of({"--data", "returns=Dual", url("/cgi/setting")}), "204");
  EXPECT_TRUE(streams(0x39));
  EXPECT_EQ(status_of({"--data", "laser=on", "--data", "returns=Last", "--data", "rpm=600",
                       url("/cgi/setting")}),
            "204");
  EXPECT_TRUE(streams(0x38));
  EXPECT_EQ(settings()["rpm"], 600);
  EXPECT_EQ(status_of({"--data", "rpm=601", url("/cgi/setting")}), "400");
  EXPECT_EQ(status_of({"--request", "PUT", "--data", "rpm=300", url("/cgi/setting")}), "405");
  EXPECT_EQ(status_of({url("/cgi/secret.json")}), "404");
  EXPECT_EQ(settings()["rpm"], 600);
}

TEST_F(LidarWebClients, CurlAsksBeforeItSendsMuch) {
  const auto body = wires_.folder / "body";
  // Over 1 kB the client is told to ask for "100 Continue" first.
  std::ofstream(body) << "rpm=300" << std::string(2000, '&');
  const std::vector<std::string> post{"--header", "Expect: 100-continue", "--data-binary",
                                      "@" + body.string(), url("/cgi/setting")};
  EXPECT_EQ(status_of(post), "204");
  EXPECT_EQ(settings()["rpm"], 300);
  std::ofstream(body) << std::string(2'000'000, 'x');
  EXPECT_EQ(status_of(post), "413");
  EXPECT_EQ(settings()["rpm"], 300);
}

TEST_F(LidarWebClients, CurlKeepsItsConnection) {
  const Answer answer = curl({"--verbose", url("/cgi/info.json"), url("/cgi/status.json")});
  EXPECT_THAT(answer.text, HasSubstr("Re-using existing connection"));
}

TEST_F(LidarWebClients, UrllibReadsAndSets) {
  const char* script = R"(
import json, sys, urllib.error, urllib.parse, urllib.request
base = sys.argv[1]
def get(path):
    with urllib.request.urlopen(base + path, timeout=200) as answer:
        return json.loads(answer.read())
def post(path, **fields):
    data = urllib.parse.urlencode(fields).encode()
    with urllib.request.urlopen(urllib.request.Request(base + path, data=data), timeout=200) as a:
        return a.status
assert post('/cgi/setting/phaselock', enabled='on', offset=9000) == 204
assert get('/cgi/settings.json')['phaselock'] == {'enabled': 'On', 'offset': '9000'}
assert post('/cgi/setting/fov', start=270, end=90) == 204
assert post('/cgi/setting', returns='Dual') == 204
try:
    post('/cgi/setting', rpm=601)
    sys.exit('rpm 601 was taken')
except urllib.error.HTTPError as error:
    assert error.code == 400 and b'601' in error.read()
print(json.dumps(get('/cgi/snapshot.hdl')['config']))
)";
  const Answer answer = run({"/usr/bin/python3", "-c", script, url("")});
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_EQ(Json::parse(answer.text)["fov"], Json::parse(R"({"start": 270, "end": 90})"));
  EXPECT_TRUE(streams(0x39));
}

// nebula 606ac41: reads the snapshot, then posts each setting that differs, one connection each;
// its limit of 500 ms is left out. Its parser turns both "2368" and 2368 into numbers.
TEST_F(LidarWebClients, NebulasSequenceEndsWithWhatItWanted) {
  const char* script = R"(
import http.client, json, sys
host, dport = '127.0.0.1', int(sys.argv[2])
def ask(method, path, body=None):
    link = http.client.HTTPConnection(host, int(sys.argv[1]), timeout=200)
    head = {'Connection': 'close'}
    if body is not None:
        head['Content-Type'] = 'application/x-www-form-urlencoded'
    link.request(method, path, body, head)
    answer = link.getresponse()
    assert answer.status in (200, 204), (path, body, answer.status)
    return answer.read()
snapshot = json.loads(ask('GET', '/cgi/snapshot.hdl'))
config = snapshot['config']
assert isinstance(snapshot['info']['model'], str) and isinstance(snapshot['info']['serial'], str)
for key in ('hv', 'lm20_temp', 'pwr_5v', 'pwr_2_5v', 'pwr_3_3v', 'pwr_5v_raw', 'pwr_vccint'):
    float(snapshot['diag']['volt_temp']['top'][key])
for key in ('i_out', 'pwr_1_2v', 'lm20_temp', 'pwr_5v', 'pwr_2_5v', 'pwr_3_3v', 'pwr_v_in',
            'pwr_1_25v'):
    float(snapshot['diag']['volt_temp']['bot'][key])
wanted = [('/cgi/setting', 'returns', config['returns'], 'Dual'),
          ('/cgi/setting', 'rpm', config['rpm'], 1200),
          ('/cgi/setting/fov', 'start', config['fov']['start'], 0),
          ('/cgi/setting/fov', 'end', config['fov']['end'], 300),
          ('/cgi/setting/host', 'addr', config['host']['addr'], '127.0.0.1'),
          ('/cgi/setting/host', 'dport', int(config['host']['dport']), dport),
          ('/cgi/setting/host', 'tport', int(config['host']['tport']), dport + 1)]
for path, key, found, want in wanted:
    if found != want:
        assert ask('POST', path, '%s=%s' % (key, want)) == b''
ask('POST', '/cgi/save', 'submit')
for path in ('/cgi/status.json', '/cgi/diag.json'):
    json.loads(ask('GET', path))
)";
  const Answer answer = run({"/usr/bin/python3", "-c", script, std::to_string(web_port_),
                             std::to_string(wires_.lidar_port)});
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_EQ(settings()["rpm"], 1200);
  EXPECT_EQ(settings()["fov"]["end"], 300);
  EXPECT_TRUE(streams(0x39));
}

// autoware's velodyne_monitor: four documents over one connection that stays open; counts and
// speeds must be numbers, model and serial number strings, and all of it "application/json".
TEST_F(LidarWebClients, VelodyneMonitorFindsAllWell) {
  const char* script = R"(
import http.client, json, math, sys, time
link = http.client.HTTPConnection('127.0.0.1', int(sys.argv[1]), timeout=200)
def get(name):
    link.request('GET', '/cgi/%s.json' % name)
    answer = link.getresponse()
    assert answer.status == 200 and answer.getheader('Content-Type') == 'application/json'
    return json.loads(answer.read())
info = get('info')
assert info['serial'] == '42' and type(info['model']) is str
def celsius(raw):
    assert type(raw) is int
    return math.sqrt(2.1962e6 + (1.8639 - raw * 5.0 / 4096) / 3.88e-6) - 1481.96
board = get('diag')['volt_temp']
for side in ('top', 'bot'):
    assert -5 < celsius(board[side]['lm20_temp']) < 75
setting = get('settings')['rpm']
speed = get('status')['motor']['rpm']
assert type(setting) is int and type(speed) is int
assert speed / setting > 0.8, (speed, setting)
)";
  const Answer answer = run({"/usr/bin/python3", "-c", script, std::to_string(web_port_)});
  EXPECT_EQ(answer.code, 0) << answer.text;
}

}  // namespace
}  // namespace rigwire
