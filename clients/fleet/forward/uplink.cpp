// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/uplink.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace dts::fleet::forward {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLookForEnd{100};

constexpr std::chrono::seconds kTryRejectedFirst{1};
constexpr std::chrono::seconds kTryRejectedLast{60};

class LinkMailbox : public Mailbox {
 public:
  LinkMailbox(std::shared_ptr<link::Link> link, std::string address, std::unique_ptr<link::Subscription> letters)
      : link_(std::move(link)), address_(std::move(address)), letters_(std::move(letters)) {}

  const std::string& address() const override { return address_; }
  std::optional<link::Letter> next(milliseconds timeout) override { return letters_->next(timeout); }

 private:
  std::shared_ptr<link::Link> link_;  ///< Outlives the subscription.
  std::string address_;
  std::unique_ptr<link::Subscription> letters_;
};

class LinkUplink : public Uplink {
 public:
  LinkUplink(link::LinkOptions options, core::Log log, std::shared_ptr<link::Link> link)
      : options_(std::move(options)), log_(std::move(log)), link_(std::move(link)) {}

  bool is_connected() const override { return current()->is_connected(); }
  std::uint64_t connections() const override {
    const auto link = current();
    const std::lock_guard lock(mutex_);
    return earlier_connections_ + link->connections();
  }
  std::string problem() const override { return current()->problem(); }
  core::Status publish(const link::Letter& letter) override { return current()->publish(letter); }
  core::Result<std::unique_ptr<Mailbox>> open_mailbox() override {
    auto link = current();
    std::string address = link->new_inbox();
    return open_at(std::move(link), std::move(address));
  }
  core::Result<std::unique_ptr<Mailbox>> listen(const std::string& subject) override { return open_at(current(), subject); }

 private:
  static core::Result<std::unique_ptr<Mailbox>> open_at(std::shared_ptr<link::Link> link, std::string address) {
    DTS_TRY_ASSIGN(auto letters, link->subscribe(address));
    return std::unique_ptr<Mailbox>(std::make_unique<LinkMailbox>(std::move(link), std::move(address), std::move(letters)));
  }
  /// Returns the connection; a rejected one is replaced when its time has come.
  std::shared_ptr<link::Link> current() const {
    const std::lock_guard lock(mutex_);
    if (link_->is_connected()) pause_ = kTryRejectedFirst;
    if (!link_->is_rejected()) return link_;
    const auto now = std::chrono::steady_clock::now();
    if (try_at_ == std::chrono::steady_clock::time_point()) try_at_ = now + pause_;
    if (now < try_at_) return link_;
    try_at_ = {};
    pause_ = std::min(2 * pause_, kTryRejectedLast);
    if (auto opened = link::Link::open(options_, log_)) {
      earlier_connections_ += link_->connections();
      link_ = std::move(*opened);
    }
    return link_;
  }

  link::LinkOptions options_;
  core::Log log_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<link::Link> link_;
  mutable std::uint64_t earlier_connections_ = 0;
  mutable std::chrono::steady_clock::time_point try_at_{};
  mutable std::chrono::seconds pause_ = kTryRejectedFirst;
};

}  // namespace

core::Result<std::unique_ptr<Uplink>> open_uplink(const link::LinkOptions& options, const core::Log& log) {
  DTS_TRY_ASSIGN(auto link, link::Link::open(options, log));
  return std::unique_ptr<Uplink>(std::make_unique<LinkUplink>(options, log, std::move(link)));
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
    if (letter->data.empty()) return core::fail(core::ErrorCode::Unreachable, "no hub runs at the centre");
    return std::move(letter->data);
  }
  return core::fail(core::ErrorCode::Failed, "stopped");
}

}  // namespace dts::fleet::forward
