// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/exposition.h"

#include <prometheus/text_serializer.h>

#include <algorithm>

namespace dts::gateway {

void Exposition::gauge(const Described& what, double value, const MetricLabels& labels) {
  add(what, prometheus::MetricType::Gauge, labels).gauge.value = value;
}

void Exposition::counter(const Described& what, double value, const MetricLabels& labels) {
  add(what, prometheus::MetricType::Counter, labels).counter.value = value;
}

void Exposition::histogram(const Described& what, prometheus::ClientMetric::Histogram histogram, const MetricLabels& labels) {
  add(what, prometheus::MetricType::Histogram, labels).histogram = std::move(histogram);
}

std::string Exposition::text() const { return prometheus::TextSerializer().Serialize(families_); }

prometheus::ClientMetric& Exposition::add(const Described& what, prometheus::MetricType type, const MetricLabels& labels) {
  auto family = std::ranges::find(families_, what.name, &prometheus::MetricFamily::name);
  if (family == families_.end()) {
    families_.push_back({.name = what.name, .help = what.help, .type = type, .metric = {}});
    family = families_.end() - 1;
  }
  prometheus::ClientMetric& metric = family->metric.emplace_back();
  for (const auto& [name, value] : labels) metric.label.push_back({.name = name, .value = value});
  return metric;
}

}  // namespace dts::gateway
