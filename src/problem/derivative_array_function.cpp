// The user's derivative array as total derivatives order by order.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/derivative_array_function.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

DerivativeArrayFunction::Ascending::Ascending(DerivativeArrayFunction* array, int highest) : array_(array) {
  if (array_ != nullptr) array_->highest_ = highest;
}

// Later calls at the same jet evaluate again: the equations may have changed.
DerivativeArrayFunction::Ascending::~Ascending() {
  if (array_ == nullptr) return;
  array_->highest_ = -1;
  array_->derivatives_.clear();
}

bool DerivativeArrayFunction::is_loaded(double t, int order, const double* derivatives, bool with_jacobian) const {
  const std::size_t length = index(n_) * index(order + 2);
  return highest_ >= 0 && order <= loaded_order_ && t == t_ && (has_jacobian_ || !with_jacobian) &&
         length <= derivatives_.size() && std::equal(derivatives, derivatives + length, derivatives_.begin());
}

int DerivativeArrayFunction::call(double t, int order, const double* derivatives, bool with_jacobian) {
  const ArrayShape shape{m_, n_, order};
  F_.assign(shape.rows(), 0.0);
  if (with_jacobian) {
    jacobian_.assign(shape.rows() * shape.columns(), 0.0);
    F_x_.resize(shape.entries());
    F_xdot_.resize(shape.entries());
  }
  const int code = function_(t, order, derivatives, F_.data(), with_jacobian ? jacobian_.data() : nullptr, user_);
  if (code != 0) return code;
  derivatives_.assign(derivatives, derivatives + index(n_) * index(order + 2));
  t_ = t;
  loaded_order_ = order;
  has_jacobian_ = with_jacobian;
  if (with_jacobian) fault_ = split_array(shape, jacobian_.data(), F_x_.data(), F_xdot_.data());
  return 0;
}

// Arrays of a higher order need not be available.
int DerivativeArrayFunction::load(double t, int order, const double* derivatives, bool with_jacobian) {
  derivatives_.clear();
  int code = SFDAE_ORDER_NOT_AVAILABLE;
  for (int k = std::max(order, highest_); k >= order && code == SFDAE_ORDER_NOT_AVAILABLE; --k)
    code = call(t, k, derivatives, with_jacobian);
  return code;
}

int DerivativeArrayFunction::evaluate(double t, int order, const double* derivatives, double* F, double* F_x,
                                      double* F_xdot, void* user) {
  auto& own = *static_cast<DerivativeArrayFunction*>(user);
  const bool with_jacobian = F_x != nullptr || F_xdot != nullptr;
  own.fault_ = {};
  if (!own.is_loaded(t, order, derivatives, with_jacobian)) {
    const int code = own.load(t, order, derivatives, with_jacobian);
    if (code != 0) return code;
    if (own.fault_.exists()) {
      own.derivatives_.clear();
      return 1;
    }
  }
  const std::size_t area = index(own.m_) * index(own.n_), first = area * index(order);
  std::copy_n(own.F_.data() + index(own.m_) * index(order), own.m_, F);
  if (F_x != nullptr) std::copy_n(own.F_x_.data() + first, area, F_x);
  if (F_xdot != nullptr) std::copy_n(own.F_xdot_.data() + first, area, F_xdot);
  return 0;
}

}  // namespace sfdae::core
