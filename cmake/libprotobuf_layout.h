// SPDX-License-Identifier: Apache-2.0
#pragma once

// Included before every file under -fsanitize=thread. protobuf's headers give maps two members more when the compiler says
// __SANITIZE_THREAD__ (map_field.h, MapFieldBase::seq1_); Debian's libprotobuf was built without them and reads such a map at the wrong
// offsets. The standard library, which has to know of the sanitizer, is asked first and has noted it (_GLIBCXX_TSAN).
#include <version>
#undef __SANITIZE_THREAD__
