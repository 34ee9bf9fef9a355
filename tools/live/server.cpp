// One connection is one request, or one page's WebSocket. All state but the slot of the latest
// snapshot belongs to the network thread.
#include "live/server.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <charconv>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <kerf/error.h>
#include "live/page_view.h"
#include "live/save.h"

namespace live {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
namespace net = boost::asio;
using tcp = net::ip::tcp;
using beast::error_code;
using Socket = beast::tcp_stream;
using HttpRequest = http::request<http::string_body>;
using HttpResponse = http::response<http::string_body>;

namespace {

constexpr int max_connections = 64, max_messages = 240;  // at a time; per second and page
constexpr auto request_time = std::chrono::seconds(10);
constexpr auto farewell_time = std::chrono::milliseconds(500);  // for pages to hear of the end
constexpr std::uint64_t largest_model = 256 << 20;              // bytes of a file that a page opens

// Whether two texts are equal, in a time that depends on their lengths only.
bool same_secret(std::string_view a, std::string_view b) {
  unsigned different = a.size() != b.size();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) different |= static_cast<unsigned char>(a[i] ^ b[i]);
  return different == 0;
}

// The address of an interface as clients write it: IPv4 in IPv6 is IPv4.
net::ip::address plain_address(const net::ip::address& address) {
  const bool mapped = address.is_v6() && address.to_v6().is_v4_mapped();
  return mapped ? net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6()) : address;
}

std::string host_name(const net::ip::address& address) {
  return address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
}

// Whether a request's host is a name with a port. Clients leave out HTTP's own port.
bool is_host(std::string_view host, const std::string& name, int port) {
  return host == name + ":" + std::to_string(port) || (port == 80 && host == name);
}

// A file name without characters that mean anything to a shell or a browser.
std::string plain_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return c > 126 || !(std::isalnum(c) || c == '-' || c == '_' || c == '.'); }, '_');
  constexpr std::size_t longest = 80;
  return name.empty() ? "body" : name.size() <= longest ? name : name.substr(name.size() - longest);  // with its ending
}

// Text of an address, whose %XX are bytes.
std::string unescaped(std::string_view text) {
  const auto digit = [](char c) { return std::string_view("0123456789abcdef").find(char(std::tolower(c))); };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_escape = text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) < 16 && digit(text[i + 2]) < 16;
    result += is_escape ? static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2])) : text[i];
    i += is_escape ? 2 : 0;
  }
  return result;
}

// The files of a request to open a model, "/open?name=NAME&beside=NAME:BYTES&…". The body has the
// model, then those beside it, in this order. Nothing where their sizes do not fit.
std::optional<ModelFile> model_of(std::string_view target, std::string body) {
  constexpr std::string_view mark = "&beside=";
  const auto begin = target.find("name=") + 5, end = target.find(mark, begin);
  ModelFile model{.name = unescaped(target.substr(begin, end - begin))};
  std::vector<BesideFile>& beside = model.beside.emplace();
  std::vector<std::size_t> sizes;
  std::size_t total = 0;
  for (auto at = end; at != target.npos; at = target.find(mark, at + 1)) {
    const auto rest = target.substr(at + mark.size(), target.find(mark, at + 1) - at - mark.size());
    const auto colon = rest.rfind(':');
    std::size_t size = 0;
    const auto* last = rest.data() + rest.size();
    if (colon == rest.npos || std::from_chars(rest.data() + colon + 1, last, size).ptr != last || size > body.size())
      return {};
    beside.push_back({unescaped(rest.substr(0, colon)), {}});
    sizes.push_back(size);
    total += size;
  }
  if (total > body.size()) return {};
  std::size_t at = body.size() - total;
  for (std::size_t i = 0; i < sizes.size(); at += sizes[i++]) beside[i].bytes = body.substr(at, sizes[i]);
  body.resize(body.size() - total);
  model.bytes = std::move(body);
  return model;
}

}  // namespace

struct Server::Impl {
  Impl(const ServerOptions& options_in, Inbox& inbox_in) : options(options_in), inbox(inbox_in) {}
  void listen();
  void accept();
  void accept_later();
  void close();
  void end_when_alone();
  bool right_host(std::string_view host, const tcp::socket& socket) const;
  void deliver();
  // Continues the visit that waits by this number.
  template <class Work>
  void pass_on(std::uint64_t number, Work work);

  ServerOptions options;
  Inbox& inbox;
  int port = 0;
  class Link;
  class Visit;
  std::map<ClientId, std::weak_ptr<Link>> links;
  ClientId last_id = 0;
  int connections = 0;
  bool ends = false;
  std::shared_ptr<const Snapshot> latest;
  std::atomic<int> nodes_wanted{0}, stress_wanted{0};
  std::atomic<std::uint64_t> graphs_wanted{0};
  std::mutex slot_mutex;
  std::shared_ptr<const Snapshot> slot;  // published, not yet delivered
  // Last: handlers that are destroyed with it own links, which use the members above.
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  net::steady_timer retry{io};
  // Visits that wait for a file, by number. The network thread alone uses them.
  std::map<std::uint64_t, std::shared_ptr<Visit>> waiting;
  std::uint64_t last_file = 0;
  std::thread thread;
};

