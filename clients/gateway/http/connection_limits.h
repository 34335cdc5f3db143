// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace dts::gateway {

/// Counts the connections. A new connection is a stranger and counts for its address; when its request identifies a user, it counts for
/// that user. Strangers cannot use up the places of users, and strangers at a user's own address cannot keep that user out: if there are
/// too many strangers, the oldest is closed. Thread: io.
class ConnectionLimits {
 public:
  struct Most {
    std::size_t all = 256;
    std::size_t strangers = 192;  ///< Part of `all`: the other places are reserved for users.
    std::size_t per_address = 64;
    std::size_t per_user = 64;
  };

  /// The place of one connection. Released when the object is destroyed, or at once when a stranger is evicted.
  class Seat {
   public:
    Seat(ConnectionLimits& limits, std::uint64_t number) : limits_(&limits), number_(number) {}
    Seat(Seat&& other) noexcept : limits_(std::exchange(other.limits_, nullptr)), number_(other.number_), user_(std::move(other.user_)) {}
    Seat& operator=(Seat&&) = delete;
    ~Seat() {
      if (limits_ != nullptr) limits_->give_back(*this);
    }

    /// Calls `leave`, once, when a new connection needs the place of this stranger; never for a user.
    void on_eviction(std::function<void()> leave);
    /// Counts this connection for `user` instead of its address. Returns false and changes nothing if that user has too many connections.
    [[nodiscard]] bool belongs_to(const std::string& user);

   private:
    friend class ConnectionLimits;
    ConnectionLimits* limits_;
    std::uint64_t number_;
    std::string user_{};  ///< Empty: a stranger.
  };

  explicit ConnectionLimits(const Most& most) noexcept : most_(most) {}

  /// Returns nothing if users hold all places. The seat must not outlive this object.
  [[nodiscard]] std::optional<Seat> take_seat(const boost::asio::ip::address& remote);
  [[nodiscard]] std::size_t taken() const noexcept { return strangers_.size() + users_; }
  [[nodiscard]] std::uint64_t evicted_total() const noexcept { return evicted_total_; }

 private:
  struct Stranger {
    std::string address;
    std::function<void()> leave{};
  };
  using Strangers = std::map<std::uint64_t, Stranger>;  ///< By number, so the oldest is first.

  void give_back(const Seat& seat) noexcept;
  void forget(Strangers::iterator stranger) noexcept;
  void evict_oldest_of(const std::string& address);
  [[nodiscard]] const std::string& most_crowded_address() const;

  Most most_;
  std::uint64_t newest_ = 0;
  std::uint64_t evicted_total_ = 0;
  Strangers strangers_;
  std::map<std::string, std::size_t> by_address_;
  std::size_t users_ = 0;
  std::map<std::string, std::size_t> by_user_;
};

/// Converts an IPv4-mapped IPv6 address, ::ffff:1.2.3.4, to the IPv4 address; other addresses stay unchanged.
[[nodiscard]] boost::asio::ip::address unmapped(const boost::asio::ip::address& address);
/// Returns the key under which an address is counted: for IPv6 its /64, because one host owns 2^64 addresses; one key for all of loopback;
/// the same key for an IPv4 address in both notations.
[[nodiscard]] std::string counted_as(const boost::asio::ip::address& remote);
/// The same for an address as text; any other text is returned unchanged.
[[nodiscard]] std::string counted_as(const std::string& remote);

}  // namespace dts::gateway
