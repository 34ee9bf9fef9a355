// The server by a client of its own: what is refused, and what each page gets when.
#include <catch2/catch.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <kerf/error.h>
#include "client.h"
#include "live/server.h"
#include "messages.h"

using namespace live;
namespace beast = boost::beast;
namespace net = boost::asio;
using tcp = net::ip::tcp;

namespace {

const std::string token = "0123456789abcdef";

struct Served {
  explicit Served(const std::string& address = "127.0.0.1") : server({address, 0, token, "<html>page</html>"}, inbox) {}
  Inbox inbox;
  Server server;
  int port() const {
    const std::string url = server.url();
    return std::stoi(url.substr(url.rfind(':') + 1));
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(port()); }
};

// The status and body of a request.
std::pair<int, std::string> answer(const Served& s, const std::string& target, const std::string& host,
                                   beast::http::verb verb = beast::http::verb::get, const std::string& upgrade = "",
                                   const std::string& origin = "") {
  net::io_context io;
  tcp::socket socket(io);
  socket.connect({net::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(s.port())});
  beast::http::request<beast::http::empty_body> request(verb, target, 11);
  if (!host.empty()) request.set(beast::http::field::host, host);
  if (!upgrade.empty()) {
    request.set(beast::http::field::upgrade, "websocket");
    request.set(beast::http::field::connection, "Upgrade");
    request.set(beast::http::field::sec_websocket_key, "AAAAAAAAAAAAAAAAAAAAAA==");
    request.set(beast::http::field::sec_websocket_version, "13");
  }
  if (!origin.empty()) request.set(beast::http::field::origin, origin);
  beast::http::write(socket, request);
  beast::flat_buffer buffer;
  beast::http::response<beast::http::string_body> response;
  beast::http::read(socket, buffer, response);
  return {static_cast<int>(response.result_int()), response.body()};
}

std::shared_ptr<Snapshot> snapshot(std::uint64_t number, std::uint32_t revision = 1) {
  auto s = std::make_shared<Snapshot>();
  auto t = std::make_shared<Topology>();
  t->revision = revision;
  t->vertices = 4;
  t->triangle = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}};
  t->patch = {0, 1, 200};
  t->triangle.resize(2 + revision % 2);
  t->patch.resize(2 + revision % 2);
  s->number = number;
  s->time = double(number) / 60;
  s->topology = t;
  s->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, double(number)}};
  s->node_count = 2;
  s->statistics = "{\"number\":" + std::to_string(number);
  static const auto scene = std::make_shared<const std::string>("{\"name\":\"test\"}");
  s->scene = scene;
  return s;
}

// The next requests of a kind.
template <class T>
std::vector<Request> wait_for(Inbox& inbox, std::size_t count) {
  std::vector<Request> found;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (found.size() < count && std::chrono::steady_clock::now() < end) {
    inbox.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(50));
    for (Request& r : inbox.take())
      if (std::holds_alternative<T>(r.what)) found.push_back(std::move(r));
  }
  REQUIRE(found.size() == count);
  return found;
}

}  // namespace

TEST_CASE("only the printed address answers") {
  Served s;
  CHECK(s.server.url() == "http://" + s.host() + "/" + token + "/");
  CHECK(answer(s, "/" + token + "/", s.host()) == std::pair<int, std::string>(200, "<html>page</html>"));
  CHECK(answer(s, "/" + token + "/", "localhost:" + std::to_string(s.port())).first == 200);
  for (const std::string target :
       {"/", "/0123456789abcdee/", "/0123456789abcde/", "/0123456789abcdeff/", "/live", "//", "*", "/0123456789abcdef"})
    CHECK(answer(s, target, s.host()).first == 404);
  CHECK(answer(s, "/" + token + "/secret", s.host()).first == 404);
  CHECK(answer(s, "/" + token + "/../" + token + "/", s.host()).first == 404);
  CHECK(answer(s, "/" + token + "/save?as=exe", s.host()).first == 404);
  CHECK(answer(s, "/" + token + "/", s.host(), beast::http::verb::post).first == 405);
  // A name that resolves to this machine is no proof; nor is another port, or none.
  for (const std::string& host : {"evil.example:" + std::to_string(s.port()), std::string("127.0.0.1:1"),
                                  std::string("127.0.0.1"), std::string("")})
    CHECK(answer(s, "/" + token + "/", host).first == 403);
  const std::string live = "/" + token + "/live";
  CHECK(answer(s, live, s.host()).first == 426);
  for (const std::string origin : {"http://evil.example", "null", "https://127.0.0.1", ""})
    CHECK(answer(s, live, s.host(), beast::http::verb::get, "websocket", origin).first == 403);
  CHECK(
      answer(s, "/0123456789abcdee/live", s.host(), beast::http::verb::get, "websocket", "http://" + s.host()).first ==
      404);
  CHECK_THROWS_AS(Server({"127.0.0.1", s.port(), token, ""}, s.inbox), geo::InputError);
  CHECK_THROWS_AS(Server({"nowhere", 0, token, ""}, s.inbox), geo::InputError);
}