// The WebSocket of a page.
class Server::Impl::Link : public std::enable_shared_from_this<Link> {
 public:
  Link(Impl& hub, Socket socket) : hub_(hub), id_(++hub.last_id), view_(id_), ws_(std::move(socket)) {}
  ~Link() {
    want_nodes(false);
    want_stress(false);
    hub_.links.erase(id_);
    if (joined_) hub_.inbox.put({id_, Leave{}});
    --hub_.connections;
    if (hub_.ends) hub_.end_when_alone();
  }

  void start(const HttpRequest& request) {
    ws_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    ws_.read_message_max(longest_message);
    ws_.auto_fragment(false);
    ws_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->hub_.links[self->id_] = self;
      self->joined_ = true;
      self->hub_.inbox.put({self->id_, Join{}});
      self->read();
      self->pump();
    });
  }
  void tell(std::string_view key, std::string_view sentence) {
    view_.tell(key, sentence);
    pump();
  }
  // Writes what there is to write, if the page is ready for it.
  void pump() {
    if (writing_ || !joined_) return;
    std::optional<std::string> message = view_.next(hub_.latest);
    if (!message) return;
    message_ = std::move(*message);
    writing_ = true;
    ws_.binary(true);
    ws_.async_write(net::buffer(message_), [self = shared_from_this()](error_code error, std::size_t) {
      self->writing_ = false;
      if (!error) self->pump();
    });
  }
  // Says goodbye, and closes the connection when the page has answered.
  void close() {
    if (!joined_) return;
    joined_ = false;
    ws_.async_close({websocket::close_code::going_away, "kerf-live has ended"},
                    [self = shared_from_this()](error_code) {
                      error_code ignored;
                      beast::get_lowest_layer(self->ws_).socket().close(ignored);
                    });
  }

 private:
  void read() {
    ws_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->finish();
      self->take();
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }
  // No more can be read: nothing more is written.
  void finish() { joined_ ? leave() : void(); }
  void leave() {
    joined_ = false;
    hub_.inbox.put({id_, Leave{}});
    hub_.links.erase(id_);
    error_code ignored;
    beast::get_lowest_layer(ws_).socket().close(ignored);
  }
  void take() {
    if (acknowledges() || !within_rate()) return;
    if (!ws_.got_text()) return tell("error", "a message is text, not bytes");
    try {
      const auto data = buffer_.data();
      obey(read_command({static_cast<const char*>(data.data()), data.size()}));
    } catch (const BadMessage& e) {
      tell("error", e.what());
    }
  }
  // Takes an acknowledgement, which is short. None is left out, since no frame would follow.
  bool acknowledges() {
    constexpr std::size_t longest = 64;
    if (buffer_.size() > longest || !ws_.got_text()) return false;
    try {
      const auto data = buffer_.data();
      const Command command = read_command({static_cast<const char*>(data.data()), data.size()});
      const auto* ack = std::get_if<Acknowledge>(&command);
      if (ack) acknowledged(ack->sequence);
      return ack != nullptr;
    } catch (const BadMessage&) {
      return false;
    }
  }
  bool within_rate() {
    const auto now = std::chrono::steady_clock::now();
    if (now - second_ > std::chrono::seconds(1)) {
      second_ = now;
      messages_ = 0;
    }
    if (++messages_ == max_messages + 1) tell("error", "more than 240 messages a second are left out");
    return messages_ <= max_messages;
  }
  void acknowledged(std::uint32_t sequence) {
    view_.acknowledged(sequence);
    pump();
  }
  void obey(Command command) {
    if (const auto* ack = std::get_if<Acknowledge>(&command)) return acknowledged(ack->sequence);
    if (const auto* want = std::get_if<Want>(&command)) {
      if (want->nodes) want_nodes(*want->nodes);
      if (want->stress) want_stress(*want->stress);
      if (want->rest) view_.want_rest(*want->rest);
      if (want->graph) view_.ask_graph(++hub_.graphs_wanted);
    }
    if (!hub_.inbox.put({id_, std::move(command)})) tell("error", "the simulation is busy; the message is left out");
  }
  void want_nodes(bool on) { hub_.nodes_wanted += int(on) - int(std::exchange(view_.nodes, on)); }
  void want_stress(bool on) { hub_.stress_wanted += int(on) - int(std::exchange(view_.stress, on)); }

  Impl& hub_;
  ClientId id_;
  PageView view_;
  websocket::stream<Socket> ws_;
  beast::flat_buffer buffer_;
  std::string message_;
  bool joined_ = false, writing_ = false;
  std::chrono::steady_clock::time_point second_;
  int messages_ = 0;
};

