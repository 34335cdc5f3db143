// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/result.h"
#include "physics/cop/cop_estimator.h"

namespace dts::physics {

/// Returns the number of sensors of the form. Fails with InvalidArgument if the form belongs to another method, a count does not match, a
/// value is not finite or a range is empty: an estimator computes with every form that passes here.
[[nodiscard]] core::Result<std::size_t> check_form(CopMethod method, const CopForm& form, const CopValidity& validity);

}  // namespace dts::physics
