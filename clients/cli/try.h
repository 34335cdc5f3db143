// SPDX-License-Identifier: Apache-2.0
#pragma once

// DTS_TRY and DTS_TRY_ASSIGN for the programs that use libdts: they accept the results of dts::client as well as those of dts::core.
#include "core/result.h"
