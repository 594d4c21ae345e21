// SPDX-License-Identifier: Apache-2.0
// One variant of a study, measured: a system with one of its surfaces in another representation, the errors of its rays against the
// true ones, and what it takes in time.
//
// Both sides are launched alike: first order and pupils are those of the system as prescribed, also where the variant's surface
// is fitted to points and would have others. The cloud is samples of the true sag (plus the roughness) at the sites of the arrangement, over a
// disc about the surface's vertex: of the beam's radius there, by rays on the rim of its pupil, and a margin.
//
// Wavefronts are those of analysis/wavefront.h of both systems, the prescribed one's by the ordinary path in double, which knows no
// point cloud; each is to the sphere about its own chief ray's image point, through the same paraxial exit pupil. There is none against a rough
// surface, whose scene has no such path.
//
// Times. Preparation: compiling the variant's scene, all of its points (process time, for several threads may share it). Tracing: the rays
// through the surface under study alone, in batches that stay in the second-level cache; launching them and the surfaces
// before are not counted. Runs are repeated, preparation as often as asked for, tracing at least three times, short ones more often. The nearest vertex is timed on as many of the rays as a quarter of a
// second allows.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "lib/prescription/model.h"
#include "lib/scene/scene.h"
#include "lib/study/arrangement.h"
#include "lib/study/errors.h"
#include "lib/study/timing.h"
#include "lib/trace/pattern.h"

namespace sagitta::study {

enum class Search { walk, nearest_vertex };  // nearest_vertex.h, on linear facets only

// A Gaussian-correlated roughness (roughness.h); rms 0: none.
struct Noise {
  double rms_um = 0, correlation_length_um = 1000;
  bool operator==(const Noise&) const = default;
};

struct Variant {
  static constexpr const char* as_prescribed = "analytic";
  std::string interpolation = "linear";  // as `delaunay` takes it, or as_prescribed: then nothing is sampled
  Arrangement arrangement;
  Search search = Search::walk;
  double margin_spacings = 3;            // of the cloud beyond the beam
  double cloud_radius_mm = 0;            // of the cloud instead; 0: by the margin
  double shape_spacings = 1;             // of multiquadrics
  Noise noise;
  bool is_against_clean = false;         // a rough cloud's truth is the surface without the roughness
  std::uint64_t seed = 1;                // of the arrangement and the roughness
  trace::Pattern pattern;
  std::int64_t rays = 10000;             // at least; all are timed
  std::int64_t most_compared = 100000;   // about so many are compared with the truth: a pattern of its own where `rays` is larger
  int threads = 1;                       // 0: as many as the machine runs
  int prepare_repeats = 3;               // at least
  double tolerance_mm = 0;               // as_prescribed only: Newton's method to this |f| (newton.h); 0: the tracer's own way
  bool want_wavefront = true;
};

struct Row {
  std::int64_t points = 0, triangles = 0;
  double points_per_mm2 = 0;             // as they came out
  double cloud_radius_mm = 0;
  std::int64_t rays = 0, compared = 0;   // timed; against the truth
  SurfaceErrors surface;
  SpotErrors spot;
  double wavefront_rms_waves = std::numeric_limits<double>::quiet_NaN();  // of the difference, tilt left in; NaN where there is none
  double wavefront_rms_without_tilt_waves = std::numeric_limits<double>::quiet_NaN();
  double looks_per_ray = std::numeric_limits<double>::quiet_NaN();        // of Newton's method to a tolerance, in the mean
  double looks_most = std::numeric_limits<double>::quiet_NaN();           // of the ray that takes most
  Spread prepare_s, prepare_wall_s;
  Spread ns_per_ray, wall_ns_per_ray;    // processor's, of all threads together; the clock's
  int threads = 1;                       // that the variant's rays are shared among
  double sampling_s = 0, comparing_s = 0, launching_ns_per_ray = 0;  // by the clock, beside what is measured: points, comparison, launching (price.h)
};

inline constexpr double most_points = 1e8;  // of a cloud: some 60 GB

struct Measured {
  std::optional<Row> row;
  std::string reason;  // why there is none
};

// A system and its surface under study. Keeps the rough cloud and the truth of the last variant, and beside a rough truth the last one without
// roughness: variants that share them (noise, seed, and pattern and rays or arrangement) are best measured one after the other.
class Subject {
 public:
  // The field counts from 0, the surface from 1; the wavelength is the primary one.
  Subject(prescription::Model system, int surface_number, std::size_t field = 0);
  ~Subject();
  Subject(Subject&&) noexcept;

  Measured measure(const Variant& variant);
  // The exact rays of a variant beforehand, by so many threads (0: as many as the machine runs): a process that is forked from this one has them.
  void know_truth(const Variant& variant, int thread_count);
  // Likewise the points of a rough variant. Without the memory for them there are none, nor is there an error before measure().
  void know_rough_cloud(const Variant& variant, int thread_count);
  // The points of a variant, as a cloud in memory; empty where there are none, or measure() has a reason.
  prescription::PointCloud cloud_of(const Variant& variant);
  // How many points a variant has, about; 0 of a surface as prescribed.
  double point_count(const Variant& variant) const;
  // The beam's radius on the surface, mm; NaN where no ray of the rim comes there.
  double beam_radius() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

inline Measured measure(const prescription::Model& system, int surface_number, const Variant& variant) {
  return Subject(system, surface_number).measure(variant);
}

}  // namespace sagitta::study
