// Linearization at a point: the C API of descriptor systems.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "c_api/checks.h"
#include "c_api/creation.h"
#include "c_api/solver.h"
#include "c_api/structs.h"
#include "linalg/index.h"
#include "linear/descriptor_system.h"
#include "solver/linearized_problem.h"

using namespace sfdae::core;

struct sfdae_descriptor {
  DescriptorSystem system;
  double rank_tol = 0.0;
  std::optional<CharacteristicValues> solution;  // of the problem's solutions; none where the pencil is another one's
  char message[1536] = "";
};

namespace {

sfdae_linearization default_linearization() {
  sfdae_linearization choice{};
  choice.size = sizeof choice;
  return choice;
}

sfdae_descriptor_matrices default_matrices() {
  sfdae_descriptor_matrices matrices{};
  matrices.size = sizeof matrices;
  return matrices;
}

// Runs the body of a call on a descriptor system: exceptions to status and message.
template <class Body>
int guarded_on(sfdae_descriptor* descriptor, Body body) noexcept {
  if (descriptor == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  const auto say = [descriptor](int status, const char* text) {
    std::snprintf(descriptor->message, sizeof descriptor->message, "%s", text);
    return status;
  };
  return status_of(body, say);
}

bool is_number_of_lines(int count, int least) { return count >= least && count <= most_dense_unknowns; }

// rows x cols from the user; null: zeros, if these are allowed.
bool read(const double* from, bool may_be_null, Matrix& to) {
  const std::size_t count = index(to.rows()) * index(to.cols());
  if (from == nullptr) return may_be_null || count == 0;
  if (!all_finite(from, count)) return false;
  std::copy_n(from, count, to.data());
  return true;
}

void write(const Matrix& from, double* to) {
  if (to != nullptr) std::copy_n(from.data(), index(from.rows()) * index(from.cols()), to);
}

void create(const sfdae_descriptor_matrices& given, sfdae_descriptor** to) {
  const int m = given.num_equations, n = given.num_unknowns, q = given.num_inputs, p = given.num_outputs;
  if (!is_number_of_lines(m, 1) || !is_number_of_lines(n, 1) || !is_number_of_lines(q, 0) ||
      !is_number_of_lines(p, 0))
    refuse_argument(format(
        "%d equations, %d unknowns, %d inputs, %d outputs: there must be 1 to %d equations and unknowns and 0 to %d "
        "inputs and outputs.",
        m, n, q, p, most_dense_unknowns, most_dense_unknowns));
  if (!(given.rank_tol >= 0.0 && given.rank_tol < 1.0))
    refuse_argument(format("rank_tol = %g; it must be >= 0 and < 1.", given.rank_tol));
  auto descriptor = std::make_unique<sfdae_descriptor>();
  DescriptorSystem& system = descriptor->system;
  system = {Matrix(m, n), Matrix(m, n), Matrix(m, q), Matrix(p, n), Matrix(p, q)};
  const struct {
    const char* name;
    const double* values;
    bool may_be_null;
    Matrix& to;
  } matrices[] = {{"E", given.E, false, system.E},
                  {"A", given.A, false, system.A},
                  {"B", given.B, true, system.B},
                  {"C", given.C, true, system.C},
                  {"D", given.D, true, system.D}};
  for (const auto& matrix : matrices)
    if (!read(matrix.values, matrix.may_be_null, matrix.to))
      refuse_argument(format("%s is NULL or contains NaN or Inf.", matrix.name));
  descriptor->rank_tol = given.rank_tol;
  *to = descriptor.release();
}

struct Places {
  sfdae_spectrum* spectrum;
  double *real, *imaginary, *errors;
};

void check(const Places& to) {
  if (to.spectrum == nullptr || !is_plausible_size(to.spectrum->size))
    refuse_argument("the spectrum is NULL or its size is not set: call sfdae_spectrum_init.");
  if (to.real == nullptr || to.imaginary == nullptr) refuse_argument("real or imaginary is NULL.");
}

// size: of the pencil.
void write(const PencilSpectrum& found, int size, const Places& to) {
  sfdae_spectrum spectrum{};
  spectrum.size = sizeof spectrum;
  spectrum.num_finite = static_cast<int>(found.finite.size());
  spectrum.num_infinite = found.is_regular() ? size - spectrum.num_finite : -1;
  spectrum.strangeness_index = found.values.mu;
  spectrum.differential = found.values.d;
  spectrum.algebraic = found.values.a;
  spectrum.undetermined = found.values.u;
  spectrum.redundant = found.values.v;
  fill_struct(to.spectrum, spectrum);
  for (std::size_t k = 0; k < found.finite.size(); ++k) {
    to.real[k] = found.finite[k].value.real();
    to.imaginary[k] = found.finite[k].value.imag();
    if (to.errors != nullptr) to.errors[k] = found.finite[k].error;
  }
}

void demand_values_of_solution(const sfdae_descriptor& descriptor, const PencilSpectrum& found) {
  const auto& solution = descriptor.solution;
  if (!solution || solution->d == found.values.d) return;
  throw Failure(
      SFDAE_CHARACTERISTICS_CHANGED,
      format("the frozen pencil has %s, solutions have %s: this is no equilibrium, and what is frozen behaves "
             "otherwise. "
             "For a pencil with as many poles, whose meaning is limited, give E = [E1; 0], A = [A1; A2] of "
             "sfdae_get_strangeness_free to sfdae_create_descriptor, or E and A themselves to have those of the "
             "frozen one.",
             describe(found.values).c_str(), describe(*solution).c_str()));
}

void transfer(const DescriptorSystem& system, int count, const double* const s[2], double* const H[2]) {
  if (count < 0) refuse_argument(format("count = %d; it must be >= 0.", count));
  if (count == 0) return;
  if (s[0] == nullptr || s[1] == nullptr || H[0] == nullptr || H[1] == nullptr)
    refuse_argument("real, imaginary, H_real or H_imaginary is NULL.");
  if (!all_finite(s[0], index(count)) || !all_finite(s[1], index(count)))
    refuse_argument("real or imaginary contains NaN or Inf.");
  const std::size_t size = index(system.inputs()) * index(system.outputs());
  std::vector<std::complex<double>> values(size);
  TransferFunction function(system);
  for (std::size_t k = 0; k < index(count); ++k) {
    function.evaluate({s[0][k], s[1][k]}, values.data());
    for (std::size_t i = 0; i < size; ++i) {
      H[0][k * size + i] = values[i].real();
      H[1][k * size + i] = values[i].imag();
    }
  }
}

}  // namespace

extern "C" {

int sfdae_linearization_init(sfdae_linearization* choice, size_t size) {
  return initialize(choice, size, default_linearization());
}

int sfdae_descriptor_matrices_init(sfdae_descriptor_matrices* matrices, size_t size) {
  return initialize(matrices, size, default_matrices());
}

int sfdae_spectrum_init(sfdae_spectrum* spectrum, size_t size) {
  sfdae_spectrum defaults{};
  return initialize(spectrum, size, defaults);
}

int sfdae_linearize(sfdae_solver* solver, const sfdae_linearization* choice, sfdae_descriptor** descriptor) {
  if (descriptor != nullptr) *descriptor = nullptr;
  return guarded<Text::of_failure>(solver, [&] {
    if (descriptor == nullptr) refuse_argument("descriptor is NULL.");
    if (choice == nullptr || !is_plausible_size(choice->size))
      refuse_argument("the choice is NULL or its size is not set: call sfdae_linearization_init.");
    auto found = std::make_unique<sfdae_descriptor>();
    found->system = linearized(*solver, read_struct(*choice, default_linearization()));
    found->rank_tol = solver->options.model.analysis.rank_tol;
    const bool is_that_of_problem = found->system.equations() == solver->model.m();
    if (solver->system() != nullptr && is_that_of_problem) found->solution = solver->system()->analysis().values;
    *descriptor = found.release();
  });
}

int sfdae_create_descriptor(const sfdae_descriptor_matrices* matrices, sfdae_descriptor** descriptor) {
  if (descriptor != nullptr) *descriptor = nullptr;
  return creating([&] {
    if (descriptor == nullptr) refuse_argument("descriptor, where the new one goes, is NULL.");
    if (matrices == nullptr || !is_plausible_size(matrices->size))
      refuse_argument("matrices is NULL or its size is not set: call sfdae_descriptor_matrices_init.");
    return create(read_struct(*matrices, default_matrices()), descriptor);
  });
}

int sfdae_destroy_descriptor(sfdae_descriptor** descriptor) {
  if (descriptor == nullptr) return SFDAE_OK;
  delete *descriptor;
  *descriptor = nullptr;
  return SFDAE_OK;
}

const char* sfdae_descriptor_message(const sfdae_descriptor* descriptor) {
  return descriptor != nullptr ? descriptor->message : "the descriptor system is NULL.";
}

int sfdae_get_descriptor_sizes(const sfdae_descriptor* descriptor, int* num_equations, int* num_unknowns,
                               int* num_inputs, int* num_outputs) {
  if (descriptor == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  const DescriptorSystem& system = descriptor->system;
  if (num_equations != nullptr) *num_equations = system.equations();
  if (num_unknowns != nullptr) *num_unknowns = system.unknowns();
  if (num_inputs != nullptr) *num_inputs = system.inputs();
  if (num_outputs != nullptr) *num_outputs = system.outputs();
  return SFDAE_OK;
}

int sfdae_get_descriptor_matrices(const sfdae_descriptor* descriptor, double* E, double* A, double* B, double* C,
                                  double* D) {
  if (descriptor == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  const DescriptorSystem& system = descriptor->system;
  write(system.E, E);
  write(system.A, A);
  write(system.B, B);
  write(system.C, C);
  write(system.D, D);
  return SFDAE_OK;
}

int sfdae_get_poles(sfdae_descriptor* descriptor, sfdae_spectrum* spectrum, double* real, double* imaginary,
                    double* errors) {
  return guarded_on(descriptor, [&] {
    const Places to{spectrum, real, imaginary, errors};
    check(to);
    const PencilSpectrum found = poles(descriptor->system, descriptor->rank_tol);
    demand_values_of_solution(*descriptor, found);
    write(found, descriptor->system.unknowns(), to);
  });
}

int sfdae_get_zeros(sfdae_descriptor* descriptor, sfdae_spectrum* spectrum, double* real, double* imaginary,
                    double* errors) {
  return guarded_on(descriptor, [&] {
    const Places to{spectrum, real, imaginary, errors};
    check(to);
    const PencilSpectrum found = invariant_zeros(descriptor->system, descriptor->rank_tol);
    write(found, descriptor->system.unknowns() + descriptor->system.inputs(), to);
  });
}

int sfdae_get_transfer(sfdae_descriptor* descriptor, int count, const double* real, const double* imaginary,
                       double* H_real, double* H_imaginary) {
  return guarded_on(descriptor, [&] {
    const double* const s[] = {real, imaginary};
    double* const H[] = {H_real, H_imaginary};
    return transfer(descriptor->system, count, s, H);
  });
}

}  // extern "C"
