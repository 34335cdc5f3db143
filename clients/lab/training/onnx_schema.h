// SPDX-License-Identifier: Apache-2.0
#pragma once

// The ONNX schema of Debian's libonnx-dev: namespace onnx, with the types of ONNX-ML, because its library is built with them.
#define ONNX_ML 1
#define ONNX_NAMESPACE onnx
#include <onnx/onnx_pb.h>
