// SPDX-License-Identifier: Apache-2.0
// sagitta schema: the JSON Schema of a prescription.
#include <fmt/core.h>

#include "lib/prescription/schema.h"
#include "tools/commands.h"

namespace sagitta::tools {

int schema_command() {
  fmt::print("{}", prescription::json_schema());
  return 0;
}

}  // namespace sagitta::tools
