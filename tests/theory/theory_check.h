/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The theory's objects of any problem, checked by their defining properties through the C API alone. */
#ifndef SFDAE_TESTS_THEORY_CHECK_H
#define SFDAE_TESTS_THEORY_CHECK_H

#include <sfdae/sfdae.h>

#ifdef __cplusplus
extern "C" {
#endif

enum theory_kind { THEORY_LINEAR, THEORY_NONLINEAR, THEORY_MULTIBODY, THEORY_MULTIBODY_CALLBACKS };

typedef struct theory_subject {
  const char* name;
  enum theory_kind kind;
  int m, n;
  sfdae_solver* solver; /* analyzed, or with an integration */
} theory_subject;

/* Checks all properties at t, for a solution that is known there. Returns how many are violated; each is printed. */
int theory_check(const theory_subject* subject, double t);

/* Those of linear problems at any t: no solution is needed. */
int theory_check_linear(const theory_subject* subject, double t);

#ifdef __cplusplus
}
#endif

#endif
