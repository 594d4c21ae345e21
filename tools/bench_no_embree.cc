// SPDX-License-Identifier: Apache-2.0
// In place of bench_embree.cc, where the build has found no Embree.
#include "tools/bench_embree.h"

namespace sagitta::bench {

std::string embree_version() { return {}; }
std::vector<std::string> embree_calls() { return {}; }
std::unique_ptr<EmbreeRays> embree_rays(const surface::Mesh&, const trace::RayBatch&, const std::string&) { return nullptr; }

}  // namespace sagitta::bench
