// SPDX-License-Identifier: Apache-2.0
// The number type of exact rays.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace sagitta::study {

// Without expression templates: the templates of surface/ name the type of what they compute.
using FiftyDigits = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type, boost::multiprecision::et_off>;

}  // namespace sagitta::study
