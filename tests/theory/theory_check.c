/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The theory's objects by their defining properties.
 *
 * Bounds. Products that vanish are sums of `rows` terms, each with a rounding error of Z2, T2, ... that is backward
 * stable in the units in which the library balances the array: relative to the rows and columns of the matrices, not
 * to their largest entries. A basis of a null space is known to rounding over the smallest pivot kept, and pivots are
 * kept down to some 1e-8 of the data without doubt: 1e-8 of the product of the lengths. Residuals of stiff equations
 * cancel within formulas, where their size is not seen: a jet counts as consistent at 1e-9, here at 1e-7. What is
 * computed from differences of callbacks has an error of 1e-7 and enters E1, A1, A2 only, not those products. */
#include "theory_check.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double small = 1e-8;
/* Of the array of the flexible slider crank, with entries 1e12 apart: 1.1e-8 with the reference BLAS. */
static const double small_in_array = 1e-7;

/* ---- Small dense algebra, column-major -------------------------------------------------------------------- */

static double* vector(int count) { return (double*)calloc((size_t)count + 1, sizeof(double)); }

static double dot(const double* x, const double* y, int count) {
  double sum = 0;
  int i;
  for (i = 0; i < count; i++) sum += x[i] * y[i];
  return sum;
}

static double length(const double* x, int count) { return sqrt(dot(x, x, count)); }

/* X^T Y */
static double* transpose_product(const double* X, const double* Y, int rows, int p, int q) {
  double* result = vector(p * q);
  int i, j;
  for (j = 0; j < q; j++)
    for (i = 0; i < p; i++) result[i + p * j] = dot(X + rows * i, Y + rows * j, rows);
  return result;
}

static double* transposed(const double* X, int rows, int columns) {
  double* result = vector(rows * columns);
  int i, j;
  for (j = 0; j < columns; j++)
    for (i = 0; i < rows; i++) result[j + columns * i] = X[i + rows * j];
  return result;
}

/* max |x_i^T y_j| / (|x_i| |y_j|) over columns; infinite for NaN. */
static double largest_cosine(const double* X, const double* Y, int rows, int p, int q) {
  double worst = 0;
  int i, j;
  for (j = 0; j < q; j++)
    for (i = 0; i < p; i++) {
      const double size = length(X + rows * i, rows) * length(Y + rows * j, rows);
      const double cosine = fabs(dot(X + rows * i, Y + rows * j, rows));
      if (cosine == 0 && size == 0) continue;
      if (!(cosine <= DBL_MAX && size <= DBL_MAX)) return HUGE_VAL;
      if (cosine / (size > 0 ? size : DBL_MIN) > worst) worst = cosine / (size > 0 ? size : DBL_MIN);
    }
  return worst;
}

/* max |Q^T Q - I| */
static double defect_of_orthonormality(const double* Q, int rows, int columns) {
  double* product = transpose_product(Q, Q, rows, columns, columns);
  double worst = 0;
  int i, j;
  for (j = 0; j < columns; j++)
    for (i = 0; i < columns; i++) {
      const double defect = fabs(product[i + columns * j] - (i == j));
      if (!(defect <= worst)) worst = defect <= DBL_MAX ? defect : HUGE_VAL;
    }
  free(product);
  return worst;
}

/* The smallest part of a row of X that is independent of the others, by Gram and Schmidt with pivoting, rows and
 * columns of length 1 at first; 0 for more rows than columns. */
