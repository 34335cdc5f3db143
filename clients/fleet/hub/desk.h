// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "core/log.h"
#include "core/token_bucket.h"
#include "fleet/hub/clinic_list.h"
#include "fleet/hub/quota.h"
#include "fleet/link/link.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {

/// What all desks count. Thread: any.
struct DeskCounts {
  std::atomic<std::uint64_t> letters_total{0};
  std::atomic<std::uint64_t> rejected_total{0};  ///< Of revoked clinics, or with a reply subject that is not the clinic's.
  std::atomic<std::uint64_t> dropped_total{0};   ///< More letters waited than a subscription keeps.
};

/// A thread that answers the letters of one matter. The clinic is that of the subject, which nats-server has checked. What is more than the
/// clinic's quota is answered with "later", without being read.
class Desk {
 public:
  /// Returns the answer to a message of a clinic; nothing: there is none.
  using Handler = std::function<std::optional<std::string>(const std::string& clinic, std::string_view data, const std::stop_token& stop)>;

  struct Surroundings {
    link::Link& link;
    const ClinicList& clinics;
    MessageQuota& quota;
    DeskCounts& counts;
    const core::Log& log;
  };

  /// `worker`: of Chunk and Commit; the other matters are shared by all hubs. The objects in `around` must outlive the desk. Fails as
  /// Link::subscribe does.
  [[nodiscard]] static core::Result<std::unique_ptr<Desk>> open(const Surroundings& around, wire::Matter matter, const std::string& worker,
                                                                const std::string& thread_name, Handler handler);
  /// Asks the thread to end, without waiting.
  void request_stop() { thread_.request_stop(); }

 private:
  Desk(const Surroundings& around, wire::Matter matter, std::unique_ptr<link::Subscription> letters, Handler handler);
  void serve(const std::stop_token& stop);
  void answer(const link::Letter& letter, const std::stop_token& stop);
  /// Returns the answer to a message that is more than the clinic's quota.
  [[nodiscard]] std::optional<std::string> slow_down(const std::string& clinic);

  Surroundings around_;
  wire::Matter matter_;
  std::unique_ptr<link::Subscription> letters_;
  Handler handler_;
  core::TokenBucket warnings_{1.0};
  core::TokenBucket quota_warnings_{1.0 / 60.0, 1.0};
  std::jthread thread_{};  ///< Must be the last member: it uses the others.
};

}  // namespace dts::fleet::hub
