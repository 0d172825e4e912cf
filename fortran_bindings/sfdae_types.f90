! SPDX-License-Identifier: BSD-3-Clause
!
! Written by scripts/generate_fortran_mirror.py from the headers in include/sfdae: do not edit.
! Constants and structs; the header explains them.
module sfdae_types
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funptr, c_int, c_long, c_null_funptr, &
    c_null_ptr, c_ptr, c_size_t
  implicit none
  private

  integer(c_int), parameter, public :: sfdae_breakpoint_jump = 1
  integer(c_int), parameter, public :: sfdae_breakpoint_kink = 0
  integer(c_int), parameter, public :: sfdae_busy = -3
  integer(c_int), parameter, public :: sfdae_callback_failed = -11
  integer(c_int), parameter, public :: sfdae_callback_stopped = -10
  integer(c_int), parameter, public :: sfdae_characteristics_changed = -22
  integer(c_int), parameter, public :: sfdae_conditions_events = 1
  integer(c_int), parameter, public :: sfdae_conditions_smooth = 0
  integer(c_int), parameter, public :: sfdae_coordinates_orthogonal = 0
  integer(c_int), parameter, public :: sfdae_coordinates_permutation = 1
  integer(c_int), parameter, public :: sfdae_decision_a2 = 1
  integer(c_int), parameter, public :: sfdae_decision_array = 3
  integer(c_int), parameter, public :: sfdae_decision_block = 4
  integer(c_int), parameter, public :: sfdae_decision_et2 = 2
  integer(c_int), parameter, public :: sfdae_decision_stage = 0
  integer(c_int), parameter, public :: sfdae_empty_problem = -4
  integer(c_int), parameter, public :: sfdae_event = 5
  integer(c_int), parameter, public :: sfdae_fixed_values = -32
  integer(c_int), parameter, public :: sfdae_illegal_argument = -1
  integer(c_int), parameter, public :: sfdae_inconsistency_ignored = 4
  integer(c_int), parameter, public :: sfdae_inconsistent_equations = -31
  integer(c_int), parameter, public :: sfdae_inconsistent_values = -30
  integer(c_int), parameter, public :: sfdae_index_too_high = -20
  integer(c_int), parameter, public :: sfdae_initial_accept = 2
  integer(c_int), parameter, public :: sfdae_initial_fixed = 1
  integer(c_int), parameter, public :: sfdae_initial_nearest = 0
  integer(c_int), parameter, public :: sfdae_instances_failed = 7
  integer(c_int), parameter, public :: sfdae_internal = -99
  integer(c_int), parameter, public :: sfdae_leading_automatic = 0
  integer(c_int), parameter, public :: sfdae_leading_identity = 3
  integer(c_int), parameter, public :: sfdae_leading_matrix = 2
  integer(c_int), parameter, public :: sfdae_leading_projector = 1
  integer(c_int), parameter, public :: sfdae_matrices_compressed = 1
  integer(c_int), parameter, public :: sfdae_matrices_dense = 0
  integer(c_int), parameter, public :: sfdae_matrices_differences = 2
  integer(c_int), parameter, public :: sfdae_max_steps = -40
  integer(c_int), parameter, public :: sfdae_method_automatic = 2
  integer(c_int), parameter, public :: sfdae_method_bdf = 0
  integer(c_int), parameter, public :: sfdae_method_radau = 1
  integer(c_int), parameter, public :: sfdae_not_finite = -12
  integer(c_int), parameter, public :: sfdae_not_started = -5
  integer(c_int), parameter, public :: sfdae_not_unique = 3
  integer(c_int), parameter, public :: sfdae_no_consistent_values = -33
  integer(c_int), parameter, public :: sfdae_ok = 0
  integer(c_int), parameter, public :: sfdae_order_missing = -13
  integer(c_int), parameter, public :: sfdae_order_not_available = 1001
  integer(c_int), parameter, public :: sfdae_output_consistent = 0
  integer(c_int), parameter, public :: sfdae_output_interpolated = 1
  integer(c_int), parameter, public :: sfdae_out_of_memory = -2
  integer(c_int), parameter, public :: sfdae_part_both = 3
  integer(c_int), parameter, public :: sfdae_part_constraints = 1
  integer(c_int), parameter, public :: sfdae_part_differential = 2
  integer(c_int), parameter, public :: sfdae_part_undetermined = 0
  integer(c_int), parameter, public :: sfdae_prescription_singular = -23
  integer(c_int), parameter, public :: sfdae_rank_unclear = -21
  integer(c_int), parameter, public :: sfdae_reduction_staged = 0
  integer(c_int), parameter, public :: sfdae_reduction_svd = 1
  integer(c_int), parameter, public :: sfdae_singular = -42
  integer(c_int), parameter, public :: sfdae_singular_crossing = 2
  integer(c_int), parameter, public :: sfdae_singular_fold = 1
  integer(c_int), parameter, public :: sfdae_singular_unbounded = 3
  integer(c_int), parameter, public :: sfdae_singular_undetermined = 0
  integer(c_int), parameter, public :: sfdae_source_c = 0
  integer(c_int), parameter, public :: sfdae_source_fortran = 1
  integer(c_int), parameter, public :: sfdae_step_taken = 1
  integer(c_int), parameter, public :: sfdae_step_too_small = -41
  integer(c_int), parameter, public :: sfdae_stopped = 2
  integer(c_int), parameter, public :: sfdae_structure_automatic = 1
  integer(c_int), parameter, public :: sfdae_structure_certified = 1
  integer(c_int), parameter, public :: sfdae_structure_misleads = 2
  integer(c_int), parameter, public :: sfdae_structure_off = 0
  integer(c_int), parameter, public :: sfdae_structure_required = 2
  integer(c_int), parameter, public :: sfdae_structure_unchecked = 0
  integer(c_int), parameter, public :: sfdae_structure_unclear = 3
  integer(c_int), parameter, public :: sfdae_tolerance_too_small = -43
  integer(c_int), parameter, public :: sfdae_transition_condition = 0
  integer(c_int), parameter, public :: sfdae_transition_time = 2
  integer(c_int), parameter, public :: sfdae_transition_zero = 1
  integer(c_int), parameter, public :: sfdae_values_changed = 6
  integer(c_int), parameter, public :: sfdae_verdict_clear = 0
  integer(c_int), parameter, public :: sfdae_verdict_confirmed = 1
  integer(c_int), parameter, public :: sfdae_verdict_unclear = 2
  integer(c_int), parameter, public :: sfdae_verdict_user = 3
  integer(c_int), parameter, public :: sfdae_version_major = 0
  integer(c_int), parameter, public :: sfdae_version_minor = 2
  integer(c_int), parameter, public :: sfdae_version_patch = 0
  integer(c_int), parameter, public :: sfdae_wrong_derivatives = -14
  integer(c_int), parameter, public :: sfdae_wrong_pattern = -15
  integer(c_int), parameter, public :: sfdae_zeno = -44

  type, bind(c), public :: sfdae_change
    integer(c_size_t) :: size = 0
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

  type, bind(c), public :: sfdae_characteristics
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    integer(c_int) :: strangeness_index = 0
    integer(c_int) :: differential = 0
    integer(c_int) :: algebraic = 0
    integer(c_int) :: undetermined = 0
    integer(c_int) :: redundant = 0
    integer(c_int) :: rank_e = 0
    integer(c_int) :: leading_term = 0
    real(c_double) :: time_scale = 0
    real(c_double) :: smallest_gap = 0
  end type sfdae_characteristics

  type, bind(c), public :: sfdae_decision
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    integer(c_int) :: level = 0
    integer(c_int) :: stage = 0
    integer(c_int) :: what = 0
    integer(c_int) :: rows = 0
    integer(c_int) :: columns = 0
    integer(c_int) :: rank = 0
    real(c_double) :: kept = 0
    real(c_double) :: dropped = 0
    real(c_double) :: noise = 0
    real(c_double) :: threshold = 0
    real(c_double) :: gap = 0
    integer(c_int) :: verdict = 0
  end type sfdae_decision

  type, bind(c), public :: sfdae_derivative_check
    integer(c_size_t) :: size = 0
    character(kind=c_char) :: function = ' '
    integer(c_int) :: order = 0
    integer(c_int) :: row = 0
    integer(c_int) :: column = 0
    real(c_double) :: supplied = 0
    real(c_double) :: difference = 0
    real(c_double) :: error = 0
    real(c_double) :: uncertainty = 0
    integer(c_int) :: suspicious = 0
  end type sfdae_derivative_check

  type, bind(c), public :: sfdae_descriptor_matrices
    integer(c_size_t) :: size = 0
    integer(c_int) :: num_equations = 0
    integer(c_int) :: num_unknowns = 0
    integer(c_int) :: num_inputs = 0
    integer(c_int) :: num_outputs = 0
    type(c_ptr) :: e = c_null_ptr
    type(c_ptr) :: a = c_null_ptr
    type(c_ptr) :: b = c_null_ptr
    type(c_ptr) :: c = c_null_ptr
    type(c_ptr) :: d = c_null_ptr
    real(c_double) :: rank_tol = 0
  end type sfdae_descriptor_matrices

  type, bind(c), public :: sfdae_ensemble
    integer(c_size_t) :: size = 0
    integer(c_int) :: num_instances = 0
    integer(c_int) :: num_parameters = 0
    type(c_ptr) :: parameter_names = c_null_ptr
    type(c_ptr) :: parameters = c_null_ptr
    real(c_double) :: t0 = 0
    type(c_ptr) :: x0 = c_null_ptr
    type(c_ptr) :: xdot0 = c_null_ptr
    integer(c_int) :: num_times = 0
    type(c_ptr) :: times = c_null_ptr
    integer(c_int) :: num_threads = 0
    type(c_funptr) :: monitor = c_null_funptr
    type(c_ptr) :: monitor_user = c_null_ptr
  end type sfdae_ensemble

  type, bind(c), public :: sfdae_ensemble_progress
    integer(c_size_t) :: size = 0
    integer(c_int) :: instance = 0
    integer(c_int) :: status = 0
    integer(c_int) :: num_ended = 0
    integer(c_int) :: num_instances = 0
  end type sfdae_ensemble_progress

  type, bind(c), public :: sfdae_ensemble_results
    integer(c_size_t) :: size = 0
    type(c_ptr) :: x = c_null_ptr
    type(c_ptr) :: xdot = c_null_ptr
    type(c_ptr) :: statuses = c_null_ptr
    type(c_ptr) :: num_outputs = c_null_ptr
    type(c_ptr) :: messages = c_null_ptr
    integer(c_size_t) :: message_length = 0
    integer(c_int) :: num_failed = 0
    integer(c_int) :: num_analyses = 0
    integer(c_int) :: num_threads = 0
  end type sfdae_ensemble_results

  type, bind(c), public :: expression
    type(c_ptr) :: record = c_null_ptr
    real(c_double) :: value = 0
    integer(c_int) :: node = 0
  end type expression

  type, bind(c), public :: sfdae_initial_report
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    real(c_double) :: residual_before = 0
    real(c_double) :: residual_after = 0
    real(c_double) :: largest_change = 0
    integer(c_int) :: component = 0
    integer(c_int) :: derivative_exact = 0
  end type sfdae_initial_report

  type, bind(c), public :: sfdae_linear_problem
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
    type(c_ptr) :: equation_names = c_null_ptr
    integer(c_int) :: e_entries = 0
    type(c_ptr) :: e_col_start = c_null_ptr
    type(c_ptr) :: e_row_index = c_null_ptr
    integer(c_int) :: a_entries = 0
    type(c_ptr) :: a_col_start = c_null_ptr
    type(c_ptr) :: a_row_index = c_null_ptr
    integer(c_int) :: matrices = 0
    integer(c_int) :: num_conditions = 0
    type(c_funptr) :: conditions = c_null_funptr
    type(c_ptr) :: branches = c_null_ptr
  end type sfdae_linear_problem

  type, bind(c), public :: sfdae_linearization
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    type(c_ptr) :: x = c_null_ptr
    type(c_ptr) :: xdot = c_null_ptr
    integer(c_int) :: num_input_parameters = 0
    type(c_ptr) :: input_parameters = c_null_ptr
    integer(c_int) :: num_input_unknowns = 0
    type(c_ptr) :: input_unknowns = c_null_ptr
    integer(c_int) :: num_input_columns = 0
    type(c_ptr) :: input_columns = c_null_ptr
    integer(c_int) :: num_output_unknowns = 0
    type(c_ptr) :: output_unknowns = c_null_ptr
    integer(c_int) :: num_output_rows = 0
    type(c_ptr) :: output_rows = c_null_ptr
  end type sfdae_linearization

  type, bind(c), public :: sfdae_mode
    integer(c_size_t) :: size = 0
    integer(c_long) :: visits = 0
    real(c_double) :: duration = 0
    integer(c_long) :: steps = 0
    integer(c_int) :: num_analyses = 0
    integer(c_int) :: strangeness_index = 0
    integer(c_int) :: differential = 0
    integer(c_int) :: algebraic = 0
  end type sfdae_mode

  type, bind(c), public :: sfdae_multibody_formulas
    type(c_ptr) :: mass = c_null_ptr
    type(c_ptr) :: forces = c_null_ptr
    type(c_ptr) :: constraints = c_null_ptr
    type(c_ptr) :: kinematics = c_null_ptr
    type(c_ptr) :: nonholonomic_matrix = c_null_ptr
    type(c_ptr) :: nonholonomic_offset = c_null_ptr
  end type sfdae_multibody_formulas

  type, bind(c), public :: sfdae_multibody_problem
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
    type(c_ptr) :: constraint_names = c_null_ptr
  end type sfdae_multibody_problem

  type, bind(c), public :: sfdae_multibody_report
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    integer(c_int) :: holonomic = 0
    integer(c_int) :: nonholonomic = 0
    integer(c_int) :: redundant = 0
    integer(c_int) :: degrees_of_freedom = 0
    integer(c_int) :: position_freedom = 0
    real(c_double) :: condition = 0
    integer(c_long) :: partitions = 0
    real(c_double) :: position_residual = 0
    real(c_double) :: velocity_residual = 0
  end type sfdae_multibody_report

  type, bind(c), public :: sfdae_nonlinear_problem
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
    type(c_ptr) :: equation_names = c_null_ptr
    integer(c_int) :: f_x_entries = 0
    type(c_ptr) :: f_x_col_start = c_null_ptr
    type(c_ptr) :: f_x_row_index = c_null_ptr
    integer(c_int) :: f_xdot_entries = 0
    type(c_ptr) :: f_xdot_col_start = c_null_ptr
    type(c_ptr) :: f_xdot_row_index = c_null_ptr
    integer(c_int) :: matrices = 0
    integer(c_int) :: num_conditions = 0
    type(c_funptr) :: conditions = c_null_funptr
    type(c_ptr) :: branches = c_null_ptr
    type(c_funptr) :: derivative_array = c_null_funptr
  end type sfdae_nonlinear_problem

  type, bind(c), public :: sfdae_options
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
    integer(c_int) :: xdot_is_guess = 0
    integer(c_int) :: output = 0
    integer(c_int) :: check_derivatives = 0
    integer(c_int) :: structure = 0
    integer(c_int) :: conditions = 0
    real(c_double) :: max_seconds = 0
  end type sfdae_options

  type, bind(c), public :: sfdae_passage
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    integer(c_int) :: transition = 0
    integer(c_int) :: from = 0
    integer(c_int) :: to = 0
    real(c_double) :: largest_impulse = 0
    integer(c_int) :: impulse_component = 0
    real(c_double) :: largest_change = 0
    integer(c_int) :: changed_component = 0
  end type sfdae_passage

  type, bind(c), public :: sfdae_progress
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    real(c_double) :: step = 0
    integer(c_int) :: order = 0
    integer(c_long) :: steps = 0
    integer(c_int) :: num_unknowns = 0
    type(c_ptr) :: x = c_null_ptr
  end type sfdae_progress

  type, bind(c), public :: sfdae_sensitivity_options
    integer(c_size_t) :: size = 0
    integer(c_int) :: error_test = 0
    type(c_ptr) :: scales = c_null_ptr
    integer(c_int) :: adjoint = 0
    integer(c_long) :: max_kept_steps = 0
  end type sfdae_sensitivity_options

  type, bind(c), public :: sfdae_sensitivity_statistics
    integer(c_size_t) :: size = 0
    integer(c_int) :: count = 0
    integer(c_long) :: linearizations = 0
    integer(c_long) :: factorizations = 0
    integer(c_long) :: error_test_failures = 0
    integer(c_long) :: outputs = 0
    integer(c_long) :: kept_steps = 0
    real(c_double) :: kept_bytes = 0
    integer(c_long) :: checkpoints = 0
    integer(c_long) :: repeated_steps = 0
  end type sfdae_sensitivity_statistics

  type, bind(c), public :: sfdae_singular_point
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    integer(c_int) :: kind = 0
    integer(c_int) :: part = 0
    integer(c_int) :: component = 0
    real(c_double) :: exponent = 0
    integer(c_int) :: passed = 0
    real(c_double) :: t_before = 0
    real(c_double) :: t_after = 0
    integer(c_long) :: count = 0
  end type sfdae_singular_point

  type, bind(c), public :: sfdae_spectrum
    integer(c_size_t) :: size = 0
    integer(c_int) :: num_finite = 0
    integer(c_int) :: num_infinite = 0
    integer(c_int) :: strangeness_index = 0
    integer(c_int) :: differential = 0
    integer(c_int) :: algebraic = 0
    integer(c_int) :: undetermined = 0
    integer(c_int) :: redundant = 0
  end type sfdae_spectrum

  type, bind(c), public :: sfdae_statistics
    integer(c_size_t) :: size = 0
    integer(c_long) :: steps = 0
    integer(c_long) :: error_failures = 0
    integer(c_long) :: other_failures = 0
    integer(c_long) :: reductions = 0
    integer(c_long) :: factorizations = 0
    integer(c_long) :: evaluations_e = 0
    integer(c_long) :: evaluations_a = 0
    integer(c_long) :: evaluations_f = 0
    integer(c_int) :: last_order = 0
    integer(c_int) :: next_order = 0
    real(c_double) :: last_step = 0
    real(c_double) :: next_step = 0
    real(c_double) :: t_internal = 0
    real(c_double) :: smallest_kept = 0
    real(c_double) :: consistency = 0
    real(c_double) :: first_step = 0
    integer(c_long) :: evaluations_residual = 0
    integer(c_long) :: linearizations = 0
    real(c_double) :: rounding = 0
    integer(c_long) :: check_calls = 0
    integer(c_long) :: switches = 0
    integer(c_long) :: jumps = 0
  end type sfdae_statistics

  type, bind(c), public :: sfdae_structure
    integer(c_size_t) :: size = 0
    integer(c_int) :: has_assignment = 0
    integer(c_int) :: freedom = 0
    integer(c_int) :: index_bound = 0
    integer(c_int) :: num_blocks = 0
    integer(c_int) :: largest_block = 0
    integer(c_int) :: is_followed = 0
    integer(c_int) :: verdict = 0
    integer(c_int) :: doubtful_block = 0
    real(c_double) :: smallest_pivot = 0
    integer(c_int) :: num_replaced = 0
  end type sfdae_structure

  type, bind(c), public :: sfdae_switch
    integer(c_size_t) :: size = 0
    real(c_double) :: t = 0
    real(c_double) :: before = 0
    real(c_double) :: after = 0
    integer(c_int) :: jumps = 0
    integer(c_int) :: condition = 0
  end type sfdae_switch

  type, bind(c), public :: sfdae_transition
    integer(c_size_t) :: size = 0
    integer(c_int) :: from = 0
    integer(c_int) :: to = 0
    integer(c_int) :: kind = 0
    type(c_funptr) :: function = c_null_funptr
    integer(c_int) :: direction = 0
    real(c_double) :: time = 0
    type(c_funptr) :: guard = c_null_funptr
    type(c_funptr) :: jump = c_null_funptr
    type(c_ptr) :: user = c_null_ptr
  end type sfdae_transition

end module sfdae_types
