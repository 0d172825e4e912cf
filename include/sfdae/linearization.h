/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - linearization at a point for control engineering: descriptor systems with their poles, zeros and transfer
 * functions.
 *
 *     E dx' = A dx + B du,   y = C dx + D du,     H(s) = C (s E - A)^-1 B + D
 *
 * E = F_x', A = -F_x, B = -F_u of F(t, x, x', u) = 0: the signs of E x' = A x + f, to which B u is added. For linear
 * problems E and A are those at t.
 *
 *     sfdae_linearization_init(&choice, sizeof choice);
 *     choice.num_input_parameters = 1;    choice.input_parameters = names;
 *     choice.num_output_unknowns = 1;     choice.output_unknowns = outputs;
 *     sfdae_linearize(solver, &choice, &descriptor);
 *     sfdae_get_poles(descriptor, &spectrum, real, imaginary, NULL);
 *
 * Meaning: E, A and B are frozen at the point: constant matrices. At an equilibrium, where F does not depend on t and
 * x' = 0, they are the linearization, for any strangeness index: the derivative array of (E, A) is that of F
 * linearized, and the finite eigenvalues are those of small deviations from the equilibrium. At other points of a
 * solution the linearization depends on t. The frozen matrices then describe the behavior on time scales on which they
 * do not change, for example fast poles. The frozen pencil may have another index or number of poles, or be singular
 * though the problem is regular: if the number of poles differs from d of the analysis, sfdae_get_poles reports
 * SFDAE_CHARACTERISTICS_CHANGED. The pencil of sfdae_get_strangeness_free, E = [E1; 0], A = [A1; A2], has d poles
 * everywhere, the same ones at equilibria; but elsewhere they depend on the choice of Z1, since A2' matters. It also
 * lacks the derivatives of u, so B has no meaning with it. Hence the pencil is that of F; sfdae_create_descriptor
 * accepts any other.
 *
 * Inputs are functions of time. For strangeness indices above 0 (or singular E) their derivatives matter: they are in
 * the transfer function, which is then unbounded as s grows.
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_LINEARIZATION_H
#define SFDAE_LINEARIZATION_H

