// SPDX-License-Identifier: Apache-2.0
// The closed list of forms of gradient-index media. A new form is one file and one line here.
#pragma once

#include <variant>

#include "lib/gradient_index/luneburg.h"
#include "lib/gradient_index/maxwell.h"
#include "lib/gradient_index/polynomial.h"
#include "lib/gradient_index/quadratic.h"
#include "lib/gradient_index/selfoc.h"

namespace sagitta::gradient_index {

using Form = std::variant<Polynomial, Selfoc, Quadratic, Luneburg, Maxwell>;

// Calls visit with a default value of every form, in order.
template <class Visit, class... Forms>
void for_each_of(const std::variant<Forms...>&, Visit&& visit) {
  (visit(Forms{}), ...);
}
template <class Visit>
void for_each_form(Visit&& visit) {
  for_each_of(Form{}, visit);
}

}  // namespace sagitta::gradient_index
