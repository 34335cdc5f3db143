// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dts/stream.h"

namespace dts::ctl {

/// A block of stream floor/cop with channels ml_mm and load_n that owns what it shows. `columns`: ml_mm then load_n.
struct CopBlock {
  explicit CopBlock(std::vector<float> columns) : values(std::move(columns)) {
    block.topic = "floor/cop";
    block.rig = "floor";
    block.stream = "cop";
    block.format = &format;
    block.segment = 3;
    block.first_scan = 40;
    block.scan_count = values.size() / 2;
    block.rate = format.rate;
    block.host_time_ns = 123'456'789'012;
    block.sequence = 9;
    block.values = values;
    block.quality = quality;
    body.set_instance_id(0xFFFF'FFFF'FFFF'FFFF);
    block.body = &body;
  }
  CopBlock(const CopBlock&) = delete;
  CopBlock& operator=(const CopBlock&) = delete;

  client::StreamFormat format{.name = "cop", .rate = {100, 1}, .channels = {{"ml_mm", "mm"}, {"load_n", "N"}}, .delay_ns = 0};
  std::vector<float> values;
  std::vector<std::uint8_t> quality{0, 0};
  v1::StreamBlock body;
  client::Block block;
};

}  // namespace dts::ctl
