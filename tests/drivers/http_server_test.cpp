#include "drivers/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/listener.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A client that shares nothing with the server but the socket.
class Client {
 public:
  Client(asio::io_context& context, std::uint16_t port) : context_(context), socket_(context) {
    socket_.connect({asio::ip::address_v4::loopback(), port});
    socket_.non_blocking(true);
  }

  void send(const std::string& text) {
    std::size_t sent = 0;
    EXPECT_TRUE(run_until(context_, [&] {
      boost::system::error_code error;
      sent += socket_.write_some(asio::buffer(text.data() + sent, text.size() - sent), error);
      return sent == text.size() || (error && error != asio::error::would_block);
    }));
  }
  void send_no_more() { socket_.shutdown(tcp::socket::shutdown_send); }
  /// What has come so far.
  const std::string& received() {
    std::array<char, 4096> piece{};
    boost::system::error_code error;
    do {
      const std::size_t size = socket_.read_some(asio::buffer(piece), error);
      text_.append(piece.data(), size);
    } while (!error);
    closed_ = error != asio::error::would_block;
    return text_;
  }
  bool closed() {
    received();
    return closed_;
  }
  /// The answer to `text`, when it ends with `end`.
  std::string ask(const std::string& text, const std::string& end) {
    text_.clear();
    send(text);
    EXPECT_TRUE(run_until(context_, [&] { return received().ends_with(end); })) << text_;
    return text_;
  }

 private:
  asio::io_context& context_;
  tcp::socket socket_;
  std::string text_;
  bool closed_ = false;
};

