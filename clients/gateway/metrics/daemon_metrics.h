// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dts/v1/control.pb.h"
#include "gateway/metrics/exposition.h"

namespace dts::gateway {

/// What the daemon's status says, as metrics. No names of sessions or subjects: a monitor has no business with people.
void add_daemon(const v1::StatusSnapshot& status, Exposition& out);

}  // namespace dts::gateway
