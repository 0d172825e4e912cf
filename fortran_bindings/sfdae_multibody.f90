! SPDX-License-Identifier: BSD-3-Clause
!
! Mechanical systems with constraints: types to extend, the callbacks by which C reaches their
! bindings, and the C struct that describes them.
module sfdae_multibody
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, &
    c_loc, c_ptr, c_size_t, c_sizeof
  use sfdae_c, only: address_of_multibody_equations_function, address_of_position_function, &
    address_of_velocity_function, c_check_multibody, c_create_multibody, c_multibody_problem_init
  use sfdae_conversions, only: matrix_at, names_in_c, vector_at
  use sfdae_problems, only: any_dae, equation_name_length, problem_holder
  use sfdae_types, only: expression, sfdae_coordinates_orthogonal, sfdae_internal, &
    sfdae_multibody_formulas, sfdae_multibody_problem, sfdae_ok, sfdae_options
  implicit none
  private

  public :: any_multibody_dae, recorded_multibody_dae, multibody_formulas
  public :: multibody_dae, kinematic_multibody_dae
  public :: multibody_holder

  ! ---- Types to extend ----------------------------------------------------------------------

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
    !> Names of the nl + nk constraints for messages, holonomic ones first, blank for those without
    !> one.
    character(len=equation_name_length), allocatable :: constraint_names(:)
  end type any_multibody_dae

  !> A mechanical system written once as formulas. Extend it: components are your data.
  type, abstract, extends(any_multibody_dae) :: recorded_multibody_dae
  contains
    !> Writes the nonzero formulas; called once, by create.
    procedure(multibody_procedure), deferred :: equations
  end type recorded_multibody_dae

  !> Places for formulas, initially zero except S, which is the identity if nq = nv.
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

  !> A system whose matrices and vectors are evaluated at every point, with q' = v.
  type, abstract, extends(any_multibody_dae) :: multibody_dae
    !> g depends on t; constraint_rate is called.
    logical :: has_constraint_rate = .false.
    !> constraint_curvature is called; else finite differences replace it.
    logical :: has_constraint_curvature = .false.
    !> nonholonomic_curvature is called; else finite differences replace it.
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

  !> A system whose matrices and vectors are evaluated at every point, with q' = S v.
  type, abstract, extends(multibody_dae) :: kinematic_multibody_dae
  contains
    !> Writes S, nq x nv.
    procedure(kinematics_procedure), deferred :: kinematics
  end type kinematic_multibody_dae

  abstract interface
    !> Writes the formulas of a mechanical system. Only the forces may depend on velocities.
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
      !> As in e_function.
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
      !> As in e_function.
      integer(c_int), intent(inout) :: status
    end subroutine kinematics_procedure
  end interface

  ! ---- Systems in C's terms ------------------------------------------------------------------

  !> Target of the `user` pointer of the callbacks.
  type :: multibody_callbacks
    class(recorded_multibody_dae), pointer :: recorded => null()
    class(multibody_dae), pointer :: system => null()
    !> The same system, if it is of this type.
    class(kinematic_multibody_dae), pointer :: kinematic => null()
    !> Positions, velocities, holonomic and nonholonomic constraints.
    integer(c_int) :: nq = 0, nv = 0, nl = 0, nk = 0
    !> Names of the constraints in C.
    character(kind=c_char), allocatable :: names(:, :)
    !> Addresses of the names.
    type(c_ptr), allocatable :: name_addresses(:)
  end type multibody_callbacks

  !> For an any_multibody_dae.
  type, extends(problem_holder) :: multibody_holder
    type(multibody_callbacks) :: callbacks
    type(sfdae_multibody_problem) :: c_problem
  contains
    procedure :: fill => fill_multibody
    procedure :: create => create_multibody
    procedure :: check => check_multibody
  end type multibody_holder

