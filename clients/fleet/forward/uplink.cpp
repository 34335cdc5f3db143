// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/uplink.h"

#include <algorithm>
#include <utility>

namespace dts::fleet::forward {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLookForEnd{100};

class LinkMailbox : public Mailbox {
 public:
  LinkMailbox(std::shared_ptr<link::Link> link, std::string address, std::unique_ptr<link::Subscription> letters)
      : link_(std::move(link)), address_(std::move(address)), letters_(std::move(letters)) {}

  const std::string& address() const override { return address_; }
  std::optional<link::Letter> next(milliseconds timeout) override { return letters_->next(timeout); }

 private:
  std::shared_ptr<link::Link> link_;
  std::string address_;
  std::unique_ptr<link::Subscription> letters_;
};

class LinkUplink : public Uplink {
 public:
  explicit LinkUplink(std::shared_ptr<link::Link> link) : link_(std::move(link)) {}

  bool is_connected() const override { return link_->is_connected(); }
  bool has_room() const override { return link_->has_room(); }
  std::uint64_t connections() const override { return link_->connections(); }
  std::string problem() const override { return link_->problem(); }
  core::Status publish(const link::Letter& letter) override { return link_->publish(letter); }
  core::Result<std::unique_ptr<Mailbox>> open_mailbox() override { return listen(link_->new_inbox()); }
  core::Result<std::unique_ptr<Mailbox>> listen(const std::string& subject) override {
    DTS_TRY_ASSIGN(auto letters, link_->subscribe(subject));
    return std::unique_ptr<Mailbox>(std::make_unique<LinkMailbox>(link_, subject, std::move(letters)));
  }

 private:
  std::shared_ptr<link::Link> link_;
};

}  // namespace

core::Result<std::unique_ptr<Uplink>> open_uplink(const link::LinkOptions& options, const core::Log& log) {
  DTS_TRY_ASSIGN(auto link, link::Link::open(options, log));
  return std::unique_ptr<Uplink>(std::make_unique<LinkUplink>(std::move(link)));
}

core::Result<std::string> ask(Uplink& uplink, const std::string& subject, std::string_view data, milliseconds timeout,
                              const std::stop_token& stop) {
  if (!uplink.is_connected()) return core::fail(core::ErrorCode::Unreachable, "no connection to the centre: " + uplink.problem());
  DTS_TRY_ASSIGN(const auto mailbox, uplink.open_mailbox());
  DTS_TRY(uplink.publish({.subject = subject, .reply = mailbox->address(), .data = std::string(data)}));
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!stop.stop_requested()) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left <= milliseconds(0)) return core::fail(core::ErrorCode::Timeout, "the centre does not answer");
    auto letter = mailbox->next(std::min(left, kLookForEnd));
    if (!letter) continue;
    if (letter->has_no_listener) return core::fail(core::ErrorCode::Unreachable, "no hub runs at the centre");
    return std::move(letter->data);
  }
  return core::fail(core::ErrorCode::Failed, "stopped");
}

}  // namespace dts::fleet::forward