// Whether this machine has an interface for IPv6.
bool has_ipv6() {
  net::io_context io;
  tcp::acceptor acceptor(io);
  beast::error_code error;
  acceptor.open(tcp::v6(), error);
  if (!error) acceptor.bind({net::ip::make_address("::1"), 0}, error);
  return !error;
}

TEST_CASE("a server at all interfaces answers under each of its addresses") {
  for (const std::string address : {"0.0.0.0", "::"}) {
    if (address == "::" && !has_ipv6()) continue;
    Served s(address);
    const std::string port = ":" + std::to_string(s.port());
    CHECK(s.server.url() ==
          "http://" + std::string(address == "::" ? "[::1]" : "127.0.0.1") + port + "/" + token + "/");
    for (const std::string name : {"127.0.0.1", "localhost"})
      CHECK(answer(s, "/" + token + "/", name + port).first == 200);
    for (const std::string name : {"[::ffff:127.0.0.1]", "0.0.0.0", "[::1]"})  // the client has come to another one
      CHECK(answer(s, "/" + token + "/", name + port).first == 403);
  }
}

TEST_CASE("a stroke is late by the time that its begin has waited") {
  Inbox inbox;
  const auto before = std::chrono::steady_clock::now();
  for (const Phase phase : {Phase::begin, Phase::move, Phase::end}) inbox.put({7, Stroke{1, 1, phase}});
  inbox.put({7, Reset{}});
  inbox.put({7, Grab{}});
  inbox.put({7, Leave{}});
  const auto after = std::chrono::steady_clock::now();
  const auto requests = inbox.take();
  REQUIRE(requests.size() == 6);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    CHECK(is_late_stroke(requests[i], after + std::chrono::seconds(2), 2) == (i == 0));
    CHECK_FALSE(is_late_stroke(requests[i], before + std::chrono::seconds(2), 2.1));
  }
}

TEST_CASE("a page gets the whole state, then the newest of what follows, one message at a time") {
  Served s;
  s.server.publish(snapshot(1));
  Client a(s.server.url());
  CHECK(wait_for<Join>(s.inbox, 1)[0].page == 1);
  CHECK(a.next().kind == 1);
  CHECK(a.page.scene["name"] == "test");
  CHECK(a.page.triangles.size() == 3);
  CHECK(a.page.patch == std::vector<int>{0, 1, 200});
  for (std::uint64_t n = 2; n <= 50; ++n) s.server.publish(snapshot(n));
  CHECK_FALSE(a.has_message(100));  // not before it has confirmed
  a.acknowledge();
  CHECK(a.next().kind == 3);
  CHECK(a.page.statistics["number"] == 50);
  CHECK(a.page.positions[3][2] == Approx(50).epsilon(1e-4));
  a.send("{\"ack\":7}");  // of another message: nothing
  s.server.publish(snapshot(51, 2));
  CHECK_FALSE(a.has_message(100));
  a.acknowledge();
  CHECK(a.next().kind == 2);
  CHECK(a.page.triangles[2] == std::array<std::uint32_t, 3>{0, 0, 0});
  // A second page, while the first one is silent.
  Client b(s.server.url());
  CHECK(b.next().kind == 1);
  CHECK(b.page.statistics["number"] == 51);
  CHECK(b.page.triangles.size() == 2);
  b.acknowledge();
  s.server.publish(snapshot(52, 3));
  CHECK(b.next().kind == 2);
  CHECK(b.page.statistics["number"] == 52);
  CHECK_FALSE(a.has_message(50));
}

