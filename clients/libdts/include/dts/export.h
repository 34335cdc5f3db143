// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks what libdts.so exports. Everything else in the library is hidden.
#define DTS_API __attribute__((visibility("default")))
