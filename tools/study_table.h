// SPDX-License-Identifier: Apache-2.0
// The rows of a study: what study.csv holds, from settings and measurements, and what the page and its plots read from it.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "lib/output/records.h"
#include "lib/prescription/study_file.h"
#include "lib/study/mean.h"
#include "lib/study/variant.h"

namespace sagitta::tools {

study::Variant variant_of(const prescription::Parameters& settings);

// One variant; `cells` are those of study_columns(), empty until it is measured.
struct StudyRow {
  const prescription::Parameters* settings = nullptr;
  std::string name;
  std::string series;        // the name without density, number of rays, tolerance and seed
  std::string of_any_rays;   // the name without the number of rays and the seed
  std::string of_any_seed;   // the name without the seed
  std::string settings_but_seed;
  std::string key;           // what the measurement depends on, as a hash: settings, system, program, processor
  std::vector<std::string> cells;

  bool is_measured() const { return !cells.empty(); }
  const std::string& text(std::string_view column) const;
  double number(std::string_view column) const;  // NaN where there is none
  bool has_failed() const { return is_measured() && !text("failed").empty(); }
};

const std::vector<output::RecordColumn>& study_columns();

// The variants of a study in its order, none measured.
std::vector<StudyRow> rows_of(const prescription::StudyFile& study, int thread_count);

struct MeasuredRow {
  study::Measured measured;
  double peak_mib = 0;  // that its process held at most
  double own_mib = std::numeric_limits<double>::quiet_NaN();  // of it, what it did not begin with: the program and the exact rays
};
void fill(StudyRow& row, const prescription::StudyFile& study, const MeasuredRow& measured);
// Takes the rows of an earlier study.csv that are finished and have the same keys.
struct Finished {
  int taken = 0, others = 0;      // rows; others are of other settings, or failed
  bool is_unreadable = false;     // it is no study.csv of this kind
};
Finished take_finished(std::vector<StudyRow>& rows, const prescription::StudyFile& study, std::string_view csv);

output::Records records_of(const std::vector<StudyRow>& rows);

// A whole number, its zeros counted where there are six or more: "2500", "1e8".
std::string count_in_words(double count);

// Rows that differ in the seed alone, as the page and the plots show them: as one. Measured, none failed, at least one.
struct Ensemble {
  std::vector<const StudyRow*> rows;

  const StudyRow& first() const { return *rows.front(); }
  const std::string& name() const { return rows.size() > 1 ? first().of_any_seed : first().name; }
  std::vector<double> numbers(std::string_view column) const;
  study::Mean mean(std::string_view column) const { return study::mean_of(numbers(column)); }
};
// In the order in which they first come.
std::vector<Ensemble> ensembles_of(const std::vector<StudyRow>& rows);

// Such as "Intel(R) Xeon(R) ...", "" where the system does not say.
std::string processor_name();

}  // namespace sagitta::tools
