// Indicators of a singular point of a nonlinear system at one jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/singularity_sample.h"

#include <algorithm>
#include <cmath>

#include "system/relative_orientation.h"

namespace sfdae::core {

namespace {

double relative(double value, double norm) { return norm > 0.0 ? value / norm : 0.0; }

double unscaled_norm_E0(const TaylorData& data) {
  double norm = 0.0;
  for (int i = 0; i < data.m; ++i) {
    double row = 0.0;
    for (int j = 0; j < data.n; ++j) row = std::max(row, std::fabs(data.E(0)(i, j)));
    norm = std::max(norm, row / data.row_scale[index(i)]);
  }
  return norm;
}

}  // namespace

void SingularitySample::take(double at, const TaylorData& data, int mu, const NullSpaceForm& form) {
  const int sign = form.d > 0 && form.u == 0 ? form.sign_of_G() : 0;
  const std::size_t count = first_row + data.row_norm.size();
  // Allocates first: if memory is missing, the sample stays as it is.
  values.reserve(count);
  if (sign != 0) {
    Z1_.reserve(index(form.m) * index(form.d));
    T2_.reserve(index(form.n) * index(form.d));
  }
  t = at;
  m_ = form.m;
  n_ = form.n;
  d_ = form.d;
  values.resize(count);
  values[0] = form.rank_of_constraints() > 0 ? relative(form.smallest_constraint(), data.norm_A(mu)) : 1.0;
  values[1] = d_ > 0 ? relative(form.smallest_of_G(), data.norm_E0()) * unscaled_norm_E0(data) : 1.0;
  std::copy(data.row_norm.begin(), data.row_norm.end(), values.begin() + first_row);
  sign_ = sign;
  if (sign_ == 0) return;
  Z1_.assign(form.Z1().data, form.Z1().data + index(m_) * index(d_));
  T2_.assign(form.T2().data, form.T2().data + index(n_) * index(d_));
}

bool SingularitySample::is_turned_from(const SingularitySample& then, Arena& arena) const {
  if (sign_ == 0 || then.sign_ == 0 || d_ != then.d_) return false;
  return relative_orientation(then.Z1(), Z1(), arena) * relative_orientation(then.T2(), T2(), arena) * sign_ !=
         then.sign_;
}

}  // namespace sfdae::core
