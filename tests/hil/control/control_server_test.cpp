// The server against its own description (GET /openapi.json): what is in it is served, what is
// served is in it.
#include "hil/control/control_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <atomic>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "clockwork.h"
#include "hil/executive/background_thread.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;
namespace asio = boost::asio;
namespace http = boost::beast::http;

struct Answer {
  int status = 0;
  std::string type;
  std::string allow;
  std::string body;
};

class ControlServerTest : public testing::Test {
 protected:
  ControlServerTest() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no folder");
    }
    folder_ = pattern;
    server_.emplace(server_io_, ControlEndpoint{folder_ + "/control", {}, 0, nullptr}, "", desk_);
    thread_.emplace(server_io_, [](const std::string& what) { ADD_FAILURE() << what; });
  }
  ~ControlServerTest() override {
    thread_.reset();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// `talk` on another thread, as a client of the run, which ends with it.
  void served(const std::function<void()>& talk) {
    std::thread client([&] {
      talk();
      asio::post(io_, [this] { executive_.stop(); });
    });
    executive_.run_free(kStart + std::chrono::hours{10'000});
    client.join();
  }
  Answer ask(http::verb verb, const std::string& target, const std::string& body = {}) {
    asio::io_context io;
    asio::generic::stream_protocol::socket socket(io);
    socket.connect(asio::local::stream_protocol::endpoint(folder_ + "/control"));
    http::request<http::string_body> message(verb, target, 11);
    message.set(http::field::host, "localhost");
    message.set(http::field::connection, "close");
    message.body() = body;
    message.prepare_payload();
    http::write(socket, message);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.skip(verb == http::verb::head);
    http::read(socket, buffer, parser);
    const auto& response = parser.get();
    const auto header = [&](http::field field) { return std::string(response[field]); };
    return {static_cast<int>(response.result_int()), header(http::field::content_type),
            header(http::field::allow), response.body()};
  }
  Answer command(const Json& request) { return ask(http::verb::post, "/command", request.dump()); }
  Json description() { return Json::parse(ask(http::verb::get, "/openapi.json").body); }

  std::string folder_;
  RigFaults faults_;
  asio::io_context io_;
  test::Clockwork truth_;
  Executive executive_{io_, truth_};
  Desk desk_{io_,
             executive_,
             {"pit",
              7,
              "abc",
              {ClockMode::Kind::step, 1.0},
              truth_.state_quantities(),
              [] { return RigStatus(); },
              faults_}};
  // The server is on another thread than the desk, as in a run.
  asio::io_context server_io_;
  std::optional<ControlServer> server_;
  std::optional<BackgroundThread> thread_;
};

/// A client that keeps its connection.
class Connection {
 public:
  explicit Connection(const std::string& folder) : socket_(io_) {
    socket_.connect(asio::local::stream_protocol::endpoint(folder + "/control"));
  }
  void send(const std::string& body) {
    http::request<http::string_body> message(http::verb::post, "/command", 11);
    message.set(http::field::host, "localhost");
    message.body() = body;
    message.prepare_payload();
    http::write(socket_, message);
  }
  Answer receive() {
    http::response<http::string_body> response;
    http::read(socket_, buffer_, response);
    return {static_cast<int>(response.result_int()), {}, {}, response.body()};
  }

 private:
  asio::io_context io_;
  asio::generic::stream_protocol::socket socket_;
  boost::beast::flat_buffer buffer_;
};

/// The fields that a schema requires are there, and each has its type.
void expect_meets(const Json& schema, const std::string& body) {
  const Json reply = Json::parse(body);
  for (const std::string key : schema["required"]) {
    EXPECT_TRUE(reply.contains(key)) << key << " of " << body;
  }
  for (const auto& [key, value] : schema["properties"].items()) {
    if (reply.contains(key)) {
      const Json& found = reply[key];
      const std::string type = value["type"];
      EXPECT_TRUE(type == "boolean"   ? found.is_boolean()
                  : type == "integer" ? found.is_number_integer()
                                      : found.is_string())
          << key << " of " << body;
    }
  }
}

TEST_F(ControlServerTest, EveryPathAndVerbOfTheDescriptionIsServedAndNoOther) {
  const std::map<std::string, http::verb> verbs{{"get", http::verb::get},
                                                {"post", http::verb::post},
                                                {"put", http::verb::put},
                                                {"delete", http::verb::delete_}};
  served([&] {
    const Json api = description();
    const Json& reply = api["components"]["schemas"]["Reply"];
    EXPECT_GE(api["paths"].size(), 5U);
    const std::string nowhere = ask(http::verb::get, "/nowhere").body;
    for (const auto& [path, operations] : api["paths"].items()) {
      EXPECT_THAT(nowhere, HasSubstr(path));
      for (const auto& [name, verb] : verbs) {
        SCOPED_TRACE(name + " " + path);
        const Answer answer = ask(verb, path, verb == http::verb::post ? "{verb: state}" : "");
        if (!operations.contains(name)) {
          EXPECT_EQ(answer.status, 405);
          EXPECT_FALSE(answer.allow.empty());
          continue;
        }
        EXPECT_EQ(answer.status, 200);
        const Json& content = operations[name]["responses"]["200"]["content"];
        ASSERT_TRUE(content.contains(answer.type)) << answer.type;
        if (content[answer.type]["schema"].contains("$ref")) {
          expect_meets(reply, answer.body);
        }
      }
      EXPECT_EQ(ask(http::verb::head, path).status, operations.contains("get") ? 200 : 405);
    }
    const Answer unknown = ask(http::verb::get, "/nowhere");
    EXPECT_EQ(unknown.status, 404);
    EXPECT_EQ(std::ranges::count(nowhere, '/'), static_cast<std::ptrdiff_t>(api["paths"].size()));
  });
}

template <class... All>
std::set<std::string> names_of(std::type_identity<std::variant<All...>>) {
  return {std::string(All::kNamed.name)...};
}

/// What is asked with a verb of the description: the keys that it must have.
std::map<std::string, std::set<std::string>> required_of(const Json& request) {
  std::map<std::string, std::set<std::string>> required;
  for (const std::string verb : request["properties"]["verb"]["enum"]) {
    required[verb];
  }
  for (const Json& one : request["allOf"]) {
    for (const std::string verb : one["if"]["properties"]["verb"]["enum"]) {
      for (const std::string key : one["then"].value("required", Json::array())) {
        required.at(verb).insert(key);
      }
    }
  }
  return required;
}

TEST_F(ControlServerTest, EveryVerbIsInTheDescriptionWithWhatItRequires) {
  const std::map<std::string, Json> some{{"time", 1.0},
                                         {"length", 0.5},
                                         {"factor", 2.0},
                                         {"quantity", "angle"},
                                         {"value", 0.0},
                                         {"on", "gnss"},
                                         {"fault", Json{{"type", "jamming"}}},
                                         {"id", 1},
                                         {"set", Json{{"boom", 0.5}}}};
  served([&] {
    const Json api = description();
    const Json& post = api["paths"]["/command"]["post"]["responses"];
    const Json& request = api["components"]["schemas"]["Request"];
    const auto required = required_of(request);
    std::set<std::string> verbs;
    for (const auto& [verb, keys] : required) {
      verbs.insert(verb);
    }
    EXPECT_EQ(verbs, names_of(std::type_identity<Command>{}));
    EXPECT_EQ(request["required"], Json::array({"verb"}));
    EXPECT_FALSE(request["properties"].contains("include"));
    for (const auto& [verb, keys] : required) {
      if (verb == "stop") {
        continue;  // the client could wait for its answer in vain
      }
      SCOPED_TRACE(verb);
      Json whole{{"verb", verb}};
      for (const std::string& key : keys) {
        whole[key] = some.at(key);
      }
      const Answer answer = command(whole);
      EXPECT_TRUE(post.contains(std::to_string(answer.status))) << answer.body;
      expect_meets(api["components"]["schemas"]["Reply"], answer.body);
      for (const std::string& key : keys) {
        Json part = whole;
        part.erase(key);
        const Answer refusal = command(part);
        EXPECT_EQ(refusal.status, 400) << "without " << key;
        EXPECT_EQ(Json::parse(refusal.body)["path"], key) << refusal.body;
      }
      command(Json{{"verb", "pause"}});
      Json more = whole;
      more["surplus"] = 1;
      EXPECT_EQ(command(more).status, 400);
    }
    EXPECT_EQ(command(Json{{"at", 1.0}}).status, 400) << "without a verb";
  });
}

/// One step at a time is on its way; who is refused asks again at once.
TEST_F(ControlServerTest, EveryOneOf64ClientsThatAskAtOnceIsAnswered) {
  constexpr int kClients = 64;
  constexpr int kSteps = 2;
  std::atomic<int> finished = 0;
  served([&] {
    std::vector<std::thread> clients;
    for (int i = 0; i < kClients; ++i) {
      clients.emplace_back([&] {
        try {
          Connection connection(folder_);
          for (int steps = 0; steps < kSteps;) {
            connection.send("{verb: step, length: 2 ms}");
            const int status = connection.receive().status;
            EXPECT_TRUE(status == 200 || status == 409) << status;
            steps += status == 200 ? 1 : 0;
          }
          ++finished;
        } catch (const std::exception& error) {
          ADD_FAILURE() << error.what();
        }
      });
    }
    for (std::thread& client : clients) {
      client.join();
    }
  });
  EXPECT_EQ(finished, kClients);
  EXPECT_EQ(executive_.now(), kStart + kClients * kSteps * std::chrono::milliseconds{2});
}

TEST_F(ControlServerTest, ClientsThatAskedPatientlyAndWentKeepNoPlace) {
  served([&] {
    std::vector<std::unique_ptr<Connection>> patient;
    for (int i = 0; i < 64; ++i) {
      patient.push_back(std::make_unique<Connection>(folder_));
      patient.back()->send("{verb: state, at: 1 s}");
    }
    patient.clear();
    // The server may notice later than the next one comes.
    std::optional<Answer> answer;
    for (int tries = 0; tries < 1000 && !answer; ++tries) {
      try {
        answer = command(Json{{"verb", "state"}});
      } catch (const boost::system::system_error&) {
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
      }
    }
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(command(Json{{"verb", "run_until"}, {"time", 2.0}}).status, 200);
    EXPECT_EQ(Json::parse(ask(http::verb::get, "/state").body)["queued"], 0);
  });
}

TEST_F(ControlServerTest, RequestsOfOneConnectionAreAnsweredInTheirOrder) {
  served([&] {
    Connection connection(folder_);
    connection.send("{verb: run_until, time: 100 ms}");
    connection.send("{verb: nonsense}");
    connection.send("{verb: state}");
    EXPECT_EQ(Json::parse(connection.receive().body)["time_ns"], 100'000'000);
    EXPECT_EQ(connection.receive().status, 400);
    EXPECT_EQ(Json::parse(connection.receive().body)["rig"], "pit");
  });
}

/// A client that has a token need not be allowed to read this user's files.
TEST_F(ControlServerTest, ARequestIncludesNoFile) {
  served([&] {
    for (const std::string body :
         {R"({"verb": "state", "include": "/etc/passwd"})",
          R"({"verb": "fault_add", "on": "gnss", "fault": {"include": "/etc/passwd"}})",
          R"({"verb": "set", "set": {"include": ["/no/such/file"]}})"}) {
      const Answer answer = ask(http::verb::post, "/command", body);
      EXPECT_THAT(answer.body, HasSubstr("includes no files"));
      EXPECT_THAT(answer.body, testing::Not(HasSubstr("no such file")));
    }
  });
}

}  // namespace
}  // namespace rigwire::hil
