// SPDX-License-Identifier: Apache-2.0
// The keys of a study file, version 1: one table a mapping, as keys.h has those of a prescription. What the settings of a variant
// mean is said in study/variant.h.
#pragma once

#include <array>

#include "lib/prescription/keys.h"

namespace sagitta::prescription {

inline constexpr int study_version = 1;

inline constexpr std::array study_keys{
    numerics::Key{.name = "sagitta_study", .meaning = "version of the format, 1", .required = true, .range = {study_version, study_version}},
    numerics::Key{.name = "name", .kind = numerics::ValueKind::text, .meaning = "of letters, digits, - and _; rows of study.csv begin with it", .required = true},
    numerics::Key{.name = "title", .kind = numerics::ValueKind::text, .meaning = "heading of the page and of the plots; the name unless given"},
    numerics::Key{.name = "source", .kind = numerics::ValueKind::text, .meaning = "where the study, or what it repeats, is published"},
    numerics::Key{.name = "about", .kind = numerics::ValueKind::text, .meaning = "what the study is of, for the page"},
    numerics::Key{.name = "notes", .kind = numerics::ValueKind::text, .meaning = "what its results mean, for the end of the page"},
    numerics::Key{.name = "system", .kind = numerics::ValueKind::file, .meaning = "file of the prescription", .required = true},
    numerics::Key{.name = "surface", .kind = numerics::ValueKind::text, .meaning = "name of the surface under study, unless a variant names another", .required = true},
    numerics::Key{.name = "field", .meaning = "number of the field, from 0, likewise", .range = {.low = 0, .high = 1e6, .whole = true}},
    numerics::Key{.name = "variants", .kind = numerics::ValueKind::list, .meaning = "blocks of settings, every one a value or a list of them", .required = true},
    numerics::Key{.name = "paper", .kind = numerics::ValueKind::list, .meaning = "printed figures to stand beside the study's"}};

// Of a block of variants, in the order in which they are multiplied out.
inline constexpr std::array variant_keys{
    numerics::Key{.name = "surface", .kind = numerics::ValueKind::text, .meaning = "name of the surface under study; the study's unless given"},
    numerics::Key{.name = "field", .meaning = "number of the field, from 0; the study's unless given", .range = {.low = 0, .high = 1e6, .whole = true}},
    numerics::Key{.name = "roughness", .kind = numerics::ValueKind::mapping, .meaning = "random height on the surface; none unless given"},
    numerics::Key{.name = "interpolation", .kind = numerics::ValueKind::text, .meaning = "surface between the points; analytic: as prescribed, without points",
                  .choices = "linear|c1|cubic|thin_plate|multiquadric|analytic"},
    numerics::Key{.name = "arrangement", .kind = numerics::ValueKind::text, .meaning = "where the points lie", .choices = "regular|jittered|random|rings"},
    numerics::Key{.name = "points_per_mm2", .meaning = "density of the points", .range = {1e-9, 1e12}},
    numerics::Key{.name = "points_per_mm", .meaning = "its root, in place of it", .range = {1e-4, 1e6}},
    numerics::Key{.name = "rings", .meaning = "number of rings, in place of a density", .range = {.low = 1, .high = 1e4, .whole = true}},
    numerics::Key{.name = "meridians", .meaning = "points on each ring", .range = {.low = 3, .high = 1e5, .whole = true}},
    numerics::Key{.name = "margin_spacings", .meaning = "how far the points reach beyond the beam", .range = {0, 1000}, .fallback = 3},
    numerics::Key{.name = "cloud_radius_mm", .meaning = "how far the points reach, in place of a margin", .range = numerics::not_negative},
    numerics::Key{.name = "shape_spacings", .meaning = "shape parameter of multiquadrics, in spacings of the points", .range = numerics::positive, .fallback = 1},
    numerics::Key{.name = "search", .kind = numerics::ValueKind::text, .meaning = "how a facet is found; nearest_vertex: as a baseline", .choices = "walk|nearest_vertex"},
    numerics::Key{.name = "tolerance_mm", .meaning = "of Newton's method on a surface as prescribed; 0: the tracer's own way", .range = {0, 1}},
    numerics::Key{.name = "pattern", .kind = numerics::ValueKind::text, .meaning = "of the rays over the pupil", .choices = "hexapolar"},
    numerics::Key{.name = "rays", .meaning = "rays that are timed, at least", .range = {.low = 1, .high = 1e9, .whole = true}, .fallback = 10000},
    numerics::Key{.name = "compared_rays", .meaning = "about so many of them are compared with the exact ones", .range = {.low = 1, .high = 1e6, .whole = true}, .fallback = 100000},
    numerics::Key{.name = "prepare_repeats", .meaning = "how often preparation is measured, at least", .range = {.low = 1, .high = 100, .whole = true}, .fallback = 3},
    numerics::Key{.name = "threads", .meaning = "threads; 0: as many as the machine runs", .range = {.low = 0, .high = 1024, .whole = true}, .fallback = 1},
    numerics::Key{.name = "seed", .meaning = "of the places of points and of the roughness", .range = {.low = 0, .high = 0x1p53, .whole = true}, .fallback = 1}};

inline constexpr std::array roughness_keys{
    numerics::Key{.name = "rms_um", .meaning = "rms height", .range = numerics::not_negative},
    numerics::Key{.name = "correlation_length_um", .meaning = "distance at which the correlation is 1/e", .range = numerics::positive, .fallback = 1000},
    numerics::Key{.name = "truth", .kind = numerics::ValueKind::text, .meaning = "surface of the exact rays: the rough one, or the clean one", .choices = "noisy|clean"}};

// Of a printed figure; the columns are those of study.csv.
inline constexpr std::array paper_keys{
    numerics::Key{.name = "where", .kind = numerics::ValueKind::mapping, .meaning = "settings of the variants that it is of, one value each", .required = true},
    numerics::Key{.name = "distance_mean_um", .meaning = "mean distance of the hits"},
    numerics::Key{.name = "distance_rms_um", .meaning = "its rms"},
    numerics::Key{.name = "angle_mean_arcmin", .meaning = "mean angle of the refracted rays"},
    numerics::Key{.name = "angle_rms_arcmin", .meaning = "its rms"},
    numerics::Key{.name = "spot_rms_um", .meaning = "RMS radius of the spot"},
    numerics::Key{.name = "spot_rms_error_percent", .meaning = "its error"},
    numerics::Key{.name = "ns_per_ray", .meaning = "time of a ray"},
    numerics::Key{.name = "note", .kind = numerics::ValueKind::text, .meaning = "where it stands, what is to be said of it"}};

}  // namespace sagitta::prescription