static double smallest_independent_part(const double* X, int rows, int columns) {
  double* R = transposed(X, rows, columns); /* row i of X is column i */
  double smallest = 1;
  int i, j, k;
  for (k = 0; k < 4; k++) {
    for (j = 0; j < columns; j++) {
      double largest = 0;
      for (i = 0; i < rows; i++) largest = fmax(largest, fabs(R[j + columns * i]));
      for (i = 0; i < rows && largest > 0; i++) R[j + columns * i] /= largest;
    }
    for (i = 0; i < rows; i++) {
      const double size = length(R + columns * i, columns);
      for (j = 0; j < columns && size > 0; j++) R[j + columns * i] /= size;
    }
  }
  for (k = 0; k < rows; k++) {
    int pivot = k, pass;
    double size = 0;
    for (i = k; i < rows; i++)
      if (length(R + columns * i, columns) > size) size = length(R + columns * i, columns), pivot = i;
    if (!(size < smallest)) size = size > 0 ? size : 0;
    else smallest = size;
    if (!(size > 0)) {
      smallest = 0;
      break;
    }
    for (j = 0; j < columns; j++) {
      const double swapped = R[j + columns * pivot] / size;
      R[j + columns * pivot] = R[j + columns * k];
      R[j + columns * k] = swapped;
    }
    for (i = k + 1; i < rows; i++)
      for (pass = 0; pass < 2; pass++) {
        const double part = dot(R + columns * i, R + columns * k, columns);
        for (j = 0; j < columns; j++) R[j + columns * i] -= part * R[j + columns * k];
      }
  }
  free(R);
  return smallest;
}

/* ---- Objects of one solver at one point ------------------------------------------------------------------- */

typedef struct objects {
  const theory_subject* subject;
  double t;
  int mu, d, a, u, rows, columns; /* of M */
  int vhat, redundant;
  int has_jet, has_array;
  double *jet, *M, *N, *g, *Z1, *Z2, *Z3, *T2, *E1, *A1, *f1, *A2, *f2;
  double residual;
  int violations;
} objects;

static void demand(objects* o, int condition, const char* what, double value) {
  if (condition) return;
  o->violations++;
  fprintf(stderr, "%s, t = %.15g: %s (%.3g)\n", o->subject->name, o->t, what, value);
}

static void demand_status(objects* o, int status, const char* call) {
  if (status >= 0) return;
  o->violations++;
  fprintf(stderr, "%s, t = %.15g: %s is %s: %s\n", o->subject->name, o->t, call, sfdae_status_name(status),
          sfdae_message(o->subject->solver));
}

static void measure(const char* what, double value) {
  static int enabled = -1;
  if (enabled < 0) enabled = getenv("SFDAE_THEORY_MEASURE") != NULL;
  if (enabled) printf("MEASURE %s %.2e\n", what, value);
}

static void allocate(objects* o) {
  const int m = o->subject->m, n = o->subject->n;
  o->jet = vector(n * (o->mu + 2));
  o->M = vector(o->rows * o->columns);
  o->N = vector(o->rows * n);
  o->g = vector(o->rows);
  o->Z1 = vector(m * o->d);
  o->Z2 = vector(o->rows * o->a);
  o->Z3 = vector(o->rows * o->rows);
  o->T2 = vector(n * (n - o->a));
  o->E1 = vector(o->d * n);
  o->A1 = vector(o->d * n);
  o->f1 = vector(o->d);
  o->A2 = vector(o->a * n);
  o->f2 = vector(o->a);
}

static void release(objects* o) {
  double* const all[] = {o->jet, o->M, o->N, o->g, o->Z1, o->Z2, o->Z3, o->T2, o->E1, o->A1, o->f1, o->A2, o->f2};
  size_t i;
  for (i = 0; i < sizeof all / sizeof all[0]; i++) free(all[i]);
}

static void read_sizes(objects* o) {
  sfdae_solver* solver = o->subject->solver;
  sfdae_characteristics c;
  sfdae_characteristics_init(&c, sizeof c);
  demand_status(o, sfdae_get_characteristics(solver, &c), "sfdae_get_characteristics");
  o->mu = c.strangeness_index;
  o->d = c.differential;
  o->a = c.algebraic;
  o->u = c.undetermined;
  o->rows = (o->mu + 1) * o->subject->m;
  o->columns = (o->mu + 1) * o->subject->n;
  o->has_array = o->subject->kind != THEORY_MULTIBODY_CALLBACKS;
  if (o->subject->kind == THEORY_MULTIBODY || o->subject->kind == THEORY_MULTIBODY_CALLBACKS) {
    sfdae_multibody_report report;
    sfdae_multibody_report_init(&report, sizeof report);
    sfdae_get_multibody_report(solver, &report);
    o->redundant = report.redundant;
  }
}

