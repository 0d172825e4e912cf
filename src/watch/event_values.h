// Where the values of event functions g come from, as far as a search for their zeros is concerned.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::core {

class EventValues {
 public:
  virtual ~EventValues() = default;
  // g at t, cheap, with the accuracy of an interpolation; false if there is no such thing.
  virtual bool approximate(double t, double* g) = 0;
  // g at t with the values that are returned there. may_improve: approximate() may become better around t by this.
  virtual void determine(double t, bool may_improve, double* g) = 0;
  // How much g changes where rounding errors change what it depends on, at the point determined last.
  virtual void rounding(double* noise) = 0;
  // The point determined last is a candidate; the last candidate becomes the point searched last.
  virtual void keep() = 0;
  virtual void accept() = 0;
};

}  // namespace sfdae::core
