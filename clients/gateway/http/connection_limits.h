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

/// Counts the connections. A new one is a stranger's, counted by its address; it becomes a user's once its request says whose it is.
/// Strangers can neither take the places of users nor, from a user's own address, keep that user out: when there are too many, the oldest
/// of them goes. Thread: io.
class ConnectionLimits {
 public:
  struct Most {
    std::size_t all = 256;
    std::size_t strangers = 192;  ///< Of all: the others are kept for users.
    std::size_t per_address = 64;
    std::size_t per_user = 64;
  };

  /// The place of one connection; given back when it is destroyed, and at once when a stranger has to go.
  class Seat {
   public:
    Seat(ConnectionLimits& limits, std::uint64_t number) : limits_(&limits), number_(number) {}
    Seat(Seat&& other) noexcept : limits_(std::exchange(other.limits_, nullptr)), number_(other.number_), user_(std::move(other.user_)) {}
    Seat& operator=(Seat&&) = delete;
    ~Seat() {
      if (limits_ != nullptr) limits_->give_back(*this);
    }

    /// `leave` is called, once, when a newcomer needs the place of this stranger; never for a user.
    void on_eviction(std::function<void()> leave);
    /// From now on it is counted for `user`, no longer for its address. False, and nothing changes: that user has too many already.
    [[nodiscard]] bool belongs_to(const std::string& user);

   private:
    friend class ConnectionLimits;
    ConnectionLimits* limits_;
    std::uint64_t number_;
    std::string user_{};  ///< Empty: a stranger's.
  };

  explicit ConnectionLimits(const Most& most) noexcept : most_(most) {}

  /// Nothing: users have all places. The seat must not outlive this object.
  [[nodiscard]] std::optional<Seat> take_seat(const boost::asio::ip::address& remote);
  [[nodiscard]] std::size_t taken() const noexcept { return strangers_.size() + users_; }
  [[nodiscard]] std::uint64_t evicted_total() const noexcept { return evicted_total_; }

 private:
  struct Stranger {
    std::string address;
    std::function<void()> leave{};
  };
  using Strangers = std::map<std::uint64_t, Stranger>;  ///< By number: the oldest first.

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

/// An IPv4 address that a socket of both families shows as ::ffff:1.2.3.4 as what it is.
[[nodiscard]] boost::asio::ip::address unmapped(const boost::asio::ip::address& address);
/// What counts as one address: an IPv6 host owns 2^64 of them, hence its /64; all of loopback; IPv4 however it is written.
[[nodiscard]] std::string counted_as(const boost::asio::ip::address& remote);
/// The same of an address as text; any other text is what it is.
[[nodiscard]] std::string counted_as(const std::string& remote);

}  // namespace dts::gateway