// A connection up to the answer of its request.
class Server::Impl::Visit : public std::enable_shared_from_this<Visit> {
 public:
  Visit(Impl& hub, tcp::socket socket) : hub_(hub), socket_(std::move(socket)) { ++hub_.connections; }
  ~Visit() {
    if (!upgraded_) --hub_.connections;
  }
  void start() {
    parser_.header_limit(8192);
    parser_.body_limit(largest_model);
    socket_.expires_after(request_time);
    http::async_read_header(socket_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == http::error::body_limit) return self->refuse_size();
      if (!error) self->answer();
    });
  }

 private:
  static std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }
  void answer() {
    const HttpRequest& request = parser_.get();
    const std::string_view host = view(request[http::field::host]), target = view(request.target());
    if (!hub_.right_host(host, socket_.socket())) return send(http::status::forbidden, "wrong host");
    const auto slash = target.find('/', 1);
    if (target.empty() || slash == target.npos || !same_secret(target.substr(1, slash - 1), hub_.options.token))
      return send(http::status::not_found, "not here; use the address that kerf-live has printed");
    const std::string_view rest = target.substr(slash);
    if (request.method() == http::verb::post && rest.starts_with("/open?name=")) return receive(host);
    if (request.method() != http::verb::get) return send(http::status::method_not_allowed, "GET only");
    if (rest == "/live") return upgrade(host);
    if (rest == "/") return send(http::status::ok, hub_.options.page, "text/html; charset=utf-8");
    if (rest.starts_with("/save?as=")) return save(std::string(rest.substr(9)));
    send(http::status::not_found, "not here");
  }
  void upgrade(std::string_view host) {
    const HttpRequest& request = parser_.get();
    if (!websocket::is_upgrade(request)) return send(http::status::upgrade_required, "a WebSocket is expected");
    if (view(request[http::field::origin]) != "http://" + std::string(host))
      return send(http::status::forbidden, "wrong origin");
    upgraded_ = true;
    socket_.expires_never();
    error_code ignored;
    socket_.socket().set_option(tcp::no_delay(true), ignored);
    std::make_shared<Link>(hub_, std::move(socket_))->start(request);
  }
  // The body of a request is read only where it is a model from the page itself.
  void receive(std::string_view host) {
    if (view(parser_.get()[http::field::origin]) != "http://" + std::string(host))
      return send(http::status::forbidden, "wrong origin");
    socket_.expires_after(request_time * 6);
    http::async_read(socket_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == http::error::body_limit) return self->refuse_size();
      if (!error) self->open();
    });
  }
  void refuse_size() {
    send(http::status::payload_too_large, "the file has more than " + std::to_string(largest_model >> 20) + " MB");
  }
  void open() {
    const std::string target(view(parser_.get().target()));
    std::optional<ModelFile> model = model_of(target, std::move(parser_.get().body()));
    if (!model) return send(http::status::bad_request, "the sizes of the files beside the model do not fit");
    const auto number = wait();
    Open open{std::move(*model), [hub = &hub_, number](Answer answer) {
                hub->pass_on(number, [answer = std::move(answer)](Visit& visit) {
                  if (answer.error.empty()) return visit.send(http::status::ok, "opened");
                  visit.send(http::status::unprocessable_entity, answer.error);
                });
              }};
    give(number, std::move(open));
  }
  // Waits for an answer of the simulation, by this number. The simulation thread drops its answer,
  // perhaps after the server has gone: it owns no visit.
  std::uint64_t wait() {
    socket_.expires_never();
    hub_.waiting[++hub_.last_file] = shared_from_this();
    return hub_.last_file;
  }
  template <class Order>
  void give(std::uint64_t number, Order order) {
    if (hub_.inbox.put({0, std::move(order)})) return;
    hub_.waiting.erase(number);
    send(http::status::service_unavailable, "the simulation is busy");
  }
  void save(const std::string& format) {
    if (!is_save_format(format)) return send(http::status::not_found, save_formats);
    const auto number = wait();
    Save save{format, [hub = &hub_, number](Answer answer) {
                hub->pass_on(
                    number, [answer = std::move(answer)](Visit& visit) mutable { visit.send_file(std::move(answer)); });
              }};
    give(number, std::move(save));
  }
  void send_file(Answer answer) {
    if (!answer.error.empty()) return send(http::status::internal_server_error, answer.error);
    file_ = plain_name(answer.name);
    send(http::status::ok, std::move(answer.bytes), "application/octet-stream");
  }
  void send(http::status status, std::string body, const std::string& type = "text/plain; charset=utf-8") {
    response_ = HttpResponse(status, 11);
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Content-Security-Policy",
                  "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
                  "connect-src 'self' ws:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
    if (!file_.empty()) response_.set(http::field::content_disposition, "attachment; filename=\"" + file_ + "\"");
    response_.keep_alive(false);
    response_.body() = std::move(body);
    if (type.starts_with("text/plain")) response_.body() += '\n';
    response_.prepare_payload();
    socket_.expires_after(request_time * 6);
    http::async_write(socket_, response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->socket_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Impl& hub_;
  Socket socket_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  HttpResponse response_;
  std::string file_;
  bool upgraded_ = false;
};

// Called on any thread, while the server lives.
template <class Work>
void Server::Impl::pass_on(std::uint64_t number, Work work) {
  net::post(io, [this, number, work = std::move(work)]() mutable {
    const auto visit = waiting.extract(number);
    if (visit) work(*visit.mapped());
  });
}

void Server::Impl::listen() {
  const std::string place = options.address + ":" + std::to_string(options.port);
  error_code error;
  const auto address = net::ip::make_address(options.address, error);
  if (error) throw geo::InputError(options.address + ": is no address of an interface, such as 127.0.0.1");
  const tcp::endpoint endpoint(address, static_cast<std::uint16_t>(options.port));
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(net::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
  if (error)
    throw geo::InputError(place + ": cannot listen there: " + error.message() + "; give another --address or --port");
  port = acceptor.local_endpoint().port();
  accept();
}

void Server::Impl::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (error) return accept_later();
    if (connections < max_connections) std::make_shared<Visit>(*this, std::move(socket))->start();
    accept();
  });
}

