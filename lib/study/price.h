// SPDX-License-Identifier: Apache-2.0
// How long measuring a variant will take by the clock, told beforehand from a small variant of its kind, its probe, which is measured first.
//
//   T = s N + r(p N) p N + c C + (1 + runs passes) R (l + t/threads) + rest                                          (1)
//   E = e C/threads                                                                                                 (2)
//
// N   points          s, p   sampling and preparing one, s          r, runs, passes   repeats by timing.h
// C   compared rays   c, e   comparing one, its exact trace, s
// R   timed rays      l, t   launching one, the surface for it, s   rest              what (1) leaves of the probe's own time
//
// Of the nearest vertex c and t grow as N. All else is taken as proportional. It is not quite: triangulating 1e7 points takes 1.5 times as
// long a point as 4000, and rays through them 2 to 3 times as long, by the caches; the surface is a part of T only.
#pragma once

#include "lib/study/variant.h"

namespace sagitta::study {

// `points` are those of the variant (Subject::point_count).
Variant probe_of(const Variant& variant, double points);

struct Probe {
  Row row;                     // of probe_of()
  double seconds = 0;          // that it took in all, but for its exact rays
  double exact_s_per_ray = 0;  // e, of one thread
};

// (1); exact rays of variants that share them are made once.
double seconds_of(const Variant& variant, double points, const Probe& probe);
// (2); thread_count 0: as many as the machine runs.
double exact_seconds_of(const Variant& variant, const Probe& probe, int thread_count);

}  // namespace sagitta::study
