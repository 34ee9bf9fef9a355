// A page of kerf-live without a screen, over a socket.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "page_model.h"

class Client {
 public:
  /// Connects to the address that kerf-live prints.
  explicit Client(const std::string& url) : ws_(io_) {
    const std::string host = url.substr(7, url.find('/', 7) - 7);
    const auto colon = host.rfind(':');
    ws_.next_layer().connect({boost::asio::ip::make_address(host.substr(0, colon)),
                              static_cast<std::uint16_t>(std::stoi(host.substr(colon + 1)))});
    ws_.next_layer().set_option(boost::asio::ip::tcp::no_delay(true));
    ws_.read_message_max(1u << 30);
    ws_.set_option(boost::beast::websocket::stream_base::decorator(
        [&](boost::beast::websocket::request_type& r) { r.set(boost::beast::http::field::origin, "http://" + host); }));
    ws_.handshake(host, url.substr(7 + host.size()) + "live");
  }
  /// The next message.
  PageModel& next() {
    boost::beast::flat_buffer buffer;
    ws_.read(buffer);
    bytes = buffer.size();
    page.take(boost::beast::buffers_to_string(buffer.data()));
    return page;
  }
  /// Whether bytes arrive within this time.
  bool has_message(int milliseconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds);
    while (ws_.next_layer().available() == 0 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return ws_.next_layer().available() > 0;
  }
  /// Sends a message.
  void send(const std::string& text, bool binary = false) {
    ws_.binary(binary);
    ws_.write(boost::asio::buffer(text));
  }
  /// Confirms the last message.
  void acknowledge() { send("{\"ack\":" + std::to_string(page.sequence) + "}"); }
  /// The connection below.
  boost::asio::ip::tcp::socket& socket() { return ws_.next_layer(); }
  /// Ends the connection without a word.
  void kill() { ws_.next_layer().close(); }
  /// Reads until the server ends the connection.
  bool is_closed() {
    boost::beast::flat_buffer buffer;
    boost::beast::error_code error;
    while (!error) ws_.read(buffer, error);
    return true;
  }
  /// Reads until the server ends the connection; the code that it gives.
  int closed_with() {
    is_closed();
    return ws_.reason().code;
  }

  PageModel page;
  std::size_t bytes = 0;  ///< of the last message

 private:
  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket> ws_;
};
