! SPDX-License-Identifier: BSD-3-Clause
!
! Analysis and looking inside: results against their defining properties, indices from 1.
program inspection_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_change, sfdae_characteristics, &
    sfdae_characteristics_changed, sfdae_decision, sfdae_decision_array, &
    sfdae_derivative_check, sfdae_illegal_argument, sfdae_index_too_high, &
    sfdae_leading_automatic, sfdae_not_started, sfdae_ok, sfdae_reduction_svd, &
    sfdae_values_changed, sfdae_verdict_clear, sfdae_verdict_confirmed
  use test_support, only: check, check_close, check_status, crossing_dae, finish, &
    gear_petzold_dae, mixed_dae, reaction_dae, within
  implicit none

  call finds_characteristic_values()
  call lists_rank_decisions()
  call locates_changes()
  call makes_values_consistent()
  call exports_derivative_array()
  call exports_projectors()
  call exports_projectors_without_columns()
  call exports_strangeness_free_system()
  call checks_derivatives()
  call writes_report()
  call finish()

contains

  !> mu, d, a, u, v of a square and of an overdetermined problem.
  subroutine finds_characteristic_values()
    type(mixed_dae), target :: mixed = mixed_dae(num_equations=3, num_unknowns=3)
    type(reaction_dae), target :: reaction = reaction_dae(num_equations=3, num_unknowns=2)
    type(sfdae_characteristics) :: found, again
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status

    call solver%create(mixed, status)
    found%algebraic = 77
    call solver%get_characteristics(found, status)
    call check_status(status, sfdae_not_started, "get_characteristics before an analysis")
    call check(found%algebraic == 77, "result of a failed call")
    call solver%analyze(1.0_dp, 1.0_dp, status, found)
    call check_status(status, sfdae_illegal_argument, "toward = t")
    call check(found%algebraic == 77, "result of a failed analysis")
    call solver%analyze(0.5_dp, 1.0_dp, status, found)
    call check_status(status, sfdae_ok, "analyze")
    call check(found%strangeness_index == 1 .and. found%differential == 1 .and. &
      found%algebraic == 2 .and. found%undetermined == 0 .and. found%redundant == 0, &
      "characteristic values of the mixed problem")
    call check(found%rank_e == 2 .and. found%smallest_gap >= 1.0e3_dp, "rank E, gap")
    call check(found%leading_term /= sfdae_leading_automatic, "leading term")
    call solver%get_characteristics(again, status)
    call check(again%strangeness_index == 1 .and. again%algebraic == 2, "get_characteristics")
    call solver%destroy()

    options%max_index = 0
    call solver%create(mixed, status, options)
    call solver%analyze(0.0_dp, 1.0_dp, status)
    call check_status(status, sfdae_index_too_high, "max_index = 0")
    call solver%destroy()

    call solver%create(reaction, status)
    call solver%analyze(0.0_dp, 1.0_dp, status, found)
    call check(found%differential == 1 .and. found%algebraic == 1 .and. &
      found%undetermined == 0 .and. found%redundant == 1, "characteristic values, v = 1")
    call solver%destroy()
  end subroutine finds_characteristic_values

  !> Decisions count from 1.
  subroutine lists_rank_decisions()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_options) :: options
    type(sfdae_decision) :: decision
    type(dae_solver) :: solver
    integer(c_int) :: status, count, k
    logical :: array_seen

    options%reduction = sfdae_reduction_svd
    call solver%create(problem, status, options)
    call solver%analyze(0.0_dp, 1.0_dp, status)
    count = 0
    call solver%get_num_decisions(count, status)
    call check_status(status, sfdae_ok, "get_num_decisions")
    call check(count > 1, "number of decisions")
    array_seen = .false.
    do k = 1, count
      call solver%get_decision(k, decision, status)
      call check_status(status, sfdae_ok, "get_decision")
      call check(decision%rank >= 0 .and. decision%rank <= min(decision%rows, decision%columns), &
        "rank of a decision")
      call check(any(decision%verdict == [sfdae_verdict_clear, sfdae_verdict_confirmed]), "verdict")
      if (decision%what == sfdae_decision_array) array_seen = .true.
    end do
    call check(array_seen, "decision on the whole array")
    call solver%get_decision(0_c_int, decision, status)
    call check_status(status, sfdae_illegal_argument, "decision 0")
    call check(index(solver%message(), "from 1") > 0, "words on decision 0")
    call solver%get_decision(count + 1_c_int, decision, status)
    call check_status(status, sfdae_illegal_argument, "decision after the last")
    call solver%destroy()
  end subroutine lists_rank_decisions

  !> diag(1, t - 1/2) loses rank at t = 1/2.
  subroutine locates_changes()
    type(crossing_dae), target :: problem = crossing_dae(num_equations=2, num_unknowns=2)
    type(sfdae_change) :: change
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(2)

    call solver%create(problem, status)
    x = [1.0_dp, -0.5_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%get_change(change, status)
    call check_status(status, sfdae_not_started, "get_change before a change")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_characteristics_changed, "advance through the change")
    call check(t <= 0.5_dp + 1.0e-6_dp, "point before the change")
    call solver%get_change(change, status)
    call check_status(status, sfdae_ok, "get_change")
    call check(abs(change%t - 0.5_dp) <= 1.0e-6_dp, "t of the change")
    call check(change%old_differential == 2 .and. change%old_algebraic == 0, "old values")
    call check(change%new_differential == 1 .or. change%new_differential == -1, "new values")
    call solver%destroy()
  end subroutine locates_changes

  !> make_consistent needs no start, and leaves the point reached alone.
  subroutine makes_values_consistent()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3), y(3), ydot(3)

    call solver%create(problem, status)
    y = [1, 2, 3]
    call solver%make_consistent(0.5_dp, y, status, ydot)
    call check_status(status, sfdae_values_changed, "make_consistent")
    call check_close(y, [1.0_dp, sin(0.5_dp), cos(0.5_dp)], 1.0e-13_dp, 1.0e-13_dp, "values")
    call check_close(ydot, [y(3) - y(1), cos(0.5_dp), -sin(0.5_dp)], 1.0e-12_dp, 1.0e-12_dp, &
      "derivatives")
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call solver%make_consistent(1.5_dp, y, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_close(x, problem%exact(2.0_dp, 0.0_dp), 1.0e-6_dp, 1.0e-6_dp, "x goes on")
    call solver%destroy()
  end subroutine makes_values_consistent

  !> M = [E 0; E' - A E], N = [A; A'], g = [f; f'].
  subroutine exports_derivative_array()
    type(gear_petzold_dae), target :: problem = &
      gear_petzold_dae(num_equations=2, num_unknowns=2, eta=0.5_dp)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp), parameter :: t = 2.0_dp, eta = 0.5_dp, o = 0.0_dp, l = 1.0_dp
    real(dp), allocatable :: m(:, :), n(:, :), g(:)
    real(dp) :: e(2, 2), a(2, 2), de(2, 2), da(2, 2), expected(4, 4)

    e = reshape([o, l, o, eta * t], [2, 2])
    de = reshape([o, o, o, eta], [2, 2])
    a = reshape([-l, o, -eta * t, -l - eta], [2, 2])
    da = reshape([o, o, -eta, o], [2, 2])
    expected = 0
    expected(1:2, 1:2) = e
    expected(3:4, 1:2) = de - a
    expected(3:4, 3:4) = e
    call solver%create(problem, status)
    call solver%get_derivative_array(t, -1_c_int, status, m)
    call check_status(status, sfdae_illegal_argument, "level -1")
    call check(.not. allocated(m), "array of a failed call")
    call solver%get_derivative_array(t, 1_c_int, status, m, n, g)
    call check_status(status, sfdae_ok, "get_derivative_array")
    call check(all(shape(m) == [4, 4]) .and. all(shape(n) == [4, 2]) .and. size(g) == 4, "shapes")
    call check(all(within(m, expected, l)), "M")
    call check(all(within(n(1:2, :), a, l)) .and. all(within(n(3:4, :), da, l)), "N")
    call check(all(within(g, [exp(-t), o, -exp(-t), o], l)), "g")
    call solver%get_derivative_array(t, 0_c_int, status, g=g)
    call check(status == sfdae_ok .and. size(g) == 2, "g alone, of another level")
    call solver%destroy()
  end subroutine exports_derivative_array

  !> The properties that define Z1, Z2, Z3, T2, with the exported array.
  subroutine exports_projectors()
    type(reaction_dae), target :: problem = reaction_dae(num_equations=3, num_unknowns=2)
    type(sfdae_characteristics) :: c
    type(dae_solver) :: solver
    integer(c_int) :: status
    integer :: k
    real(dp), allocatable :: m(:, :), n(:, :), z1(:, :), z2(:, :), z3(:, :), t2(:, :), a2(:, :)

    call solver%create(problem, status)
    call solver%get_projectors(0.5_dp, status, z1)
    call check_status(status, sfdae_not_started, "get_projectors before an analysis")
    call solver%analyze(0.0_dp, 1.0_dp, status, c)
    call solver%get_projectors(0.5_dp, status, z1, z2, z3, t2)
    call check_status(status, sfdae_ok, "get_projectors")
    call solver%get_derivative_array(0.5_dp, c%strangeness_index, status, m, n)
    k = (c%strangeness_index + 1) * 3
    call check(all(shape(z1) == [3_c_int, c%differential]), "shape of Z1")
    call check(all(shape(z2) == [k, int(c%algebraic)]), "shape of Z2")
    call check(size(z3, 1) == k .and. size(z3, 2) >= c%redundant, "shape of Z3")
    call check(all(shape(t2) == [2_c_int, 2_c_int - c%algebraic]), "shape of T2")
    call check(is_orthonormal(z1) .and. is_orthonormal(z2), "Z1 and Z2 are orthonormal")
    call check(is_orthonormal(z3) .and. is_orthonormal(t2), "Z3 and T2 are orthonormal")
    call check(is_zero(matmul(transpose(z2), m)), "Z2^T M = 0")
    call check(is_zero(matmul(transpose(z3), m)), "Z3^T M = 0")
    call check(is_zero(matmul(transpose(z3), n)), "Z3^T N = 0")
    a2 = matmul(transpose(z2), n)
    call check(norm2(a2) > 0.1_dp, "A2 = Z2^T N has rank a")
    call check(is_zero(matmul(a2, t2)), "A2 T2 = 0")
    call solver%destroy()
  end subroutine exports_projectors

  !> d = 0, vhat = 0: arrays without columns.
  subroutine exports_projectors_without_columns()
    type(gear_petzold_dae), target :: problem = gear_petzold_dae(num_equations=2, num_unknowns=2)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp), allocatable :: z1(:, :), t2(:, :), e1(:, :), f1(:), a2(:, :), f2(:)
    real(dp) :: residual

    residual = 7
    call solver%create(problem, status)
    call solver%analyze(0.0_dp, 1.0_dp, status)
    call solver%get_projectors(0.5_dp, status, z1=z1, t2=t2)
    call check_status(status, sfdae_ok, "get_projectors, d = 0")
    call check(all(shape(z1) == [2, 0]) .and. all(shape(t2) == [2, 0]), "no columns")
    call solver%get_strangeness_free(0.5_dp, status, e1=e1, f1=f1, a2=a2, f2=f2, &
      residual=residual)
    call check_status(status, sfdae_ok, "get_strangeness_free, d = 0")
    call check(all(shape(e1) == [0, 2]) .and. size(f1) == 0, "no rows")
    call check(is_zero(reshape(matmul(a2, [1.5_dp, 1.0_dp] * exp(-0.5_dp)) + f2, [2, 1])), &
      "the solution fulfils A2 x + f2 = 0")
    call check(abs(residual) <= 1.0e-13_dp, "no contradiction")
    call solver%destroy()
  end subroutine exports_projectors_without_columns

  !> The solution fulfils E1 x' = A1 x + f1, 0 = A2 x + f2.
  subroutine exports_strangeness_free_system()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp), allocatable :: e1(:, :), a1(:, :), f1(:), a2(:, :), f2(:), z1(:, :)
    real(dp) :: x(3), xdot(3), residual
    real(dp), parameter :: t = 0.5_dp

    call solver%create(problem, status)
    call solver%get_strangeness_free(t, status, e1)
    call check_status(status, sfdae_not_started, "get_strangeness_free before an analysis")
    call check(.not. allocated(e1), "arrays of a failed call")
    call solver%analyze(0.0_dp, 1.0_dp, status)
    call solver%get_strangeness_free(t, status, e1, a1, f1, a2, f2, residual)
    call check_status(status, sfdae_ok, "get_strangeness_free")
    call check(all(shape(e1) == [1, 3]) .and. all(shape(a2) == [2, 3]), "shapes")
    x = problem%exact(t, 1.0_dp)
    xdot = [x(3) - x(1), cos(t), -sin(t)]
    call check(is_zero(reshape(matmul(e1, xdot) - matmul(a1, x) - f1, [1, 1])), "E1 x' = A1 x + f1")
    call check(is_zero(reshape(matmul(a2, x) + f2, [1, 2])), "0 = A2 x + f2")
    call solver%get_projectors(t, status, z1=z1)
    call check(is_zero(matmul(transpose(z1), reshape(real([1, 0, 0, 0, 1, 0, 0, 0, 0], dp), &
      [3, 3])) - e1), "E1 = Z1^T E")
    call solver%destroy()
  end subroutine exports_strangeness_free_system

  !> A mistake in A' is found, with its row and column.
  subroutine checks_derivatives()
    type(gear_petzold_dae), target :: problem = &
      gear_petzold_dae(num_equations=2, num_unknowns=2, eta=0.5_dp)
    type(sfdae_derivative_check) :: worst
    type(dae_solver) :: solver
    integer(c_int) :: status

    call solver%create(problem, status)
    call solver%check_derivatives(1.0_dp, 2_c_int, worst, status)
    call check_status(status, sfdae_ok, "check_derivatives")
    call check(worst%suspicious == 0, "derivatives are right")
    problem%mistake = 0.25_dp
    call solver%check_derivatives(1.0_dp, 2_c_int, worst, status)
    call check(worst%suspicious == 1 .and. worst%function == "A", "a mistake is found")
    call check(worst%row == 1 .and. worst%column == 2 .and. worst%order == 1, "where it is")
    call check_close([worst%supplied, worst%difference], [-0.25_dp, -0.5_dp], 1.0e-6_dp, &
      1.0e-6_dp, "what it is")
    call solver%check_derivatives(1.0_dp, 0_c_int, worst, status)
    call check_status(status, sfdae_illegal_argument, "max_order = 0")
    call check(worst%row == 1 .and. worst%column == 2, "result of a failed check")
    call solver%destroy()
  end subroutine checks_derivatives

  !> The report is a Fortran string of the right length.
  subroutine writes_report()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    character(len=:), allocatable :: text
    real(dp) :: t, x(3), distance

    call solver%create(problem, status)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call solver%report(text, status)
    call check_status(status, sfdae_ok, "report")
    call check(len(text) > 200 .and. index(text, achar(0)) == 0, "length of the report")
    call check(index(text, new_line('a')) > 0, "lines of the report")
    call check(index(text, "strangeness index 1") > 0, "strangeness index in the report")
    call solver%certify(distance, status)
    call check_status(status, sfdae_ok, "certify")
    call check(distance > 1.0e-3_dp .and. distance <= 1.0_dp, "distance of a tame problem")
    call solver%report(text, status)
    call check(index(text, "gives another answer") > 0, "distance in the report")
    call solver%destroy()
  end subroutine writes_report

  !> Whether Z^T Z = I, to rounding.
  function is_orthonormal(z) result(orthonormal)
    real(dp), intent(in) :: z(:, :)
    logical :: orthonormal
    real(dp) :: product(size(z, 2), size(z, 2))
    integer :: i

    product = matmul(transpose(z), z)
    do i = 1, size(z, 2)
      product(i, i) = product(i, i) - 1
    end do
    orthonormal = is_zero(product)
  end function is_orthonormal

  !> Whether a matrix vanishes, compared with data of size 1.
  function is_zero(matrix) result(zero)
    real(dp), intent(in) :: matrix(:, :)
    logical :: zero

    zero = all(within(matrix, 0.0_dp, 1.0_dp))
  end function is_zero

end program inspection_test
