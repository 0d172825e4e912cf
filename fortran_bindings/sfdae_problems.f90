! SPDX-License-Identifier: BSD-3-Clause
!
! Linear and nonlinear problems: types to extend, the callbacks by which C reaches their bindings,
! and the C structs that describe them.
module sfdae_problems
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_funptr, &
    c_int, c_loc, c_ptr, c_size_t, c_sizeof
  use sfdae_c, only: address_of_conditions_function, address_of_derivative_array_function, &
    address_of_equations_function, address_of_linear_equations_function, &
    address_of_matrix_function, address_of_total_derivative_function, &
    address_of_vector_function, c_check_linear, c_check_nonlinear, c_create_linear, &
    c_create_nonlinear, c_linear_problem_init, c_nonlinear_problem_init, c_split_derivative_array
  use sfdae_conversions, only: flag, matrix_at, names_in_c, text_in, vector_at
  use sfdae_types, only: expression, sfdae_illegal_argument, sfdae_internal, &
    sfdae_linear_problem, sfdae_matrices_dense, sfdae_nonlinear_problem, sfdae_ok, sfdae_options, &
    sfdae_order_not_available
  implicit none
  private

  public :: sparsity_pattern
  public :: any_dae, linear_dae, nonlinear_dae, recorded_linear_dae
  public :: numeric_dae, derivative_dae, derivative_array_dae, sfdae_split_derivative_array
  public :: problem_holder, linear_holder, nonlinear_holder, equation_name_length

  !> Longer names are truncated.
  integer, parameter :: equation_name_length = 128

  ! ---- Types to extend ----------------------------------------------------------------------

  !> Sparsity of an m x n matrix by compressed columns: rows of the entries of column j are
  !> row_index(col_start(j)), ..., row_index(col_start(j + 1) - 1), in any order, none twice.
  type :: sparsity_pattern
    !> n + 1 numbers, the first 1, the last the number of entries + 1.
    integer(c_int), allocatable :: col_start(:)
    !> One for each entry, 1 ... m.
    integer(c_int), allocatable :: row_index(:)
  end type sparsity_pattern

  !> Components common to all problems.
  type, abstract :: any_dae
    !> m >= 1.
    integer(c_int) :: num_equations = 0
    !> n >= 1; m and n may differ.
    integer(c_int) :: num_unknowns = 0
    !> Only if u > 0: components of x, from 1, that eval_prescribed gives as functions of time.
    integer(c_int), allocatable :: prescribed(:)
    !> Not for linear_dae: how often each equation is differentiated at most. Not allocated: no
    !> limit.
    integer(c_int), allocatable :: differentiations(:)
    !> Not for mechanical systems: names of the equations for messages, m of them, blank for those
    !> without one.
    character(len=equation_name_length), allocatable :: equation_names(:)
  contains
    !> Writes the values of the prescribed components.
    procedure :: eval_prescribed => missing_prescribed
  end type any_dae

  !> Linear problem E(t) x' = A(t) x + f(t). Extend it: components are your data.
  type, abstract, extends(any_dae) :: linear_dae
    !> E does not depend on t: eval_e is called for order 0 only, once.
    logical :: constant_e = .false.
    !> A does not depend on t; if both are constant, one reduction is used for all points.
    logical :: constant_a = .false.
    !> .false.: f = 0, eval_f is not called.
    logical :: has_f = .true.
    !> Patterns of E and A, both or none: equations are then solved by structural analysis.
    type(sparsity_pattern) :: pattern_e, pattern_a
    !> sfdae_matrices_compressed: e and a of the bindings have one column, the entries in the
    !> order of the pattern.
    integer(c_int) :: matrices = sfdae_matrices_dense
    !> Conditions on which E, A and f depend: written by eval_conditions, read from branches.
    integer(c_int) :: num_conditions = 0
    !> num_conditions entries: 1 where a condition holds, else 0. The library allocates it when a
    !> solver is created, and writes it before each call.
    integer(c_int), allocatable :: branches(:)
  contains
    !> Writes g_k(t, x, x') of each condition, which holds where g_k > 0; called if num_conditions > 0.
    procedure :: eval_conditions => missing_linear_conditions
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

  !> Nonlinear problem F(t, x, x') = 0 with derivatives of your own: extend derivative_dae or
  !> derivative_array_dae.
  type, abstract, extends(any_dae) :: numeric_dae
    !> Patterns of F_x and F_x', both or none: equations are then solved by structural analysis.
    type(sparsity_pattern) :: pattern_f_x, pattern_f_xdot
    !> sfdae_matrices_compressed (derivative_dae only): f_x and f_xdot of the binding have one
    !> column, the entries in the order of the pattern. sfdae_matrices_differences: Jacobians are
    !> always absent.
    integer(c_int) :: matrices = sfdae_matrices_dense
    !> Conditions on which F depends: written by eval_conditions, read from branches.
    integer(c_int) :: num_conditions = 0
    !> num_conditions entries: 1 where a condition holds, else 0. The library allocates it when a
    !> solver is created, and writes it before each call.
    integer(c_int), allocatable :: branches(:)
  contains
    !> Writes g_k(t, x, x') of each condition, which holds where g_k > 0; called if num_conditions > 0.
    procedure :: eval_conditions => missing_conditions
  end type numeric_dae

  !> Nonlinear problem with total derivatives order by order.
  type, abstract, extends(numeric_dae) :: derivative_dae
  contains
    !> Writes F and its Jacobians, or total derivatives of them; called at every point.
    procedure(total_derivative_procedure), deferred :: total_derivative
  end type derivative_dae

  !> Nonlinear problem with the derivative array as one procedure.
  type, abstract, extends(numeric_dae) :: derivative_array_dae
  contains
    !> Writes all total derivatives of F up to an order, and their Jacobian; called at every point.
    procedure(derivative_array_procedure), deferred :: derivative_array
  end type derivative_array_dae

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
      !> As in e_function.
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
      !> m x n, zero on entry; absent if it is not asked for.
      real(c_double), intent(inout), optional :: f_xdot(:, :)
      !> As in e_function.
      integer(c_int), intent(inout) :: status
    end subroutine total_derivative_procedure

    !> Writes the derivative array of the given order: F and its total derivatives along a jet, one
    !> after the other, and their Jacobian with respect to x, x', ..., x^(order + 1), whose blocks
    !> are C(k, j) F_x^(k-j) + C(k, j-1) F_x'^(k-j+1). Plain derivatives. Orders asked for: 0 ... mu
    !> + 1.
    subroutine derivative_array_procedure(self, t, order, x, f, jacobian, status)
      import :: c_double, c_int, derivative_array_dae
      class(derivative_array_dae), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> 0: F alone.
      integer(c_int), intent(in) :: order
      !> n x (order + 2): column k, from 0, is the k-th derivative of x.
      real(c_double), intent(in) :: x(:, 0:)
      !> (order + 1) m entries, zero on entry.
      real(c_double), intent(inout) :: f(:)
      !> (order + 1) m x (order + 2) n, zero on entry; absent if it is not asked for.
      real(c_double), intent(inout), optional :: jacobian(:, :)
      !> As in e_function.
      integer(c_int), intent(inout) :: status
    end subroutine derivative_array_procedure
  end interface

  ! ---- Problems in C's terms -----------------------------------------------------------------

  !> Copy of a solver's problem: the C struct and its targets. It must stay in place as long as the
  !> solver.
  type, abstract :: problem_holder
    !> m when the solver was created.
    integer(c_int) :: num_equations = 0
    !> n when the solver was created.
    integer(c_int) :: num_unknowns = 0
  contains
    !> Describes a problem.
    procedure(fill_procedure), deferred :: fill
    !> Creates the C solver.
    procedure(create_function), deferred :: create
    !> Describes errors in the problem or the options.
    procedure(check_function), deferred :: check
  end type problem_holder

  abstract interface
    !> Describes a problem. If that fails, create and check refuse it.
    subroutine fill_procedure(self, problem)
      import :: any_dae, problem_holder
      class(problem_holder), target, intent(inout) :: self
      !> The problem, of the kind that this holder is for.
      class(any_dae), target, intent(inout) :: problem
    end subroutine fill_procedure

    !> Creates the C solver and returns a status.
    recursive function create_function(self, solver, options) result(status)
      import :: c_int, c_ptr, problem_holder, sfdae_options
      class(problem_holder), intent(in) :: self
      !> Null after a failure.
      type(c_ptr), intent(inout) :: solver
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: status
    end function create_function

    !> Describes errors, and returns the status that create would return.
    recursive function check_function(self, options, text) result(status)
      import :: c_char, c_int, problem_holder, sfdae_options
      class(problem_holder), intent(in) :: self
      type(sfdae_options), intent(in) :: options
      !> Terminated by zero.
      character(kind=c_char), contiguous, intent(inout) :: text(:)
      integer(c_int) :: status
    end function check_function
  end interface

  !> Target of the `user` pointer of the callbacks.
  type :: problem_callbacks
    class(any_dae), pointer :: problem => null()
    !> The problem again, as what it is.
    class(linear_dae), pointer :: linear => null()
    class(nonlinear_dae), pointer :: nonlinear => null()
    class(recorded_linear_dae), pointer :: recorded_linear => null()
    class(numeric_dae), pointer :: numeric => null()
    class(derivative_dae), pointer :: derivative => null()
    class(derivative_array_dae), pointer :: array => null()
    !> m.
    integer(c_int) :: num_equations = 0
    !> n.
    integer(c_int) :: num_unknowns = 0
    !> Prescribed components, from 0.
    integer(c_int), allocatable :: prescribed(:)
    !> As in the problem; if their number is wrong, -1, which create and check refuse.
    integer(c_int), allocatable :: differentiations(:)
    !> Names of the equations in C.
    character(kind=c_char), allocatable :: names(:, :)
    !> Addresses of the names.
    type(c_ptr), allocatable :: name_addresses(:)
    !> Patterns for C: of E and A, or of F_x and F_x'. An array, since gfortran 12 does not free all
    !> of several components.
    type(sparsity_pattern), allocatable :: patterns(:)
    integer(c_int) :: matrices = sfdae_matrices_dense
  end type problem_callbacks

  !> For a linear_dae.
  type, extends(problem_holder) :: linear_holder
    type(problem_callbacks) :: callbacks
    type(sfdae_linear_problem) :: c_problem
  contains
    procedure :: fill => fill_linear
    procedure :: create => create_linear
    procedure :: check => check_linear
  end type linear_holder

  !> For all problems without a holder of their own.
  type, extends(problem_holder) :: nonlinear_holder
    type(problem_callbacks) :: callbacks
    type(sfdae_nonlinear_problem) :: c_problem
  contains
    procedure :: fill => fill_nonlinear
    procedure :: create => create_nonlinear
    procedure :: check => check_nonlinear
  end type nonlinear_holder

contains

  !> Splits the Jacobian of a derivative array into the total derivatives of F_x and F_x', and
  !> checks all its blocks; no solver is needed. order = size(f_x, 3) - 1.
  subroutine sfdae_split_derivative_array(jacobian, f_x, f_xdot, text, status)
    !> (order + 1) m x (order + 2) n, as a derivative_array_dae writes it.
    real(c_double), contiguous, intent(in) :: jacobian(:, :)
    !> m x n x (order + 1): the derivatives of order 0, 1, ... of F_x, without factorials.
    real(c_double), contiguous, intent(inout) :: f_x(:, :, :)
    !> The same of F_x'.
    real(c_double), contiguous, intent(inout) :: f_xdot(:, :, :)
    !> Description of the error; empty if there is none.
    character(len=:), allocatable, intent(out) :: text
    !> sfdae_wrong_derivatives if an entry contradicts others. The matrices are then unchanged.
    integer(c_int), intent(out) :: status
    integer :: levels
    character(kind=c_char) :: buffer(1536)

    levels = size(f_x, 3)
    status = sfdae_illegal_argument
    text = "jacobian has to have m (order + 1) rows and n (order + 2) columns, and f_xdot the " // &
      "shape of f_x: m x n x (order + 1)"
    if (any(shape(f_xdot) /= shape(f_x))) return
    if (any(shape(jacobian) /= [levels * size(f_x, 1), (levels + 1) * size(f_x, 2)])) return
    status = c_split_derivative_array(size(f_x, 1, c_int), size(f_x, 2, c_int), &
      int(levels - 1, c_int), jacobian, f_x, f_xdot, buffer, size(buffer, kind=c_size_t))
    text = text_in(buffer)
  end subroutine sfdae_split_derivative_array

  ! ---- Bindings that need not be overridden -------------------------------------------------

  !> f = 0.
  subroutine zero_f(self, t, order, f, status)
    class(linear_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> 0: f itself.
    integer(c_int), intent(in) :: order
    !> m entries, zero on entry.
    real(c_double), intent(inout) :: f(:)
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => order, u4 => f, u5 => status) ! unused
    end associate
  end subroutine zero_f

  !> Fails: components are prescribed, but eval_prescribed is not overridden.
  subroutine missing_prescribed(self, t, values, status)
    class(any_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> One entry for each prescribed component, zero on entry.
    real(c_double), intent(inout) :: values(:)
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => values) ! unused
    end associate
    status = -1
  end subroutine missing_prescribed

  !> Fails: there are conditions, but eval_conditions is not overridden.
  subroutine missing_linear_conditions(self, t, x, xdot, g, status)
    class(linear_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n unknowns.
    real(c_double), intent(in) :: x(:)
    !> Their derivatives.
    real(c_double), intent(in) :: xdot(:)
    !> One entry for each condition, zero on entry.
    real(c_double), intent(inout) :: g(:)
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => x, u4 => xdot, u5 => g) ! unused
    end associate
    status = -1
  end subroutine missing_linear_conditions

  !> Fails: there are conditions, but eval_conditions is not overridden.
  subroutine missing_conditions(self, t, x, xdot, g, status)
    class(numeric_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n unknowns.
    real(c_double), intent(in) :: x(:)
    !> Their derivatives.
    real(c_double), intent(in) :: xdot(:)
    !> One entry for each condition, zero on entry.
    real(c_double), intent(inout) :: g(:)
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => x, u4 => xdot, u5 => g) ! unused
    end associate
    status = -1
  end subroutine missing_conditions

  ! ---- Callbacks: from C to the bindings ----------------------------------------------------

  !> sfdae_matrix_function of E.
  recursive function call_eval_e(t, order, matrix, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: matrix, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%linear%eval_e(t, order, matrix_of(to, matrix, to%patterns(1)), status)
  end function call_eval_e

  !> sfdae_matrix_function of A.
  recursive function call_eval_a(t, order, matrix, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: matrix, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%linear%eval_a(t, order, matrix_of(to, matrix, to%patterns(2)), status)
  end function call_eval_a

  !> sfdae_vector_function of f.
  recursive function call_eval_f(t, order, vector, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: vector, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%linear%eval_f(t, order, vector_at(vector, to%num_equations), status)
  end function call_eval_f

  !> sfdae_vector_function of the prescribed components; only order 0 is asked for.
  recursive function call_eval_prescribed(t, order, vector, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: vector, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = merge(sfdae_ok, sfdae_order_not_available, order == 0)
    if (order == 0) call to%problem%eval_prescribed(t, &
      vector_at(vector, size(to%prescribed, kind=c_int)), status)
  end function call_eval_prescribed

  !> sfdae_conditions_function.
  recursive function call_conditions(t, x, xdot, g, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: x, xdot, g, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    if (associated(to%linear)) then
      call to%linear%eval_conditions(t, vector_at(x, to%num_unknowns), &
        vector_at(xdot, to%num_unknowns), vector_at(g, to%linear%num_conditions), status)
    else
      call to%numeric%eval_conditions(t, vector_at(x, to%num_unknowns), &
        vector_at(xdot, to%num_unknowns), vector_at(g, to%numeric%num_conditions), status)
    end if
  end function call_conditions

  !> sfdae_equations_function.
  recursive function call_equations(record, t, x, xdot, residual, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: x, xdot, residual, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to
    type(expression), pointer :: unknowns(:), derivatives(:), residuals(:)

    call c_f_pointer(user, to)
    call c_f_pointer(x, unknowns, [to%num_unknowns])
    call c_f_pointer(xdot, derivatives, [to%num_unknowns])
    call c_f_pointer(residual, residuals, [to%num_equations])
    call to%nonlinear%equations(t, unknowns, derivatives, residuals)
    status = merge(sfdae_ok, sfdae_internal, c_associated(record))
  end function call_equations

  !> sfdae_linear_equations_function.
  recursive function call_linear_equations(record, t, e, a, f, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: e, a, f, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to
    type(expression), pointer :: matrix_e(:, :), matrix_a(:, :), vector_f(:)

    call c_f_pointer(user, to)
    call c_f_pointer(e, matrix_e, [to%num_equations, to%num_unknowns])
    call c_f_pointer(a, matrix_a, [to%num_equations, to%num_unknowns])
    call c_f_pointer(f, vector_f, [to%num_equations])
    call to%recorded_linear%linear_equations(t, matrix_e, matrix_a, vector_f)
    status = merge(sfdae_ok, sfdae_internal, c_associated(record))
  end function call_linear_equations

  !> sfdae_total_derivative_function. Pointers that are not associated are absent arguments.
  recursive function call_total_derivative(t, order, derivatives, f, f_x, f_xdot, user) &
    bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: derivatives, f, f_x, f_xdot, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to
    real(c_double), pointer :: jet(:, :), matrix_x(:, :), matrix_xdot(:, :)

    call c_f_pointer(user, to)
    jet => matrix_at(derivatives, to%num_unknowns, order + 2_c_int)
    nullify (matrix_x, matrix_xdot)
    if (c_associated(f_x)) matrix_x => matrix_of(to, f_x, to%patterns(1))
    if (c_associated(f_xdot)) matrix_xdot => matrix_of(to, f_xdot, to%patterns(2))
    status = sfdae_ok
    call to%derivative%total_derivative(t, order, jet, vector_at(f, to%num_equations), matrix_x, &
      matrix_xdot, status)
  end function call_total_derivative

  !> sfdae_derivative_array_function. A pointer that is not associated is an absent argument.
  recursive function call_derivative_array(t, order, derivatives, f, jacobian, user) &
    bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: order
    type(c_ptr), value :: derivatives, f, jacobian, user
    integer(c_int) :: status
    type(problem_callbacks), pointer :: to
    real(c_double), pointer :: jet(:, :), matrix(:, :)
    integer(c_int) :: rows

    call c_f_pointer(user, to)
    jet => matrix_at(derivatives, to%num_unknowns, order + 2_c_int)
    rows = (order + 1) * to%num_equations
    nullify (matrix)
    if (c_associated(jacobian)) matrix => matrix_at(jacobian, rows, (order + 2) * to%num_unknowns)
    status = sfdae_ok
    call to%array%derivative_array(t, order, jet, vector_at(f, rows), matrix, status)
  end function call_derivative_array

  !> The matrix at an address, or the entries of its pattern.
  function matrix_of(to, address, pattern) result(matrix)
    type(problem_callbacks), intent(in) :: to
    type(c_ptr), intent(in) :: address
    type(sparsity_pattern), intent(in) :: pattern
    real(c_double), pointer :: matrix(:, :)

    if (to%matrices == sfdae_matrices_dense) then
      matrix => matrix_at(address, to%num_equations, to%num_unknowns)
    else
      matrix => matrix_at(address, size(pattern%row_index, kind=c_int), 1_c_int)
    end if
  end function matrix_of

  ! ---- Descriptions for C -------------------------------------------------------------------

  !> Describes a linear_dae.
  subroutine fill_linear(self, problem)
    class(linear_holder), target, intent(inout) :: self
    !> A linear_dae.
    class(any_dae), target, intent(inout) :: problem

    self%num_equations = problem%num_equations
    self%num_unknowns = problem%num_unknowns
    call prepare_callbacks(self%callbacks, problem)
    associate (c => self%c_problem)
      if (c_linear_problem_init(c, c_sizeof(c)) < 0) return ! c%size stays 0: is refused
      if (allocated(self%callbacks%name_addresses)) &
        c%equation_names = c_loc(self%callbacks%name_addresses)
      c%num_equations = problem%num_equations
      c%num_unknowns = problem%num_unknowns
      c%user = c_loc(self%callbacks)
      select type (problem)
      class is (linear_dae)
        self%callbacks%linear => problem
        c%e = address_of_matrix_function(call_eval_e)
        c%a = address_of_matrix_function(call_eval_a)
        if (problem%has_f) c%f = address_of_vector_function(call_eval_f)
        call fill_conditions(problem%num_conditions, problem%branches, c%num_conditions, &
          c%conditions, c%branches)
        c%constant_e = flag(problem%constant_e)
        c%constant_a = flag(problem%constant_a)
        c%matrices = problem%matrices
        self%callbacks%matrices = problem%matrices
        call copy_pattern(problem%pattern_e, self%callbacks%patterns(1), c%e_entries, &
          c%e_col_start, c%e_row_index)
        call copy_pattern(problem%pattern_a, self%callbacks%patterns(2), c%a_entries, &
          c%a_col_start, c%a_row_index)
      end select
      if (.not. allocated(self%callbacks%prescribed)) return
      c%num_prescribed = size(self%callbacks%prescribed, kind=c_int)
      c%prescribed = c_loc(self%callbacks%prescribed)
      c%prescribed_values = address_of_vector_function(call_eval_prescribed)
    end associate
  end subroutine fill_linear

  !> Describes any other problem. Without a function, create and check refuse.
  subroutine fill_nonlinear(self, problem)
    class(nonlinear_holder), target, intent(inout) :: self
    !> A nonlinear_dae, recorded_linear_dae, derivative_dae or derivative_array_dae.
    class(any_dae), target, intent(inout) :: problem

    self%num_equations = problem%num_equations
    self%num_unknowns = problem%num_unknowns
    call prepare_callbacks(self%callbacks, problem)
    associate (c => self%c_problem)
      if (c_nonlinear_problem_init(c, c_sizeof(c)) < 0) return ! c%size stays 0: is refused
      if (allocated(self%callbacks%name_addresses)) &
        c%equation_names = c_loc(self%callbacks%name_addresses)
      c%num_equations = problem%num_equations
      c%num_unknowns = problem%num_unknowns
      c%user = c_loc(self%callbacks)
      select type (problem)
      class is (nonlinear_dae)
        self%callbacks%nonlinear => problem
        c%equations = address_of_equations_function(call_equations)
      class is (recorded_linear_dae)
        self%callbacks%recorded_linear => problem
        c%linear_equations = address_of_linear_equations_function(call_linear_equations)
      class is (derivative_dae)
        self%callbacks%derivative => problem
        c%total_derivative = address_of_total_derivative_function(call_total_derivative)
      class is (derivative_array_dae)
        self%callbacks%array => problem
        c%derivative_array = address_of_derivative_array_function(call_derivative_array)
      end select
      select type (problem)
      class is (numeric_dae)
        self%callbacks%numeric => problem
        call fill_conditions(problem%num_conditions, problem%branches, c%num_conditions, &
          c%conditions, c%branches)
        c%matrices = problem%matrices
        self%callbacks%matrices = problem%matrices
        call copy_pattern(problem%pattern_f_x, self%callbacks%patterns(1), c%f_x_entries, &
          c%f_x_col_start, c%f_x_row_index)
        call copy_pattern(problem%pattern_f_xdot, self%callbacks%patterns(2), &
          c%f_xdot_entries, c%f_xdot_col_start, c%f_xdot_row_index)
      end select
      if (allocated(self%callbacks%differentiations)) &
        c%differentiations = c_loc(self%callbacks%differentiations)
      if (.not. allocated(self%callbacks%prescribed)) return
      c%num_prescribed = size(self%callbacks%prescribed, kind=c_int)
      c%prescribed = c_loc(self%callbacks%prescribed)
      c%prescribed_values = address_of_vector_function(call_eval_prescribed)
    end associate
  end subroutine fill_nonlinear

  !> Allocates the branches of the conditions and passes their address.
  subroutine fill_conditions(wanted, branches, count, function_address, branch_address)
    integer(c_int), intent(in) :: wanted
    integer(c_int), allocatable, target, intent(inout) :: branches(:)
    integer(c_int), intent(inout) :: count
    type(c_funptr), intent(inout) :: function_address
    type(c_ptr), intent(inout) :: branch_address

    count = wanted
    if (wanted < 1) return
    if (allocated(branches)) deallocate (branches)
    allocate (branches(wanted), source=0_c_int)
    function_address = address_of_conditions_function(call_conditions)
    branch_address = c_loc(branches)
  end subroutine fill_conditions

  !> Copies a pattern that counts from 1 to one for C, which counts from 0.
  subroutine copy_pattern(pattern, copy, entries, col_start, row_index)
    type(sparsity_pattern), intent(in) :: pattern
    type(sparsity_pattern), target, intent(inout) :: copy
    integer(c_int), intent(inout) :: entries
    type(c_ptr), intent(inout) :: col_start, row_index

    if (allocated(pattern%row_index)) then
      copy%row_index = pattern%row_index - 1_c_int
      entries = size(pattern%row_index, kind=c_int)
      if (entries > 0) row_index = c_loc(copy%row_index)
    end if
    if (.not. allocated(pattern%col_start)) return
    copy%col_start = pattern%col_start - 1_c_int
    if (size(pattern%col_start) > 0) col_start = c_loc(copy%col_start)
  end subroutine copy_pattern

  !> Sets the components of callbacks that any problem needs.
  subroutine prepare_callbacks(callbacks, problem)
    type(problem_callbacks), target, intent(inout) :: callbacks
    class(any_dae), target, intent(inout) :: problem

    callbacks%problem => problem
    callbacks%num_equations = problem%num_equations
    callbacks%num_unknowns = problem%num_unknowns
    allocate (callbacks%patterns(2))
    if (allocated(problem%differentiations)) then
      allocate (callbacks%differentiations(max(problem%num_equations, 1)), source=-1_c_int)
      if (size(problem%differentiations) == problem%num_equations) &
        callbacks%differentiations(:) = problem%differentiations
    end if
    ! If their number is wrong, create and check refuse.
    if (allocated(problem%equation_names)) then
      if (size(problem%equation_names) == problem%num_equations) &
        call names_in_c(problem%equation_names, callbacks%names, callbacks%name_addresses)
    end if
    if (.not. allocated(problem%prescribed)) return
    if (size(problem%prescribed) > 0) callbacks%prescribed = problem%prescribed - 1_c_int
  end subroutine prepare_callbacks

  !> Creates the C solver of a linear problem.
  recursive function create_linear(self, solver, options) result(status)
    class(linear_holder), intent(in) :: self
    type(c_ptr), intent(inout) :: solver
    type(sfdae_options), intent(in) :: options
    integer(c_int) :: status

    status = c_create_linear(solver, self%c_problem, options)
  end function create_linear

  !> Describes the errors of a linear problem.
  recursive function check_linear(self, options, text) result(status)
    class(linear_holder), intent(in) :: self
    type(sfdae_options), intent(in) :: options
    character(kind=c_char), contiguous, intent(inout) :: text(:)
    integer(c_int) :: status

    status = c_check_linear(self%c_problem, options, text, size(text, kind=c_size_t))
  end function check_linear

  !> Creates the C solver of a nonlinear problem.
  recursive function create_nonlinear(self, solver, options) result(status)
    class(nonlinear_holder), intent(in) :: self
    type(c_ptr), intent(inout) :: solver
    type(sfdae_options), intent(in) :: options
    integer(c_int) :: status

    status = c_create_nonlinear(solver, self%c_problem, options)
  end function create_nonlinear

  !> Describes the errors of a nonlinear problem.
  recursive function check_nonlinear(self, options, text) result(status)
    class(nonlinear_holder), intent(in) :: self
    type(sfdae_options), intent(in) :: options
    character(kind=c_char), contiguous, intent(inout) :: text(:)
    integer(c_int) :: status

    status = c_check_nonlinear(self%c_problem, options, text, size(text, kind=c_size_t))
  end function check_nonlinear

end module sfdae_problems
