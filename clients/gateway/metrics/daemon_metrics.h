// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dts/v1/control.pb.h"
#include "gateway/metrics/exposition.h"

namespace dts::gateway {

/// Adds the daemon's status as metrics. Adds no names of sessions or subjects: a monitor must not see personal data.
void add_daemon(const v1::StatusSnapshot& status, Exposition& out);

}  // namespace dts::gateway
