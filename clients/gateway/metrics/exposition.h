// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <prometheus/metric_family.h>

#include <string>
#include <utility>
#include <vector>

namespace dts::gateway {

/// Name and help text of a metric. The name has the base unit (seconds, bytes, ratio); the name of a counter ends in _total.
struct Described {
  const char* name;
  const char* help;
};

using MetricLabels = std::vector<std::pair<std::string, std::string>>;

/// The metrics of one scrape, family by family in the order in which they were first added.
class Exposition {
 public:
  void gauge(const Described& what, double value, const MetricLabels& labels = {});
  void counter(const Described& what, double value, const MetricLabels& labels = {});
  void histogram(const Described& what, prometheus::ClientMetric::Histogram histogram, const MetricLabels& labels = {});

  /// Prometheus' text format 0.0.4; label values are escaped.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] prometheus::ClientMetric& add(const Described& what, prometheus::MetricType type, const MetricLabels& labels);

  std::vector<prometheus::MetricFamily> families_;
};

}  // namespace dts::gateway
