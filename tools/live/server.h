// HTTP and WebSocket for pages, on a thread of its own. Boost.Beast stays in the source.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "live/inbox.h"
#include "live/pages.h"

namespace live {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< of the interface to listen at
  int port = 0;                       ///< 0: a free one
  std::string token;                  ///< first part of every path
  std::string page;                   ///< HTML
};

/// Serves until it is destroyed, which tells all pages that it ends, and closes all connections.
class Server : public Pages {
 public:
  /// Listens, and starts the thread. Requests go to `inbox`, which must outlive the server. Throws
  /// geo::InputError for an address or port that cannot be listened at.
  Server(const ServerOptions& options, Inbox& inbox);
  ~Server() override;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// The address of the page.
  std::string url() const;
  void publish(std::shared_ptr<const Snapshot> snapshot) override;
  void tell(ClientId page, const std::string& key, const std::string& sentence) override;
  bool wants_nodes() const override;
  bool wants_stress() const override;
  std::uint64_t graphs_wanted() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace live