/* All at one jet of the solution, or at t alone. */
static void read_objects(objects* o) {
  sfdae_solver* solver = o->subject->solver;
  const double t = o->t, *jet = o->jet;
  if (!o->has_jet) {
    demand_status(o, sfdae_get_derivative_array(solver, t, o->mu, o->M, o->N, o->g), "sfdae_get_derivative_array");
    demand_status(o, sfdae_get_projectors(solver, t, o->Z1, o->Z2, o->Z3, o->T2, &o->vhat), "sfdae_get_projectors");
    demand_status(o, sfdae_get_strangeness_free(solver, t, o->E1, o->A1, o->f1, o->A2, o->f2, &o->residual),
                  "sfdae_get_strangeness_free");
    return;
  }
  demand_status(o, sfdae_get_jet(solver, t, NULL, o->has_array ? o->mu : 0, o->jet), "sfdae_get_jet");
  demand_status(o, sfdae_get_derivative_array_at(solver, t, jet, o->has_array ? o->mu : 0, o->M, o->N, o->g),
                "sfdae_get_derivative_array_at");
  if (o->has_array)
    demand_status(o, sfdae_get_projectors_at(solver, t, jet, o->Z1, o->Z2, o->Z3, o->T2, &o->vhat),
                  "sfdae_get_projectors_at");
  else
    demand_status(o, sfdae_get_projectors_at(solver, t, jet, o->Z1, NULL, NULL, o->T2, NULL),
                  "sfdae_get_projectors_at");
  demand_status(o, sfdae_get_strangeness_free_at(solver, t, jet, o->E1, o->A1, o->f1, o->A2, o->f2, &o->residual),
                "sfdae_get_strangeness_free_at");
}

/* ---- Properties --------------------------------------------------------------------------------------------- */

/* What is added up in row i of F_l: the terms of M y and N x, and at least those of unknowns of size 1, as constants
 * may cancel. */
static double size_of_row(const objects* o, int rows, int row) {
  const int n = o->subject->n, columns = rows / o->subject->m * n;
  double size = 0, largest = 0;
  int j;
  for (j = 0; j < columns; j++) {
    size += fabs(o->M[row + rows * j] * o->jet[n + j]);
    largest = fmax(largest, fabs(o->M[row + rows * j]));
  }
  for (j = 0; j < n; j++) {
    size += fabs(o->N[row + rows * j] * o->jet[j]);
    largest = fmax(largest, fabs(o->N[row + rows * j]));
  }
  return size + largest;
}

