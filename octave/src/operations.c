/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Operations of formulas. erf and erfc are functions that the library calls with their derivatives. */
#include "operations.h"

#include <math.h>
#include <string.h>

/* Derivatives of erf (sign 1) or erfc (-1): Hermite polynomials times exp(-a^2), H_(k+1) = 2 a H_k - 2 k H_(k-1). */
static int error_function(int order, double a, double value, double sign, double* derivatives) {
  double before = 0.0, now = 1.0;
  int k;
  if (order == 0) {
    derivatives[0] = value;
    return 0;
  }
  for (k = 0; k < order - 1; ++k) {
    const double next = 2.0 * a * now - 2.0 * k * before;
    before = now;
    now = next;
  }
  derivatives[0] = sign * (order % 2 ? 1.0 : -1.0) * 1.1283791670955126 * now * exp(-a * a); /* 2 / sqrt(pi) */
  return 0;
}

static int call_erf(int order, const double* arguments, double* derivatives, void* user) {
  (void)user;
  return error_function(order, arguments[0], erf(arguments[0]), 1.0, derivatives);
}

static int call_erfc(int order, const double* arguments, double* derivatives, void* user) {
  (void)user;
  return error_function(order, arguments[0], erfc(arguments[0]), -1.0, derivatives);
}

static sfdae_expression erf_of(sfdae_expression a) {
  if (a.record == NULL) return sfdae_number(erf(a.value));
  return sfdae_external("erf", call_erf, 1, &a, NULL);
}

static sfdae_expression erfc_of(sfdae_expression a) {
  if (a.record == NULL) return sfdae_number(erfc(a.value));
  return sfdae_external("erfc", call_erfc, 1, &a, NULL);
}

#define UNARY(name, function) \
  { name, 1, function, NULL, NULL }
#define BINARY(name, function) \
  { name, 2, NULL, function, NULL }

/* The order of the first ones is that of the enumeration in operations.h. */
const sfdae_operation sfdae_operations[] = {
    {"dead", 0, NULL, NULL, NULL},
    {"variable", 0, NULL, NULL, NULL},
    {"number", 0, NULL, NULL, NULL},
    {"parameter", 0, NULL, NULL, NULL},
    {"table", 1, NULL, NULL, NULL},
    UNARY("negate", sfdae_negate),
    BINARY("add", sfdae_add),
    BINARY("subtract", sfdae_subtract),
    BINARY("multiply", sfdae_multiply),
    BINARY("divide", sfdae_divide),
    BINARY("power", sfdae_power),
    UNARY("sqrt", sfdae_sqrt),
    UNARY("exp", sfdae_exp),
    UNARY("log", sfdae_log),
    UNARY("log10", sfdae_log10),
    UNARY("sin", sfdae_sin),
    UNARY("cos", sfdae_cos),
    UNARY("tan", sfdae_tan),
    UNARY("asin", sfdae_asin),
    UNARY("acos", sfdae_acos),
    UNARY("atan", sfdae_atan),
    BINARY("atan2", sfdae_atan2),
    UNARY("sinh", sfdae_sinh),
    UNARY("cosh", sfdae_cosh),
    UNARY("tanh", sfdae_tanh),
    UNARY("abs", sfdae_abs),
    BINARY("min", sfdae_min),
    BINARY("max", sfdae_max),
    UNARY("sign", sfdae_sign),
    UNARY("floor", sfdae_floor),
    BINARY("modulo", sfdae_modulo),
    BINARY("less", sfdae_less),
    BINARY("less_equal", sfdae_less_equal),
    BINARY("greater", sfdae_greater),
    BINARY("greater_equal", sfdae_greater_equal),
    BINARY("and", sfdae_and),
    BINARY("or", sfdae_or),
    UNARY("not", sfdae_not),
    {"choose", 3, NULL, NULL, sfdae_choose},
    BINARY("derivative", sfdae_derivative),
    UNARY("time_derivative", sfdae_time_derivative),
    UNARY("erf", erf_of),
    UNARY("erfc", erfc_of),
};

const int sfdae_num_operations = (int)(sizeof sfdae_operations / sizeof sfdae_operations[0]);

int find_operation(const char* name) {
  int i;
  for (i = OP_NEGATE; i < sfdae_num_operations; ++i) {
    if (strcmp(sfdae_operations[i].name, name) == 0) return i;
  }
  return -1;
}
