// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>
#include <zmq.hpp>

namespace dts::relay {

/// Receives a message without waiting; nothing if none is there. Keeps only the first `most` frames: one more than a message may have shows
/// that there are too many.
inline std::optional<std::vector<zmq::message_t>> receive_frames(zmq::socket_t& socket, std::size_t most) {
  std::vector<zmq::message_t> frames;
  bool has_more = true;
  while (has_more) {
    zmq::message_t frame;
    if (!socket.recv(frame, zmq::recv_flags::dontwait)) return std::nullopt;
    has_more = frame.more();
    if (frames.size() < most) frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace dts::relay
