// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

namespace dts::core {

/// Blocks `signals` and ignores SIGPIPE. Call it before the first thread starts, so that every thread inherits the mask.
void block_signals(std::initializer_list<int> signals) noexcept;

/// Raises the limit of descriptors to the hard limit: libzmq 4.3.4 aborts the process if it cannot accept a connection for lack of
/// descriptors.
void raise_descriptor_limit() noexcept;

}  // namespace dts::core
