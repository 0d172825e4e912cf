// Source of event function values for a search of their zeros.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::core {

class EventValues {
 public:
  virtual ~EventValues() = default;
  // g at t, inexpensive, with interpolation accuracy; false if not available.
  virtual bool approximate(double t, double* g) = 0;
  // g at t with the values returned there. may_improve: the call may improve approximate() around t.
  virtual void determine(double t, bool may_improve, double* g) = 0;
  // Changes of g that rounding errors of its arguments cause, at the point determined last.
  virtual void rounding(double* noise) = 0;
  // keep(): the point determined last becomes the candidate. accept(): the candidate becomes the point searched last.
  virtual void keep() = 0;
  virtual void accept() = 0;
};

}  // namespace sfdae::core
