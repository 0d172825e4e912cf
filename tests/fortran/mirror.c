/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Fills every struct of the C API with the numbers 1, 2, 3, ... in the order of its members, and returns its size.
 * mirror_test.f90 reads them. */
#include <sfdae/sfdae.h>

size_t fill_characteristics(sfdae_characteristics* s);
size_t fill_decision(sfdae_decision* s);
size_t fill_change(sfdae_change* s);
size_t fill_initial_report(sfdae_initial_report* s);
size_t fill_statistics(sfdae_statistics* s);
size_t fill_derivative_check(sfdae_derivative_check* s);
size_t fill_progress(sfdae_progress* s);
size_t fill_linear_problem(sfdae_linear_problem* s);
size_t fill_nonlinear_problem(sfdae_nonlinear_problem* s);
size_t fill_multibody_problem(sfdae_multibody_problem* s);
size_t fill_multibody_formulas(sfdae_multibody_formulas* s);
size_t fill_multibody_report(sfdae_multibody_report* s);
size_t fill_structure(sfdae_structure* s);
size_t fill_spectrum(sfdae_spectrum* s);
size_t fill_linearization(sfdae_linearization* s);
size_t fill_descriptor_matrices(sfdae_descriptor_matrices* s);
size_t fill_options(sfdae_options* s);
size_t fill_ensemble(sfdae_ensemble* s);
size_t fill_ensemble_progress(sfdae_ensemble_progress* s);
size_t fill_ensemble_results(sfdae_ensemble_results* s);
size_t fill_expression(sfdae_expression* s);

/* Addresses stand for numbers: entry k of this array for k. */
static double numbers[32];
static int integers[32];
static int matrix_1(double t, int order, double* m, void* user) {
  (void)t, (void)order, (void)m, (void)user;
  return 1;
}
static int matrix_2(double t, int order, double* m, void* user) {
  (void)t, (void)order, (void)m, (void)user;
  return 2;
}
static int vector_3(double t, int order, double* v, void* user) {
  (void)t, (void)order, (void)v, (void)user;
  return 3;
}
static int vector_4(double t, int order, double* v, void* user) {
  (void)t, (void)order, (void)v, (void)user;
  return 4;
}
static int monitor_5(const sfdae_progress* progress, void* user) {
  (void)progress, (void)user;
  return 5;
}

size_t fill_characteristics(sfdae_characteristics* s) {
  const sfdae_characteristics value = {1, 2.0, 3, 4, 5, 6, 7, 8, 9, 10.0, 11.0};
  *s = value;
  return sizeof value;
}

size_t fill_decision(sfdae_decision* s) {
  const sfdae_decision value = {1, 2.0, 3, 4, 5, 6, 7, 8, 9.0, 10.0, 11.0, 12.0, 13.0, 14};
  *s = value;
  return sizeof value;
}

size_t fill_change(sfdae_change* s) {
  const sfdae_change value = {1, 2.0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  *s = value;
  return sizeof value;
}

size_t fill_initial_report(sfdae_initial_report* s) {
  const sfdae_initial_report value = {1, 2.0, 3.0, 4.0, 5.0, 6, 7};
  *s = value;
  return sizeof value;
}

size_t fill_statistics(sfdae_statistics* s) {
  const sfdae_statistics value = {1,    2,    3,    4,    5,    6,  7,  8,    9,  10, 11, 12.0,
                                  13.0, 14.0, 15.0, 16.0, 17.0, 18, 19, 20.0, 21, 22, 23};
  *s = value;
  return sizeof value;
}

size_t fill_derivative_check(sfdae_derivative_check* s) {
  const sfdae_derivative_check value = {1, '2', 3, 4, 5, 6.0, 7.0, 8.0, 9.0, 10};
  *s = value;
  return sizeof value;
}

size_t fill_progress(sfdae_progress* s) {
  const sfdae_progress value = {1, 2.0, 3.0, 4, 5, 6, &numbers[7]};
  *s = value;
  numbers[7] = 7.0;
  return sizeof value;
}

size_t fill_linear_problem(sfdae_linear_problem* s) {
  const sfdae_linear_problem value = {1,
                                      2,
                                      3,
                                      matrix_1,
                                      matrix_2,
                                      vector_3,
                                      7,
                                      8,
                                      9,
                                      &integers[10],
                                      vector_4,
                                      &integers[12],
                                      (const char* const*)&integers[13],
                                      14,
                                      &integers[15],
                                      &integers[16],
                                      17,
                                      &integers[18],
                                      &integers[19],
                                      20,
                                      21,
                                      (sfdae_conditions_function)(void (*)(void))vector_4,
                                      &integers[23]};
  *s = value;
  integers[10] = 10, integers[12] = 12, integers[13] = 13;
  integers[15] = 15, integers[16] = 16, integers[18] = 18, integers[19] = 19, integers[23] = 23;
  return sizeof value;
}

/* Functions of other types, under the type that the test calls them by. */
size_t fill_nonlinear_problem(sfdae_nonlinear_problem* s) {
  const sfdae_nonlinear_problem value = {1,
                                         2,
                                         3,
                                         (sfdae_equations_function)(void (*)(void))matrix_1,
                                         (sfdae_linear_equations_function)(void (*)(void))matrix_2,
                                         (sfdae_total_derivative_function)(void (*)(void))vector_3,
                                         7,
                                         &integers[8],
                                         vector_4,
                                         &integers[10],
                                         &integers[11],
                                         (const char* const*)&integers[12],
                                         13,
                                         &integers[14],
                                         &integers[15],
                                         16,
                                         &integers[17],
                                         &integers[18],
                                         19,
                                         20,
                                         (sfdae_conditions_function)(void (*)(void))matrix_1,
                                         &integers[22],
                                         (sfdae_derivative_array_function)(void (*)(void))vector_3};
  *s = value;
  integers[8] = 8, integers[10] = 10, integers[11] = 11, integers[12] = 12;
  integers[14] = 14, integers[15] = 15, integers[17] = 17, integers[18] = 18, integers[22] = 22;
  return sizeof value;
}

size_t fill_multibody_problem(sfdae_multibody_problem* s) {
  const sfdae_multibody_problem value = {1,
                                         2,
                                         3,
                                         4,
                                         5,
                                         (sfdae_multibody_equations_function)(void (*)(void))matrix_1,
                                         (sfdae_position_function)(void (*)(void))matrix_2,
                                         (sfdae_velocity_function)(void (*)(void))vector_3,
                                         (sfdae_position_function)(void (*)(void))vector_4,
                                         (sfdae_position_function)(void (*)(void))matrix_1,
                                         (sfdae_position_function)(void (*)(void))matrix_2,
                                         (sfdae_position_function)(void (*)(void))vector_3,
                                         (sfdae_position_function)(void (*)(void))vector_4,
                                         (sfdae_position_function)(void (*)(void))matrix_1,
                                         (sfdae_velocity_function)(void (*)(void))matrix_2,
                                         (sfdae_velocity_function)(void (*)(void))vector_3,
                                         17,
                                         &integers[18],
                                         (const char* const*)&integers[19]};
  *s = value;
  integers[18] = 18, integers[19] = 19;
  return sizeof value;
}

size_t fill_multibody_formulas(sfdae_multibody_formulas* s) {
  static sfdae_expression places[7];
  const sfdae_multibody_formulas value = {&places[1], &places[2], &places[3], &places[4], &places[5], &places[6]};
  int i;
  for (i = 0; i < 7; i++) places[i].value = i;
  *s = value;
  return sizeof value;
}

size_t fill_multibody_report(sfdae_multibody_report* s) {
  const sfdae_multibody_report value = {1, 2.0, 3, 4, 5, 6, 7, 8.0, 9, 10.0, 11.0};
  *s = value;
  return sizeof value;
}

size_t fill_structure(sfdae_structure* s) {
  const sfdae_structure value = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10.0, 11};
  *s = value;
  return sizeof value;
}

