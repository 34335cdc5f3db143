// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "lab/training/network_json.h"

namespace dts::lab::training {

/// Returns the model's general networks as ONNX (IR 8, operators 13, all numbers double): input "features" [n, k] as measured, output
/// "probability" [n, 3] of class 1 to 3. The graph includes scaling, averaging and temperature, but not rejection, own scale or angle.
[[nodiscard]] std::string onnx_text(const classifier::TrunkModel& model);

/// Reads networks of two fully connected layers each (Gemm, or MatMul and Add), with tanh between them and Sigmoid or Softmax after them.
/// Ignores the nodes before and after. Fails with InvalidArgument, naming the file and the reason.
[[nodiscard]] core::Result<ForeignNetworks> read_onnx(const std::string& file);

}  // namespace dts::lab::training
