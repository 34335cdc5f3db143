// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/connection_limits.h"

#include <algorithm>

namespace dts::gateway {

boost::asio::ip::address unmapped(const boost::asio::ip::address& address) {
  if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address;
  return boost::asio::ip::make_address_v4(boost::asio::ip::v4_mapped, address.to_v6());
}

std::string counted_as(const boost::asio::ip::address& remote) {
  const auto address = unmapped(remote);
  if (address.is_loopback()) return "loopback";
  if (address.is_v4()) return address.to_string();
  auto network = address.to_v6().to_bytes();
  std::fill(network.begin() + 8, network.end(), static_cast<unsigned char>(0));
  return boost::asio::ip::address_v6(network).to_string();
}

std::string counted_as(const std::string& remote) {
  boost::system::error_code wrong;
  const auto address = boost::asio::ip::make_address(remote, wrong);
  return wrong ? remote : counted_as(address);
}

std::optional<ConnectionLimits::Seat> ConnectionLimits::take_seat(const boost::asio::ip::address& remote) {
  std::string key = counted_as(remote);
  const auto of_address = by_address_.find(key);
  if (of_address != by_address_.end() && of_address->second >= most_.per_address) {
    evict_oldest_of(key);
  } else if (!strangers_.empty() && (strangers_.size() >= most_.strangers || taken() >= most_.all)) {
    evict_oldest_of(std::string(most_crowded_address()));
  }
  if (taken() >= most_.all) return std::nullopt;
  ++by_address_[key];
  strangers_.emplace(++newest_, Stranger{.address = std::move(key)});
  return std::optional<Seat>(std::in_place, *this, newest_);
}

const std::string& ConnectionLimits::most_crowded_address() const {
  return std::ranges::max_element(by_address_, {}, &std::pair<const std::string, std::size_t>::second)->first;
}

void ConnectionLimits::evict_oldest_of(const std::string& address) {
  const auto oldest = std::ranges::find(strangers_, address, [](const auto& entry) { return entry.second.address; });
  if (oldest == strangers_.end()) return;
  const std::function<void()> leave = std::move(oldest->second.leave);
  forget(oldest);
  ++evicted_total_;
  if (leave) leave();
}

void ConnectionLimits::forget(Strangers::iterator stranger) noexcept {
  const auto of_address = by_address_.find(stranger->second.address);
  if (--of_address->second == 0) by_address_.erase(of_address);
  strangers_.erase(stranger);
}

void ConnectionLimits::give_back(const Seat& seat) noexcept {
  if (seat.user_.empty()) {
    if (const auto stranger = strangers_.find(seat.number_); stranger != strangers_.end()) forget(stranger);
    return;
  }
  --users_;
  const auto of_user = by_user_.find(seat.user_);
  if (--of_user->second == 0) by_user_.erase(of_user);
}

void ConnectionLimits::Seat::on_eviction(std::function<void()> leave) {
  const auto stranger = limits_->strangers_.find(number_);
  if (stranger != limits_->strangers_.end()) stranger->second.leave = std::move(leave);
}

bool ConnectionLimits::Seat::belongs_to(const std::string& user) {
  if (user_ == user) return true;
  const auto of_user = limits_->by_user_.find(user);
  const auto stranger = limits_->strangers_.find(number_);
  const bool is_stranger = user_.empty() && stranger != limits_->strangers_.end();
  const bool has_room = of_user == limits_->by_user_.end() || of_user->second < limits_->most_.per_user;
  if (!is_stranger || !has_room) return false;
  limits_->forget(stranger);
  ++limits_->users_;
  ++limits_->by_user_[user];
  user_ = user;
  return true;
}

}  // namespace dts::gateway
