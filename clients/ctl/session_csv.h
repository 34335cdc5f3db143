// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dts/v1/sessions.pb.h"

namespace dts::ctl {

/// Returns the values of all trials as CSV, one row for each trial and measure. Trials that are not valid have their values too: `outcome`
/// and `fault` say why. A trial without values has one row without a measure.
///
///     session_id,subject,protocol,part,trial,attempt,condition,outcome,fault,is_valid,measure,name,value,unit
///     20261121T144525Z-floor-1,P017,romberg,1,2,1,eyes-closed,rejected,,0,MVELO,Mean velocity,12.25,mm/s
[[nodiscard]] std::string trials_csv(const v1::SessionRecord& session);

}  // namespace dts::ctl
