// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/result.h"
#include "record/catalogue/catalogue.h"

namespace dts::session {

/// Returns true if some trial of the session has a computed result. In such a session, a trial without a result cannot be done.
[[nodiscard]] bool has_trial_results(const record::SessionRow& session);

/// Computes the results of a session from the results of those trials that are done after corrections, for each part, as at the session's
/// end. A reach keeps the class that it had at that time: whether the subject's own scale was used does not change. Fails with DataDamaged
/// if the result of a trial cannot be read. Thread: any.
[[nodiscard]] core::Result<std::vector<record::ResultRow>> corrected_results(const record::SessionRow& session);

}  // namespace dts::session