static void check_array(objects* o) {
  const int rows = o->rows, n = o->subject->n, a = o->a - o->redundant;
  double cosine, *A2;
  demand(o, o->vhat >= 0 && o->vhat <= rows - a, "vhat", o->vhat);
  cosine = defect_of_orthonormality(o->Z2, rows, a);
  measure("orthonormal", cosine);
  demand(o, cosine <= 100 * DBL_EPSILON * rows, "Z2 is not orthonormal", cosine);
  cosine = defect_of_orthonormality(o->Z3, rows, o->vhat);
  demand(o, cosine <= 100 * DBL_EPSILON * rows, "Z3 is not orthonormal", cosine);
  cosine = largest_cosine(o->Z2, o->Z3, rows, a, o->vhat);
  demand(o, cosine <= 100 * DBL_EPSILON * rows, "Z2 and Z3 are not orthogonal", cosine);
  cosine = largest_cosine(o->Z2, o->M, rows, a, o->columns);
  measure("Z2M", cosine);
  demand(o, cosine <= small_in_array, "Z2^T M is not 0", cosine);
  cosine = largest_cosine(o->Z3, o->M, rows, o->vhat, o->columns);
  measure("Z3M", cosine);
  demand(o, cosine <= small_in_array, "Z3^T M is not 0", cosine);
  cosine = largest_cosine(o->Z3, o->N, rows, o->vhat, n);
  measure("Z3N", cosine);
  demand(o, cosine <= small_in_array, "Z3^T N is not 0", cosine);
  A2 = transpose_product(o->Z2, o->N, rows, a, n);
  {
    double* rows_of_A2 = transposed(A2, a, n);
    cosine = largest_cosine(rows_of_A2, o->T2, n, a, n - o->a);
    measure("Z2NT2", cosine);
    demand(o, cosine <= small_in_array, "Z2^T N T2 is not 0", cosine);
    free(rows_of_A2);
  }
  cosine = smallest_independent_part(A2, a, n);
  measure("rankZ2N", -cosine);
  demand(o, a == 0 || cosine > 1e-13, "Z2^T N has not full row rank", cosine);
  free(A2);
}

static void check_system(objects* o) {
  const int m = o->subject->m, n = o->subject->n, d = o->d, a = o->a, level0 = o->has_array ? o->rows : m;
  double *both = vector((d + a) * n), *E = vector(m * n), *ET2, *E1, *rows_of_A2, value;
  int i, j;
  value = defect_of_orthonormality(o->Z1, m, d);
  demand(o, value <= 100 * DBL_EPSILON * m, "Z1 is not orthonormal", value);
  value = defect_of_orthonormality(o->T2, n, n - a);
  demand(o, value <= 100 * DBL_EPSILON * n, "T2 is not orthonormal", value);
  rows_of_A2 = transposed(o->A2, a, n);
  value = largest_cosine(rows_of_A2, o->T2, n, a, n - a);
  measure("A2T2", value);
  demand(o, value <= small, "A2 T2 is not 0", value);
  /* E, of M the first block; Z1^T E T2 is what is left of E T2. */
  for (j = 0; j < n; j++)
    for (i = 0; i < m; i++) E[i + m * j] = o->M[i + level0 * j];
  E1 = transpose_product(o->Z1, E, m, d, n);
  for (i = 0, value = 0; i < d * n; i++) value = fmax(value, fabs(E1[i] - o->E1[i]));
  demand(o, value <= 100 * DBL_EPSILON * m * (1 + length(E, m * n)), "E1 is not Z1^T E", value);
  ET2 = vector(m * (n - a));
  for (j = 0; j < n - a; j++)
    for (i = 0; i < m; i++) {
      int k;
      for (k = 0; k < n; k++) ET2[i + m * j] += E[i + m * k] * o->T2[k + n * j];
    }
  for (j = 0, value = 0; j < n - a; j++) {
    double* column = ET2 + m * j;
    const double scale = length(E, m * n);
    int k;
    for (k = 0; k < d; k++) {
      const double part = dot(column, o->Z1 + m * k, m);
      for (i = 0; i < m; i++) column[i] -= part * o->Z1[i + m * k];
    }
    if (scale > 0) value = fmax(value, length(column, m) / scale);
  }
  measure("rangeET2", value);
  demand(o, value <= small, "Z1 does not span the range of E T2", value);
  for (j = 0; j < n; j++) {
    for (i = 0; i < d; i++) both[i + (d + a) * j] = o->E1[i + d * j];
    for (i = 0; i < a; i++) both[d + i + (d + a) * j] = o->A2[i + a * j];
  }
  demand(o, o->u > 0 || d + a == n, "d + a is not n", d + a);
  value = smallest_independent_part(both, d + a, n);
  measure("E1A2", -value);
  demand(o, d + a == 0 || value > 1e-13, "[E1; A2] has not full row rank", value);
  free(both), free(E), free(ET2), free(E1), free(rows_of_A2);
}

