// SPDX-License-Identifier: Apache-2.0
// CMake tells the version, the build and its libraries (SAGITTA_VERSION, SAGITTA_BUILD, SAGITTA_LIBRARIES, SAGITTA_PICTURE_LIBRARIES).
#include "tools/version.h"

#include <fmt/format.h>

#include "lib/numerics/instruction_set.h"
#include "lib/scene/delaunay.h"

namespace sagitta::tools {
namespace {

std::string instruction_sets() {
#if defined(SAGITTA_CHOOSES_INSTRUCTIONS)
  const auto& names = numerics::instruction_set_names;
  return fmt::format("{}; here {}", fmt::join(names, ", "), names[static_cast<std::size_t>(numerics::instruction_set())]);
#else
  return "the compiler's";
#endif
}

}  // namespace

const char* version() { return SAGITTA_VERSION; }

const char* build() { return SAGITTA_BUILD; }

std::string about_this_build() {
  const std::string_view triangulator = scene::triangulator();
  return fmt::format("sagitta {}\n"
                     "build             {}\n"
                     "instruction sets  {}\n"
                     "delaunay          {}\n"
                     "libraries         {}\n"
                     "for pictures      {}\n"
                     "licence           {}",
                     version(), SAGITTA_BUILD, instruction_sets(), triangulator.empty() ? "no: without CGAL" : fmt::format("by {}", triangulator),
                     SAGITTA_LIBRARIES, SAGITTA_PICTURE_LIBRARIES,
                     triangulator.empty() ? "Apache-2.0" : "GPL-3.0-or-later as a whole, as CGAL's triangulations are; without CGAL Apache-2.0");
}

}  // namespace sagitta::tools