#ifdef __cplusplus
extern "C" {
#endif

/** A descriptor system with m equations, n unknowns, q inputs and p outputs. It belongs to no solver. */
typedef struct sfdae_descriptor sfdae_descriptor;

/** The point of linearization, inputs and outputs. Call sfdae_linearization_init first, then set members. No pointer is
 * stored. n: unknowns, m: equations of the problem. Multibody systems have x = (q, v, lambda, kappa), m = n. */
typedef struct sfdae_linearization {
  size_t size; /**< set by sfdae_linearization_init */

  double t; /**< default 0 */
  /** n values, or NULL (default): the solution at t, as for sfdae_get_jet. Linear problems: not used unless an input
   * multiplies an unknown. */
  const double* x;
  /** n values, or NULL (default): those of sfdae_get_jet through x. If both are given, they need not be consistent and
   * no analysis is needed: F is linearized there. */
  const double* xdot;

  /** Inputs: first parameters (sfdae_parameter) of recorded equations, which are treated as functions of time. If
   * equations contain the derivative of an input, write it as an unknown. */
  int num_input_parameters;
  const char* const* input_parameters; /**< their names, no two equal */
  /** Then unknowns that are inputs: x_j = u is one more equation, E and A have one more row. Other prescribed
   * components are held constant: dx_j = 0 is one more equation, after these. */
  int num_input_unknowns;
  const int* input_unknowns; /**< 0 <= j < n, no two equal */
  /** Then right-hand sides: B has these columns, f + B u of linear problems, F = B u of others. */
  int num_input_columns;
  const double* input_columns; /**< m x num_input_columns */

  /** Outputs: first unknowns, then combinations C x of them. For others write an equation 0 = y - h(t, x). */
  int num_output_unknowns;
  const int* output_unknowns; /**< 0 <= j < n */
  int num_output_rows;
  const double* output_rows; /**< num_output_rows x n */
} sfdae_linearization;
/** Sets every member to its default: no inputs, no outputs. size: sizeof(sfdae_linearization). SFDAE_ILLEGAL_ARGUMENT
 * for NULL. */
SFDAE_API int sfdae_linearization_init(sfdae_linearization* choice, size_t size);

/** Creates the descriptor system of a problem of any kind, linearized at a point. An integration is not affected; the
 * parameters have the values of the solver. If derivatives of callbacks are finite differences, A has their errors. On
 * failure *descriptor is NULL, sfdae_message(solver) explains it.
 * Failures: callbacks, those of sfdae_get_jet; SFDAE_ILLEGAL_ARGUMENT for more than 5000 equations or unknowns;
 * SFDAE_NOT_STARTED if the solution is needed and not known. */
SFDAE_API int sfdae_linearize(sfdae_solver* solver, const sfdae_linearization* choice, sfdae_descriptor** descriptor);

/** Matrices of a descriptor system, column-major. Call sfdae_descriptor_matrices_init first, then set members. */
typedef struct sfdae_descriptor_matrices {
  size_t size;       /**< set by sfdae_descriptor_matrices_init */
  int num_equations; /**< m, 1 ... 5000 */
  int num_unknowns;  /**< n, 1 ... 5000 */
  int num_inputs;    /**< q, 0 ... 5000, default 0 */
  int num_outputs;   /**< p, 0 ... 5000, default 0 */
  const double* E;   /**< m x n */
  const double* A;   /**< m x n */
  const double* B;   /**< m x q, NULL: 0 */
  const double* C;   /**< p x n, NULL: 0 */
  const double* D;   /**< p x q, NULL (default): 0 */
  double rank_tol;   /**< of sfdae_options, for poles and zeros; default 0 */
} sfdae_descriptor_matrices;
/** Sets every member to its default. size: sizeof(sfdae_descriptor_matrices). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_descriptor_matrices_init(sfdae_descriptor_matrices* matrices, size_t size);

/** Creates a descriptor system of matrices, which are copied. SFDAE_ILLEGAL_ARGUMENT for sizes out of range, NULL and
 * numbers that are not finite; *descriptor is then NULL, and sfdae_message(NULL) explains the failure. */
SFDAE_API int sfdae_create_descriptor(const sfdae_descriptor_matrices* matrices, sfdae_descriptor** descriptor);

/** Destroys the descriptor system and sets *descriptor to NULL. NULL is allowed. */
SFDAE_API int sfdae_destroy_descriptor(sfdae_descriptor** descriptor);

/** The message of the last call with this descriptor system, "" if there is none; valid until the next call. */
SFDAE_API const char* sfdae_descriptor_message(const sfdae_descriptor* descriptor);

/** m, n, q, p: numbers of equations, unknowns, inputs, outputs. Any pointer may be NULL. */
SFDAE_API int sfdae_get_descriptor_sizes(const sfdae_descriptor* descriptor, int* num_equations, int* num_unknowns,
                                         int* num_inputs, int* num_outputs);

/** E and A, m x n; B, m x q; C, p x n; D, p x q. Any pointer may be NULL. */
SFDAE_API int sfdae_get_descriptor_matrices(const sfdae_descriptor* descriptor, double* E, double* A, double* B,
                                            double* C, double* D);

/** Properties of a pencil lambda E - A. Call sfdae_spectrum_init first. */
typedef struct sfdae_spectrum {
  size_t size;
  int num_finite;   /**< finite eigenvalues, with their multiplicities; at most n */
  int num_infinite; /**< multiplicity of infinity; -1 (unknown) for singular pencils */
  /** Characteristic values of E x' = A x; chains at infinity have the length strangeness_index + 1 at most. */
  int strangeness_index; /**< mu */
  int differential;      /**< d, which is num_finite for regular pencils */
  int algebraic;         /**< a */
  int undetermined;      /**< u */
  int redundant;         /**< v; the pencil is regular if u and v are 0 */
} sfdae_spectrum;
/** Prepares a result of sfdae_get_poles and sfdae_get_zeros. size: sizeof(sfdae_spectrum). */
SFDAE_API int sfdae_spectrum_init(sfdae_spectrum* spectrum, size_t size);

/** Poles: the finite eigenvalues of lambda E - A, sorted by size, conjugate ones together, that with the positive
 * imaginary part first. real, imaginary: room for n values each, num_finite are written. errors (NULL: not wanted), n:
 * estimates of the absolute errors that rounding errors of the entries of E and A cause; multiple poles have large
 * ones. The pencil is reduced like a linear problem of any index: QZ of the original pencil turns chains at infinity of
 * length k into numbers of size eps^(-1/k), which look like eigenvalues. Small poles keep their digits next to large
 * ones, and units do not matter.
 * Failures: SFDAE_SINGULAR if the pencil is singular (also if m and n differ); SFDAE_RANK_UNCLEAR, SFDAE_INDEX_TOO_HIGH
 * (above 12); SFDAE_CHARACTERISTICS_CHANGED if the problem was analyzed, nothing is prescribed or an input unknown, and
 * solutions have another number d of differential equations than the frozen pencil: the point is no equilibrium. */
SFDAE_API int sfdae_get_poles(sfdae_descriptor* descriptor, sfdae_spectrum* spectrum, double* real, double* imaginary,
                              double* errors);

/** Invariant zeros: the finite eigenvalues of the system pencil [s E - A, -B; C, D], (m + p) x (n + q), returned as
 * poles by sfdae_get_poles; *spectrum is that of this pencil. If the system is not square, or the pencil is singular
 * for another reason, they are those of its regular part: numbers s at which its rank drops. Uncontrollable and
 * unobservable poles are zeros. There are at most n. Failures: SFDAE_RANK_UNCLEAR, SFDAE_INDEX_TOO_HIGH. */
SFDAE_API int sfdae_get_zeros(sfdae_descriptor* descriptor, sfdae_spectrum* spectrum, double* real, double* imaginary,
                              double* errors);

/** Transfer function H(s) = C (s E - A)^-1 B + D at `count` numbers s (i omega for frequency responses). real,
 * imaginary: their parts. H_real, H_imaginary: p x q x count, H of s[k] from k p q on; entries not computed are
 * untouched. SFDAE_SINGULAR if an s is a pole to roundoff, or the pencil is singular: values before that are
 * written. */
SFDAE_API int sfdae_get_transfer(sfdae_descriptor* descriptor, int count, const double* real, const double* imaginary,
                                 double* H_real, double* H_imaginary);

#ifdef __cplusplus
}
#endif

#endif
