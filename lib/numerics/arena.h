// SPDX-License-Identifier: Apache-2.0
// Keeps arrays alive for shapes that hold only pointers to them (kernel code has no containers).
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace sagitta::numerics {

class Arena {
 public:
  // The address stays valid as long as the arena, or a copy of it, lives.
  template <class T, class Allocator>
  const T* keep(std::vector<T, Allocator> values) {
    auto held = std::make_shared<const std::vector<T, Allocator>>(std::move(values));
    kept_.push_back(held);
    return held->data();
  }
  template <class T>
  const T& keep_shared(std::shared_ptr<const T> object) {
    kept_.push_back(object);
    return *object;
  }

 private:
  std::vector<std::shared_ptr<const void>> kept_;
};

}  // namespace sagitta::numerics
