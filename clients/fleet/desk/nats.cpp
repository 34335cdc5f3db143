// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/nats.h"

#include <utility>

namespace dts::fleet::desk {
namespace {

constexpr std::chrono::seconds kPauseAfterRejection{5};

}  // namespace

Nats::Nats(link::LinkOptions options, core::Log log, std::shared_ptr<link::Link> link)
    : options_(std::move(options)), log_(std::move(log)), link_(std::move(link)) {}

core::Result<std::unique_ptr<Nats>> Nats::open(const link::LinkOptions& options, const core::Log& log) {
  DTS_TRY_ASSIGN(auto opened, link::Link::open(options, log));
  return std::unique_ptr<Nats>(new Nats(options, log, std::move(opened)));
}

std::shared_ptr<link::Link> Nats::link() {
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (link_->is_rejected() && now - opened_at_ >= kPauseAfterRejection) {
    opened_at_ = now;
    if (auto opened = link::Link::open(options_, log_)) link_ = std::move(*opened);
  }
  return link_;
}

}  // namespace dts::fleet::desk
