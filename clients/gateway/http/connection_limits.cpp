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
  if (taken_ >= most_) return std::nullopt;
  std::string key = counted_as(remote);
  std::size_t& of_address = by_address_[key];
  if (of_address >= most_per_address_) return std::nullopt;
  ++of_address;
  ++taken_;
  return std::optional<Seat>(std::in_place, *this, std::move(key));
}

void ConnectionLimits::give_back(const std::string& key) noexcept {
  --taken_;
  const auto found = by_address_.find(key);
  if (found != by_address_.end() && --found->second == 0) by_address_.erase(found);
}

}  // namespace dts::gateway
