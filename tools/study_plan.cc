// SPDX-License-Identifier: Apache-2.0
#include "tools/study_plan.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "lib/study/price.h"
#include "tools/study_run.h"

namespace sagitta::tools {
namespace {

using study::Variant;

study::Noise noise_of_truth(const Variant& variant) { return variant.is_against_clean ? study::Noise{} : variant.noise; }

// What a planned variant may share with the one before: exact rays, of which a subject keeps the rough ones and the clean ones, and rough points.
auto shared_points(const PlannedVariant& planned) {
  const Variant& variant = planned.variant;
  const bool is_rough = variant.noise.rms_um > 0;
  return is_rough ? std::tuple(variant.seed, variant.arrangement.kind, variant.arrangement.points_per_mm2, variant.arrangement.rings, variant.arrangement.meridians, variant.margin_spacings,
                               variant.cloud_radius_mm)
                  : std::tuple(std::uint64_t{0}, study::ArrangementKind{}, 0.0, 0, 0, 0.0, 0.0);
}
auto shared(const PlannedVariant& planned) {
  const Variant& variant = planned.variant;
  const bool is_rough = variant.noise.rms_um > 0;
  return std::tuple(planned.surface_number, planned.field, variant.pattern.kind, variant.pattern.seed, std::min(variant.rays, variant.most_compared), is_rough ? variant.noise.rms_um : 0,
                    is_rough ? variant.noise.correlation_length_um : 0, shared_points(planned));
}

// What the exact rays of a planned variant are of.
auto truth(const PlannedVariant& planned) {
  const Variant& variant = planned.variant;
  const study::Noise noise = noise_of_truth(variant);
  const bool is_rough = noise.rms_um > 0;
  return std::tuple(planned.surface_number, planned.field, is_rough ? noise.rms_um : 0, is_rough ? noise.correlation_length_um : 0, is_rough ? variant.seed : 0, variant.pattern.kind,
                    variant.pattern.seed, std::min(variant.rays, variant.most_compared));
}

// Variants of the same kind take the same time for a point and for a ray.
auto kind(const PlannedVariant& planned) {
  const Variant& variant = planned.variant;
  return std::tuple(planned.surface_number, planned.field, variant.interpolation, variant.search, variant.tolerance_mm > 0, variant.noise.rms_um > 0,
                    noise_of_truth(variant).rms_um > 0, variant.arrangement.rings > 0, variant.pattern.kind);
}

study::Probe probe(study::Subject& subject, const Variant& variant) {
  const study::Times start = study::times_now(study::Clocked::process);
  subject.know_truth(variant, 1);
  const study::Times known = study::times_now(study::Clocked::process);
  const MeasuredRow measured = measure_apart(subject, variant, [] {});
  const double seconds = (study::times_now(study::Clocked::process) - known).wall;
  if (!measured.measured.row) return {{}, seconds, 0};
  return {*measured.measured.row, seconds, (known - start).wall / static_cast<double>(measured.measured.row->compared)};
}

void price(CurrentSubject& subjects, std::vector<PlannedVariant>& planned, int thread_count) {
  std::map<decltype(kind(planned.front())), study::Probe> probes;
  std::set<decltype(truth(planned.front()))> known_truths;
  std::set<decltype(shared(planned.front()))> known_points;
  for (PlannedVariant& one : planned) {
    study::Subject& subject = subjects.of(one);
    const double points = subject.point_count(one.variant);
    auto found = probes.find(kind(one));
    if (found == probes.end()) found = probes.emplace(kind(one), probe(subject, study::probe_of(one.variant, points))).first;
    study::Probe known = found->second;
    if (one.variant.noise.rms_um > 0 && !known_points.insert(shared(one)).second) known.row.sampling_s = 0;
    if (known.row.compared == 0) one.seconds = known.seconds;  // it has no row: others of its kind will hardly have one
    else one.seconds = study::seconds_of(one.variant, points, known);
    if (known_truths.insert(truth(one)).second) one.seconds += study::exact_seconds_of(one.variant, known, thread_count);
  }
}

}  // namespace

study::Subject& CurrentSubject::of(const PlannedVariant& planned) {
  if (!subject_ || planned.surface_number != surface_number_ || planned.field != field_) {
    subject_.emplace(study_->system, planned.surface_number, planned.field);
    surface_number_ = planned.surface_number;
    field_ = planned.field;
  }
  return *subject_;
}

std::vector<PlannedVariant> plan_of(const prescription::StudyFile& study, std::vector<StudyRow>& rows, int thread_count) {
  std::vector<PlannedVariant> planned;
  for (StudyRow& row : rows) {
    if (row.is_measured()) continue;
    planned.push_back({&row, variant_of(*row.settings), prescription::surface_number_of(study, *row.settings), prescription::field_of(*row.settings), 0});
    Variant& variant = planned.back().variant;
    if (variant.threads == 0) variant.threads = thread_count;
  }
  std::stable_sort(planned.begin(), planned.end(), [](const PlannedVariant& a, const PlannedVariant& b) { return shared(a) < shared(b); });
  CurrentSubject subjects(study);
  price(subjects, planned, thread_count);
  return planned;
}

}  // namespace sagitta::tools
