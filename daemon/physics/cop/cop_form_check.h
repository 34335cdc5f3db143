// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/result.h"
#include "physics/cop/cop_estimator.h"

namespace dts::physics {

/// How many sensors the form is for. Fails with InvalidArgument when the form is another method's, a count does not fit, a value is not
/// finite or a range is empty: an estimator computes with whatever passes here.
[[nodiscard]] core::Result<std::size_t> check_form(CopMethod method, const CopForm& form, const CopValidity& validity);

}  // namespace dts::physics
