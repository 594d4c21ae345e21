// SPDX-License-Identifier: Apache-2.0
// What a reader of lens files has to say. Two kinds of errors: what is broken, and what the file has but a prescription has not, or the reader does not know.
// The second is a warning where a part of the lens is good enough, and then the head comment of the prescription lists it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lib/lens_file/lens.h"

namespace sagitta::lens_file {

class Report {
 public:
  Report(prescription::Findings& findings, bool takes_parts) : findings_(findings), takes_parts_(takes_parts) {}

  void broken(Place place, std::string what, std::string hint = {}) {
    if (!findings_.is_full()) findings_.error(std::move(place), std::move(what), std::move(hint));
  }
  // `what` is a clause without a full stop.
  void left_out(Place place, std::string what, std::string hint = {}) {
    if (!takes_parts_) {
      could_be_left_out_ = true;
      return broken(std::move(place), std::move(what), std::move(hint));
    }
    ++left_out_count_;
    if (left_out_.size() >= prescription::most_told_errors) return;
    left_out_.push_back({place, what});
    findings_.warning(std::move(place), std::move(what), std::move(hint));
  }
  void warning(Place place, std::string what, std::string hint = {}) { findings_.warning(std::move(place), std::move(what), std::move(hint)); }
  void note(Place place, std::string what) { findings_.note(std::move(place), std::move(what)); }

  bool has_errors() const { return findings_.has_errors(); }
  // Whether there is an error that would be a warning where a part of the lens is good enough.
  bool could_be_left_out() const { return could_be_left_out_; }
  prescription::Findings& findings() { return findings_; }

  struct LeftOut {
    Place place;
    std::string what;
  };
  const std::vector<LeftOut>& all_left_out() const { return left_out_; }
  int left_out_count() const { return left_out_count_; }

 private:
  prescription::Findings& findings_;
  bool takes_parts_, could_be_left_out_ = false;
  std::vector<LeftOut> left_out_;
  int left_out_count_ = 0;
};

}  // namespace sagitta::lens_file
