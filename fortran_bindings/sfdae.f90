! SPDX-License-Identifier: BSD-3-Clause
!
! sfdae - initial value problems for differential-algebraic equations of arbitrary index.
!
!     F(t, x(t), x'(t)) = 0   or   E(t) x'(t) = A(t) x(t) + f(t),
!     m equations, n unknowns, any strangeness index.
!
! Extend one of these; its components are your data:
!
!     nonlinear_dae          `equations` writes F(t, x, x') once, as formulas
!     recorded_linear_dae    `linear_equations` writes E(t), A(t), f(t) once, as formulas
!     linear_dae             `eval_e`, `eval_a`, `eval_f` evaluate E, A, f and their derivatives
!     derivative_dae         `total_derivative` evaluates F and its total derivatives along a jet
!     recorded_multibody_dae `equations` writes a mechanical system with constraints as formulas
!     multibody_dae          `forces`, `constraints`, ... evaluate those of a mechanical system
!
! Then
!
!     type(my_problem), target :: problem
!     type(dae_solver) :: solver
!     call solver%create(problem, status)
!     call solver%start(t0, tend, x, status)
!     call solver%advance(tend, t, x, status)
!     call solver%destroy(status)
!
! Conventions
!  - This is the C API of sfdae.h with Fortran's manners. Components, rows, columns and rank
!    decisions count from 1. Constants and result types have the names they have in C.
!  - status: sfdae_ok, a remark (> 0) or a failure (< 0); solver%message() explains the last one.
!    After a failure output arguments keep their values, except where stated (advance, step).
!  - The problem and the monitor are pointed to, not copied: declare them with `target`, and let
!    them live, in place, as long as the solver. Their numbers of equations, unknowns and
!    prescribed components are read by `create` and must not change afterwards.
!  - A solver is not to be copied or assigned: both copies would own the same memory. Call
!    `destroy` before it goes out of scope; there is no finalizer.
!  - Different solvers are independent, in threads, too. A solver may not be used from within its
!    own callbacks.
!  - Kinds are c_int, c_long and c_double of iso_c_binding, whatever the default kinds are.
module sfdae
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_funloc, &
    c_funptr, c_int, c_loc, c_long, c_null_char, c_null_funptr, c_null_ptr, c_ptr, c_size_t, &
    c_sizeof
  use sfdae_expressions
  implicit none
  private

  public :: linear_dae, nonlinear_dae, recorded_linear_dae, derivative_dae
  public :: recorded_multibody_dae, multibody_dae, kinematic_multibody_dae, multibody_formulas
  public :: dae_events, dae_monitor, dae_options, dae_solver
  public :: sfdae_check_linear, sfdae_check_nonlinear, sfdae_check_multibody
  public :: sfdae_status_name, sfdae_version
  public :: sfdae_characteristics, sfdae_decision, sfdae_change, sfdae_initial_report
  public :: sfdae_statistics, sfdae_derivative_check, sfdae_progress, sfdae_multibody_report
  public :: sfdae_linear_problem, sfdae_nonlinear_problem, sfdae_multibody_problem, &
    sfdae_multibody_formulas, sfdae_options ! mirrors of C, nothing that a program needs

  ! ---- Recorded equations: all of sfdae_expressions -----------------------------------------

  public :: expression, named_parameter, choose
  public :: assignment(=), operator(+), operator(-), operator(*), operator(/), operator(**)
  public :: sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh
  public :: abs, min, max

  ! ---- Version of the header that this module mirrors ---------------------------------------

  integer(c_int), parameter, public :: sfdae_version_major = 0
  integer(c_int), parameter, public :: sfdae_version_minor = 1
  integer(c_int), parameter, public :: sfdae_version_patch = 0

  ! ---- Status -------------------------------------------------------------------------------

  integer(c_int), parameter, public :: sfdae_ok = 0

  !> Remarks: the call did what it could, read on.
  integer(c_int), parameter, public :: sfdae_step_taken = 1
  integer(c_int), parameter, public :: sfdae_stopped = 2
  integer(c_int), parameter, public :: sfdae_not_unique = 3
  integer(c_int), parameter, public :: sfdae_inconsistency_ignored = 4
  integer(c_int), parameter, public :: sfdae_event = 5

  !> Failures: wrong use.
  integer(c_int), parameter, public :: sfdae_illegal_argument = -1
  integer(c_int), parameter, public :: sfdae_out_of_memory = -2
  integer(c_int), parameter, public :: sfdae_busy = -3
  integer(c_int), parameter, public :: sfdae_empty_problem = -4
  integer(c_int), parameter, public :: sfdae_not_started = -5

  !> Failures: the user's procedures.
  integer(c_int), parameter, public :: sfdae_callback_stopped = -10
  integer(c_int), parameter, public :: sfdae_callback_failed = -11
  integer(c_int), parameter, public :: sfdae_not_finite = -12
  integer(c_int), parameter, public :: sfdae_order_missing = -13

  !> Failures: the structure of the problem.
  integer(c_int), parameter, public :: sfdae_index_too_high = -20
  integer(c_int), parameter, public :: sfdae_rank_unclear = -21
  integer(c_int), parameter, public :: sfdae_characteristics_changed = -22
  integer(c_int), parameter, public :: sfdae_prescription_singular = -23

  !> Failures: values.
  integer(c_int), parameter, public :: sfdae_inconsistent_values = -30
  integer(c_int), parameter, public :: sfdae_inconsistent_equations = -31
  integer(c_int), parameter, public :: sfdae_fixed_values = -32
  integer(c_int), parameter, public :: sfdae_no_consistent_values = -33

  !> Failures: the integration. The point reached is returned, advance may be called again.
  integer(c_int), parameter, public :: sfdae_max_steps = -40
  integer(c_int), parameter, public :: sfdae_step_too_small = -41
  integer(c_int), parameter, public :: sfdae_singular = -42
  integer(c_int), parameter, public :: sfdae_tolerance_too_small = -43

  !> A defect of the library: please report it.
  integer(c_int), parameter, public :: sfdae_internal = -99

  !> Status of a callback that cannot provide the derivative order asked for.
  integer(c_int), parameter, public :: sfdae_order_not_available = 1001

  ! ---- Values of options and results --------------------------------------------------------

  !> How the derivative array is reduced (dae_options%reduction).
  integer(c_int), parameter, public :: sfdae_reduction_staged = 0
  integer(c_int), parameter, public :: sfdae_reduction_svd = 1

  !> How initial values become consistent (dae_options%initial_values).
  integer(c_int), parameter, public :: sfdae_initial_nearest = 0
  integer(c_int), parameter, public :: sfdae_initial_fixed = 1
  integer(c_int), parameter, public :: sfdae_initial_accept = 2

  !> The quantity W x that is differentiated by the integrator (dae_options%leading_term).
  integer(c_int), parameter, public :: sfdae_leading_automatic = 0
  integer(c_int), parameter, public :: sfdae_leading_projector = 1
  integer(c_int), parameter, public :: sfdae_leading_matrix = 2
  integer(c_int), parameter, public :: sfdae_leading_identity = 3

  !> Integration methods (dae_options%method).
  integer(c_int), parameter, public :: sfdae_method_bdf = 0
  integer(c_int), parameter, public :: sfdae_method_radau = 1
  integer(c_int), parameter, public :: sfdae_method_automatic = 2

  !> How positions and velocities are divided (coordinates of multibody systems).
  integer(c_int), parameter, public :: sfdae_coordinates_orthogonal = 0
  integer(c_int), parameter, public :: sfdae_coordinates_permutation = 1

  !> Which matrix a rank decision was about (sfdae_decision%what).
  integer(c_int), parameter, public :: sfdae_decision_stage = 0
  integer(c_int), parameter, public :: sfdae_decision_a2 = 1
  integer(c_int), parameter, public :: sfdae_decision_et2 = 2
  integer(c_int), parameter, public :: sfdae_decision_array = 3

  !> Verdicts on rank decisions (sfdae_decision%verdict).
  integer(c_int), parameter, public :: sfdae_verdict_clear = 0
  integer(c_int), parameter, public :: sfdae_verdict_confirmed = 1
  integer(c_int), parameter, public :: sfdae_verdict_unclear = 2
  integer(c_int), parameter, public :: sfdae_verdict_user = 3

  ! ---- Results: the C structs, member by member. `size` is the library's business -----------

  !> Characteristic values: d + a + v = m, d + a + u = n.
  type, bind(c) :: sfdae_characteristics
    integer(c_size_t) :: size = 0
    !> Where they were determined.
    real(c_double) :: t = 0
    !> mu; the differentiation index of a regular problem is mu + 1, or 0 if a = 0.
    integer(c_int) :: strangeness_index = 0
    !> d, the number of differential equations.
    integer(c_int) :: differential = 0
    !> a, the number of constraints, hidden ones included.
    integer(c_int) :: algebraic = 0
    !> u, the number of free components of the solution, before any are prescribed.
    integer(c_int) :: undetermined = 0
    !> v, the number of equations that follow from the others.
    integer(c_int) :: redundant = 0
    !> Rank of E(t).
    integer(c_int) :: rank_e = 0
    !> sfdae_leading_..., in use.
    integer(c_int) :: leading_term = 0
    !> Unit of time in which derivatives are compared, in use.
    real(c_double) :: time_scale = 0
    !> Smallest ratio of kept to dropped values of all rank decisions; >= 1e3 is clear.
    real(c_double) :: smallest_gap = 0
  end type sfdae_characteristics

  !> One rank decision of the last analysis, be it a failed one. Values are relative to the norm
  !> of the data.
  type, bind(c) :: sfdae_decision
    integer(c_size_t) :: size = 0
    !> Where it was taken.
    real(c_double) :: t = 0
    !> Level of the derivative array, 0 ...
    integer(c_int) :: level = 0
    !> Block column, 1 ... level + 1, for sfdae_decision_stage, else 0.
    integer(c_int) :: stage = 0
    !> sfdae_decision_...
    integer(c_int) :: what = 0
    !> Rows of the matrix judged.
    integer(c_int) :: rows = 0
    !> Columns of the matrix judged.
    integer(c_int) :: columns = 0
    !> Rank found.
    integer(c_int) :: rank = 0
    !> Smallest value kept, 0 if rank = 0.
    real(c_double) :: kept = 0
    !> Largest value dropped, 0 if the rank is full.
    real(c_double) :: dropped = 0
    !> What rounding errors may amount to.
    real(c_double) :: noise = 0
    !> Values below count as zero.
    real(c_double) :: threshold = 0
    !> kept / max(dropped, noise); 1e300 if nothing was kept.
    real(c_double) :: gap = 0
    !> sfdae_verdict_...
    integer(c_int) :: verdict = 0
  end type sfdae_decision

  !> Where the characteristic values changed, from what to what. New values are -1 if they could
  !> not be determined.
  type, bind(c) :: sfdae_change
    integer(c_size_t) :: size = 0
    !> Where, to about 1e-6 of the step or better.
    real(c_double) :: t = 0
    integer(c_int) :: old_strangeness_index = 0
    integer(c_int) :: old_differential = 0
    integer(c_int) :: old_algebraic = 0
    integer(c_int) :: old_undetermined = 0
    integer(c_int) :: old_redundant = 0
    integer(c_int) :: new_strangeness_index = 0
    integer(c_int) :: new_differential = 0
    integer(c_int) :: new_algebraic = 0
    integer(c_int) :: new_undetermined = 0
    integer(c_int) :: new_redundant = 0
  end type sfdae_change

  !> What the last start or make_consistent did to the initial values.
  type, bind(c) :: sfdae_initial_report
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    !> Distance of the values given to the nearest consistent point: 2-norm of A2 x + f2, rows of
    !> A2 orthonormalized.
    real(c_double) :: residual_before = 0
    !> And for the values returned.
    real(c_double) :: residual_after = 0
    !> Largest |change of x(i)|, 0 if nothing changed.
    real(c_double) :: largest_change = 0
    !> Component i where it happened, from 1; 0 if nothing changed.
    integer(c_int) :: component = 0
    !> 1: x' from the derivative array; 0: its algebraic part from differences.
    integer(c_int) :: derivative_exact = 0
  end type sfdae_initial_report

  !> Counts since start, except where stated.
  type, bind(c) :: sfdae_statistics
    integer(c_size_t) :: size = 0
    !> Accepted steps.
    integer(c_long) :: steps = 0
    !> Attempts rejected by the error test.
    integer(c_long) :: error_failures = 0
    !> Attempts rejected otherwise: callbacks, singular matrices.
    integer(c_long) :: other_failures = 0
    !> Strangeness-free systems computed.
    integer(c_long) :: reductions = 0
    !> LU factorizations of the step's matrix.
    integer(c_long) :: factorizations = 0
    !> Calls of eval_e since creation.
    integer(c_long) :: evaluations_e = 0
    !> Calls of eval_a since creation.
    integer(c_long) :: evaluations_a = 0
    !> Calls of eval_f since creation.
    integer(c_long) :: evaluations_f = 0
    !> Order of the last step, 0 before the first.
    integer(c_int) :: last_order = 0
    integer(c_int) :: next_order = 0
    !> Signed size of the last step.
    real(c_double) :: last_step = 0
    real(c_double) :: next_step = 0
    !> Farthest point reached, at or behind the last point returned.
    real(c_double) :: t_internal = 0
    !> Smallest value kept in any rank decision along the way, relative.
    real(c_double) :: smallest_kept = 0
    !> Largest relative residual of redundant equations along the way (v > 0).
    real(c_double) :: consistency = 0
    !> Signed size of the first accepted step.
    real(c_double) :: first_step = 0
    !> Nonlinear: evaluations of F and its total derivatives along a jet, since creation;
    !> evaluations_F in C.
    integer(c_long) :: evaluations_residual = 0
    !> Likewise with their Jacobians.
    integer(c_long) :: linearizations = 0
    !> nonlinear: largest rounding error of a component along the way, against the tolerance used for it
    real(c_double) :: rounding = 0
  end type sfdae_statistics

  !> Worst mismatch found by check_derivatives, check_total_derivatives or
  !> check_multibody_derivatives.
  type, bind(c) :: sfdae_derivative_check
    integer(c_size_t) :: size = 0
    !> 'E', 'A' or 'f'; 'F', 'x' (F_x) or 'd' (F_x'); 'G' (g_q), 'T' (g_t), 'C' (gamma) or 'H'
    !> (eta); blank if nothing could be compared.
    character(kind=c_char) :: function = ' '
    !> Order of the derivative; >= 1, but for 'x' and 'd'.
    integer(c_int) :: order = 0
    !> Row of the entry, from 1.
    integer(c_int) :: row = 0
    !> Column of the entry, from 1; 1 for f and F.
    integer(c_int) :: column = 0
    !> Value supplied by the callback.
    real(c_double) :: supplied = 0
    !> Value by differences of order - 1, or of F for 'x' and 'd'.
    real(c_double) :: difference = 0
    !> |supplied - difference| relative to the size of the function's derivatives.
    real(c_double) :: error = 0
    !> Of the differences, likewise; an error far above is a mistake in the callback.
    real(c_double) :: uncertainty = 0
    !> 1 if error > 100 uncertainty.
    integer(c_int) :: suspicious = 0
  end type sfdae_derivative_check

  !> What is known of a multibody system at the point reached.
  type, bind(c) :: sfdae_multibody_report
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    !> Constraints given: nl.
    integer(c_int) :: holonomic = 0
    !> And nk.
    integer(c_int) :: nonholonomic = 0
    !> Of these, those that follow from the others.
    integer(c_int) :: redundant = 0
    !> Independent velocities.
    integer(c_int) :: degrees_of_freedom = 0
    !> Independent positions.
    integer(c_int) :: position_freedom = 0
    !> Of the partition in use; 1 is perfect.
    real(c_double) :: condition = 0
    !> Partitions chosen since start, 1 at first.
    integer(c_long) :: partitions = 0
    !> max |g|, each row in units of its gradient.
    real(c_double) :: position_residual = 0
    !> max |G v + g_t|, |H v + h|, likewise.
    real(c_double) :: velocity_residual = 0
  end type sfdae_multibody_report

  !> What the monitor is told after every accepted step.
  type, bind(c) :: sfdae_progress
    integer(c_size_t) :: size = 0
    !> Point reached.
    real(c_double) :: t = 0
    !> Step size that led there, negative when integrating backward.
    real(c_double) :: step = 0
    !> Order of that step.
    integer(c_int) :: order = 0
    !> Accepted steps since start.
    integer(c_long) :: steps = 0
    !> n.
    integer(c_int) :: num_unknowns = 0
    !> Address of the values; the monitor gets them as an array.
    type(c_ptr) :: x = c_null_ptr
  end type sfdae_progress

  ! ---- Input: the C structs, filled from problems and dae_options ---------------------------

  !> Mirror of the C problem; programs extend linear_dae instead.
  type, bind(c) :: sfdae_linear_problem
    integer(c_size_t) :: size = 0
    integer(c_int) :: num_equations = 0
    integer(c_int) :: num_unknowns = 0
    type(c_funptr) :: e = c_null_funptr
    type(c_funptr) :: a = c_null_funptr
    type(c_funptr) :: f = c_null_funptr
    integer(c_int) :: constant_e = 0
    integer(c_int) :: constant_a = 0
    integer(c_int) :: num_prescribed = 0
    type(c_ptr) :: prescribed = c_null_ptr
    type(c_funptr) :: prescribed_values = c_null_funptr
    type(c_ptr) :: user = c_null_ptr
  end type sfdae_linear_problem

  !> Mirror of the C problem; programs extend nonlinear_dae and others instead.
  type, bind(c) :: sfdae_nonlinear_problem
    integer(c_size_t) :: size = 0
    integer(c_int) :: num_equations = 0
    integer(c_int) :: num_unknowns = 0
    type(c_funptr) :: equations = c_null_funptr
    type(c_funptr) :: linear_equations = c_null_funptr
    type(c_funptr) :: total_derivative = c_null_funptr
    integer(c_int) :: num_prescribed = 0
    type(c_ptr) :: prescribed = c_null_ptr
    type(c_funptr) :: prescribed_values = c_null_funptr
    type(c_ptr) :: user = c_null_ptr
    type(c_ptr) :: differentiations = c_null_ptr
  end type sfdae_nonlinear_problem

  !> Mirror of the C problem; programs extend multibody_dae and others instead.
  type, bind(c) :: sfdae_multibody_problem
    integer(c_size_t) :: size = 0
    integer(c_int) :: num_positions = 0
    integer(c_int) :: num_velocities = 0
    integer(c_int) :: num_constraints = 0
    integer(c_int) :: num_nonholonomic = 0
    type(c_funptr) :: equations = c_null_funptr
    type(c_funptr) :: mass = c_null_funptr
    type(c_funptr) :: forces = c_null_funptr
    type(c_funptr) :: constraints = c_null_funptr
    type(c_funptr) :: constraint_jacobian = c_null_funptr
    type(c_funptr) :: constraint_rate = c_null_funptr
    type(c_funptr) :: kinematics = c_null_funptr
    type(c_funptr) :: nonholonomic_matrix = c_null_funptr
    type(c_funptr) :: nonholonomic_offset = c_null_funptr
    type(c_funptr) :: constraint_curvature = c_null_funptr
    type(c_funptr) :: nonholonomic_curvature = c_null_funptr
    integer(c_int) :: coordinates = 0
    type(c_ptr) :: user = c_null_ptr
  end type sfdae_multibody_problem

  !> Mirror of the places for formulas in C; programs see multibody_formulas instead.
  type, bind(c) :: sfdae_multibody_formulas
    type(c_ptr) :: mass = c_null_ptr
    type(c_ptr) :: forces = c_null_ptr
    type(c_ptr) :: constraints = c_null_ptr
    type(c_ptr) :: kinematics = c_null_ptr
    type(c_ptr) :: nonholonomic_matrix = c_null_ptr
    type(c_ptr) :: nonholonomic_offset = c_null_ptr
  end type sfdae_multibody_formulas

  !> Mirror of the C options; programs use dae_options instead.
  type, bind(c) :: sfdae_options
    integer(c_size_t) :: size = 0
    real(c_double) :: rtol = 0
    real(c_double) :: atol = 0
    type(c_ptr) :: rtol_vector = c_null_ptr
    type(c_ptr) :: atol_vector = c_null_ptr
    integer(c_int) :: max_index = 0
    integer(c_int) :: reduction = 0
    real(c_double) :: rank_tol = 0
    real(c_double) :: time_scale = 0
    integer(c_int) :: difference_derivatives = 0
    real(c_double) :: difference_step = 0
    integer(c_int) :: initial_values = 0
    type(c_ptr) :: fixed = c_null_ptr
    type(c_ptr) :: initial_weights = c_null_ptr
    integer(c_int) :: ignore_inconsistency = 0
    real(c_double) :: consistency_tol = 0
    integer(c_int) :: max_order = 0
    real(c_double) :: initial_step = 0
    real(c_double) :: max_step = 0
    integer(c_int) :: use_stop_time = 0
    real(c_double) :: stop_time = 0
    integer(c_long) :: max_steps = 0
    integer(c_int) :: leading_term = 0
    type(c_funptr) :: monitor = c_null_funptr
    type(c_ptr) :: monitor_user = c_null_ptr
    integer(c_int) :: method = 0
    integer(c_int) :: min_stages = 0
    integer(c_int) :: max_stages = 0
  end type sfdae_options

  ! ---- Problem ------------------------------------------------------------------------------

  !> What all problems have.
  type, abstract :: any_dae
    !> m >= 1.
    integer(c_int) :: num_equations = 0
    !> n >= 1; m and n may differ.
    integer(c_int) :: num_unknowns = 0
    !> u > 0 only: components of x, from 1, that eval_prescribed gives as functions of time.
    integer(c_int), allocatable :: prescribed(:)
    !> Not for linear_dae: how often each equation is differentiated at most. Not allocated: no limit.
    integer(c_int), allocatable :: differentiations(:)
  contains
    !> Writes the values of the prescribed components.
    procedure :: eval_prescribed => missing_prescribed
  end type any_dae

  !> Linear problem E(t) x' = A(t) x + f(t). Extend it: components are your data.
  type, abstract, extends(any_dae) :: linear_dae
    !> E does not depend on t: eval_e is called for order 0 only, once.
    logical :: constant_e = .false.
    !> A does not depend on t; both constant: one reduction serves all points.
    logical :: constant_a = .false.
    !> .false.: f = 0, eval_f is not called.
    logical :: has_f = .true.
  contains
    !> Writes E or its derivatives.
    procedure(e_function), deferred :: eval_e
    !> Writes A or its derivatives.
    procedure(a_function), deferred :: eval_a
    !> Writes f or its derivatives; f = 0 unless overridden.
    procedure :: eval_f => zero_f
  end type linear_dae

  !> Nonlinear problem F(t, x, x') = 0, written once as formulas. Extend it: components are your
  !> data. Equations that turn out to be linear are solved as a linear problem.
  type, abstract, extends(any_dae) :: nonlinear_dae
  contains
    !> Writes F; called once, by create.
    procedure(equations_procedure), deferred :: equations
  end type nonlinear_dae

  !> Linear problem E(t) x' = A(t) x + f(t), written once as formulas.
  type, abstract, extends(any_dae) :: recorded_linear_dae
  contains
    !> Writes E, A and f; called once, by create.
    procedure(linear_equations_procedure), deferred :: linear_equations
  end type recorded_linear_dae

  !> Nonlinear problem F(t, x, x') = 0 with derivatives of your own.
  type, abstract, extends(any_dae) :: derivative_dae
  contains
    !> Writes F and its Jacobians, or total derivatives of them; called at every point.
    procedure(total_derivative_procedure), deferred :: total_derivative
  end type derivative_dae

  abstract interface
    !> Writes the plain derivative of the given order of E at t. Orders asked for: up to max_index
    !> in the analysis; later up to max(mu, 1), and mu + 1 for x' of initial values.
    subroutine e_function(self, t, order, e, status)
      import :: c_double, c_int, linear_dae
      class(linear_dae), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> 0: E itself.
      integer(c_int), intent(in) :: order
      !> m x n, zero on entry: write the nonzeros only.
      real(c_double), intent(inout) :: e(:, :)
      !> 0 on entry. > 0: cannot evaluate here, try a smaller step. < 0: stop at once.
      integer(c_int), intent(inout) :: status
    end subroutine e_function

    !> Writes the plain derivative of the given order of A at t, as e_function does.
    subroutine a_function(self, t, order, a, status)
      import :: c_double, c_int, linear_dae
      class(linear_dae), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> 0: A itself.
      integer(c_int), intent(in) :: order
      !> m x n, zero on entry.
      real(c_double), intent(inout) :: a(:, :)
      !> As of e_function.
      integer(c_int), intent(inout) :: status
    end subroutine a_function

    !> Writes the entries of F(t, x, x'), all of them, as formulas. There are no values to branch
    !> on: see choose.
    subroutine equations_procedure(self, t, x, xdot, residual)
      import :: expression, nonlinear_dae
      class(nonlinear_dae), intent(inout) :: self
      type(expression), intent(in) :: t
      !> n unknowns.
      type(expression), intent(in) :: x(:)
      !> Their derivatives.
      type(expression), intent(in) :: xdot(:)
      !> m entries.
      type(expression), intent(inout) :: residual(:)
    end subroutine equations_procedure

    !> Writes the entries of E(t), A(t) and f(t) that are not zero, as formulas.
    subroutine linear_equations_procedure(self, t, e, a, f)
      import :: expression, recorded_linear_dae
      class(recorded_linear_dae), intent(inout) :: self
      type(expression), intent(in) :: t
      !> m x n.
      type(expression), intent(inout) :: e(:, :)
      !> m x n.
      type(expression), intent(inout) :: a(:, :)
      !> m entries.
      type(expression), intent(inout) :: f(:)
    end subroutine linear_equations_procedure

    !> Writes the total derivative of the given order, d^order/dt^order along a jet, of F, F_x and
    !> F_x'. Plain derivatives. Orders asked for: 0 ... mu + 1.
    subroutine total_derivative_procedure(self, t, order, x, f, f_x, f_xdot, status)
      import :: c_double, c_int, derivative_dae
      class(derivative_dae), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> 0: F itself.
      integer(c_int), intent(in) :: order
      !> n x (order + 2): column k, from 0, is the k-th derivative of x.
      real(c_double), intent(in) :: x(:, 0:)
      !> m entries, zero on entry.
      real(c_double), intent(inout) :: f(:)
      !> m x n, zero on entry; absent if it is not asked for.
      real(c_double), intent(inout), optional :: f_x(:, :)
      !> Likewise.
      real(c_double), intent(inout), optional :: f_xdot(:, :)
      !> As of e_function.
      integer(c_int), intent(inout) :: status
    end subroutine total_derivative_procedure
  end interface

  ! ---- Mechanical systems -------------------------------------------------------------------

  !> A mechanical system with constraints, G = g_q S:
  !>
  !>     q' = S(t,q) v,   M(t,q) v' = f(t,q,v) - G**T lambda - H(t,q)**T kappa
  !>     0 = g(t,q),      0 = H(t,q) v + h(t,q)
  !>
  !> The unknowns are x = (q, v, lambda, kappa). create sets num_equations and num_unknowns.
  type, abstract, extends(any_dae) :: any_multibody_dae
    !> nq >= 1.
    integer(c_int) :: num_positions = 0
    !> nv; 0: nq.
    integer(c_int) :: num_velocities = 0
    !> nl, entries of g.
    integer(c_int) :: num_constraints = 0
    !> nk, rows of H.
    integer(c_int) :: num_nonholonomic = 0
    !> sfdae_coordinates_orthogonal or sfdae_coordinates_permutation.
    integer(c_int) :: coordinates = sfdae_coordinates_orthogonal
  end type any_multibody_dae

  !> One written once as formulas. Extend it: components are your data.
  type, abstract, extends(any_multibody_dae) :: recorded_multibody_dae
  contains
    !> Writes the formulas that are not zero; called once, by create.
    procedure(multibody_procedure), deferred :: equations
  end type recorded_multibody_dae

  !> Places for formulas, all zero at first but S, which is the identity if nq = nv.
  type :: multibody_formulas
    !> M, nv x nv.
    type(expression), pointer :: mass(:, :) => null()
    !> f, nv entries.
    type(expression), pointer :: forces(:) => null()
    !> g, nl entries.
    type(expression), pointer :: constraints(:) => null()
    !> S, nq x nv.
    type(expression), pointer :: kinematics(:, :) => null()
    !> H, nk x nv.
    type(expression), pointer :: nonholonomic_matrix(:, :) => null()
    !> h, nk entries.
    type(expression), pointer :: nonholonomic_offset(:) => null()
  end type multibody_formulas

  !> One whose matrices and vectors are evaluated at every point, with q' = v.
  type, abstract, extends(any_multibody_dae) :: multibody_dae
    !> g depends on t, constraint_rate is to be called.
    logical :: has_constraint_rate = .false.
    !> constraint_curvature is to be called; else differences take its place.
    logical :: has_constraint_curvature = .false.
    !> Likewise nonholonomic_curvature.
    logical :: has_nonholonomic_curvature = .false.
  contains
    !> Writes f.
    procedure(velocity_procedure), deferred :: forces
    !> Writes M; the identity unless overridden.
    procedure :: mass => identity_mass
    !> Writes g.
    procedure :: constraints => missing_constraints
    !> Writes g_q, nl x nq.
    procedure :: constraint_jacobian => missing_matrix
    !> Writes g_t, nl entries.
    procedure :: constraint_rate => missing_constraints
    !> Writes H, nk x nv.
    procedure :: nonholonomic_matrix => missing_matrix
    !> Writes h, nk entries; 0 unless overridden.
    procedure :: nonholonomic_offset => zero_offset
    !> Writes gamma = (dG/dt) v + d(g_t)/dt, nl entries.
    procedure :: constraint_curvature => missing_curvature
    !> Writes eta = (dH/dt) v + dh/dt, nk entries.
    procedure :: nonholonomic_curvature => missing_curvature
  end type multibody_dae

  !> Likewise, with q' = S v.
  type, abstract, extends(multibody_dae) :: kinematic_multibody_dae
  contains
    !> Writes S, nq x nv.
    procedure(kinematics_procedure), deferred :: kinematics
  end type kinematic_multibody_dae

  abstract interface
    !> Writes the formulas of a mechanical system. All but the forces depend on t and q alone.
    subroutine multibody_procedure(self, t, q, v, to)
      import :: expression, multibody_formulas, recorded_multibody_dae
      class(recorded_multibody_dae), intent(inout) :: self
      type(expression), intent(in) :: t
      !> nq positions.
      type(expression), intent(in) :: q(:)
      !> nv velocities.
      type(expression), intent(in) :: v(:)
      type(multibody_formulas), intent(in) :: to
    end subroutine multibody_procedure

    !> Writes a vector that depends on velocities.
    subroutine velocity_procedure(self, t, q, v, vector, status)
      import :: c_double, c_int, multibody_dae
      class(multibody_dae), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> nq positions.
      real(c_double), intent(in) :: q(:)
      !> nv velocities.
      real(c_double), intent(in) :: v(:)
      !> Zero on entry.
      real(c_double), intent(inout) :: vector(:)
      !> As of e_function.
      integer(c_int), intent(inout) :: status
    end subroutine velocity_procedure

    !> Writes S.
    subroutine kinematics_procedure(self, t, q, matrix, status)
      import :: c_double, c_int, kinematic_multibody_dae
      class(kinematic_multibody_dae), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> nq positions.
      real(c_double), intent(in) :: q(:)
      !> nq x nv, zero on entry.
      real(c_double), intent(inout) :: matrix(:, :)
      !> As of e_function.
      integer(c_int), intent(inout) :: status
    end subroutine kinematics_procedure
  end interface

  ! ---- Options ------------------------------------------------------------------------------

  !> Watches the integration: extend it, components are your data. See dae_options%monitor.
  type, abstract :: dae_monitor
  contains
    !> Called after every accepted step.
    procedure(monitor_function), deferred :: after_step
  end type dae_monitor

  abstract interface
    !> Called after every accepted step.
    subroutine monitor_function(self, progress, x, stop_now)
      import :: c_double, dae_monitor, sfdae_progress
      class(dae_monitor), intent(inout) :: self
      type(sfdae_progress), intent(in) :: progress
      !> n values at progress%t.
      real(c_double), intent(in) :: x(:)
      !> .false. on entry; .true. stops the call that is running with sfdae_stopped.
      logical, intent(inout) :: stop_now
    end subroutine monitor_function
  end interface

  !> Options, with their defaults. The error of x(i) is kept near rtol |x(i)| + atol.
  type :: dae_options
    !> 0 <= rtol < 1, not both tolerances zero.
    real(c_double) :: rtol = 1.0e-6_c_double
    !> >= 0.
    real(c_double) :: atol = 1.0e-6_c_double
    !> n values that replace rtol, one for each component.
    real(c_double), allocatable :: rtol_vector(:)
    !> n values that replace atol.
    real(c_double), allocatable :: atol_vector(:)

    !> Highest strangeness index tried, 0 ... 12.
    integer(c_int) :: max_index = 5
    !> sfdae_reduction_staged or sfdae_reduction_svd.
    integer(c_int) :: reduction = sfdae_reduction_staged
    !> > 0, < 1: values below rank_tol * norm of the data count as zero. 0: the library judges.
    real(c_double) :: rank_tol = 0
    !> > 0: unit of time in which derivatives are compared. 0: chosen.
    real(c_double) :: time_scale = 0
    !> Derivatives that are not available (sfdae_order_not_available) come from differences.
    logical :: difference_derivatives = .false.
    !> > 0: spacing of the points used for that. 0: chosen.
    real(c_double) :: difference_step = 0

    !> sfdae_initial_nearest, sfdae_initial_fixed or sfdae_initial_accept.
    integer(c_int) :: initial_values = sfdae_initial_nearest
    !> For sfdae_initial_fixed: n flags, .true. where x(i) must not change.
    logical, allocatable :: fixed(:)
    !> n positive numbers w(i): sum (change(i) / w(i))**2 is smallest.
    real(c_double), allocatable :: initial_weights(:)

    !> Go on (sfdae_inconsistency_ignored) where redundant equations contradict each other.
    logical :: ignore_inconsistency = .false.
    !> Relative size of a contradiction that counts, > 0, < 1.
    real(c_double) :: consistency_tol = 1.0e-8_c_double

    !> Highest BDF order, 1 ... 5.
    integer(c_int) :: max_order = 5
    !> Size of the first step. 0: chosen.
    real(c_double) :: initial_step = 0
    !> Largest step. 0: no limit.
    real(c_double) :: max_step = 0
    !> Nothing is evaluated beyond stop_time.
    logical :: use_stop_time = .false.
    real(c_double) :: stop_time = 0
    !> Attempted steps in one call, >= 1.
    integer(c_long) :: max_steps = 100000
    !> sfdae_leading_...
    integer(c_int) :: leading_term = sfdae_leading_automatic

    !> Called after every accepted step if associated. Its target must live as long as the solver.
    class(dae_monitor), pointer :: monitor => null()

    !> sfdae_method_bdf, sfdae_method_radau or sfdae_method_automatic; a change takes effect with
    !> the next start.
    integer(c_int) :: method = sfdae_method_bdf
    !> Radau: smallest number of stages, 1, 3, 5 or 7.
    integer(c_int) :: min_stages = 1
    !> Radau: largest number of stages, 1, 3, 5 or 7, >= min_stages.
    integer(c_int) :: max_stages = 7
  end type dae_options

  ! ---- Events -------------------------------------------------------------------------------

  !> Events are zeros of functions of t, x and x': extend it, components are your data. See
  !> dae_solver%set_events.
  type, abstract :: dae_events
    !> Number of functions, 0: none.
    integer(c_int) :: num_events = 0
    !> num_events numbers: +1 only rising zeros count, in the direction of integration, -1 only
    !> falling ones, 0 both. Not allocated: both.
    integer(c_int), allocatable :: directions(:)
  contains
    !> Writes the event functions.
    procedure(event_function), deferred :: eval_g
  end type dae_events

  abstract interface
    !> Writes the event functions at a point.
    subroutine event_function(self, t, x, xdot, g, status)
      import :: c_double, c_int, dae_events
      class(dae_events), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> n values.
      real(c_double), intent(in) :: x(:)
      !> n values of x'.
      real(c_double), intent(in) :: xdot(:)
      !> num_events entries, zero on entry.
      real(c_double), intent(inout) :: g(:)
      !> 0 on entry. > 0: cannot evaluate here. < 0: stop at once.
      integer(c_int), intent(inout) :: status
    end subroutine event_function
  end interface

  ! ---- Solver -------------------------------------------------------------------------------

  !> What the `user` pointer of the C callbacks points to. On the heap, so that it stays in place.
  type :: callback_holder
    class(any_dae), pointer :: problem => null()
    !> The problem again, as what it is.
    class(linear_dae), pointer :: linear => null()
    class(nonlinear_dae), pointer :: nonlinear => null()
    class(recorded_linear_dae), pointer :: recorded_linear => null()
    class(derivative_dae), pointer :: derivative => null()
    class(recorded_multibody_dae), pointer :: recorded_multibody => null()
    class(multibody_dae), pointer :: multibody => null()
    class(kinematic_multibody_dae), pointer :: kinematic => null()
    class(dae_monitor), pointer :: monitor => null()
    class(dae_events), pointer :: events => null()
    !> Of the events when they were set.
    integer(c_int) :: num_events = 0
    !> m when the solver was created.
    integer(c_int) :: num_equations = 0
    !> n when the solver was created.
    integer(c_int) :: num_unknowns = 0
    !> nq, nv, nl and nk of a mechanical system.
    integer(c_int) :: num_positions = 0, num_velocities = 0
    integer(c_int) :: num_constraints = 0, num_nonholonomic = 0
    !> Prescribed components, from 0.
    integer(c_int), allocatable :: prescribed(:)
    !> As in the problem; where their number is wrong, -1, which create and check refuse.
    integer(c_int), allocatable :: differentiations(:)
  end type callback_holder

  !> A solver. Never copy one, and destroy it before it goes out of scope.
  type :: dae_solver
    private
    !> The C solver.
    type(c_ptr) :: handle = c_null_ptr
    type(callback_holder), pointer :: holder => null()
    !> Message of this module about the last call; else the library has the word.
    character(len=:), allocatable :: complaint
  contains
    procedure :: create => solver_create
    procedure :: destroy => solver_destroy
    procedure :: set_options => solver_set_options
    procedure :: message => solver_message
    procedure :: request_stop => solver_request_stop
    procedure :: analyze => solver_analyze
    procedure :: analyze_at => solver_analyze_at
    procedure :: set_parameter => solver_set_parameter
    procedure :: get_parameter => solver_get_parameter
    procedure :: get_characteristics => solver_get_characteristics
    procedure :: get_num_decisions => solver_get_num_decisions
    procedure :: get_decision => solver_get_decision
    procedure :: get_change => solver_get_change
    procedure :: make_consistent => solver_make_consistent
    procedure :: get_initial_report => solver_get_initial_report
    procedure :: start => solver_start
    procedure :: advance => solver_advance
    procedure :: step => solver_step
    procedure :: save_checkpoint => solver_save_checkpoint
    procedure :: restore_checkpoint => solver_restore_checkpoint
    procedure :: set_events => solver_set_events
    procedure :: get_events => solver_get_events
    procedure :: interpolate => solver_interpolate
    procedure :: get_statistics => solver_get_statistics
    procedure :: report => solver_report
    procedure :: get_derivative_array => solver_get_derivative_array
    procedure :: get_projectors => solver_get_projectors
    procedure :: get_strangeness_free => solver_get_strangeness_free
    procedure :: check_derivatives => solver_check_derivatives
    procedure :: check_total_derivatives => solver_check_total_derivatives
    procedure :: check_multibody_derivatives => solver_check_multibody_derivatives
    procedure :: get_multibody_report => solver_get_multibody_report
  end type dae_solver

  !> sfdae_check_linear, sfdae_check_nonlinear or sfdae_check_multibody with its text as a Fortran
  !> string.
  interface check_filled
    module procedure check_filled_linear, check_filled_nonlinear, check_filled_multibody
  end interface check_filled

  ! ---- The C functions; sfdae.h explains them and their arguments ---------------------------

  interface
    function c_status_name(status) bind(c, name="sfdae_status_name") result(name)
      import :: c_int, c_ptr
      integer(c_int), value :: status
      type(c_ptr) :: name
    end function c_status_name

    function c_version() bind(c, name="sfdae_version") result(version)
      import :: c_ptr
      type(c_ptr) :: version
    end function c_version

    function c_linear_problem_init(problem, size) bind(c, name="sfdae_linear_problem_init") &
      result(status)
      import :: c_int, c_size_t, sfdae_linear_problem
      type(sfdae_linear_problem), intent(inout) :: problem
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_linear_problem_init

    function c_nonlinear_problem_init(problem, size) &
      bind(c, name="sfdae_nonlinear_problem_init") result(status)
      import :: c_int, c_size_t, sfdae_nonlinear_problem
      type(sfdae_nonlinear_problem), intent(inout) :: problem
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_nonlinear_problem_init

    function c_options_init(options, size) bind(c, name="sfdae_options_init") result(status)
      import :: c_int, c_size_t, sfdae_options
      type(sfdae_options), intent(inout) :: options
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_options_init

    recursive function c_create_linear(solver, problem, options) &
      bind(c, name="sfdae_create_linear") result(status)
      import :: c_int, c_ptr, sfdae_linear_problem, sfdae_options
      type(c_ptr), intent(out) :: solver
      type(sfdae_linear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: status
    end function c_create_linear

    recursive function c_check_linear(problem, options, text, length) &
      bind(c, name="sfdae_check_linear") result(status)
      import :: c_char, c_int, c_size_t, sfdae_linear_problem, sfdae_options
      type(sfdae_linear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function c_check_linear

    recursive function c_create_nonlinear(solver, problem, options) &
      bind(c, name="sfdae_create_nonlinear") result(status)
      import :: c_int, c_ptr, sfdae_nonlinear_problem, sfdae_options
      type(c_ptr), intent(out) :: solver
      type(sfdae_nonlinear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: status
    end function c_create_nonlinear

    recursive function c_check_nonlinear(problem, options, text, length) &
      bind(c, name="sfdae_check_nonlinear") result(status)
      import :: c_char, c_int, c_size_t, sfdae_nonlinear_problem, sfdae_options
      type(sfdae_nonlinear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function c_check_nonlinear

    function c_multibody_problem_init(problem, size) &
      bind(c, name="sfdae_multibody_problem_init") result(status)
      import :: c_int, c_size_t, sfdae_multibody_problem
      type(sfdae_multibody_problem), intent(inout) :: problem
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_multibody_problem_init

    recursive function c_create_multibody(solver, problem, options) &
      bind(c, name="sfdae_create_multibody") result(status)
      import :: c_int, c_ptr, sfdae_multibody_problem, sfdae_options
      type(c_ptr), intent(out) :: solver
      type(sfdae_multibody_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: status
    end function c_create_multibody

    recursive function c_check_multibody(problem, options, text, length) &
      bind(c, name="sfdae_check_multibody") result(status)
      import :: c_char, c_int, c_size_t, sfdae_multibody_problem, sfdae_options
      type(sfdae_multibody_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function c_check_multibody

    function c_set_parameter(solver, name, value) bind(c, name="sfdae_set_parameter") &
      result(status)
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: value
      integer(c_int) :: status
    end function c_set_parameter

    function c_get_parameter(solver, name, value) bind(c, name="sfdae_get_parameter") &
      result(status)
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), intent(inout) :: value
      integer(c_int) :: status
    end function c_get_parameter

    function c_destroy(solver) bind(c, name="sfdae_destroy") result(status)
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: solver
      integer(c_int) :: status
    end function c_destroy

    function c_set_options(solver, options) bind(c, name="sfdae_set_options") result(status)
      import :: c_int, c_ptr, sfdae_options
      type(c_ptr), value :: solver
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: status
    end function c_set_options

    function c_message(solver) bind(c, name="sfdae_message") result(text)
      import :: c_ptr
      type(c_ptr), value :: solver
      type(c_ptr) :: text
    end function c_message

    function c_request_stop(solver) bind(c, name="sfdae_request_stop") result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int) :: status
    end function c_request_stop

    function c_characteristics_init(characteristics, size) &
      bind(c, name="sfdae_characteristics_init") result(status)
      import :: c_int, c_size_t, sfdae_characteristics
      type(sfdae_characteristics), intent(inout) :: characteristics
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_characteristics_init

    recursive function c_analyze(solver, t, toward, characteristics) &
      bind(c, name="sfdae_analyze") result(status)
      import :: c_double, c_int, c_ptr, sfdae_characteristics
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      type(sfdae_characteristics), intent(inout) :: characteristics
      integer(c_int) :: status
    end function c_analyze

    recursive function c_analyze_at(solver, t, toward, x, characteristics) &
      bind(c, name="sfdae_analyze_at") result(status)
      import :: c_double, c_int, c_ptr, sfdae_characteristics
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      real(c_double), intent(in) :: x(*)
      type(sfdae_characteristics), intent(inout) :: characteristics
      integer(c_int) :: status
    end function c_analyze_at

    function c_get_characteristics(solver, characteristics) &
      bind(c, name="sfdae_get_characteristics") result(status)
      import :: c_int, c_ptr, sfdae_characteristics
      type(c_ptr), value :: solver
      type(sfdae_characteristics), intent(inout) :: characteristics
      integer(c_int) :: status
    end function c_get_characteristics

    function c_decision_init(decision, size) bind(c, name="sfdae_decision_init") result(status)
      import :: c_int, c_size_t, sfdae_decision
      type(sfdae_decision), intent(inout) :: decision
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_decision_init

    function c_get_num_decisions(solver, count) bind(c, name="sfdae_get_num_decisions") &
      result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), intent(inout) :: count
      integer(c_int) :: status
    end function c_get_num_decisions

    function c_get_decision(solver, index, decision) bind(c, name="sfdae_get_decision") &
      result(status)
      import :: c_int, c_ptr, sfdae_decision
      type(c_ptr), value :: solver
      integer(c_int), value :: index
      type(sfdae_decision), intent(inout) :: decision
      integer(c_int) :: status
    end function c_get_decision

    function c_change_init(change, size) bind(c, name="sfdae_change_init") result(status)
      import :: c_int, c_size_t, sfdae_change
      type(sfdae_change), intent(inout) :: change
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_change_init

    function c_get_change(solver, change) bind(c, name="sfdae_get_change") result(status)
      import :: c_int, c_ptr, sfdae_change
      type(c_ptr), value :: solver
      type(sfdae_change), intent(inout) :: change
      integer(c_int) :: status
    end function c_get_change

    function c_initial_report_init(report, size) bind(c, name="sfdae_initial_report_init") &
      result(status)
      import :: c_int, c_size_t, sfdae_initial_report
      type(sfdae_initial_report), intent(inout) :: report
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_initial_report_init

    function c_get_initial_report(solver, report) bind(c, name="sfdae_get_initial_report") &
      result(status)
      import :: c_int, c_ptr, sfdae_initial_report
      type(c_ptr), value :: solver
      type(sfdae_initial_report), intent(inout) :: report
      integer(c_int) :: status
    end function c_get_initial_report

    recursive function c_make_consistent(solver, t, x, xdot) &
      bind(c, name="sfdae_make_consistent") result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: status
    end function c_make_consistent

    recursive function c_start(solver, t, toward, x, xdot) bind(c, name="sfdae_start") &
      result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: status
    end function c_start

    recursive function c_advance(solver, tout, t, x, xdot) bind(c, name="sfdae_advance") &
      result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: tout
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: status
    end function c_advance

    recursive function c_step(solver, tout, t, x, xdot) bind(c, name="sfdae_step") &
      result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: tout
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: status
    end function c_step

    function c_get_checkpoint_length(solver, length) &
      bind(c, name="sfdae_get_checkpoint_length") result(status)
      import :: c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      integer(c_size_t), intent(inout) :: length
      integer(c_int) :: status
    end function c_get_checkpoint_length

    function c_save_checkpoint(solver, checkpoint, length) &
      bind(c, name="sfdae_save_checkpoint") result(status)
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      real(c_double), intent(inout) :: checkpoint(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function c_save_checkpoint

    function c_restore_checkpoint(solver, checkpoint, length) &
      bind(c, name="sfdae_restore_checkpoint") result(status)
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      real(c_double), intent(in) :: checkpoint(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function c_restore_checkpoint

    function c_set_events(solver, num_events, function, directions, user) &
      bind(c, name="sfdae_set_events") result(status)
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), value :: num_events
      type(c_funptr), value :: function
      type(c_ptr), value :: directions
      type(c_ptr), value :: user
      integer(c_int) :: status
    end function c_set_events

    function c_get_events(solver, which) bind(c, name="sfdae_get_events") result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), intent(inout) :: which(*)
      integer(c_int) :: status
    end function c_get_events

    recursive function c_interpolate(solver, t, x, xdot) bind(c, name="sfdae_interpolate") &
      result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: status
    end function c_interpolate

    function c_statistics_init(statistics, size) bind(c, name="sfdae_statistics_init") &
      result(status)
      import :: c_int, c_size_t, sfdae_statistics
      type(sfdae_statistics), intent(inout) :: statistics
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_statistics_init

    function c_get_statistics(solver, statistics) bind(c, name="sfdae_get_statistics") &
      result(status)
      import :: c_int, c_ptr, sfdae_statistics
      type(c_ptr), value :: solver
      type(sfdae_statistics), intent(inout) :: statistics
      integer(c_int) :: status
    end function c_get_statistics

    function c_report(solver, text, length, needed) bind(c, name="sfdae_report") result(status)
      import :: c_char, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_size_t), intent(inout) :: needed
      integer(c_int) :: status
    end function c_report

    recursive function c_get_derivative_array(solver, t, level, m, n, g) &
      bind(c, name="sfdae_get_derivative_array") result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      integer(c_int), value :: level
      real(c_double), intent(inout) :: m(*)
      real(c_double), intent(inout) :: n(*)
      real(c_double), intent(inout) :: g(*)
      integer(c_int) :: status
    end function c_get_derivative_array

    recursive function c_get_projectors(solver, t, z1, z2, z3, t2, vhat) &
      bind(c, name="sfdae_get_projectors") result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: z1(*)
      real(c_double), intent(inout) :: z2(*)
      real(c_double), intent(inout) :: z3(*)
      real(c_double), intent(inout) :: t2(*)
      integer(c_int), intent(inout) :: vhat
      integer(c_int) :: status
    end function c_get_projectors

    recursive function c_get_strangeness_free(solver, t, e1, a1, f1, a2, f2, residual) &
      bind(c, name="sfdae_get_strangeness_free") result(status)
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: e1(*)
      real(c_double), intent(inout) :: a1(*)
      real(c_double), intent(inout) :: f1(*)
      real(c_double), intent(inout) :: a2(*)
      real(c_double), intent(inout) :: f2(*)
      real(c_double), intent(inout) :: residual
      integer(c_int) :: status
    end function c_get_strangeness_free

    function c_derivative_check_init(check, size) bind(c, name="sfdae_derivative_check_init") &
      result(status)
      import :: c_int, c_size_t, sfdae_derivative_check
      type(sfdae_derivative_check), intent(inout) :: check
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_derivative_check_init

    recursive function c_check_derivatives(solver, t, max_order, check) &
      bind(c, name="sfdae_check_derivatives") result(status)
      import :: c_double, c_int, c_ptr, sfdae_derivative_check
      type(c_ptr), value :: solver
      real(c_double), value :: t
      integer(c_int), value :: max_order
      type(sfdae_derivative_check), intent(inout) :: check
      integer(c_int) :: status
    end function c_check_derivatives

    recursive function c_check_total_derivatives(solver, t, derivatives, max_order, check) &
      bind(c, name="sfdae_check_total_derivatives") result(status)
      import :: c_double, c_int, c_ptr, sfdae_derivative_check
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: derivatives(*)
      integer(c_int), value :: max_order
      type(sfdae_derivative_check), intent(inout) :: check
      integer(c_int) :: status
    end function c_check_total_derivatives

    recursive function c_check_multibody_derivatives(solver, t, q, v, check) &
      bind(c, name="sfdae_check_multibody_derivatives") result(status)
      import :: c_double, c_int, c_ptr, sfdae_derivative_check
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: q(*)
      real(c_double), intent(in) :: v(*)
      type(sfdae_derivative_check), intent(inout) :: check
      integer(c_int) :: status
    end function c_check_multibody_derivatives

    function c_multibody_report_init(report, size) bind(c, name="sfdae_multibody_report_init") &
      result(status)
      import :: c_int, c_size_t, sfdae_multibody_report
      type(sfdae_multibody_report), intent(inout) :: report
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function c_multibody_report_init

    function c_get_multibody_report(solver, report) bind(c, name="sfdae_get_multibody_report") &
      result(status)
      import :: c_int, c_ptr, sfdae_multibody_report
      type(c_ptr), value :: solver
      type(sfdae_multibody_report), intent(inout) :: report
      integer(c_int) :: status
    end function c_get_multibody_report

    !> Of the C library: characters before the final zero.
    function c_strlen(text) bind(c, name="strlen") result(length)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function c_strlen
  end interface

contains

  ! ---- Without a solver ---------------------------------------------------------------------

  !> Version of the library that is running, for example "0.1.0".
  function sfdae_version() result(version)
    character(len=:), allocatable :: version

    version = text_at(c_version())
  end function sfdae_version

  !> Name of a status as in C, for example "SFDAE_STEP_TOO_SMALL".
  function sfdae_status_name(status) result(name)
    integer(c_int), intent(in) :: status
    character(len=:), allocatable :: name

    name = text_at(c_status_name(status))
  end function sfdae_status_name

  !> Checks a problem with its options as create does and says in words what is wrong.
  recursive subroutine sfdae_check_linear(problem, text, status, options)
    class(linear_dae), target, intent(inout) :: problem
    !> What is wrong; empty if nothing is.
    character(len=:), allocatable, intent(out) :: text
    !> As of create.
    integer(c_int), intent(out) :: status
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(callback_holder), target :: holder
    type(sfdae_linear_problem) :: c_problem
    type(sfdae_options) :: c_options
    integer(c_int), allocatable, target :: fixed(:)

    call fill_problem(problem, holder, c_problem)
    call fill_options(options, holder, fixed, c_options, text)
    status = sfdae_illegal_argument
    if (len(text) == 0) call check_filled(c_problem, c_options, text, status)
  end subroutine sfdae_check_linear

  !> The same for a problem that is not a linear_dae; equations are recorded.
  recursive subroutine sfdae_check_nonlinear(problem, text, status, options)
    !> nonlinear_dae, recorded_linear_dae or derivative_dae.
    class(any_dae), target, intent(inout) :: problem
    !> What is wrong; empty if nothing is.
    character(len=:), allocatable, intent(out) :: text
    !> As of create.
    integer(c_int), intent(out) :: status
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(callback_holder), target :: holder
    type(sfdae_nonlinear_problem) :: c_problem
    type(sfdae_options) :: c_options
    integer(c_int), allocatable, target :: fixed(:)

    call fill_nonlinear_problem(problem, holder, c_problem)
    call fill_options(options, holder, fixed, c_options, text)
    status = sfdae_illegal_argument
    if (len(text) == 0) call check_filled(c_problem, c_options, text, status)
  end subroutine sfdae_check_nonlinear

  !> The same for a mechanical system.
  recursive subroutine sfdae_check_multibody(problem, text, status, options)
    !> recorded_multibody_dae, multibody_dae or kinematic_multibody_dae.
    class(any_multibody_dae), target, intent(inout) :: problem
    !> What is wrong; empty if nothing is.
    character(len=:), allocatable, intent(out) :: text
    !> As of create.
    integer(c_int), intent(out) :: status
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(callback_holder), target :: holder
    type(sfdae_multibody_problem) :: c_problem
    type(sfdae_options) :: c_options
    integer(c_int), allocatable, target :: fixed(:)

    call count_unknowns(problem)
    call fill_multibody_problem(problem, holder, c_problem)
    call fill_options(options, holder, fixed, c_options, text)
    status = sfdae_illegal_argument
    if (len(text) == 0) call check_filled(c_problem, c_options, text, status)
  end subroutine sfdae_check_multibody

  ! ---- Life ---------------------------------------------------------------------------------

  !> Creates the solver. A solver that exists already is refused: destroy it first.
  recursive subroutine solver_create(self, problem, status, options)
    class(dae_solver), intent(inout) :: self
    !> Must have the target attribute and live, in place, as long as the solver.
    class(any_dae), target, intent(inout) :: problem
    !> Failures: sfdae_illegal_argument, sfdae_empty_problem, sfdae_out_of_memory.
    integer(c_int), intent(out) :: status
    !> Copied. Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(sfdae_options) :: c_options
    integer(c_int), allocatable, target :: fixed(:)
    integer :: allocation

    status = sfdae_illegal_argument
    self%complaint = "the solver exists already: destroy it first"
    if (c_associated(self%handle)) return
    status = sfdae_out_of_memory
    self%complaint = "out of memory for the solver"
    allocate (self%holder, stat=allocation)
    if (allocation /= 0) return
    status = sfdae_illegal_argument
    call count_unknowns(problem)
    self%holder%num_unknowns = problem%num_unknowns
    call fill_options(options, self%holder, fixed, c_options, self%complaint)
    if (len(self%complaint) == 0) then
      select type (problem)
      class is (linear_dae)
        call create_linear(self, problem, c_options, status)
      class is (any_multibody_dae)
        call create_multibody(self, problem, c_options, status)
      class default
        call create_nonlinear(self, problem, c_options, status)
      end select
    end if
    if (status < 0) deallocate (self%holder)
  end subroutine solver_create

  !> Second half of solver_create for a linear problem.
  recursive subroutine create_linear(self, problem, c_options, status)
    class(dae_solver), intent(inout) :: self
    class(linear_dae), target, intent(inout) :: problem
    type(sfdae_options), intent(in) :: c_options
    integer(c_int), intent(out) :: status
    type(sfdae_linear_problem) :: c_problem
    integer(c_int) :: check_status

    call fill_problem(problem, self%holder, c_problem)
    status = c_create_linear(self%handle, c_problem, c_options)
    if (status < 0) call check_filled(c_problem, c_options, self%complaint, check_status)
  end subroutine create_linear

  !> Likewise for any other problem.
  recursive subroutine create_nonlinear(self, problem, c_options, status)
    class(dae_solver), intent(inout) :: self
    class(any_dae), target, intent(inout) :: problem
    type(sfdae_options), intent(in) :: c_options
    integer(c_int), intent(out) :: status
    type(sfdae_nonlinear_problem) :: c_problem
    integer(c_int) :: check_status

    call fill_nonlinear_problem(problem, self%holder, c_problem)
    status = c_create_nonlinear(self%handle, c_problem, c_options)
    if (status < 0) call check_filled(c_problem, c_options, self%complaint, check_status)
  end subroutine create_nonlinear

  !> Likewise for a mechanical system.
  recursive subroutine create_multibody(self, problem, c_options, status)
    class(dae_solver), intent(inout) :: self
    class(any_multibody_dae), target, intent(inout) :: problem
    type(sfdae_options), intent(in) :: c_options
    integer(c_int), intent(out) :: status
    type(sfdae_multibody_problem) :: c_problem
    integer(c_int) :: check_status

    call fill_multibody_problem(problem, self%holder, c_problem)
    status = c_create_multibody(self%handle, c_problem, c_options)
    if (status < 0) call check_filled(c_problem, c_options, self%complaint, check_status)
  end subroutine create_multibody

  !> Frees the solver. One that does not exist is allowed.
  subroutine solver_destroy(self, status)
    class(dae_solver), intent(inout) :: self
    !> sfdae_busy if called from a callback of this solver; then nothing happened.
    integer(c_int), intent(out), optional :: status
    integer(c_int) :: outcome

    outcome = c_destroy(self%handle)
    if (outcome == sfdae_ok) then
      if (associated(self%holder)) deallocate (self%holder)
      self%complaint = ""
    end if
    if (present(status)) status = outcome
  end subroutine solver_destroy

  !> Replaces the options; the point reached stays. A change of max_index, reduction, rank_tol,
  !> time_scale, difference_derivatives, difference_step or leading_term needs a new start.
  subroutine solver_set_options(self, options, status)
    class(dae_solver), intent(inout) :: self
    type(dae_options), target, intent(in) :: options
    integer(c_int), intent(out) :: status
    type(sfdae_options) :: c_options
    integer(c_int), allocatable, target :: fixed(:)
    class(dae_monitor), pointer :: old_monitor

    call check_call(self, status)
    if (status < 0) return
    old_monitor => self%holder%monitor
    call fill_options(options, self%holder, fixed, c_options, self%complaint)
    status = sfdae_illegal_argument
    if (len(self%complaint) == 0) status = c_set_options(self%handle, c_options)
    if (status < 0) self%holder%monitor => old_monitor
  end subroutine solver_set_options

  !> What the last call had to say: what, where, with which numbers, what to do next.
  function solver_message(self) result(text)
    class(dae_solver), intent(in) :: self
    !> Empty after sfdae_ok.
    character(len=:), allocatable :: text

    text = ""
    if (allocated(self%complaint)) text = self%complaint
    if (len(text) == 0) text = text_at(c_message(self%handle))
  end function solver_message

  !> Stops the call that is running, or else the next one, with sfdae_stopped. May be called from
  !> other threads.
  subroutine solver_request_stop(self, status)
    class(dae_solver), intent(in) :: self
    integer(c_int), intent(out) :: status

    status = c_request_stop(self%handle)
  end subroutine solver_request_stop

  !> Changes a parameter of recorded equations, see named_parameter; start has to follow.
  subroutine solver_set_parameter(self, name, value, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(c_double), intent(in) :: value
    !> sfdae_illegal_argument if there is no such parameter or the value is not finite.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_set_parameter(self%handle, trim(name) // c_null_char, value)
  end subroutine solver_set_parameter

  !> The value of a parameter of recorded equations.
  subroutine solver_get_parameter(self, name, value, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(c_double), intent(inout) :: value
    !> sfdae_illegal_argument if there is no such parameter.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_parameter(self%handle, trim(name) // c_null_char, value)
  end subroutine solver_get_parameter

  ! ---- Index analysis -----------------------------------------------------------------------

  !> Detects the strangeness index at t and nearby toward the end of the interval. Forgets the
  !> point reached: start has to follow. Remark: sfdae_not_unique. Failures: callbacks, structure.
  recursive subroutine solver_analyze(self, t, toward, status, characteristics)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> /= t.
    real(c_double), intent(in) :: toward
    integer(c_int), intent(out) :: status
    type(sfdae_characteristics), intent(inout), optional :: characteristics
    type(sfdae_characteristics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_characteristics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_analyze(self%handle, t, toward, found)
    if (status >= 0 .and. present(characteristics)) characteristics = found
  end subroutine solver_analyze

  !> The same along the solution through a point near x; for nonlinear problems, which need x.
  recursive subroutine solver_analyze_at(self, t, toward, x, status, characteristics)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> /= t.
    real(c_double), intent(in) :: toward
    !> n values, which need not be consistent.
    real(c_double), contiguous, intent(in) :: x(:)
    integer(c_int), intent(out) :: status
    type(sfdae_characteristics), intent(inout), optional :: characteristics
    type(sfdae_characteristics) :: found

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    if (status == sfdae_ok) status = c_characteristics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_analyze_at(self%handle, t, toward, x, found)
    if (status >= 0 .and. present(characteristics)) characteristics = found
  end subroutine solver_analyze_at

  !> The characteristic values in use. sfdae_not_started before an analysis.
  subroutine solver_get_characteristics(self, characteristics, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_characteristics), intent(inout) :: characteristics
    integer(c_int), intent(out) :: status
    type(sfdae_characteristics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_characteristics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_characteristics(self%handle, found)
    if (status >= 0) characteristics = found
  end subroutine solver_get_characteristics

  !> Number of rank decisions of the last analysis.
  subroutine solver_get_num_decisions(self, count, status)
    class(dae_solver), intent(inout) :: self
    integer(c_int), intent(inout) :: count
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_num_decisions(self%handle, count)
  end subroutine solver_get_num_decisions

  !> One rank decision of the last analysis.
  subroutine solver_get_decision(self, index, decision, status)
    class(dae_solver), intent(inout) :: self
    !> 1 ... number of decisions.
    integer(c_int), intent(in) :: index
    type(sfdae_decision), intent(inout) :: decision
    integer(c_int), intent(out) :: status
    type(sfdae_decision) :: found

    call check_call(self, status)
    if (status == sfdae_ok .and. index < 1) then
      status = sfdae_illegal_argument
      self%complaint = "decisions count from 1"
    end if
    if (status == sfdae_ok) status = c_decision_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_decision(self%handle, index - 1_c_int, found)
    if (status >= 0) decision = found
  end subroutine solver_get_decision

  !> Where the characteristic values changed (after sfdae_characteristics_changed).
  subroutine solver_get_change(self, change, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_change), intent(inout) :: change
    !> sfdae_not_started if they did not change.
    integer(c_int), intent(out) :: status
    type(sfdae_change) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_change_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_change(self%handle, found)
    if (status >= 0) change = found
  end subroutine solver_get_change

  ! ---- Initial values -----------------------------------------------------------------------

  !> Makes x consistent at t as the options say; analyzes first, forward from t, if that has not
  !> happened. The point reached is unaffected. Failures: callbacks, structure, values.
  recursive subroutine solver_make_consistent(self, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values, in: guess, out: consistent.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values: x'(t) of the solution through x, of minimum norm where the problem leaves it free.
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    xdot_address = c_null_ptr
    if (present(xdot)) then
      call check_entries(self, "xdot", size(xdot, kind=c_int), status)
      xdot_address = c_loc(xdot)
    end if
    if (status == sfdae_ok) status = c_make_consistent(self%handle, t, x, xdot_address)
  end subroutine solver_make_consistent

  !> What the last start or make_consistent did to the initial values.
  subroutine solver_get_initial_report(self, report, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_initial_report), intent(inout) :: report
    integer(c_int), intent(out) :: status
    type(sfdae_initial_report) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_initial_report_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_initial_report(self%handle, found)
    if (status < 0) return
    found%component = found%component + 1_c_int
    report = found
  end subroutine solver_get_initial_report

  ! ---- Integration --------------------------------------------------------------------------

  !> Starts or restarts at (t, x); analyzes if need be and makes x consistent. Failures: callbacks,
  !> structure, values. A restart on an analyzed solver needs no new analysis.
  recursive subroutine solver_start(self, t, toward, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> Tells the direction of integration.
    real(c_double), intent(in) :: toward
    !> n values, in: guess, out: consistent.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    xdot_address = c_null_ptr
    if (present(xdot)) then
      call check_entries(self, "xdot", size(xdot, kind=c_int), status)
      xdot_address = c_loc(xdot)
    end if
    if (status == sfdae_ok) status = c_start(self%handle, t, toward, x, xdot_address)
  end subroutine solver_start

  !> Integrates to tout. Remarks and failures of the integration return the last accepted point.
  recursive subroutine solver_advance(self, tout, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    !> In the direction of integration, at or behind the last point returned.
    real(c_double), intent(in) :: tout
    !> Point reached, tout if all went well.
    real(c_double), intent(inout) :: t
    !> n values at t, which satisfy all constraints, hidden ones included.
    real(c_double), contiguous, intent(inout) :: x(:)
    !> Remarks: sfdae_stopped, sfdae_inconsistency_ignored, sfdae_event. Failures: callbacks,
    !> integration, ...
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    xdot_address = c_null_ptr
    if (present(xdot)) then
      call check_entries(self, "xdot", size(xdot, kind=c_int), status)
      xdot_address = c_loc(xdot)
    end if
    if (status == sfdae_ok) status = c_advance(self%handle, tout, t, x, xdot_address)
  end subroutine solver_advance

  !> Takes one step toward tout: sfdae_step_taken with the point reached, or sfdae_ok at tout.
  recursive subroutine solver_step(self, tout, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    !> In the direction of integration, at or behind the last point returned.
    real(c_double), intent(in) :: tout
    !> Point reached.
    real(c_double), intent(inout) :: t
    !> n values at t.
    real(c_double), contiguous, intent(inout) :: x(:)
    !> Otherwise as of advance.
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    xdot_address = c_null_ptr
    if (present(xdot)) then
      call check_entries(self, "xdot", size(xdot, kind=c_int), status)
      xdot_address = c_loc(xdot)
    end if
    if (status == sfdae_ok) status = c_step(self%handle, tout, t, x, xdot_address)
  end subroutine solver_step

  !> The analysis and the state of the integration as an array of plain numbers, to be kept,
  !> written to a file (17 digits) or handed to another process. Problem and options are not in it.
  subroutine solver_save_checkpoint(self, checkpoint, status)
    class(dae_solver), intent(inout) :: self
    !> Allocated as needed; its size changes from step to step.
    real(c_double), allocatable, intent(inout) :: checkpoint(:)
    !> sfdae_not_started if there is no integration.
    integer(c_int), intent(out) :: status
    real(c_double), allocatable :: found(:)
    integer(c_size_t) :: length
    integer :: allocation

    call check_call(self, status)
    length = 0
    if (status == sfdae_ok) status = c_get_checkpoint_length(self%handle, length)
    if (status < 0) return
    allocate (found(length), stat=allocation)
    if (allocation /= 0) then
      status = sfdae_out_of_memory
      self%complaint = "out of memory for the checkpoint"
      return
    end if
    status = c_save_checkpoint(self%handle, found, length)
    if (status >= 0) call move_alloc(found, checkpoint)
  end subroutine solver_save_checkpoint

  !> Continues from a checkpoint instead of start: advance is next. The solver has to be created
  !> with the problem and the options that the checkpoint was made with (tolerances, limits and the
  !> monitor may differ); no callback is called.
  subroutine solver_restore_checkpoint(self, checkpoint, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: checkpoint(:)
    !> sfdae_illegal_argument if it is damaged or does not fit; then nothing is started.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_restore_checkpoint(self%handle, checkpoint, &
      size(checkpoint, kind=c_size_t))
  end subroutine solver_restore_checkpoint

  !> From the point returned last or the next start on, advance and step return sfdae_event where
  !> an event function becomes zero or changes its sign: t is that zero or, within rounding, the
  !> first point behind it. Each event is returned once. To change x there, call start.
  subroutine solver_set_events(self, events, status)
    class(dae_solver), intent(inout) :: self
    !> Must have the target attribute and live, in place, as long as it is in use; num_events must
    !> not change. num_events = 0: no events any more.
    class(dae_events), target, intent(inout) :: events
    integer(c_int), intent(out) :: status
    integer(c_int), allocatable, target :: directions(:)
    type(c_ptr) :: address

    call check_call(self, status)
    if (status < 0) return
    address = c_null_ptr
    if (allocated(events%directions)) then
      directions = events%directions
      status = sfdae_illegal_argument
      self%complaint = "directions has not num_events entries"
      if (size(directions) /= events%num_events) return
      self%complaint = ""
      if (size(directions) > 0) address = c_loc(directions)
    end if
    status = c_set_events(self%handle, events%num_events, c_funloc(call_eval_g), address, &
      c_loc(self%holder))
    if (status < 0) return
    self%holder%events => events
    self%holder%num_events = events%num_events
  end subroutine solver_set_events

  !> Which events happened at the point that was returned with sfdae_event.
  subroutine solver_get_events(self, which, status)
    class(dae_solver), intent(inout) :: self
    !> num_events entries: +1 where a function was rising, -1 where it was falling, else 0.
    integer(c_int), contiguous, intent(inout) :: which(:)
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status < 0) return
    status = sfdae_illegal_argument
    self%complaint = "which has not num_events entries"
    if (size(which) /= self%holder%num_events) return
    self%complaint = ""
    status = c_get_events(self%handle, which)
  end subroutine solver_get_events

  !> The solution at any t within the last step taken. The point reached stays.
  recursive subroutine solver_interpolate(self, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values at t, which satisfy all constraints.
    real(c_double), contiguous, intent(inout) :: x(:)
    !> sfdae_illegal_argument if t lies outside of the last step.
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    xdot_address = c_null_ptr
    if (present(xdot)) then
      call check_entries(self, "xdot", size(xdot, kind=c_int), status)
      xdot_address = c_loc(xdot)
    end if
    if (status == sfdae_ok) status = c_interpolate(self%handle, t, x, xdot_address)
  end subroutine solver_interpolate

  !> Counts since start.
  subroutine solver_get_statistics(self, statistics, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_statistics), intent(inout) :: statistics
    integer(c_int), intent(out) :: status
    type(sfdae_statistics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_statistics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_statistics(self%handle, found)
    if (status >= 0) statistics = found
  end subroutine solver_get_statistics

  ! ---- Looking inside -----------------------------------------------------------------------

  !> The diagnostics report: index analysis with every rank decision, initial values, integration.
  subroutine solver_report(self, text, status)
    class(dae_solver), intent(inout) :: self
    !> Lines are separated by new_line('a').
    character(len=:), allocatable, intent(inout) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: nothing(1)
    character(kind=c_char), allocatable :: buffer(:)
    integer(c_size_t) :: needed

    call check_call(self, status)
    needed = 1
    if (status == sfdae_ok) status = c_report(self%handle, nothing, 1_c_size_t, needed)
    if (status < 0) return
    allocate (buffer(needed))
    status = c_report(self%handle, buffer, needed, needed)
    if (status >= 0) text = text_in(buffer)
  end subroutine solver_report

  !> Classical derivative array M y = N x + g at t, with plain derivatives y = (x', x'', ...).
  !> Arrays are allocated as needed.
  recursive subroutine solver_get_derivative_array(self, t, level, status, m, n, g)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> l >= 0.
    integer(c_int), intent(in) :: level
    integer(c_int), intent(out) :: status
    !> M, (l+1)m x (l+1)n, with blocks C(i,j) E^(i-j) - C(i,j+1) A^(i-j-1).
    real(c_double), allocatable, intent(inout), optional :: m(:, :)
    !> N, (l+1)m x n, with blocks A^(i).
    real(c_double), allocatable, intent(inout), optional :: n(:, :)
    !> (l+1)m entries f^(i).
    real(c_double), allocatable, intent(inout), optional :: g(:)
    real(c_double), allocatable :: m_found(:, :), n_found(:, :), g_found(:)
    integer(c_size_t) :: rows, columns
    integer :: allocation

    call check_call(self, status)
    if (status < 0) return
    rows = (level + 1_c_size_t) * self%holder%num_equations
    columns = self%holder%num_unknowns
    allocate (m_found(rows, (level + 1_c_size_t) * columns), n_found(rows, columns), &
      g_found(rows), stat=allocation)
    if (allocation /= 0) then
      status = sfdae_out_of_memory
      self%complaint = "out of memory for the derivative array"
      return
    end if
    status = c_get_derivative_array(self%handle, t, level, m_found, n_found, g_found)
    if (status < 0) return
    if (present(m)) call move_alloc(m_found, m)
    if (present(n)) call move_alloc(n_found, n)
    if (present(g)) call move_alloc(g_found, g)
  end subroutine solver_get_derivative_array

  !> Projectors at t for the classical array of level mu, with orthonormal columns. Arrays are
  !> allocated as needed. Needs an analysis.
  recursive subroutine solver_get_projectors(self, t, status, z1, z2, z3, t2)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(out) :: status
    !> Z1, m x d: spans the range of E T2.
    real(c_double), allocatable, intent(inout), optional :: z1(:, :)
    !> Z2, (mu+1)m x a: Z2^T M = 0, A2 = Z2^T N has full row rank.
    real(c_double), allocatable, intent(inout), optional :: z2(:, :)
    !> Z3, (mu+1)m x vhat: Z3^T [M N] = 0.
    real(c_double), allocatable, intent(inout), optional :: z3(:, :)
    !> T2, n x (n-a): A2 T2 = 0.
    real(c_double), allocatable, intent(inout), optional :: t2(:, :)
    type(sfdae_characteristics) :: sizes
    real(c_double), allocatable :: z1_found(:, :), z2_found(:, :), z3_found(:, :), t2_found(:, :)
    integer(c_int) :: rows, m, n, vhat

    call self%get_characteristics(sizes, status)
    if (status < 0) return
    m = self%holder%num_equations
    n = self%holder%num_unknowns
    rows = (sizes%strangeness_index + 1_c_int) * m
    allocate (z1_found(m, sizes%differential), z2_found(rows, sizes%algebraic))
    allocate (z3_found(rows, rows - sizes%algebraic), t2_found(n, n - sizes%algebraic))
    vhat = 0
    status = c_get_projectors(self%handle, t, z1_found, z2_found, z3_found, t2_found, vhat)
    if (status < 0) return
    if (present(z1)) call move_alloc(z1_found, z1)
    if (present(z2)) call move_alloc(z2_found, z2)
    if (present(z3)) z3 = z3_found(:, 1:vhat)
    if (present(t2)) call move_alloc(t2_found, t2)
  end subroutine solver_get_projectors

  !> Strangeness-free system at t: E1 x' = A1 x + f1, 0 = A2 x + f2. Arrays are allocated as
  !> needed. Needs an analysis.
  recursive subroutine solver_get_strangeness_free(self, t, status, e1, a1, f1, a2, f2, residual)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(out) :: status
    !> E1 = Z1^T E, d x n.
    real(c_double), allocatable, intent(inout), optional :: e1(:, :)
    !> A1 = Z1^T A, d x n.
    real(c_double), allocatable, intent(inout), optional :: a1(:, :)
    !> f1 = Z1^T f, d entries.
    real(c_double), allocatable, intent(inout), optional :: f1(:)
    !> A2 = Z2^T N, a x n.
    real(c_double), allocatable, intent(inout), optional :: a2(:, :)
    !> f2 = Z2^T g, a entries.
    real(c_double), allocatable, intent(inout), optional :: f2(:)
    !> Max norm of Z3^T g, the contradiction of redundant equations.
    real(c_double), intent(inout), optional :: residual
    type(sfdae_characteristics) :: sizes
    real(c_double), allocatable :: e1_found(:, :), a1_found(:, :), a2_found(:, :)
    real(c_double), allocatable :: f1_found(:), f2_found(:)
    real(c_double) :: residual_found

    call self%get_characteristics(sizes, status)
    if (status < 0) return
    associate (d => sizes%differential, a => sizes%algebraic, n => self%holder%num_unknowns)
      allocate (e1_found(d, n), a1_found(d, n), f1_found(d), a2_found(a, n), f2_found(a))
    end associate
    residual_found = 0
    status = c_get_strangeness_free(self%handle, t, e1_found, a1_found, f1_found, a2_found, &
      f2_found, residual_found)
    if (status < 0) return
    if (present(e1)) call move_alloc(e1_found, e1)
    if (present(a1)) call move_alloc(a1_found, a1)
    if (present(f1)) call move_alloc(f1_found, f1)
    if (present(a2)) call move_alloc(a2_found, a2)
    if (present(f2)) call move_alloc(f2_found, f2)
    if (present(residual)) residual = residual_found
  end subroutine solver_get_strangeness_free

  !> Compares the derivatives that the callbacks supply near t with differences of the order
  !> below; message says it in words if they do not fit. Orders that are not available are
  !> passed over.
  recursive subroutine solver_check_derivatives(self, t, max_order, check, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> Highest order compared, >= 1.
    integer(c_int), intent(in) :: max_order
    !> The worst mismatch.
    type(sfdae_derivative_check), intent(inout) :: check
    integer(c_int), intent(out) :: status
    type(sfdae_derivative_check) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_derivative_check_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_check_derivatives(self%handle, t, max_order, found)
    if (status >= 0) check = from_one(found)
  end subroutine solver_check_derivatives

  !> The same for the procedure total_derivative of a derivative_dae along a jet.
  recursive subroutine solver_check_total_derivatives(self, t, derivatives, check, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n x (highest order compared + 2): x, x', x'', ..., best without zeros.
    real(c_double), contiguous, intent(in) :: derivatives(:, :)
    !> The worst mismatch.
    type(sfdae_derivative_check), intent(inout) :: check
    integer(c_int), intent(out) :: status
    type(sfdae_derivative_check) :: found
    integer(c_int) :: max_order

    call check_call(self, status)
    call check_entries(self, "a column of derivatives", size(derivatives, 1, c_int), status)
    if (status == sfdae_ok) status = c_derivative_check_init(found, c_sizeof(found))
    max_order = size(derivatives, 2, c_int) - 2_c_int
    if (status == sfdae_ok) status = c_check_total_derivatives(self%handle, t, derivatives, &
      max_order, found)
    if (status >= 0) check = from_one(found)
  end subroutine solver_check_total_derivatives

  !> The same for the derivatives that a multibody_dae supplies, near (t, q, v).
  recursive subroutine solver_check_multibody_derivatives(self, t, q, v, check, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), contiguous, intent(in) :: q(:)
    !> nv velocities.
    real(c_double), contiguous, intent(in) :: v(:)
    !> The worst mismatch.
    type(sfdae_derivative_check), intent(inout) :: check
    integer(c_int), intent(out) :: status
    type(sfdae_derivative_check) :: found

    call check_call(self, status)
    if (status == sfdae_ok .and. (associated(self%holder%multibody) .or. &
      associated(self%holder%recorded_multibody))) then
      call compare_size("q", size(q, kind=c_int), self%holder%num_positions, self%complaint, "nq")
      call compare_size("v", size(v, kind=c_int), self%holder%num_velocities, self%complaint, "nv")
      if (len(self%complaint) > 0) status = sfdae_illegal_argument
    end if
    if (status == sfdae_ok) status = c_derivative_check_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_check_multibody_derivatives(self%handle, t, q, v, found)
    if (status >= 0) check = from_one(found)
  end subroutine solver_check_multibody_derivatives

  !> Constraints, freedom and partition of a mechanical system at the point reached.
  subroutine solver_get_multibody_report(self, report, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_multibody_report), intent(inout) :: report
    !> sfdae_not_started before an analysis, sfdae_illegal_argument for other problems.
    integer(c_int), intent(out) :: status
    type(sfdae_multibody_report) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_multibody_report_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_multibody_report(self%handle, found)
    if (status >= 0) report = found
  end subroutine solver_get_multibody_report

  ! ---- Bindings that need not be overridden -------------------------------------------------

  !> M = I.
  subroutine identity_mass(self, t, q, matrix, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nv x nv, zero on entry.
    real(c_double), intent(inout) :: matrix(:, :)
    !> As of e_function.
    integer(c_int), intent(inout) :: status
    integer :: i

    associate (u1 => self, u2 => t, u3 => q, u4 => status) ! unused
    end associate
    do i = 1, size(matrix, 1)
      matrix(i, i) = 1
    end do
  end subroutine identity_mass

  !> There are constraints, but nobody says what they are.
  subroutine missing_constraints(self, t, q, vector, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nl entries, zero on entry.
    real(c_double), intent(inout) :: vector(:)
    !> As of e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => vector) ! unused
    end associate
    status = -1
  end subroutine missing_constraints

  !> Likewise their matrices.
  subroutine missing_matrix(self, t, q, matrix, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> Zero on entry.
    real(c_double), intent(inout) :: matrix(:, :)
    !> As of e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => matrix) ! unused
    end associate
    status = -1
  end subroutine missing_matrix

  !> h = 0.
  subroutine zero_offset(self, t, q, vector, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nk entries, zero on entry.
    real(c_double), intent(inout) :: vector(:)
    !> As of e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => vector, u5 => status) ! unused
    end associate
  end subroutine zero_offset

  !> A curvature is said to be there, but is not.
  subroutine missing_curvature(self, t, q, v, vector, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nv velocities.
    real(c_double), intent(in) :: v(:)
    !> Zero on entry.
    real(c_double), intent(inout) :: vector(:)
    !> As of e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => v, u5 => vector) ! unused
    end associate
    status = -1
  end subroutine missing_curvature

  !> f = 0.
  subroutine zero_f(self, t, order, f, status)
    class(linear_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> 0: f itself.
    integer(c_int), intent(in) :: order
    !> m entries, zero on entry.
    real(c_double), intent(inout) :: f(:)
    !> As of e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => order, u4 => f, u5 => status) ! unused
    end associate
  end subroutine zero_f

  !> Components are prescribed, but nobody says what they are.
  subroutine missing_prescribed(self, t, values, status)
    class(any_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> One entry for each prescribed component, zero on entry.
    real(c_double), intent(inout) :: values(:)
    !> As of e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => values) ! unused
    end associate
    status = -1
  end subroutine missing_prescribed

  ! ---- Callbacks: from C to the bindings ----------------------------------------------------

  !> sfdae_matrix_function of E.
  recursive function call_eval_e(t, order, matrix, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: matrix
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: e(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(matrix, e, [holder%num_equations, holder%num_unknowns])
    status = sfdae_ok
    call holder%linear%eval_e(t, order, e, status)
  end function call_eval_e

  !> sfdae_matrix_function of A.
  recursive function call_eval_a(t, order, matrix, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: matrix
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: a(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(matrix, a, [holder%num_equations, holder%num_unknowns])
    status = sfdae_ok
    call holder%linear%eval_a(t, order, a, status)
  end function call_eval_a

  !> sfdae_vector_function of f.
  recursive function call_eval_f(t, order, vector, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: vector
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: f(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(vector, f, [holder%num_equations])
    status = sfdae_ok
    call holder%linear%eval_f(t, order, f, status)
  end function call_eval_f

  !> sfdae_vector_function of the prescribed components; only order 0 is asked for.
  recursive function call_eval_prescribed(t, order, vector, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: vector
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: values(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(vector, values, [size(holder%prescribed)])
    status = merge(sfdae_ok, sfdae_order_not_available, order == 0)
    if (order == 0) call holder%problem%eval_prescribed(t, values, status)
  end function call_eval_prescribed

  !> sfdae_equations_function.
  recursive function call_equations(record, t, x, xdot, residual, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: x
    type(c_ptr), value :: xdot
    type(c_ptr), value :: residual
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    type(expression), pointer :: unknowns(:), derivatives(:), residuals(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(x, unknowns, [holder%num_unknowns])
    call c_f_pointer(xdot, derivatives, [holder%num_unknowns])
    call c_f_pointer(residual, residuals, [holder%num_equations])
    call holder%nonlinear%equations(t, unknowns, derivatives, residuals)
    status = merge(sfdae_ok, sfdae_internal, c_associated(record))
  end function call_equations

  !> sfdae_linear_equations_function.
  recursive function call_linear_equations(record, t, e, a, f, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: e
    type(c_ptr), value :: a
    type(c_ptr), value :: f
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    type(expression), pointer :: matrix_e(:, :), matrix_a(:, :), vector_f(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(e, matrix_e, [holder%num_equations, holder%num_unknowns])
    call c_f_pointer(a, matrix_a, [holder%num_equations, holder%num_unknowns])
    call c_f_pointer(f, vector_f, [holder%num_equations])
    call holder%recorded_linear%linear_equations(t, matrix_e, matrix_a, vector_f)
    status = merge(sfdae_ok, sfdae_internal, c_associated(record))
  end function call_linear_equations

  !> sfdae_total_derivative_function. Pointers that are not associated are absent arguments.
  recursive function call_total_derivative(t, order, derivatives, f, f_x, f_xdot, user) &
    bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: derivatives
    type(c_ptr), value :: f
    type(c_ptr), value :: f_x
    type(c_ptr), value :: f_xdot
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: jet(:, :), residual(:), matrix_x(:, :), matrix_xdot(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(derivatives, jet, [holder%num_unknowns, order + 2_c_int])
    call c_f_pointer(f, residual, [holder%num_equations])
    nullify (matrix_x, matrix_xdot)
    if (c_associated(f_x)) &
      call c_f_pointer(f_x, matrix_x, [holder%num_equations, holder%num_unknowns])
    if (c_associated(f_xdot)) &
      call c_f_pointer(f_xdot, matrix_xdot, [holder%num_equations, holder%num_unknowns])
    status = sfdae_ok
    call holder%derivative%total_derivative(t, order, jet, residual, matrix_x, matrix_xdot, status)
  end function call_total_derivative

  !> sfdae_multibody_equations_function.
  recursive function call_multibody_equations(record, t, q, v, formulas, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: v
    type(sfdae_multibody_formulas), intent(in) :: formulas
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    type(expression), pointer :: positions(:), velocities(:)
    type(multibody_formulas) :: to

    call c_f_pointer(user, holder)
    associate (nq => holder%num_positions, nv => holder%num_velocities, &
      nl => holder%num_constraints, nk => holder%num_nonholonomic)
      call c_f_pointer(q, positions, [nq])
      call c_f_pointer(v, velocities, [nv])
      call c_f_pointer(formulas%mass, to%mass, [nv, nv])
      call c_f_pointer(formulas%forces, to%forces, [nv])
      call c_f_pointer(formulas%constraints, to%constraints, [nl])
      call c_f_pointer(formulas%kinematics, to%kinematics, [nq, nv])
      call c_f_pointer(formulas%nonholonomic_matrix, to%nonholonomic_matrix, [nk, nv])
      call c_f_pointer(formulas%nonholonomic_offset, to%nonholonomic_offset, [nk])
    end associate
    call holder%recorded_multibody%equations(t, positions, velocities, to)
    status = merge(sfdae_ok, sfdae_internal, c_associated(record))
  end function call_multibody_equations

  !> sfdae_position_function of mass.
  recursive function call_mass(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_velocities, holder%num_velocities])
    status = sfdae_ok
    call holder%multibody%mass(t, positions, to, status)
  end function call_mass

  !> sfdae_velocity_function of forces.
  recursive function call_forces(t, q, v, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: v
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), velocities(:), to(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(v, velocities, [holder%num_velocities])
    call c_f_pointer(values, to, [holder%num_velocities])
    status = sfdae_ok
    call holder%multibody%forces(t, positions, velocities, to, status)
  end function call_forces

  !> sfdae_position_function of constraints.
  recursive function call_constraints(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_constraints])
    status = sfdae_ok
    call holder%multibody%constraints(t, positions, to, status)
  end function call_constraints

  !> sfdae_position_function of constraint_jacobian.
  recursive function call_constraint_jacobian(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_constraints, holder%num_positions])
    status = sfdae_ok
    call holder%multibody%constraint_jacobian(t, positions, to, status)
  end function call_constraint_jacobian

  !> sfdae_position_function of constraint_rate.
  recursive function call_constraint_rate(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_constraints])
    status = sfdae_ok
    call holder%multibody%constraint_rate(t, positions, to, status)
  end function call_constraint_rate

  !> sfdae_position_function of kinematics.
  recursive function call_kinematics(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_positions, holder%num_velocities])
    status = sfdae_ok
    call holder%kinematic%kinematics(t, positions, to, status)
  end function call_kinematics

  !> sfdae_position_function of nonholonomic_matrix.
  recursive function call_nonholonomic_matrix(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:, :)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_nonholonomic, holder%num_velocities])
    status = sfdae_ok
    call holder%multibody%nonholonomic_matrix(t, positions, to, status)
  end function call_nonholonomic_matrix

  !> sfdae_position_function of nonholonomic_offset.
  recursive function call_nonholonomic_offset(t, q, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), to(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(values, to, [holder%num_nonholonomic])
    status = sfdae_ok
    call holder%multibody%nonholonomic_offset(t, positions, to, status)
  end function call_nonholonomic_offset

  !> sfdae_velocity_function of constraint_curvature.
  recursive function call_constraint_curvature(t, q, v, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: v
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), velocities(:), to(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(v, velocities, [holder%num_velocities])
    call c_f_pointer(values, to, [holder%num_constraints])
    status = sfdae_ok
    call holder%multibody%constraint_curvature(t, positions, velocities, to, status)
  end function call_constraint_curvature

  !> sfdae_velocity_function of nonholonomic_curvature.
  recursive function call_nonholonomic_curvature(t, q, v, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q
    type(c_ptr), value :: v
    type(c_ptr), value :: values
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: positions(:), velocities(:), to(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(q, positions, [holder%num_positions])
    call c_f_pointer(v, velocities, [holder%num_velocities])
    call c_f_pointer(values, to, [holder%num_nonholonomic])
    status = sfdae_ok
    call holder%multibody%nonholonomic_curvature(t, positions, velocities, to, status)
  end function call_nonholonomic_curvature

  !> sfdae_monitor_function.
  recursive function call_monitor(progress, user) bind(c, name="") result(outcome)
    type(sfdae_progress), intent(in) :: progress
    !> The callback_holder.
    type(c_ptr), value :: user
    !> 1 stops the call.
    integer(c_int) :: outcome
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: x(:)
    logical :: stop_now

    call c_f_pointer(user, holder)
    call c_f_pointer(progress%x, x, [progress%num_unknowns])
    stop_now = .false.
    call holder%monitor%after_step(progress, x, stop_now)
    outcome = merge(1_c_int, 0_c_int, stop_now)
  end function call_monitor

  !> sfdae_event_function.
  recursive function call_eval_g(t, x, xdot, g, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: x
    type(c_ptr), value :: xdot
    type(c_ptr), value :: g
    !> The callback_holder.
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(callback_holder), pointer :: holder
    real(c_double), pointer :: values(:)
    real(c_double), pointer :: slopes(:)
    real(c_double), pointer :: functions(:)

    call c_f_pointer(user, holder)
    call c_f_pointer(x, values, [holder%num_unknowns])
    call c_f_pointer(xdot, slopes, [holder%num_unknowns])
    call c_f_pointer(g, functions, [holder%num_events])
    status = sfdae_ok
    call holder%events%eval_g(t, values, slopes, functions, status)
  end function call_eval_g

  ! ---- Conversions --------------------------------------------------------------------------

  !> Describes the problem to C and remembers in the holder what the callbacks need.
  subroutine fill_problem(problem, holder, c_problem)
    class(linear_dae), target, intent(inout) :: problem
    type(callback_holder), target, intent(inout) :: holder
    type(sfdae_linear_problem), intent(inout) :: c_problem
    integer(c_int) :: status

    call fill_holder(problem, holder)
    holder%linear => problem
    status = c_linear_problem_init(c_problem, c_sizeof(c_problem))
    if (status < 0) return ! c_problem%size stays 0, which create and check refuse
    c_problem%num_equations = problem%num_equations
    c_problem%num_unknowns = problem%num_unknowns
    c_problem%e = c_funloc(call_eval_e)
    c_problem%a = c_funloc(call_eval_a)
    if (problem%has_f) c_problem%f = c_funloc(call_eval_f)
    c_problem%constant_e = flag(problem%constant_e)
    c_problem%constant_a = flag(problem%constant_a)
    c_problem%user = c_loc(holder)
    if (.not. allocated(holder%prescribed)) return
    c_problem%num_prescribed = size(holder%prescribed, kind=c_int)
    c_problem%prescribed = c_loc(holder%prescribed)
    c_problem%prescribed_values = c_funloc(call_eval_prescribed)
  end subroutine fill_problem

  !> The same for a problem that is not a linear_dae. Without a function, create and check refuse.
  subroutine fill_nonlinear_problem(problem, holder, c_problem)
    class(any_dae), target, intent(inout) :: problem
    type(callback_holder), target, intent(inout) :: holder
    type(sfdae_nonlinear_problem), intent(inout) :: c_problem
    integer(c_int) :: status

    call fill_holder(problem, holder)
    status = c_nonlinear_problem_init(c_problem, c_sizeof(c_problem))
    if (status < 0) return ! c_problem%size stays 0, which create and check refuse
    c_problem%num_equations = problem%num_equations
    c_problem%num_unknowns = problem%num_unknowns
    select type (problem)
    class is (nonlinear_dae)
      holder%nonlinear => problem
      c_problem%equations = c_funloc(call_equations)
    class is (recorded_linear_dae)
      holder%recorded_linear => problem
      c_problem%linear_equations = c_funloc(call_linear_equations)
    class is (derivative_dae)
      holder%derivative => problem
      c_problem%total_derivative = c_funloc(call_total_derivative)
    end select
    c_problem%user = c_loc(holder)
    if (allocated(holder%differentiations)) &
      c_problem%differentiations = c_loc(holder%differentiations)
    if (.not. allocated(holder%prescribed)) return
    c_problem%num_prescribed = size(holder%prescribed, kind=c_int)
    c_problem%prescribed = c_loc(holder%prescribed)
    c_problem%prescribed_values = c_funloc(call_eval_prescribed)
  end subroutine fill_nonlinear_problem

  !> The same for a mechanical system.
  subroutine fill_multibody_problem(problem, holder, c_problem)
    class(any_multibody_dae), target, intent(inout) :: problem
    type(callback_holder), target, intent(inout) :: holder
    type(sfdae_multibody_problem), intent(inout) :: c_problem
    integer(c_int) :: status

    call fill_holder(problem, holder)
    holder%num_positions = problem%num_positions
    holder%num_velocities = velocities_of(problem)
    holder%num_constraints = problem%num_constraints
    holder%num_nonholonomic = problem%num_nonholonomic
    status = c_multibody_problem_init(c_problem, c_sizeof(c_problem))
    if (status < 0) return ! c_problem%size stays 0, which create and check refuse
    c_problem%num_positions = problem%num_positions
    c_problem%num_velocities = problem%num_velocities
    c_problem%num_constraints = problem%num_constraints
    c_problem%num_nonholonomic = problem%num_nonholonomic
    c_problem%coordinates = problem%coordinates
    c_problem%user = c_loc(holder)
    select type (problem)
    class is (recorded_multibody_dae)
      holder%recorded_multibody => problem
      c_problem%equations = c_funloc(call_multibody_equations)
    class is (kinematic_multibody_dae)
      holder%kinematic => problem
      c_problem%kinematics = c_funloc(call_kinematics)
    end select
    select type (problem)
    class is (multibody_dae)
      holder%multibody => problem
      c_problem%mass = c_funloc(call_mass)
      c_problem%forces = c_funloc(call_forces)
      c_problem%constraints = c_funloc(call_constraints)
      c_problem%constraint_jacobian = c_funloc(call_constraint_jacobian)
      c_problem%nonholonomic_matrix = c_funloc(call_nonholonomic_matrix)
      c_problem%nonholonomic_offset = c_funloc(call_nonholonomic_offset)
      if (problem%has_constraint_rate) c_problem%constraint_rate = c_funloc(call_constraint_rate)
      if (problem%has_constraint_curvature) &
        c_problem%constraint_curvature = c_funloc(call_constraint_curvature)
      if (problem%has_nonholonomic_curvature) &
        c_problem%nonholonomic_curvature = c_funloc(call_nonholonomic_curvature)
    end select
  end subroutine fill_multibody_problem

  !> Sets the numbers of equations and unknowns of a mechanical system.
  subroutine count_unknowns(problem)
    class(any_dae), intent(inout) :: problem

    select type (problem)
    class is (any_multibody_dae)
      problem%num_unknowns = problem%num_positions + velocities_of(problem) + &
        problem%num_constraints + problem%num_nonholonomic
      problem%num_equations = problem%num_unknowns
    end select
  end subroutine count_unknowns

  !> nv
  function velocities_of(problem) result(count)
    class(any_multibody_dae), intent(in) :: problem
    integer(c_int) :: count

    count = merge(problem%num_positions, problem%num_velocities, problem%num_velocities == 0)
  end function velocities_of

  !> What all callbacks need.
  subroutine fill_holder(problem, holder)
    class(any_dae), target, intent(inout) :: problem
    type(callback_holder), intent(inout) :: holder

    holder%problem => problem
    holder%num_equations = problem%num_equations
    holder%num_unknowns = problem%num_unknowns
    if (allocated(problem%differentiations)) then
      allocate (holder%differentiations(max(problem%num_equations, 1)), source=-1_c_int)
      if (size(problem%differentiations) == problem%num_equations) &
        holder%differentiations(:) = problem%differentiations
    end if
    if (.not. allocated(problem%prescribed)) return
    if (size(problem%prescribed) > 0) holder%prescribed = problem%prescribed - 1_c_int
  end subroutine fill_holder

  !> Describes the options to C and remembers the monitor in the holder. c_options points into
  !> options and fixed.
  subroutine fill_options(options, holder, fixed, c_options, complaint)
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(callback_holder), target, intent(inout) :: holder
    !> options%fixed in C's terms.
    integer(c_int), allocatable, target, intent(out) :: fixed(:)
    type(sfdae_options), intent(inout) :: c_options
    !> What is wrong with the sizes of arrays; empty if nothing is.
    character(len=:), allocatable, intent(out) :: complaint
    integer(c_int) :: status

    complaint = ""
    status = c_options_init(c_options, c_sizeof(c_options))
    if (status < 0 .or. .not. present(options)) return

    call check_size("rtol_vector", options%rtol_vector, holder%num_unknowns, complaint)
    call check_size("atol_vector", options%atol_vector, holder%num_unknowns, complaint)
    call check_size("initial_weights", options%initial_weights, holder%num_unknowns, complaint)
    if (allocated(options%fixed)) then
      fixed = flag(options%fixed)
      call compare_size("fixed", size(fixed, kind=c_int), holder%num_unknowns, complaint)
      if (size(fixed) > 0) c_options%fixed = c_loc(fixed)
    end if

    c_options%rtol = options%rtol
    c_options%atol = options%atol
    c_options%rtol_vector = address_in(options%rtol_vector)
    c_options%atol_vector = address_in(options%atol_vector)
    c_options%max_index = options%max_index
    c_options%reduction = options%reduction
    c_options%rank_tol = options%rank_tol
    c_options%time_scale = options%time_scale
    c_options%difference_derivatives = flag(options%difference_derivatives)
    c_options%difference_step = options%difference_step
    c_options%initial_values = options%initial_values
    c_options%initial_weights = address_in(options%initial_weights)
    c_options%ignore_inconsistency = flag(options%ignore_inconsistency)
    c_options%consistency_tol = options%consistency_tol
    c_options%max_order = options%max_order
    c_options%initial_step = options%initial_step
    c_options%max_step = options%max_step
    c_options%use_stop_time = flag(options%use_stop_time)
    c_options%stop_time = options%stop_time
    c_options%max_steps = options%max_steps
    c_options%leading_term = options%leading_term
    c_options%method = options%method
    c_options%min_stages = options%min_stages
    c_options%max_stages = options%max_stages

    holder%monitor => options%monitor
    if (associated(options%monitor)) c_options%monitor = c_funloc(call_monitor)
    c_options%monitor_user = c_loc(holder)
  end subroutine fill_options

  !> sfdae_check_linear with its text as a Fortran string.
  recursive subroutine check_filled_linear(c_problem, c_options, text, status)
    type(sfdae_linear_problem), intent(in) :: c_problem
    type(sfdae_options), intent(in) :: c_options
    character(len=:), allocatable, intent(out) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: buffer(1024)

    buffer = c_null_char
    status = c_check_linear(c_problem, c_options, buffer, size(buffer, kind=c_size_t))
    text = text_in(buffer)
  end subroutine check_filled_linear

  !> sfdae_check_nonlinear with its text as a Fortran string.
  recursive subroutine check_filled_nonlinear(c_problem, c_options, text, status)
    type(sfdae_nonlinear_problem), intent(in) :: c_problem
    type(sfdae_options), intent(in) :: c_options
    character(len=:), allocatable, intent(out) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: buffer(1024)

    buffer = c_null_char
    status = c_check_nonlinear(c_problem, c_options, buffer, size(buffer, kind=c_size_t))
    text = text_in(buffer)
  end subroutine check_filled_nonlinear

  !> sfdae_check_multibody with its text as a Fortran string.
  recursive subroutine check_filled_multibody(c_problem, c_options, text, status)
    type(sfdae_multibody_problem), intent(in) :: c_problem
    type(sfdae_options), intent(in) :: c_options
    character(len=:), allocatable, intent(out) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: buffer(1024)

    buffer = c_null_char
    status = c_check_multibody(c_problem, c_options, buffer, size(buffer, kind=c_size_t))
    text = text_in(buffer)
  end subroutine check_filled_multibody

  !> Before every call on a solver: refuses it if the solver does not exist.
  subroutine check_call(self, status)
    class(dae_solver), intent(inout) :: self
    !> sfdae_ok or sfdae_illegal_argument.
    integer(c_int), intent(out) :: status

    status = sfdae_ok
    self%complaint = ""
    if (c_associated(self%handle)) return
    status = sfdae_illegal_argument
    self%complaint = "the solver does not exist: create it first"
  end subroutine check_call

  !> Refuses a call with an array that has not n entries.
  subroutine check_entries(self, name, length, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: length
    !> If not sfdae_ok, the call is refused already.
    integer(c_int), intent(inout) :: status

    if (status /= sfdae_ok) return
    call compare_size(name, length, self%holder%num_unknowns, self%complaint)
    if (len(self%complaint) > 0) status = sfdae_illegal_argument
  end subroutine check_entries

  !> Complains if an option that has been set has not n values.
  subroutine check_size(name, values, n, complaint)
    character(len=*), intent(in) :: name
    real(c_double), allocatable, intent(in) :: values(:)
    integer(c_int), intent(in) :: n
    character(len=:), allocatable, intent(inout) :: complaint

    if (allocated(values)) call compare_size(name, size(values, kind=c_int), n, complaint)
  end subroutine check_size

  !> Complains if an array has not n entries.
  subroutine compare_size(name, length, n, complaint, symbol)
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: length
    integer(c_int), intent(in) :: n
    character(len=:), allocatable, intent(inout) :: complaint
    !> Of the number of entries; absent: n.
    character(len=*), intent(in), optional :: symbol
    character(len=12) :: found, expected

    if (length == n) return
    write (found, '(i0)') length
    write (expected, '(i0)') n
    complaint = name // " has " // trim(found) // " entries, but "
    if (present(symbol)) then
      complaint = complaint // symbol // " = " // trim(expected)
    else
      complaint = complaint // "n = " // trim(expected)
    end if
  end subroutine compare_size

  !> Address of an option that has been set, or null.
  function address_in(values) result(address)
    real(c_double), allocatable, target, intent(in) :: values(:)
    type(c_ptr) :: address

    address = c_null_ptr
    if (.not. allocated(values)) return
    if (size(values) > 0) address = c_loc(values)
  end function address_in

  !> A mismatch with rows and columns that count from 1.
  function from_one(found) result(check)
    type(sfdae_derivative_check), intent(in) :: found
    type(sfdae_derivative_check) :: check

    check = found
    if (check%function == c_null_char) then
      check%function = ' '
    else
      check%row = check%row + 1_c_int
      check%column = check%column + 1_c_int
    end if
  end function from_one

  !> A truth value in C's terms.
  elemental function flag(condition) result(number)
    logical, intent(in) :: condition
    integer(c_int) :: number

    number = merge(1_c_int, 0_c_int, condition)
  end function flag

  !> The C string at an address.
  function text_at(address) result(text)
    type(c_ptr), intent(in) :: address
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: characters(:)

    text = ""
    if (.not. c_associated(address)) return
    call c_f_pointer(address, characters, [c_strlen(address) + 1])
    text = text_in(characters)
  end function text_at

  !> The C string in an array of characters.
  function text_in(characters) result(text)
    !> Up to the first zero, or all of them.
    character(kind=c_char), intent(in) :: characters(:)
    character(len=:), allocatable :: text
    integer :: i, length

    length = 0
    do while (length < size(characters))
      if (characters(length + 1) == c_null_char) exit
      length = length + 1
    end do
    allocate (character(len=length) :: text)
    do i = 1, length
      text(i:i) = characters(i)
    end do
  end function text_in

end module sfdae
