// SPDX-License-Identifier: Apache-2.0
// What a compiled scene costs, surface by surface, and what was left out of it for what is asked.
//
// Operations are counted by sending one ray through the templates that the kernels are made of (numerics/counted.h): the first
// ray, of a few of each field at the first wavelength, that arrives when no aperture stops it; of
// shapes with an iteration or a search, as many steps as that ray takes. Where media differ at some wavelengths only, they
// differ. Apertures, transforms and refraction are counted the same way, with and without.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/analysis/job.h"
#include "lib/numerics/counted.h"

namespace sagitta::scene {
struct CompileResult;  // of scene/compile.h, which brings the prescription: who calls plan_of includes it
}

namespace sagitta::analysis {

struct SurfacePlan {
  int surface = 0;                                 // its number
  std::string kernel;
  std::optional<numerics::Operations> operations;  // of a ray; none where no ray gets there
  std::optional<double> gradient_steps;            // of the integration through the medium before it, mean over the sample; none: rays are straight
  std::size_t bytes_per_ray = 0;                   // of the columns that are read and written; they stay in the first-level cache
  std::size_t data_bytes = 0;                      // of the surface's own numbers: coefficients, facets, patches
};

struct Omission {
  std::string what, why, saves;
};

// What it takes to aim at the stop (trace/aim.h), of a sample of each field at the first wavelength.
struct AimPlan {
  int stop = 0;                  // number of the surface
  double passes_per_ray = 0;     // of the ray up to the stop, before it is launched
  double passes_before = 0;      // of other rays, for each field and wavelength, to begin with
};

struct Plan {
  bool has_opl = false;  // in `surfaces`: OPL is counted where wavefronts are asked for
  std::vector<SurfacePlan> surfaces;
  std::optional<AimPlan> aim;  // none: rays are not aimed
  std::vector<Omission> left_out;
};

// `compiled` has a scene.
Plan plan_of(const scene::CompileResult& compiled, const JobRequest& request);

}  // namespace sagitta::analysis