class HttpServerTest : public ::testing::Test {
 protected:
  void open(HttpServerSettings settings = {}) {
    settings.port = 0;
    server_ = std::make_unique<HttpServer>(context_, settings);
    server_->start([this](const HttpRequest& request) {
      requests_.push_back(request);
      return response_;
    });
  }
  Client client() { return {context_, server_->port()}; }
  [[nodiscard]] bool wait(const std::function<bool()>& done) { return run_until(context_, done); }
  static std::string message_of(const std::function<void()>& open) {
    try {
      open();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "opened";
  }

  asio::io_context context_;
  HttpResponse response_{200, "text/plain", "hello", {}, false};
  std::vector<HttpRequest> requests_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(HttpServerTest, AnswersAndKeepsTheConnection) {
  open();
  auto one = client();
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(one.ask("GET /a?b=c HTTP/1.1\r\nHost: x\r\n\r\n", "hello"),
                AllOf(StartsWith("HTTP/1.1 200 OK\r\n"), HasSubstr("Content-Length: 5\r\n"),
                      HasSubstr("Content-Type: text/plain\r\n")));
  }
  EXPECT_FALSE(one.closed());
  ASSERT_EQ(requests_.size(), 3U);
  EXPECT_EQ(requests_[0].method, "GET");
  EXPECT_EQ(requests_[0].target, "/a?b=c");
  EXPECT_TRUE(server_->status().client_present);
  EXPECT_EQ(server_->requests(), 3U);
}

TEST_F(HttpServerTest, AKeptPortIsNobodyElsesBetweenTwoServers) {
  const auto kept = std::make_shared<KeptListener>();
  HttpServerSettings settings;
  settings.kept = kept;
  open(settings);
  const std::uint16_t port = server_->port();
  auto before = client();
  EXPECT_THAT(before.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello"), HasSubstr("200 OK"));
  server_.reset();
  HttpServerSettings stranger;
  stranger.port = port;
  EXPECT_THAT(message_of([&] { HttpServer other(context_, stranger); }), HasSubstr("in use"));
  Client meanwhile(context_, port);  // waits for the next server
  open(settings);
  EXPECT_EQ(server_->port(), port);
  EXPECT_THAT(meanwhile.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello"), HasSubstr("200 OK"));
  settings.kept.reset();
  server_.reset();
  const int socket = kept->take();
  EXPECT_GE(socket, 0);
  kept->keep(socket);
}

TEST_F(HttpServerTest, AClientThatClosedItsSendingHalfGetsEveryAnswer) {
  open();
  auto one = client();
  one.send("GET /a HTTP/1.1\r\nHost: x\r\n\r\nGET /b HTTP/1.1\r\nHost: x\r\n\r\n");
  one.send_no_more();
  EXPECT_TRUE(wait([&] { return one.closed(); }));
  ASSERT_EQ(requests_.size(), 2U);
  EXPECT_EQ(requests_[1].target, "/b");
  EXPECT_THAT(one.received(), AllOf(StartsWith("HTTP/1.1 200 OK\r\n"), EndsWith("hello")));
}

TEST_F(HttpServerTest, ClosesWhenTheClientWishesOrIsOld) {
  open();
  auto one = client();
  one.ask("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n", "hello");
  EXPECT_TRUE(wait([&] { return one.closed(); }));
  auto old = client();
  EXPECT_THAT(old.ask("GET / HTTP/1.0\r\n\r\n", "hello"), StartsWith("HTTP/1.0 200 OK"));
  EXPECT_TRUE(wait([&] { return old.closed(); }));
  EXPECT_EQ(server_->clients(), 0U);
}

TEST_F(HttpServerTest, TakesBodiesWithLengthAndInChunks) {
  open();
  auto one = client();
  one.ask("POST /p HTTP/1.1\r\nHost: x\r\nContent-Length: 7\r\n\r\nrpm=600", "hello");
  one.ask(
      "POST /p HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
      "4\r\nrpm=\r\n3\r\n300\r\n0\r\n\r\n",
      "hello");
  ASSERT_EQ(requests_.size(), 2U);
  EXPECT_EQ(requests_[0].body, "rpm=600");
  EXPECT_EQ(requests_[1].body, "rpm=300");
}

TEST_F(HttpServerTest, NoContentHasNeitherBodyNorLength) {
  response_ = {204, {}, {}, {}, false};
  open();
  auto one = client();
  const std::string answer =
      one.ask("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\n\r\n", "\r\n\r\n");
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 204 "), Not(HasSubstr("Content-Length")),
                            EndsWith("\r\n\r\n")));
  EXPECT_FALSE(one.closed());
}

TEST_F(HttpServerTest, HeadTellsTheLengthAlone) {
  open();
  auto one = client();
  EXPECT_THAT(one.ask("HEAD / HTTP/1.1\r\nHost: x\r\n\r\n", "\r\n\r\n"),
              HasSubstr("Content-Length: 5\r\n"));
}

TEST_F(HttpServerTest, WrongMethodNamesTheRightOnes) {
  response_ = {405, "text/plain", "no", "POST", false};
  open();
  auto one = client();
  EXPECT_THAT(one.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "no"), HasSubstr("Allow: POST\r\n"));
}

