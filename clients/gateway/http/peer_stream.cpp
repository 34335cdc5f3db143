// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/peer_stream.h"

#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace dts::gateway {

void PeerStream::async_handshake(EndHandler handler) {
  tls_->async_handshake(boost::asio::ssl::stream_base::server, std::move(handler));
}

void PeerStream::async_tls_shutdown(EndHandler handler) { tls_->async_shutdown(std::move(handler)); }

void PeerStream::read_some(FirstBuffers<boost::asio::mutable_buffer> buffers, IoHandler handler) {
  if (tls_) {
    tls_->async_read_some(buffers, std::move(handler));
  } else {
    tcp_->async_read_some(buffers, std::move(handler));
  }
}

void PeerStream::write_some(FirstBuffers<boost::asio::const_buffer> buffers, IoHandler handler) {
  if (tls_) {
    tls_->async_write_some(buffers, std::move(handler));
  } else {
    tcp_->async_write_some(buffers, std::move(handler));
  }
}

void PeerStream::tear_down(boost::beast::role_type role, EndHandler handler) {
  using boost::beast::websocket::async_teardown;
  if (tls_) {
    async_teardown(role, *tls_, std::move(handler));
  } else {
    async_teardown(role, *tcp_, std::move(handler));
  }
}

}  // namespace dts::gateway