/* F_mu = 0 at the jet, so that f1 and f2 vanish. */
static void check_residuals(objects* o) {
  const int m = o->subject->m, rows = o->has_array ? o->rows : m;
  double worst = 0, scale1 = 0, scale2 = 0;
  int i;
  for (i = 0; i < rows; i++) {
    const double size = size_of_row(o, rows, i);
    worst = fmax(worst, fabs(o->g[i]) / (size + DBL_EPSILON));
    scale2 = fmax(scale2, size);
    if (i < m) scale1 = fmax(scale1, size);
  }
  measure("residual", worst);
  demand(o, worst <= 10 * small, "F_mu is not 0 at the jet", worst);
  for (i = 0, worst = 0; i < o->d; i++) worst = fmax(worst, fabs(o->f1[i]));
  demand(o, worst <= small * m * scale1 + DBL_EPSILON, "f1 is not 0", worst);
  for (i = 0, worst = 0; i < o->a; i++) {
    double size = scale2;
    int j;
    for (j = 0; j < o->subject->n; j++) size += fabs(o->A2[i + o->a * j] * o->jet[j]);
    worst = fmax(worst, fabs(o->f2[i]) / (size + DBL_EPSILON));
  }
  measure("f2", worst);
  demand(o, worst <= small * rows, "f2 is not 0", worst);
}

/* The functions without a jet say the same of the solution at t. */
static void check_without_jet(objects* o) {
  sfdae_solver* solver = o->subject->solver;
  const int rows = o->has_array ? o->rows : o->subject->m, columns = o->has_array ? o->columns : o->subject->n;
  double *M = vector(rows * columns), *E1 = vector(o->d * o->subject->n), *A2 = vector(o->a * o->subject->n);
  double worst = 0, size = length(o->M, rows * columns);
  int i;
  demand_status(o, sfdae_get_derivative_array(solver, o->t, o->has_array ? o->mu : 0, M, NULL, NULL),
                "sfdae_get_derivative_array");
  for (i = 0; i < rows * columns; i++) worst = fmax(worst, fabs(M[i] - o->M[i]));
  measure("sameM", worst / (size + DBL_MIN));
  demand(o, worst <= small * size, "the array of the solution differs from that of its jet", worst);
  demand_status(o, sfdae_get_strangeness_free(solver, o->t, E1, NULL, NULL, A2, NULL, NULL),
                "sfdae_get_strangeness_free");
  /* Bases may differ, spaces do not. */
  {
    double* rows_of_A2 = transposed(A2, o->a, o->subject->n);
    worst = largest_cosine(rows_of_A2, o->T2, o->subject->n, o->a, o->subject->n - o->a);
    demand(o, worst <= small, "A2 of the solution differs from that of its jet", worst);
    free(rows_of_A2);
  }
  free(M), free(E1), free(A2);
}

/* ---- Extended systems of multibody systems ------------------------------------------------------------------ */

/* to := rows x count matrix X times Q, Q of order count. */
static void multiply(const double* X, const double* Q, int rows, int count, double* to) {
  int i, j, k;
  for (j = 0; j < count; j++)
    for (i = 0; i < rows; i++)
      for (k = 0, to[i + rows * j] = 0; k < count; k++) to[i + rows * j] += X[i + rows * k] * Q[k + count * j];
}

/* The extended system E X' = A X + f is strangeness-free with d differential equations if E has rank d and A is
 * regular from ker E to what E does not reach. ker E are the directions Q2, the multipliers and w, so that the matrix
 * [E Q1, A Q2, A (mu, w)] has to be regular, which E Q2 = 0 makes enough. */