TEST_CASE("nodes, stress and graph go to the page that wants them") {
  Served s;
  auto full = [](std::uint64_t n) {
    auto x = snapshot(n);
    x->nodes = {{0, 0, 0.5}, {1, 2, 3}};
    x->stress = {10, 5};
    x->graph = std::make_shared<std::vector<std::pair<std::uint32_t, std::uint32_t>>>(1, std::pair(0u, 1u));
    x->graph_number = 1;
    return x;
  };
  s.server.publish(full(1));
  Client a(s.server.url());
  CHECK(a.next().node_positions.empty());
  CHECK_FALSE(s.server.wants_nodes());
  a.send(R"({"want":{"nodes":true,"stress":true,"graph":true}})");
  wait_for<Command>(s.inbox, 1);
  CHECK((s.server.wants_nodes() && s.server.wants_stress() && s.server.graphs_wanted() == 1));
  a.acknowledge();
  CHECK(a.next().kind == 4);
  CHECK(a.page.edges == std::vector<std::array<std::uint32_t, 2>>{{0, 1}});
  a.acknowledge();
  s.server.publish(full(2));
  CHECK(a.next().kind == 3);
  CHECK(a.page.node_positions[1][2] == Approx(3).epsilon(1e-3));
  CHECK(a.page.stress[1] == Approx(5).epsilon(1e-3));
  a.kill();
  wait_for<Leave>(s.inbox, 1);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (s.server.wants_nodes() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK_FALSE(s.server.wants_nodes());
}

TEST_CASE("a page is sent the graph as it is when asked, and none that another page has asked for before") {
  Served s;
  const auto with_graph = [](std::uint64_t n, std::uint32_t end) {
    auto x = snapshot(n);
    x->graph = std::make_shared<std::vector<std::pair<std::uint32_t, std::uint32_t>>>(1, std::pair(0u, end));
    x->graph_number = end;
    return x;
  };
  Client a(s.server.url());
  a.send(R"({"want":{"graph":true}})");
  wait_for<Command>(s.inbox, 1);
  s.server.publish(with_graph(1, 1));
  CHECK(a.next().kind == 4);
  Client b(s.server.url());
  CHECK(b.next().kind == 1);
  b.send(R"({"want":{"graph":true}})");
  wait_for<Command>(s.inbox, 1);
  CHECK(s.server.graphs_wanted() == 2);
  b.acknowledge();
  CHECK_FALSE(b.has_message(100));
  s.server.publish(with_graph(2, 2));
  CHECK(b.next().kind == 4);
  CHECK(b.page.edges == std::vector<std::array<std::uint32_t, 2>>{{0, 2}});
}

TEST_CASE("a page that sends too many messages is still sent frames") {
  Served s;
  s.server.publish(snapshot(1));
  Client a(s.server.url());
  CHECK(a.next().kind == 1);
  for (std::uint64_t n = 2; n <= 4; ++n) {
    const std::string confirmation = "{\"ack\":" + std::to_string(a.page.sequence) + "}";
    for (int i = 0; i < 300; ++i) a.send("{\"undo\":true}");
    a.send(confirmation);
    s.server.publish(snapshot(n));
    while (a.next().kind == 5) CHECK(a.page.notice.contains("error"));
    CHECK(a.page.statistics["number"] == n);
  }
}

TEST_CASE("hostile messages are refused with a reason, and the page goes on") {
  Served s;
  s.server.publish(snapshot(1));
  Client a(s.server.url());
  a.next();
  a.send("no JSON");
  CHECK(a.next().notice["error"] == "the message is no JSON");
  a.send("{\"undo\":true}", true);
  CHECK(a.next().notice["error"] == "a message is text, not bytes");
  a.send("{\"ack\":" + std::string(3000, '9') + "}");
  CHECK(a.next().notice.contains("error"));
  std::mt19937_64 random(5);
  const auto samples = sample_messages();
  for (int i = 0; i < 500; ++i) {  // more than are read in a second: the rest is left out
    std::string text = damaged_message(samples, random).substr(0, longest_message);
    for (char& c : text) c = static_cast<char>(c & 127);  // else no text: the connection ends
    a.send(text);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  a.send(R"({"set":{"gravity":[1,2]}})");
  bool limited = false;
  for (std::string reason; reason != "'set.gravity' must be three numbers";) {
    reason = a.next().notice["error"].get<std::string>();
    limited |= reason == "more than 240 messages a second are left out";
  }
  CHECK(limited);
  s.inbox.take();
  a.send("{\"step\":true}");
  CHECK(std::holds_alternative<Step>(std::get<Command>(wait_for<Command>(s.inbox, 1)[0].what)));
  // A frame of 1 GB, announced but not sent; one of 5000 bytes; text that is none.
  for (int kind = 0; kind < 3; ++kind) {
    Client b(s.server.url());
    b.next();
    std::string frame = kind == 0 ? std::string("\x81\xff\0\0\0\0\x40\0\0\0", 10) : std::string("\x81\xfe\x13\x88", 4);
    if (kind == 2) frame = std::string("\x81\x82", 2);
    frame += std::string("\0\0\0\0", 4);
    frame += kind == 2 ? std::string("\xff\xfe") : std::string(kind == 1 ? 5000 : 100000, 'x');
    beast::error_code ignored;
    net::write(b.socket(), net::buffer(frame), ignored);
    CHECK(b.is_closed());
  }
  s.server.publish(snapshot(2));
  Client c(s.server.url());
  CHECK(c.next().kind == 1);
  CHECK(c.page.statistics["number"] == 2);
}

TEST_CASE("twenty pages come and go, some of them killed") {
  Served s;
  s.server.publish(snapshot(1));
  for (std::uint64_t i = 1; i <= 20; ++i) {
    Client a(s.server.url());
    s.server.publish(snapshot(i + 1, static_cast<std::uint32_t>(i)));
    CHECK(a.next().kind == 1);
    a.acknowledge();
    if (i % 3 == 0) a.kill();
  }
  wait_for<Leave>(s.inbox, 20);
  Client last(s.server.url());
  CHECK(last.next().statistics["number"] == 21);
}

TEST_CASE("a saved file is asked of the simulation, and comes with a harmless name") {
  Served s;
  std::thread simulation([&] {
    auto requests = wait_for<Save>(s.inbox, 1);
    std::get<Save>(requests[0].what)
        .answer({.bytes = "bytes of " + std::get<Save>(requests[0].what).format, .name = "a b/c"});
    requests = wait_for<Save>(s.inbox, 1);
    std::get<Save>(requests[0].what).answer({.error = "no such thing"});
  });
  CHECK(answer(s, "/" + token + "/save?as=ply", s.host()) == std::pair<int, std::string>(200, "bytes of ply"));
  CHECK(answer(s, "/" + token + "/save?as=toml", s.host()).first == 500);
  simulation.join();
}

// The status and body of a POST. `announced`: size of its body by the header; 0: its own.
std::pair<int, std::string> posted(const Served& s, const std::string& target, const std::string& body,
                                   const std::string& origin, std::uint64_t announced = 0) {
  net::io_context io;
  tcp::socket socket(io);
  socket.connect({net::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(s.port())});
  beast::http::request<beast::http::string_body> request(beast::http::verb::post, target, 11);
  request.set(beast::http::field::host, s.host());
  request.set(beast::http::field::origin, origin);
  request.body() = body;
  request.prepare_payload();
  if (announced > 0) request.content_length(announced);
  beast::http::write(socket, request);
  beast::flat_buffer buffer;
  beast::http::response<beast::http::string_body> response;
  beast::http::read(socket, buffer, response);
  return {static_cast<int>(response.result_int()), response.body()};
}

TEST_CASE("a model is opened for the page itself only, and what is wrong with it is answered") {
  Served s;
  const std::string target = "/" + token + "/open?name=a%20b%2fc%zz.off", own = "http://" + s.host();
  CHECK(posted(s, target, "OFF", "http://evil.example").first == 403);
  CHECK(posted(s, "/0123456789abcdee/open?name=a", "OFF", own).first == 404);
  CHECK(posted(s, "/" + token + "/save?as=ply", "OFF", own).first == 405);
  CHECK(posted(s, target, "", own, std::uint64_t(1) << 29) ==
        std::pair<int, std::string>(413, "the file has more than 256 MB\n"));
  std::string name, bytes;
  std::vector<BesideFile> beside;
  std::thread simulation([&] {
    auto requests = wait_for<Open>(s.inbox, 1);
    auto& open = std::get<Open>(requests[0].what);
    name = open.model.name;
    bytes = open.model.bytes;
    beside = open.model.beside.value_or(std::vector<BesideFile>{});
    open.answer({});
    requests = wait_for<Open>(s.inbox, 1);
    std::get<Open>(requests[0].what).answer({.error = "a.off: is open"});
  });
  CHECK(posted(s, target + "&beside=a:99", "OFF 3", own).first == 400);
  CHECK(posted(s, target + "&beside=a", "OFF 3", own).first == 400);
  CHECK(posted(s, target + "&beside=m%20.mtl:2&beside=i:png:3", "OFF 3MLPNG", own).first == 200);
  CHECK(posted(s, target, "OFF", own) == std::pair<int, std::string>(422, "a.off: is open\n"));
  simulation.join();
  CHECK(name == "a b/c%zz.off");
  CHECK(bytes == "OFF 3");
  REQUIRE(beside.size() == 2);
  CHECK((beside[0].name == "m .mtl" && beside[0].bytes == "ML"));
  CHECK((beside[1].name == "i:png" && beside[1].bytes == "PNG"));
}

TEST_CASE("a page gets the whole state of another scene, and is told of the end") {
  std::optional<Served> s(std::in_place);
  s->server.publish(snapshot(1));
  Client page(s->server.url());
  CHECK(page.next().kind == 1);
  page.acknowledge();
  const auto scene = std::make_shared<std::string>("{\"name\":\"test\"}");
  const auto show = [&](std::uint64_t number) {
    auto next = snapshot(number);
    next->scene = scene;
    s->server.publish(next);
    const int kind = page.next().kind;
    page.acknowledge();
    return kind;
  };
  CHECK(show(2) == 1);
  CHECK(show(3) == 3);
  std::thread end([&] { s.reset(); });
  CHECK(page.closed_with() == 1001);
  end.join();
}

// The request of a file that a page asks for, which has not been answered.
Request asked_file(Served& s, tcp::socket& page) {
  page.connect({net::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(s.port())});
  beast::http::request<beast::http::empty_body> request(beast::http::verb::get, "/" + token + "/save?as=ply", 11);
  request.set(beast::http::field::host, s.host());
  beast::http::write(page, request);
  return std::move(wait_for<Save>(s.inbox, 1).at(0));
}

// Whether the other end closes the connection within 20 seconds: then nothing more can be written.
bool is_closed_by_other_end(tcp::socket& page) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  for (beast::error_code error; std::chrono::steady_clock::now() < end;) {
    net::write(page, net::buffer("x", 1), error);
    if (error) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST_CASE("the request of a file keeps no connection open and may outlive the server") {
  net::io_context io;
  tcp::socket page(io);
  std::optional<Served> s(std::in_place);
  const Request request = asked_file(*s, page);
  SECTION("answered") {
    std::get<Save>(request.what).answer({.bytes = "bytes"});
    beast::flat_buffer buffer;
    beast::http::response<beast::http::string_body> response;
    beast::http::read(page, buffer, response);
    CHECK(response.body() == "bytes");
  }
  SECTION("never answered") { s.reset(); }
  CHECK(is_closed_by_other_end(page));
}

TEST_CASE("a move takes the place of the move before it and keeps the path, and nothing is put behind a full queue") {
  Inbox inbox;
  const auto stroke = [](std::uint64_t id, Phase phase, double x) {
    Stroke s;
    s.id = id;
    s.phase = phase;
    s.origin = {x, 0, 0};
    return s;
  };
  inbox.put({1, Command(stroke(1, Phase::begin, 0))});
  for (int i = 1; i < 9; ++i) {
    inbox.put({1, Command(stroke(1, Phase::move, i))});
    inbox.put({2, Command(stroke(1, Phase::move, -i))});
  }
  inbox.put({1, Command(Undo{})});
  inbox.put({1, Command(stroke(1, Phase::move, 9))});
  inbox.put({1, Command(stroke(1, Phase::end, 10))});
  const auto all = inbox.take();
  REQUIRE(all.size() == 6);
  CHECK(std::get<Stroke>(std::get<Command>(all[1].what)).origin.x() == 8);
  CHECK(std::get<Stroke>(std::get<Command>(all[2].what)).origin.x() == -8);
  const auto& way = std::get<Stroke>(std::get<Command>(all[1].what)).way;
  REQUIRE(way.size() == 7);
  for (int i = 1; i < 8; ++i) CHECK(way[static_cast<std::size_t>(i - 1)].origin.x() == i);
  for (int i = 0; i < 2000; ++i) inbox.put({1, Command(Undo{})});
  CHECK_FALSE(inbox.put({1, Command(Undo{})}));
  CHECK(inbox.put({1, Leave{}}));
  CHECK(inbox.take().size() == 1025);
}
