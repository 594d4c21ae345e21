// SPDX-License-Identifier: Apache-2.0
#include "tools/pictures.h"

#include <dlfcn.h>
#include <fmt/core.h>

namespace sagitta::tools {

const Pictures* pictures(const char* command) {
  static const auto* const found = [command] {
    void* const module = dlopen("libsagitta_pictures.so", RTLD_NOW | RTLD_LOCAL);
    const void* const table = module ? dlsym(module, "sagitta_pictures") : nullptr;
    if (!table)
      fmt::print(stderr, "sagitta {}: no picture can be made: {}\n  hint: the module belongs beside the program, or in ../lib from there\n", command, dlerror());
    return static_cast<const Pictures*>(table);
  }();
  return found;
}

}  // namespace sagitta::tools
