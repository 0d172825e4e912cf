// All copies of a case as one problem of the library, in units and in a formulation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sfdae/sfdae.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "families.h"
#include "reference.h"

namespace campaign {

enum class Formulation { recorded, structure_off, structure_required, dense, compressed, differences };
inline constexpr std::array<const char*, 6> formulation_names = {
    "recorded",  "structure off",         "structure required",
    "callbacks", "callbacks, compressed", "callbacks, differences"};
inline bool has_callbacks(Formulation formulation) { return formulation >= Formulation::dense; }

struct Variant {
  Formulation formulation = Formulation::recorded;
  int method = SFDAE_METHOD_BDF;
  double tolerance = 1e-6;
  double atol_factor = 1.0;  // atol = tolerance * atol_factor * largest value
  std::vector<double> units = {
      1.0};                // X = unit * x, taken in turn by the unknowns, of multibody systems by the copies
  double time_unit = 1.0;  // t of the library = time_unit * t
  bool has_sum = false;    // a further unknown, the sum of the first unknowns of all copies
};

class System {
 public:
  System(const Case& problem, const Variant& variant, const std::vector<std::unique_ptr<Reference>>& references)
      : problem_(problem), variant_(variant), references_(references) {}
  virtual ~System() = default;
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  virtual int size() const = 0;
  virtual int create(sfdae_solver** solver, const sfdae_options& options) = 0;
  // In units of the library: the start, the solution at an output, the largest values of the unknowns.
  virtual std::vector<double> start() const = 0;
  virtual std::vector<double> solution(std::size_t output) const = 0;
  virtual std::vector<double> sizes() const = 0;
  // Errors that perturbations of rtol |x| + atol of the states at any one time lead to at an output.
  virtual std::vector<double> perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const = 0;
  virtual std::string text() const = 0;

 protected:
  std::size_t data_of(int copy) const { return static_cast<std::size_t>(copy) % problem_.copies.size(); }
  const SmallProblem& copy(int k) const { return problem_.copies[data_of(k)]; }
  const Reference& reference(int k) const { return *references_[data_of(k)]; }
  double unit(int k) const { return variant_.units[static_cast<std::size_t>(k) % variant_.units.size()]; }

  const Case& problem_;
  const Variant& variant_;
  const std::vector<std::unique_ptr<Reference>>& references_;
};

std::unique_ptr<System> make_equations(const Case& problem, const Variant& variant,
                                       const std::vector<std::unique_ptr<Reference>>& references);
std::unique_ptr<System> make_multibody(const Case& problem, const Variant& variant,
                                       const std::vector<std::unique_ptr<Reference>>& references);

}  // namespace campaign