TEST_F(HttpServerTest, RequestsInOneGoAreAnsweredInOrder) {
  open();
  auto one = client();
  one.send("GET /1 HTTP/1.1\r\nHost: x\r\n\r\nGET /2 HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_TRUE(wait([&] { return requests_.size() == 2; }));
  EXPECT_EQ(requests_[0].target, "/1");
  EXPECT_EQ(requests_[1].target, "/2");
}

TEST_F(HttpServerTest, ClientThatAsksFirstIsToldToContinue) {
  open();
  auto one = client();
  EXPECT_EQ(one.ask("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\n"
                    "Expect: 100-continue\r\n\r\n",
                    "\r\n\r\n"),
            "HTTP/1.1 100 Continue\r\n\r\n");
  EXPECT_THAT(one.ask("ok", "hello"), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(requests_.at(0).body, "ok");
}

TEST_F(HttpServerTest, HugeBodyIsRefusedBeforeItIsSent) {
  open();
  auto one = client();
  EXPECT_THAT(one.ask("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 100000000\r\n"
                      "Expect: 100-continue\r\n\r\n",
                      "\n"),
              StartsWith("HTTP/1.1 413 "));
  EXPECT_TRUE(requests_.empty());
}

TEST_F(HttpServerTest, SenderOfAHugeBodyStillSeesTheAnswer) {
  HttpServerSettings settings;
  settings.body_bytes = 1000;
  open(settings);
  auto one = client();
  one.send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 200000\r\n\r\n" +
           std::string(200'000, 'x'));
  EXPECT_TRUE(wait([&] { return one.closed(); }));
  EXPECT_THAT(one.received(), StartsWith("HTTP/1.1 413 "));
  EXPECT_TRUE(wait([&] { return server_->clients() == 1; }));  // until the client closes too
  auto chunked = client();
  chunked.send("POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\nffff\r\n" +
               std::string(0xFFFF, 'x') + "\r\n0\r\n\r\n");
  EXPECT_TRUE(wait([&] { return chunked.closed(); }));
  EXPECT_THAT(chunked.received(), StartsWith("HTTP/1.1 413 "));
}

TEST_F(HttpServerTest, LongHeadersAndNoiseAreRefused) {
  open();
  auto greedy = client();
  greedy.send("GET / HTTP/1.1\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n");
  EXPECT_TRUE(wait([&] { return greedy.closed(); }));
  EXPECT_THAT(greedy.received(), StartsWith("HTTP/1.1 431 "));
  for (const std::string& noise :
       {std::string("\x16\x03\x01\x02\n\r\n\r\n"), std::string("GET\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nContent-Length: -5\r\n\r\n"),
        std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")}) {
    auto one = client();
    one.send(noise);
    EXPECT_TRUE(wait([&] { return one.closed(); })) << noise;
    EXPECT_THAT(one.received(), StartsWith("HTTP/1.1 400 ")) << noise;
  }
  EXPECT_TRUE(requests_.empty());
}

TEST_F(HttpServerTest, HalfARequestIsGivenUp) {
  HttpServerSettings settings;
  settings.patience = std::chrono::milliseconds(50);
  open(settings);
  auto header = client();
  header.send("GET / HTTP/1.1\r\n");
  auto body = client();
  body.send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 10\r\n\r\n123");
  auto nothing = client();
  EXPECT_TRUE(wait([&] { return header.closed() && body.closed() && nothing.closed(); }));
  EXPECT_TRUE(wait([&] { return server_->clients() == 0; }));
  EXPECT_TRUE(requests_.empty());
}

TEST_F(HttpServerTest, ClientThatNeverReadsHoldsUpNobody) {
  HttpServerSettings settings;
  settings.patience = std::chrono::milliseconds(200);
  response_.body = std::string(std::size_t{8} << 20U, 'x');
  open(settings);
  auto deaf = client();
  deaf.send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_TRUE(wait([&] { return requests_.size() == 1; }));
  response_.body = "hello";
  auto other = client();
  other.ask("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n", "hello");
  EXPECT_TRUE(wait([&] { return server_->clients() == 0; }));
}

TEST_F(HttpServerTest, NewcomerGetsThePlaceOfTheMostSilent) {
  HttpServerSettings settings;
  settings.clients_max = 2;
  open(settings);
  auto silent = client();
  EXPECT_TRUE(wait([&] { return server_->clients() == 1; }));
  auto busy = client();
  busy.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello");
  auto newcomer = client();
  newcomer.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello");
  EXPECT_TRUE(silent.closed());
  EXPECT_FALSE(busy.closed());
  EXPECT_EQ(server_->clients(), 2U);
}

TEST_F(HttpServerTest, ARequestWithTwoHostsIsRefused) {
  open();
  auto one = client();
  EXPECT_THAT(one.ask("GET / HTTP/1.1\r\nHost: x\r\nHost: y\r\n\r\n", "Host\n"),
              StartsWith("HTTP/1.1 400 "));
  EXPECT_TRUE(requests_.empty());
}

TEST_F(HttpServerTest, WhoWaitsForAnAnswerKeepsItsPlace) {
  HttpServerSettings settings;
  settings.port = 0;
  settings.clients_max = 2;
  server_ = std::make_unique<HttpServer>(context_, settings);
  std::vector<HttpServer::Respond> waiting;
  server_->start_patiently([&](const HttpRequest& request, const HttpServer::Respond& respond) {
    if (request.target == "/wait") {
      waiting.push_back(respond);
    } else {
      respond(response_);
    }
  });
  auto patient = client();
  patient.send("GET /wait HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_TRUE(wait([&] { return waiting.size() == 1; }));
  for (int i = 0; i < 20; ++i) {
    auto newcomer = client();
    newcomer.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello");
  }
  EXPECT_FALSE(patient.closed());
  auto second = client();
  second.send("GET /wait HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_TRUE(wait([&] { return waiting.size() == 2; }));
  auto third = client();
  EXPECT_TRUE(wait([&] { return third.closed(); })) << "all places wait for answers";
  waiting[0](response_);
  EXPECT_TRUE(wait([&] { return patient.received().ends_with("hello"); }));
}

TEST_F(HttpServerTest, AClientThatGoesWhileItWaitsGivesItsPlaceBack) {
  std::string folder = "/tmp/rigwire-test-XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  HttpServerSettings settings;
  settings.path = folder + "/control";
  server_ = std::make_unique<HttpServer>(context_, settings);
  std::vector<HttpServer::Respond> waiting;
  server_->start_patiently(
      [&](const HttpRequest&, const HttpServer::Respond& respond) { waiting.push_back(respond); });
  const auto ask = [&](const std::string& text) {
    asio::local::stream_protocol::socket socket(context_);
    socket.connect({settings.path});
    asio::write(socket, asio::buffer(text));
    return socket;
  };
  const std::string request = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";
  auto gone = ask(request);
  auto gone_with_more = ask(request + request);
  auto stays = ask(request);
  EXPECT_TRUE(wait([&] { return waiting.size() == 3; }));
  EXPECT_EQ(server_->clients(), 3U);
  gone.close();
  gone_with_more.close();
  EXPECT_TRUE(wait([&] { return server_->clients() == 1; }));
  stays.shutdown(asio::local::stream_protocol::socket::shutdown_send);
  run_for(context_, std::chrono::milliseconds(20));
  EXPECT_EQ(server_->clients(), 1U) << "it still reads";
  for (const HttpServer::Respond& respond : waiting) {
    respond(response_);
  }
  std::string answer;
  stays.non_blocking(true);
  EXPECT_TRUE(wait([&] {
    boost::system::error_code error;
    std::array<char, 512> piece{};
    answer.append(piece.data(), stays.read_some(asio::buffer(piece), error));
    return answer.ends_with("hello");
  }));
  server_.reset();
  std::filesystem::remove_all(folder);
}

/// When a TCP connection is closed, the server learns that nothing more comes, as from a client
/// that still reads.
TEST_F(HttpServerTest, AClientThatSendsNoMoreHasItsAnswerUnlessANewcomerNeedsThePlace) {
  HttpServerSettings settings;
  settings.port = 0;
  settings.clients_max = 2;
  server_ = std::make_unique<HttpServer>(context_, settings);
  std::vector<HttpServer::Respond> waiting;
  server_->start_patiently([&](const HttpRequest& request, const HttpServer::Respond& respond) {
    if (request.target == "/wait") {
      waiting.push_back(respond);
    } else {
      respond(response_);
    }
  });
  const std::string request = "GET /wait HTTP/1.1\r\nHost: x\r\n\r\n";
  auto stays = client();
  stays.send(request);
  auto reads_on = client();
  reads_on.send(request);
  EXPECT_TRUE(wait([&] { return waiting.size() == 2; }));
  reads_on.send_no_more();
  run_for(context_, std::chrono::milliseconds(20));
  waiting[1](response_);
  EXPECT_TRUE(wait([&] { return reads_on.closed(); }));
  EXPECT_THAT(reads_on.received(), EndsWith("hello"));
  {
    auto gone = client();
    gone.send(request);
    EXPECT_TRUE(wait([&] { return waiting.size() == 3; }));
  }
  run_for(context_, std::chrono::milliseconds(20));
  auto newcomer = client();
  EXPECT_THAT(newcomer.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello"), HasSubstr(" 200 "));
  EXPECT_EQ(server_->clients(), 2U);
  waiting[0](response_);
  EXPECT_TRUE(wait([&] { return stays.received().ends_with("hello"); })) << "it has kept its place";
}

/// The next request is there while the one before waits, and is no news.
TEST_F(HttpServerTest, ARequestBehindOneThatWaitsIsAnsweredAfterIt) {
  HttpServerSettings settings;
  settings.port = 0;
  server_ = std::make_unique<HttpServer>(context_, settings);
  std::vector<HttpServer::Respond> waiting;
  server_->start_patiently([&](const HttpRequest& request, const HttpServer::Respond& respond) {
    requests_.push_back(request);
    waiting.push_back(respond);
  });
  auto one = client();
  one.send("GET /a HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_TRUE(wait([&] { return waiting.size() == 1; }));
  one.send("GET /b HTTP/1.1\r\nHost: x\r\n\r\n");
  run_for(context_, std::chrono::milliseconds(20));
  EXPECT_EQ(waiting.size(), 1U);
  waiting[0]({200, "text/plain", "first", {}, false});
  EXPECT_TRUE(wait([&] { return waiting.size() == 2; }));
  waiting[1]({200, "text/plain", "second", {}, false});
  EXPECT_TRUE(wait([&] { return one.received().ends_with("second"); }));
  EXPECT_THAT(one.received(), HasSubstr("first"));
  EXPECT_EQ(requests_[1].target, "/b");
}

TEST_F(HttpServerTest, AnAnswerMayComeLaterThanItsClientWouldBePatient) {
  HttpServerSettings settings;
  settings.port = 0;
  settings.patience = std::chrono::milliseconds(20);
  server_ = std::make_unique<HttpServer>(context_, settings);
  std::vector<HttpServer::Respond> open;
  server_->start_patiently([&](const HttpRequest& request, HttpServer::Respond respond) {
    requests_.push_back(request);
    open.push_back(std::move(respond));
  });
  auto one = client();
  one.send("GET / HTTP/1.1\r\nHost: here\r\nOrigin: http://there\r\nAuthorization: me\r\n\r\n");
  EXPECT_TRUE(wait([&] { return open.size() == 1; }));
  EXPECT_EQ(requests_[0].host, "here");
  EXPECT_EQ(requests_[0].origin, "http://there");
  EXPECT_EQ(requests_[0].authorization, "me");
  run_for(context_, std::chrono::milliseconds(60));
  EXPECT_FALSE(one.closed());
  open[0](response_);
  EXPECT_TRUE(wait([&] { return one.received().ends_with("hello"); }));

  std::optional<Client> gone(client());
  gone->send("GET / HTTP/1.1\r\nHost: here\r\n\r\n");
  EXPECT_TRUE(wait([&] { return open.size() == 2; }));
  gone.reset();
  open[1](response_);
  server_.reset();
  open[1](response_);
}

TEST_F(HttpServerTest, ASocketInTheFileSystemIsItsOwnersAlone) {
  std::string folder = "/tmp/rigwire-test-XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  HttpServerSettings settings;
  settings.path = folder + "/control";
  open(settings);
  struct stat found {};
  ASSERT_EQ(::lstat(settings.path.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777U, 0600U);
  EXPECT_EQ(server_->status().address, "http unix:" + settings.path);
  EXPECT_THAT(message_of([&] { HttpServer(context_, settings); }), HasSubstr("another process"));

  asio::local::stream_protocol::socket one(context_);
  one.connect({settings.path});
  asio::write(one, asio::buffer(std::string("GET / HTTP/1.1\r\nHost: x\r\n\r\n")));
  EXPECT_TRUE(wait([&] { return requests_.size() == 1; }));
  std::string answer;
  one.non_blocking(true);
  EXPECT_TRUE(wait([&] {
    boost::system::error_code error;
    std::array<char, 512> piece{};
    answer.append(piece.data(), one.read_some(asio::buffer(piece), error));
    return answer.ends_with("hello");
  }));
  server_.reset();
  EXPECT_NE(::lstat(settings.path.c_str(), &found), 0) << "it is left behind";

  // What a process that was killed has left is taken over; what is no socket stays.
  asio::local::stream_protocol::acceptor(context_, {settings.path}).close();
  open(settings);
  server_.reset();
  std::ofstream(settings.path) << "a text";
  EXPECT_THAT(message_of([&] { HttpServer(context_, settings); }), HasSubstr("something else"));
  settings.path = std::string(200, 'x');
  EXPECT_THAT(message_of([&] { HttpServer(context_, settings); }), HasSubstr("200 bytes"));
  std::filesystem::remove_all(folder);
}

TEST_F(HttpServerTest, EndsWithClientsConnected) {
  open();
  auto one = client();
  one.send("GET / HT");
  EXPECT_TRUE(wait([&] { return server_->clients() == 1; }));
  server_.reset();
  run_for(context_, std::chrono::milliseconds(20));
  EXPECT_TRUE(one.closed());
}

TEST_F(HttpServerTest, OpeningSaysWhatIsWrongAndHowToMendIt) {
  open();
  HttpServerSettings settings;
  settings.port = server_->port();
  EXPECT_THAT(message_of([&] { HttpServer(context_, settings); }),
              AllOf(StartsWith("http 127.0.0.1:"), HasSubstr("another program has the port")));
  settings = {};
  settings.address = "0.0.0.0";
  EXPECT_THAT(message_of([&] { HttpServer(context_, settings); }), HasSubstr("allow_remote"));
  settings.address = "localhost";
  EXPECT_THAT(message_of([&] { HttpServer(context_, settings); }), HasSubstr("not a numeric"));
  settings = {};
  settings.clients_max = 0;
  EXPECT_EQ(message_of([&] { HttpServer(context_, settings); }),
            "http server clients_max: found 0, allowed 1 .. 1024");
}

TEST_F(HttpServerTest, FurtherHeadersAreSent) {
  response_.headers = {{"X-Content-Type-Options", "nosniff"}};
  open();
  auto one = client();
  EXPECT_THAT(one.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello"),
              HasSubstr("X-Content-Type-Options: nosniff\r\n"));
}

/// A server whose WebSocket sends what is in a list, and a client of Beast's.
class WebSocketTest : public HttpServerTest {
 protected:
  using Stream = boost::beast::websocket::stream<tcp::socket>;

  void open_web_sockets(HttpServerSettings settings = {}) {
    settings.port = 0;
    server_ = std::make_unique<HttpServer>(context_, settings);
    server_->on_web_socket([this](const HttpRequest& request) {
      requests_.push_back(request);
      WebSocketAnswer answer;
      if (request.target != "/stream") {
        answer.refusal = {403, "text/plain", "no", {}, false};
      }
      answer.subprotocol = "b";
      answer.open = [this](std::shared_ptr<WebSocket> socket) {
        socket_ = std::move(socket);
        return WebSocket::Owner{
            [this] {
              WebSocketMessage next;
              if (!to_send_.empty()) {
                next = {true, std::make_shared<const std::string>(to_send_.front())};
                to_send_.erase(to_send_.begin());
              }
              return next;
            },
            [this](bool text, std::string_view bytes) {
              received_.emplace_back(text ? "text " : "binary ");
              received_.back() += bytes;
            },
            [this] { ++closed_; }};
      };
      return answer;
    });
    server_->start([this](const HttpRequest&) { return response_; });
  }
  std::unique_ptr<Stream> connect(const std::string& target = "/stream") {
    auto stream = std::make_unique<Stream>(context_);
    stream->next_layer().connect({asio::ip::address_v4::loopback(), server_->port()});
    stream->set_option(boost::beast::websocket::stream_base::decorator(
        [](boost::beast::websocket::request_type& request) {
          request.set(boost::beast::http::field::sec_websocket_protocol, "a, b");
        }));
    bool done = false;
    stream->async_handshake(answer_, "127.0.0.1", target,
                            [&](const boost::system::error_code& error) {
                              error_ = error;
                              done = true;
                            });
    EXPECT_TRUE(wait([&] { return done; }));
    return stream;
  }
  std::string read(Stream& stream) {
    boost::beast::flat_buffer buffer;
    bool done = false;
    stream.async_read(buffer, [&](const boost::system::error_code& error, std::size_t) {
      error_ = error;
      done = true;
    });
    EXPECT_TRUE(wait([&] { return done; }));
    return boost::beast::buffers_to_string(buffer.data());
  }

  std::shared_ptr<WebSocket> socket_;
  std::vector<std::string> to_send_;
  std::vector<std::string> received_;
  int closed_ = 0;
  boost::beast::websocket::response_type answer_;
  boost::system::error_code error_;
};

TEST_F(WebSocketTest, MessagesGoBothWays) {
  open_web_sockets();
  to_send_ = {"one", "two"};
  const auto stream = connect();
  ASSERT_FALSE(error_) << error_.message();
  EXPECT_EQ(answer_[boost::beast::http::field::sec_websocket_protocol], "b");
  EXPECT_EQ(requests_.front().subprotocols, "a, b");
  EXPECT_EQ(read(*stream), "one");
  EXPECT_EQ(read(*stream), "two");
  to_send_.emplace_back("three");
  socket_->wake();
  EXPECT_EQ(read(*stream), "three");
  stream->binary(true);
  stream->write(asio::buffer("hello", 5));
  EXPECT_TRUE(wait([&] { return !received_.empty(); }));
  EXPECT_EQ(received_, std::vector<std::string>{"binary hello"});
}

TEST_F(WebSocketTest, WhatIsRefusedStaysHttp) {
  open_web_sockets();
  connect("/elsewhere");
  EXPECT_EQ(error_, boost::beast::websocket::error::upgrade_declined);
  EXPECT_EQ(answer_.result_int(), 403U);
  EXPECT_FALSE(socket_);
  auto plain = client();
  EXPECT_THAT(plain.ask("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "hello"), HasSubstr("200 OK"));
}

TEST_F(WebSocketTest, TheOwnerIsToldOnceWhenTheClientLeaves) {
  open_web_sockets();
  auto stream = connect();
  stream->next_layer().close();
  EXPECT_TRUE(wait([&] { return closed_ == 1; }));
  socket_->wake();
  socket_->close();
  run_for(context_, std::chrono::milliseconds(20));
  EXPECT_EQ(closed_, 1);
}

TEST_F(WebSocketTest, AMessageBeyondTheLimitEndsTheConnection) {
  HttpServerSettings settings;
  settings.body_bytes = 256;
  open_web_sockets(settings);
  const auto stream = connect();
  stream->write(asio::buffer(std::string(300, 'x')));
  read(*stream);
  EXPECT_EQ(error_, boost::beast::websocket::error::closed);
  EXPECT_EQ(stream->reason().code, boost::beast::websocket::close_code::too_big);
  EXPECT_TRUE(wait([&] { return closed_ == 1; }));
  EXPECT_TRUE(received_.empty());
}

TEST_F(WebSocketTest, WhenAllPlacesAreTakenANewcomerIsRefused) {
  HttpServerSettings settings;
  settings.clients_max = 1;
  open_web_sockets(settings);
  const auto first = connect();
  ASSERT_FALSE(error_);
  connect();
  EXPECT_EQ(answer_.result_int(), 503U);
}

TEST_F(WebSocketTest, TheServersEndIsTheConnectionsEnd) {
  open_web_sockets();
  const auto stream = connect();
  server_.reset();
  read(*stream);
  EXPECT_TRUE(error_);
  EXPECT_EQ(closed_, 0);
}

}  // namespace
}  // namespace rigwire::drivers
