// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "lab/training/network_json.h"

namespace dts::lab::training {

/// The model's general networks as ONNX (IR 8, operators 13, all numbers double): input "features" [n, k] as they are measured, output
/// "probability" [n, 3] of class 1 to 3. Scaling, averaging and temperature are part of the graph; rejection, own scale and angle are not.
[[nodiscard]] std::string onnx_text(const classifier::TrunkModel& model);

/// Networks of two fully connected layers each (Gemm, or MatMul and Add), tanh between, Sigmoid or Softmax behind; what stands before and
/// behind them is not looked at. Fails with InvalidArgument, naming the file and why.
[[nodiscard]] core::Result<ForeignNetworks> read_onnx(const std::string& file);

}  // namespace dts::lab::training
