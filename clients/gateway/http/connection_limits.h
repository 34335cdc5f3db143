// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace dts::gateway {

/// Counts the connections, all together and by address.
class ConnectionLimits {
 public:
  /// The place of one connection; given back when it is destroyed.
  class Seat {
   public:
    Seat(ConnectionLimits& limits, std::string key) : limits_(&limits), key_(std::move(key)) {}
    Seat(Seat&& other) noexcept : limits_(std::exchange(other.limits_, nullptr)), key_(std::move(other.key_)) {}
    Seat& operator=(Seat&&) = delete;
    ~Seat() {
      if (limits_ != nullptr) limits_->give_back(key_);
    }

   private:
    ConnectionLimits* limits_;
    std::string key_;
  };

  ConnectionLimits(std::size_t most, std::size_t most_per_address) noexcept : most_(most), most_per_address_(most_per_address) {}

  /// Nothing: too many already. The seat must not outlive this object.
  [[nodiscard]] std::optional<Seat> take_seat(const boost::asio::ip::address& remote);
  [[nodiscard]] std::size_t taken() const noexcept { return taken_; }

 private:
  void give_back(const std::string& key) noexcept;

  std::size_t most_;
  std::size_t most_per_address_;
  std::size_t taken_ = 0;
  std::map<std::string, std::size_t> by_address_;
};

/// An IPv4 address that a socket of both families shows as ::ffff:1.2.3.4 as what it is.
[[nodiscard]] boost::asio::ip::address unmapped(const boost::asio::ip::address& address);
/// What counts as one address: an IPv6 host owns 2^64 of them, hence its /64; all of loopback; IPv4 however it is written.
[[nodiscard]] std::string counted_as(const boost::asio::ip::address& remote);
/// The same of an address as text; any other text is what it is.
[[nodiscard]] std::string counted_as(const std::string& remote);

}  // namespace dts::gateway
