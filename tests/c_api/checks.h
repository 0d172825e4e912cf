/* SPDX-License-Identifier: BSD-3-Clause
 * Checks of the C tests: a program returns 0 if none failed. */
#ifndef SFDAE_TESTS_CHECKS_H
#define SFDAE_TESTS_CHECKS_H

#include <stdio.h>
#include <stdlib.h>

#include <sfdae/sfdae.h>

static int failures = 0;
#define CHECK(condition) \
  ((condition) ? (void)0 : (void)(failures++, fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition)))
#define CHECK_STATUS(call, expected) check_status(__FILE__, __LINE__, #call, (call), (expected))

static void check_status(const char* file, int line, const char* call, int status, int expected) {
  if (status == expected) return;
  failures++;
  fprintf(stderr, "%s:%d: %s is %s, not %s\n", file, line, call, sfdae_status_name(status),
          sfdae_status_name(expected));
}

/* k if SFDAE_TEST_SCALE is below 1, otherwise 1: of many similar cases every k-th is tried. */
static inline int stride(int k) {
  const char* scale = getenv("SFDAE_TEST_SCALE");
  return scale && atof(scale) < 1 ? k : 1;
}

#endif
