// SPDX-License-Identifier: Apache-2.0
// A vector whose resize() leaves new numbers without a value: for millions of them that several threads are about to write.
#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace sagitta::numerics {

template <class T>
struct LeaveUnset : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = LeaveUnset<U>;
  };
  LeaveUnset() = default;
  template <class U>
  LeaveUnset(const LeaveUnset<U>&) noexcept {}

  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    std::construct_at(place, std::forward<Arguments>(arguments)...);
  }
};

template <class T>
using UnsetArray = std::vector<T, LeaveUnset<T>>;

}  // namespace sagitta::numerics