// A process without free file descriptors cannot accept: an attempt at once would fail again.
void Server::Impl::accept_later() {
  retry.expires_after(std::chrono::milliseconds(100));
  retry.async_wait([this](error_code error) {
    if (!error && acceptor.is_open()) accept();
  });
}

// A name that resolves here is no proof of where a page came from: only addresses, and localhost.
bool Server::Impl::right_host(std::string_view host, const tcp::socket& socket) const {
  error_code error;
  const auto local = socket.local_endpoint(error);
  if (error) return false;
  const auto address = plain_address(local.address());
  return is_host(host, host_name(address), port) || (address.is_loopback() && is_host(host, "localhost", port));
}

void Server::Impl::deliver() {
  {
    const std::lock_guard lock(slot_mutex);
    latest = std::exchange(slot, nullptr);
  }
  std::vector<std::shared_ptr<Link>> all;
  for (const auto& [id, link] : links)
    if (auto alive = link.lock()) all.push_back(std::move(alive));
  for (const auto& link : all) link->pump();
}

void Server::Impl::close() {
  error_code ignored;
  acceptor.close(ignored);
  std::vector<std::shared_ptr<Link>> all;
  for (const auto& [id, link] : links)
    if (auto alive = link.lock()) all.push_back(std::move(alive));
  for (const auto& link : all) link->close();
  all.clear();
  retry.expires_after(farewell_time);
  retry.async_wait([this](error_code) { io.stop(); });
  end_when_alone();
}

// Without links there is no page to wait for.
void Server::Impl::end_when_alone() {
  ends = true;
  if (links.empty()) io.stop();
}

Server::Server(const ServerOptions& options, Inbox& inbox) : impl_(std::make_unique<Impl>(options, inbox)) {
  impl_->listen();
  impl_->thread = std::thread([io = &impl_->io] { io->run(); });
}

Server::~Server() {
  net::post(impl_->io, [this] { impl_->close(); });
  impl_->thread.join();
}

std::string Server::url() const {
  const auto address = impl_->acceptor.local_endpoint().address();
  const auto shown = address.is_unspecified() ? net::ip::make_address(address.is_v6() ? "::1" : "127.0.0.1") : address;
  return "http://" + host_name(shown) + ":" + std::to_string(impl_->port) + "/" + impl_->options.token + "/";
}

void Server::publish(std::shared_ptr<const Snapshot> snapshot) {
  bool waits;
  {
    const std::lock_guard lock(impl_->slot_mutex);
    waits = impl_->slot != nullptr;
    impl_->slot = std::move(snapshot);
  }
  if (!waits) net::post(impl_->io, [impl = impl_.get()] { impl->deliver(); });
}

void Server::tell(ClientId page, const std::string& key, const std::string& sentence) {
  net::post(impl_->io, [impl = impl_.get(), page, key, sentence] {
    const auto at = impl->links.find(page);
    if (at == impl->links.end()) return;
    if (const auto link = at->second.lock()) link->tell(key, sentence);
  });
}

bool Server::wants_nodes() const { return impl_->nodes_wanted > 0; }
bool Server::wants_stress() const { return impl_->stress_wanted > 0; }
std::uint64_t Server::graphs_wanted() const { return impl_->graphs_wanted; }

}  // namespace live
