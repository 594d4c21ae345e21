// SPDX-License-Identifier: Apache-2.0
// A variant measured in a process of its own: what it takes in memory is its own, and one that dies takes no other with it.
#pragma once

#include <functional>

#include "tools/study_table.h"

namespace sagitta::tools {

// The child starts as a copy of this process, with what `subject` knows; where it dies its end is the reason. Calls `waiting` a few
// times a second. Threads of this process must have ended.
MeasuredRow measure_apart(study::Subject& subject, const study::Variant& variant, const std::function<void()>& waiting);

}  // namespace sagitta::tools
