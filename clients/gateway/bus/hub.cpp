// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/hub.h"

#include <chrono>
#include <utility>

#include "gateway/bus/hub_tab.h"

namespace dts::gateway {
namespace {

constexpr std::chrono::milliseconds kWishPause{200};
constexpr std::chrono::seconds kLongestStatus{5};  // the daemon publishes it every second

TabQueue::Dropped sum(const TabQueue::Dropped& one, const TabQueue::Dropped& other) {
  return {.blocks = one.blocks + other.blocks, .scans = one.scans + other.scans, .events = one.events + other.events};
}

}  // namespace

std::int64_t own_host_time() {  // steady_clock is CLOCK_MONOTONIC, like host times
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Hub::Hub(boost::asio::io_context& io, CommandPool* commands, std::function<void(std::vector<std::string>)> want, std::string version,
         HostClock clock)
    : io_(io), commands_(commands), want_(std::move(want)), version_(std::move(version)), clock_(std::move(clock)), timer_(io) {}

Hub::~Hub() = default;

void Hub::handle(const BusItem& item) {
  if (const auto* message = std::get_if<CarriedPointer>(&item)) {
    keep(*message);
    for (HubTab* tab : tabs_) tab->push(*message);
    return;
  }
  link_ = std::get<v1::Link>(item);
  for (HubTab* tab : tabs_) tab->send_link(link_);
}

/// Keeps retained messages; drops those of a daemon that was restarted.
void Hub::keep(const CarriedPointer& message) {
  if (message->instance_id != instance_id_) {
    retained_.clear();
    retained_bytes_ = 0;
  }
  instance_id_ = message->instance_id;
  if (message->is_retained) retain(message);
  if (message->topic == kStatusTopic) status_received_at_ = std::chrono::steady_clock::now();
}

/// A message that does not fit is not kept: later subscribers get the next one of its topic.
void Hub::retain(const CarriedPointer& message) {
  if (const auto known = retained_.find(message->topic); known != retained_.end()) {
    retained_bytes_ -= known->second->bytes.size();
    retained_.erase(known);
  }
  if (retained_.size() >= kMostRetained || retained_bytes_ + message->bytes.size() > kMostRetainedBytes) return;
  retained_bytes_ += message->bytes.size();
  retained_[message->topic] = message;
}

std::unique_ptr<Tab> Hub::open_tab(const Identity& identity, TabConnection& connection) {
  auto tab = std::make_unique<HubTab>(*this, io_, commands_, identity, connection);
  tab->welcome(version_, link_);
  tabs_.insert(tab.get());
  return tab;
}

void Hub::close_tab(HubTab& tab) {
  tabs_.erase(&tab);
  dropped_for_closed_ = sum(dropped_for_closed_, tab.dropped());
  send_wishes();
}

CarriedPointer Hub::status(std::chrono::steady_clock::time_point now) const {
  const auto known = retained_.find(std::string(kStatusTopic));
  const bool is_fresh = now - status_received_at_ <= kLongestStatus;
  return link_.is_up() && is_fresh && known != retained_.end() ? known->second : nullptr;
}

TabQueue::Dropped Hub::dropped() const {
  TabQueue::Dropped all = dropped_for_closed_;
  for (const HubTab* tab : tabs_) all = sum(all, tab->dropped());
  return all;
}

void Hub::wishes_changed(HubTab& tab) {
  for (const auto& [topic, message] : retained_) tab.push(message);
  send_wishes();
}

void Hub::send_wishes() {
  if (is_sending_later_) return;
  if (!wish_sends_.take(std::chrono::steady_clock::now())) return send_wishes_later();
  std::set<std::string> together;
  for (const HubTab* tab : tabs_) together.insert(tab->prefixes().begin(), tab->prefixes().end());
  if (together == wishes_) return;
  wishes_ = together;
  want_({together.begin(), together.end()});
}

void Hub::send_wishes_later() {
  is_sending_later_ = true;
  timer_.expires_after(kWishPause);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    is_sending_later_ = false;
    send_wishes();
  });
}

}  // namespace dts::gateway
