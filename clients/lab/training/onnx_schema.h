// SPDX-License-Identifier: Apache-2.0
#pragma once

// The schema of ONNX as Debian's libonnx-dev has it: as namespace onnx, with the types of ONNX-ML, which its library is built with.
#define ONNX_ML 1
#define ONNX_NAMESPACE onnx
#include <onnx/onnx_pb.h>