static void check_extended(objects* o) {
  sfdae_multibody_report report;
  int nq, nv, rq, rv, order, i, j;
  double *Qq, *Qv, *E, *A, *f, *w, *EQ, *AQ, *rows, worst, size = 0;
  sfdae_multibody_report_init(&report, sizeof report);
  sfdae_get_multibody_report(o->subject->solver, &report);
  /* n = nq + nv + nl + nk */
  rv = report.holonomic + report.nonholonomic - report.redundant;
  nv = report.degrees_of_freedom + rv;
  nq = o->subject->n - nv - report.holonomic - report.nonholonomic;
  rq = nq - report.position_freedom;
  order = o->subject->n + rq + rv;
  Qq = vector(nq * nq), Qv = vector(nv * nv), E = vector(order * order), A = vector(order * order);
  EQ = vector(order * order), AQ = vector(order * order), f = vector(order), w = vector(rq + rv);
  demand_status(o, sfdae_get_extended_system(o->subject->solver, o->t, NULL, Qq, Qv, E, A, f, w),
                "sfdae_get_extended_system");
  worst = fmax(defect_of_orthonormality(Qq, nq, nq), defect_of_orthonormality(Qv, nv, nv));
  demand(o, worst <= 100 * DBL_EPSILON * (nq + nv), "[Q1 Q2] is not orthonormal", worst);
  for (i = 0, worst = 0; i < order; i++) {
    double row = 0;
    for (j = 0; j < o->subject->n; j++) row += fabs(A[i + order * j] * o->jet[j]);
    for (j = 0; j < rq + rv; j++) row += fabs(A[i + order * (o->subject->n + j)] * w[j]);
    size = fmax(size, row);
    worst = fmax(worst, fabs(f[i]));
  }
  measure("extendedf", worst / (size + DBL_EPSILON));
  demand(o, worst <= small * size + DBL_EPSILON, "the extended system is not fulfilled", worst);
  demand(o, o->d == nq - rq + nv - rv, "d is not the number of directions Q1", o->d);
  memcpy(EQ, E, sizeof(double) * (size_t)(order * order));
  memcpy(AQ, A, sizeof(double) * (size_t)(order * order));
  multiply(E, Qq, order, nq, EQ), multiply(E + order * nq, Qv, order, nv, EQ + order * nq);
  multiply(A, Qq, order, nq, AQ), multiply(A + order * nq, Qv, order, nv, AQ + order * nq);
  for (j = 0, worst = 0; j < order; j++) {
    const int is_Q1 = j < nq - rq || (j >= nq && j < nq + nv - rv);
    if (is_Q1) memcpy(AQ + order * j, EQ + order * j, sizeof(double) * (size_t)order);
    else worst = fmax(worst, length(EQ + order * j, order));
  }
  size = length(E, order * order);
  demand(o, worst <= 100 * DBL_EPSILON * (nq + nv) * size, "E Q2 is not 0", worst);
  rows = transposed(AQ, order, order);
  worst = smallest_independent_part(rows, order, order);
  measure("extended", -worst);
  demand(o, worst > 1e-13, "the extended system is not strangeness-free", worst);
  free(Qq), free(Qv), free(E), free(A), free(f), free(w), free(EQ), free(AQ), free(rows);
}

/* ---- Entries -------------------------------------------------------------------------------------------------- */

static int check(const theory_subject* subject, double t, int has_jet) {
  objects o;
  memset(&o, 0, sizeof o);
  o.subject = subject;
  o.t = t;
  o.has_jet = has_jet;
  read_sizes(&o);
  if (o.violations > 0) return o.violations;
  allocate(&o);
  read_objects(&o);
  if (o.violations == 0) {
    if (o.has_array) check_array(&o);
    check_system(&o);
    if (has_jet) {
      check_residuals(&o);
      if (subject->kind != THEORY_LINEAR) check_without_jet(&o);
      if (subject->kind == THEORY_MULTIBODY || subject->kind == THEORY_MULTIBODY_CALLBACKS) check_extended(&o);
    }
  }
  release(&o);
  return o.violations;
}

int theory_check(const theory_subject* subject, double t) { return check(subject, t, 1); }
int theory_check_linear(const theory_subject* subject, double t) { return check(subject, t, 0); }
