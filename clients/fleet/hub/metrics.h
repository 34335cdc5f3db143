// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>

#include "core/result.h"
#include "fleet/database/database.h"
#include "fleet/hub/desk.h"
#include "fleet/hub/ingest.h"
#include "fleet/hub/quota.h"

namespace dts::fleet::hub {

/// What this hub knows of itself.
struct HubState {
  IngestCounts counts;
  const DeskCounts& letters;
  std::map<std::string, std::uint64_t> slowed;  ///< Messages of each clinic that were more than its quota.
  const Store& store;
  const QuotaFigures& quota;
  bool is_connected = false;
};

/// Returns the state of the hub and of all clinics in Prometheus' text format. No names but those of clinics. The clinics are those of the
/// database; without it their lines are missing.
[[nodiscard]] std::string metrics_text(const HubState& hub, database::Database& database);

/// Answers "GET /metrics" on an address, one request at a time. Every other request is answered with 404, and a slow one is dropped.
class MetricsListener {
 public:
  /// Calls `text` on a thread of its own. Fails if the address cannot be bound.
  [[nodiscard]] static core::Result<std::unique_ptr<MetricsListener>> open(const std::string& address, std::uint16_t port,
                                                                           std::function<std::string()> text);
  ~MetricsListener();
  MetricsListener(const MetricsListener&) = delete;
  MetricsListener& operator=(const MetricsListener&) = delete;
  MetricsListener(MetricsListener&&) = delete;
  MetricsListener& operator=(MetricsListener&&) = delete;

  /// The port; of port 0 the one that the system chose.
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

 private:
  MetricsListener(int socket, std::uint16_t port, std::function<std::string()> text);
  void serve(const std::stop_token& stop);
  void answer(int peer) const;

  int socket_;
  std::uint16_t port_;
  std::function<std::string()> text_;
  std::jthread thread_{};  ///< Must be the last member: it uses the others.
};

}  // namespace dts::fleet::hub