size_t fill_spectrum(sfdae_spectrum* s) {
  const sfdae_spectrum value = {1, 2, 3, 4, 5, 6, 7, 8};
  *s = value;
  return sizeof value;
}

size_t fill_linearization(sfdae_linearization* s) {
  static const char* text = "6";
  const sfdae_linearization value = {1, 2.0,          &numbers[3], &numbers[4],   5,  &text,       7, &integers[8],
                                     9, &numbers[10], 11,          &integers[12], 13, &numbers[14]};
  *s = value;
  numbers[3] = 3.0, numbers[4] = 4.0, integers[8] = 8, numbers[10] = 10.0, integers[12] = 12, numbers[14] = 14.0;
  return sizeof value;
}

size_t fill_descriptor_matrices(sfdae_descriptor_matrices* s) {
  const sfdae_descriptor_matrices value = {
      1, 2, 3, 4, 5, &numbers[6], &numbers[7], &numbers[8], &numbers[9], &numbers[10], 11.0};
  int i;
  *s = value;
  for (i = 6; i <= 10; i++) numbers[i] = i;
  return sizeof value;
}

size_t fill_options(sfdae_options* s) {
  const sfdae_options value = {
      1,   2.0,           3.0,           &numbers[4], &numbers[5], 6,  7,    8.0,  9.0, 10,   11.0,
      12,  &integers[13], &numbers[14],  15,          16.0,        17, 18.0, 19.0, 20,  21.0, 22,
      23,  monitor_5,     &integers[25], 26,          27,          28, 29,   30,   31,  32,   33,
      34.0};
  *s = value;
  numbers[4] = 4.0, numbers[5] = 5.0, integers[13] = 13, numbers[14] = 14.0, integers[25] = 25;
  return sizeof value;
}

size_t fill_ensemble(sfdae_ensemble* s) {
  static const char* text = "4";
  const sfdae_ensemble value = {1,
                                2,
                                3,
                                &text,
                                &numbers[5],
                                6.0,
                                &numbers[7],
                                &numbers[8],
                                9,
                                &numbers[10],
                                11,
                                (sfdae_ensemble_monitor_function)(void (*)(void))matrix_1,
                                &integers[13]};
  *s = value;
  numbers[5] = 5.0, numbers[7] = 7.0, numbers[8] = 8.0, numbers[10] = 10.0, integers[13] = 13;
  return sizeof value;
}

size_t fill_ensemble_progress(sfdae_ensemble_progress* s) {
  const sfdae_ensemble_progress value = {1, 2, 3, 4, 5};
  *s = value;
  return sizeof value;
}

size_t fill_ensemble_results(sfdae_ensemble_results* s) {
  static char text = 6;
  const sfdae_ensemble_results value = {1, &numbers[2], &numbers[3], &integers[4], &integers[5], &text, 7, 8, 9, 10};
  *s = value;
  numbers[2] = 2.0, numbers[3] = 3.0, integers[4] = 4, integers[5] = 5;
  return sizeof value;
}

size_t fill_expression(sfdae_expression* s) {
  sfdae_expression value;
  value.record = (sfdae_record*)(void*)&numbers[1];
  value.value = 2.0;
  value.node = 3;
  *s = value;
  return sizeof value;
}