contains

  ! ---- Bindings that need not be overridden -------------------------------------------------

  !> M = I.
  subroutine identity_mass(self, t, q, matrix, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nv x nv, zero on entry.
    real(c_double), intent(inout) :: matrix(:, :)
    !> As in e_function.
    integer(c_int), intent(inout) :: status
    integer :: i

    associate (u1 => self, u2 => t, u3 => q, u4 => status) ! unused
    end associate
    do i = 1, size(matrix, 1)
      matrix(i, i) = 1
    end do
  end subroutine identity_mass

  !> Fails: there are constraints, but their binding is not overridden.
  subroutine missing_constraints(self, t, q, vector, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nl entries, zero on entry.
    real(c_double), intent(inout) :: vector(:)
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => vector) ! unused
    end associate
    status = -1
  end subroutine missing_constraints

  !> Fails: there are constraints, but their matrices are not overridden.
  subroutine missing_matrix(self, t, q, matrix, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> Zero on entry.
    real(c_double), intent(inout) :: matrix(:, :)
    !> As in e_function.
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
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => vector, u5 => status) ! unused
    end associate
  end subroutine zero_offset

  !> Fails: the curvature is announced, but its binding is not overridden.
  subroutine missing_curvature(self, t, q, v, vector, status)
    class(multibody_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), intent(in) :: q(:)
    !> nv velocities.
    real(c_double), intent(in) :: v(:)
    !> Zero on entry.
    real(c_double), intent(inout) :: vector(:)
    !> As in e_function.
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => q, u4 => v, u5 => vector) ! unused
    end associate
    status = -1
  end subroutine missing_curvature

  ! ---- Callbacks: from C to the bindings ----------------------------------------------------

  !> sfdae_multibody_equations_function.
  recursive function call_multibody_equations(record, t, q, v, formulas, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: q, v
    type(sfdae_multibody_formulas), intent(in) :: formulas
    type(c_ptr), value :: user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to
    type(expression), pointer :: positions(:), velocities(:)
    type(multibody_formulas) :: places

    call c_f_pointer(user, to)
    call c_f_pointer(q, positions, [to%nq])
    call c_f_pointer(v, velocities, [to%nv])
    call c_f_pointer(formulas%mass, places%mass, [to%nv, to%nv])
    call c_f_pointer(formulas%forces, places%forces, [to%nv])
    call c_f_pointer(formulas%constraints, places%constraints, [to%nl])
    call c_f_pointer(formulas%kinematics, places%kinematics, [to%nq, to%nv])
    call c_f_pointer(formulas%nonholonomic_matrix, places%nonholonomic_matrix, [to%nk, to%nv])
    call c_f_pointer(formulas%nonholonomic_offset, places%nonholonomic_offset, [to%nk])
    call to%recorded%equations(t, positions, velocities, places)
    status = merge(sfdae_ok, sfdae_internal, c_associated(record))
  end function call_multibody_equations

  !> sfdae_position_function of mass.
  recursive function call_mass(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%mass(t, vector_at(q, to%nq), matrix_at(values, to%nv, to%nv), status)
  end function call_mass

  !> sfdae_velocity_function of forces.
  recursive function call_forces(t, q, v, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, v, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%forces(t, vector_at(q, to%nq), vector_at(v, to%nv), &
      vector_at(values, to%nv), status)
  end function call_forces

  !> sfdae_position_function of constraints.
  recursive function call_constraints(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%constraints(t, vector_at(q, to%nq), vector_at(values, to%nl), status)
  end function call_constraints

  !> sfdae_position_function of constraint_jacobian.
  recursive function call_constraint_jacobian(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%constraint_jacobian(t, vector_at(q, to%nq), &
      matrix_at(values, to%nl, to%nq), status)
  end function call_constraint_jacobian

  !> sfdae_position_function of constraint_rate.
  recursive function call_constraint_rate(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%constraint_rate(t, vector_at(q, to%nq), vector_at(values, to%nl), status)
  end function call_constraint_rate

  !> sfdae_position_function of kinematics.
  recursive function call_kinematics(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%kinematic%kinematics(t, vector_at(q, to%nq), matrix_at(values, to%nq, to%nv), status)
  end function call_kinematics

  !> sfdae_position_function of nonholonomic_matrix.
  recursive function call_nonholonomic_matrix(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%nonholonomic_matrix(t, vector_at(q, to%nq), &
      matrix_at(values, to%nk, to%nv), status)
  end function call_nonholonomic_matrix

  !> sfdae_position_function of nonholonomic_offset.
  recursive function call_nonholonomic_offset(t, q, values, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%nonholonomic_offset(t, vector_at(q, to%nq), vector_at(values, to%nk), status)
  end function call_nonholonomic_offset

  !> sfdae_velocity_function of constraint_curvature.
  recursive function call_constraint_curvature(t, q, v, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, v, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%constraint_curvature(t, vector_at(q, to%nq), vector_at(v, to%nv), &
      vector_at(values, to%nl), status)
  end function call_constraint_curvature

  !> sfdae_velocity_function of nonholonomic_curvature.
  recursive function call_nonholonomic_curvature(t, q, v, values, user) bind(c, name="") &
    result(status)
    real(c_double), value :: t
    type(c_ptr), value :: q, v, values, user
    integer(c_int) :: status
    type(multibody_callbacks), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%system%nonholonomic_curvature(t, vector_at(q, to%nq), vector_at(v, to%nv), &
      vector_at(values, to%nk), status)
  end function call_nonholonomic_curvature

  ! ---- Description for C --------------------------------------------------------------------

  !> Describes a mechanical system and sets its numbers of equations and unknowns.
  subroutine fill_multibody(self, problem)
    class(multibody_holder), target, intent(inout) :: self
    !> An any_multibody_dae.
    class(any_dae), target, intent(inout) :: problem

    select type (problem)
    class is (any_multibody_dae)
      call fill_sizes(self, problem)
    end select
    associate (c => self%c_problem)
      select type (problem)
      class is (recorded_multibody_dae)
        self%callbacks%recorded => problem
        c%equations = address_of_multibody_equations_function(call_multibody_equations)
      class is (kinematic_multibody_dae)
        self%callbacks%kinematic => problem
        c%kinematics = address_of_position_function(call_kinematics)
      end select
      select type (problem)
      class is (multibody_dae)
        self%callbacks%system => problem
        c%mass = address_of_position_function(call_mass)
        c%forces = address_of_velocity_function(call_forces)
        c%constraints = address_of_position_function(call_constraints)
        c%constraint_jacobian = address_of_position_function(call_constraint_jacobian)
        c%nonholonomic_matrix = address_of_position_function(call_nonholonomic_matrix)
        c%nonholonomic_offset = address_of_position_function(call_nonholonomic_offset)
        if (problem%has_constraint_rate) &
          c%constraint_rate = address_of_position_function(call_constraint_rate)
        if (problem%has_constraint_curvature) &
          c%constraint_curvature = address_of_velocity_function(call_constraint_curvature)
        if (problem%has_nonholonomic_curvature) &
          c%nonholonomic_curvature = address_of_velocity_function(call_nonholonomic_curvature)
      end select
    end associate
  end subroutine fill_multibody

  !> First part of fill_multibody: defaults and numbers.
  subroutine fill_sizes(self, problem)
    class(multibody_holder), target, intent(inout) :: self
    class(any_multibody_dae), intent(inout) :: problem

    associate (c => self%c_problem, to => self%callbacks)
      to%nq = problem%num_positions
      to%nv = merge(problem%num_positions, problem%num_velocities, problem%num_velocities == 0)
      to%nl = problem%num_constraints
      to%nk = problem%num_nonholonomic
      problem%num_unknowns = to%nq + to%nv + to%nl + to%nk
      problem%num_equations = problem%num_unknowns
      self%num_unknowns = problem%num_unknowns
      self%num_equations = problem%num_equations
      if (c_multibody_problem_init(c, c_sizeof(c)) < 0) return ! c%size stays 0: is refused
      c%num_positions = problem%num_positions
      c%num_velocities = problem%num_velocities
      c%num_constraints = problem%num_constraints
      c%num_nonholonomic = problem%num_nonholonomic
      c%coordinates = problem%coordinates
      c%user = c_loc(self%callbacks)
      ! If their number is wrong, create and check refuse.
      if (.not. allocated(problem%constraint_names)) return
      if (size(problem%constraint_names) /= to%nl + to%nk) return
      call names_in_c(problem%constraint_names, to%names, to%name_addresses)
      c%constraint_names = c_loc(to%name_addresses)
    end associate
  end subroutine fill_sizes

  !> Creates the C solver of a mechanical system.
  recursive function create_multibody(self, solver, options) result(status)
    class(multibody_holder), intent(in) :: self
    type(c_ptr), intent(inout) :: solver
    type(sfdae_options), intent(in) :: options
    integer(c_int) :: status

    status = c_create_multibody(solver, self%c_problem, options)
  end function create_multibody

  !> Describes the errors of a mechanical system.
  recursive function check_multibody(self, options, text) result(status)
    class(multibody_holder), intent(in) :: self
    type(sfdae_options), intent(in) :: options
    character(kind=c_char), contiguous, intent(inout) :: text(:)
    integer(c_int) :: status

    status = c_check_multibody(self%c_problem, options, text, size(text, kind=c_size_t))
  end function check_multibody

end module sfdae_multibody
