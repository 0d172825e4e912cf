#!/usr/bin/env python3
"""200 fixed small changes of the library, to judge what tests notice: changed signs, comparisons and limits, dropped
statements, spread over all folders of src/.

  mutants.py list TREE           says of each mutant whether its text is in exactly one place of TREE/src
  mutants.py apply K TREE COPY   copies TREE to COPY, without build/ and .git/, and applies mutant K there; COPY may
                                 exist, then src/ alone is copied anew, so that little is compiled again

A mutant is a text of one line and what replaces it ("" drops the statement). It has no file name: it survives when
files are renamed, and is gone when its line changes. Exit code of apply: 0 applied, 1 the text is not there or not
in one place only, 2 wrong use.
"""
import pathlib
import shutil
import sys

MUTANTS = [
    # array
    ("if (has_failed_ || kept > dip_ * level) return std::nullopt;",
     "if (has_failed_ || kept > dip_ / level) return std::nullopt;"),
    ("largest_column = std::max(largest_column, column);", "largest_column = std::min(largest_column, column);"),
    ("constexpr double fallen = 0.3;", "constexpr double fallen = 0.0375;"),
    ("stages_.predict(equations, history_, linearization_.determined());", ""),
    ("if (!(max_abs(form_.xp(), problem_.n()) <= largest_correction * size)) return false;",
     "if (!(max_abs(form_.xp(), problem_.n()) <= largest_correction / size)) return false;"),
    ("if (has_within_ || has_end_) {", "if (has_within_ && has_end_) {"),
    ("constexpr int fewest_stages = 3;", "constexpr int fewest_stages = 1;"),
    ("norm = std::max(norm, above_noise(dx[i], noise[index(i)]));", ""),
    ("allowed += std::fabs(data_.A(0)(i, j)) * change / problem_.units()[j];",
     "allowed += std::fabs(data_.A(0)(i, j)) * change * problem_.units()[j];"),
    ("largest_residual = std::max(largest_residual, residual);",
     "largest_residual = std::min(largest_residual, residual);"),
    ("constexpr int few_constraints = 4;", "constexpr int few_constraints = 1;"),
    ("quality_.kept_constraints = judge.kept_constraints();", ""),
    ("const double t = 0.5 * (left + right);", "const double t = 0.5 * (left - right);"),
    ("if (kept.differential > less * kept.constraints) return SingularPart::constraints;",
     "if (kept.differential < less * kept.constraints) return SingularPart::constraints;"),
    # c_api
    ("difference = std::max(difference, std::fabs(above[i] + below[i] - 2.0 * here[i]) / sizes[i]);",
     "difference = std::max(difference, std::fabs(above[i] + below[i] - 2.0 * here[i]) * sizes[i]);"),
    ("if (options.method < SFDAE_METHOD_BDF || options.method > SFDAE_METHOD_AUTOMATIC)",
     "if (options.method < SFDAE_METHOD_BDF && options.method > SFDAE_METHOD_AUTOMATIC)"),
    ("constexpr double noise = 3e-15;", "constexpr double noise = 3e-14;"),
    ("found.freedom = structure.offsets.freedom();", ""),
    ("else if (given.kind == SFDAE_TRANSITION_CONDITION) g[i] -= transition.margin;",
     "else if (given.kind == SFDAE_TRANSITION_CONDITION) g[i] += transition.margin;"),
    ("return status < 0 ? of_mode(hybrid, hybrid.run.mode, status) : CallResult{};",
     "return status > 0 ? of_mode(hybrid, hybrid.run.mode, status) : CallResult{};"),
    ("constexpr int most_events = 10000;", "constexpr int most_events = 3333;"),
    ("parameters[index(j)] = *found;", ""),
    ("sum.linearizations += calls.linearizations;", "sum.linearizations -= calls.linearizations;"),
    ("if (checks && may_be_of_derivatives(failure.status()))",
     "if (checks || may_be_of_derivatives(failure.status()))"),
    ("constexpr double free_weight = 1e8;", "constexpr double free_weight = 1000000000.0;"),
    ("model_.evaluator()->set_parameter(number_, value);", ""),
    ("const double tolerance = tolerances.rtol[i] * std::fabs(run.x[i]) + tolerances.atol[i];",
     "const double tolerance = tolerances.rtol[i] / std::fabs(run.x[i]) + tolerances.atol[i];"),
    ("if (rtol == 0.0 && atol == 0.0)", "if (rtol == 0.0 || atol == 0.0)"),
    ("constexpr int most_threads = 1024;", "constexpr int most_threads = 341;"),
    ("sum.check_calls += calls.check_calls;", ""),
    ("const double fastest = std::max(std::fabs(dt) / time_, speed(dx, sizes_));",
     "const double fastest = std::max(std::fabs(dt) * time_, speed(dx, sizes_));"),
    # expression
    ("case Operation::divide: return {(y / b).node, (-(y * v) / b).node, -1};",
     "case Operation::divide: return {(y / b).node, (-(y / v) / b).node, -1};"),
    ("return largest > 0.0 ? largest : size_of_times_;", "return largest < 0.0 ? largest : size_of_times_;"),
    ("constexpr std::size_t longest = 80;", "constexpr std::size_t longest = 26;"),
    ("q_of_[index(i)] = instruction.q;", ""),
    ("case Operation::log10: return {(y / (v.number(std::log(10.0)) * a)).node, -1, -1};",
     "case Operation::log10: return {(y * (v.number(std::log(10.0)) * a)).node, -1, -1};"),
    ("if (first == last) continue;", "if (first != last) continue;"),
    ("constexpr double largest_argument = 709.0;", "constexpr double largest_argument = 88.625;"),
    ("for_each_result(all[k], [&](int slot) { order = std::max(order, order_of[index(slot)]); });", ""),
    ("if (has_exact_inverse(*divisor)) return multiply(a, constant(1.0 / *divisor));",
     "if (has_exact_inverse(*divisor)) return multiply(a, constant(1.0 * *divisor));"),
    ("if (node.operation == Operation::cos || node.operation == Operation::cosh) {",
     "if (node.operation == Operation::cos && node.operation == Operation::cosh) {"),
    ("static constexpr std::size_t max_derivatives = 4096;", "static constexpr std::size_t max_derivatives = 1365;"),
    ("has_jump[k] = std::fabs(after - before) > few * (std::fabs(after) + std::fabs(before)) ? 1 : 0;", ""),
    ("const double offset = argument.offset, slope = argument.slope, now = offset + slope * search_for.t;",
     "const double offset = argument.offset, slope = argument.slope, now = offset + slope / search_for.t;"),
    ("run(t, order, orders.of_gradients() >= 0);", "run(t, order, orders.of_gradients() < 0);"),
    ("constexpr double same_end = 0.25;", "constexpr double same_end = 0.03125;"),
    # extension
    ("constexpr double shortest = 1.0 / 1024.0;", "constexpr double shortest = 1.0 * 1024.0;"),
    ("(certificates == Certificates::not_kept || !certificate_.blocks.empty());",
     "(certificates == Certificates::not_kept && !certificate_.blocks.empty());"),
    ("constexpr int most_stage_iterations = 50;", "constexpr int most_stage_iterations = 16;"),
    ("stage_rows.columns = extension_.first_column(stage + 1) - first_column;", ""),
    ("return weight_of_free / (size * size);", "return weight_of_free * (size * size);"),
    ("const bool is_slope = order == 1 && choice_.is_state(j);",
     "const bool is_slope = order != 1 && choice_.is_state(j);"),
    ("constexpr double weight_of_free = 1e-10;", "constexpr double weight_of_free = 1e-09;"),
    ("noise[index(column)] = std::fabs(jet.column(order)[unknown]);", ""),
    ("const double ratio = least_weight_ / request_.weights[j];",
     "const double ratio = least_weight_ * request_.weights[j];"),
    ("return size() <= most_by_loops ? small::factor_lu(M, pivots_.data()) : factor_lu(M, pivots_.data());",
     "return size() > most_by_loops ? small::factor_lu(M, pivots_.data()) : factor_lu(M, pivots_.data());"),
    ("constexpr double uncertain = 0.02;", "constexpr double uncertain = 0.2;"),
    ("change = std::max(change, size / std::fabs(part.factor));", ""),
    ("if (!(derivative < beyond_rounding * size)) return true;",
     "if (!(derivative < beyond_rounding / size)) return true;"),
    ("double above_noise(double change, double noise) { return std::max(0.0, std::fabs(change) - noise); }",
     "double above_noise(double change, double noise) { return std::min(0.0, std::fabs(change) - noise); }"),
    ("constexpr int points_between_renewals = 4;", "constexpr int points_between_renewals = 1;"),
    # integrate
    ("if (kink && std::fabs(step.tout - *kink) <= Integrator::resolution(step.t, step.tout)) return step.tout;",
     "if (kink && std::fabs(step.tout + *kink) <= Integrator::resolution(step.t, step.tout)) return step.tout;"),
    ("if (++points_since_ < most_points_in_excess || excess_at_start(weights)) return;",
     "if (++points_since_ > most_points_in_excess || excess_at_start(weights)) return;"),
    ("constexpr double nonlinear_safety = 0.2;", "constexpr double nonlinear_safety = 0.025;"),
    ("system.restore(nullptr, x_last.data(), x);", ""),
    ("return safety_ * (tightening_ == Tightening::none ? 1.0 : std::min(1.0, 4.0 * std::pow(tol, 1.0 / 6.0)));",
     "return safety_ * (tightening_ == Tightening::none ? 1.0 : std::min(1.0, 4.0 * std::pow(tol, 1.0 * 6.0)));"),
    ("if (history_.is_at_start() && last_.order == 0) history_.place_fictitious_point(next_step_);",
     "if (history_.is_at_start() && last_.order != 0) history_.place_fictitious_point(next_step_);"),
    ("constexpr double first_bdf_step_fraction = 0.7390851e-3;",
     "constexpr double first_bdf_step_fraction = 0.007390851;"),
    ("archive.reals(before_, size());", ""),
    ("const Complex shift = lambda * (1.0 + 1e-10);", "const Complex shift = lambda * (1.0 - 1e-10);"),
    ("int sign = direction_ < 0.0 ? 1 : 0;", "int sign = direction_ > 0.0 ? 1 : 0;"),
    ("constexpr double remembered = 0.5;", "constexpr double remembered = 0.0625;"),
    ("terms.decay[index(k)] = norm(weights);", ""),
    ("const bool is_new_step = std::fabs(state.t - from) >= whole_step * std::fabs(state.last.h);",
     "const bool is_new_step = std::fabs(state.t - from) >= whole_step / std::fabs(state.last.h);"),
    ("const bool is_slope = i % 2 == 1;", "const bool is_slope = i % 2 != 1;"),
    ("constexpr double large = 1e3;", "constexpr double large = 125.0;"),
    ("high = std::max(high, value);", ""),
    ("const double factor = 2.0 / degree * halves * cosine;",
     "const double factor = 2.0 * degree * halves * cosine;"),
    ("length_of_pieces_(max_kept_steps == 0 ? 0 : static_cast<std::size_t>(std::max(max_kept_steps / 3, 1L))),",
     "length_of_pieces_(max_kept_steps == 0 ? 0 : static_cast<std::size_t>(std::min(max_kept_steps / 3, 1L))),"),
    # linalg
    ("y[k] = sum * factors[list_.pivot[k]];", "y[k] = sum / factors[list_.pivot[k]];"),
    ("if (last.reflections_of_q == count && has_size_of(last.q, q)) return copy(last.q, q);",
     "if (last.reflections_of_q != count && has_size_of(last.q, q)) return copy(last.q, q);"),
    ("inline constexpr int lane_count = 8;", "inline constexpr int lane_count = 2;"),
    ("multiply(1.0, Op::transposed, weights_, d.data(), 1.0, of_.columns(q));", ""),
    ("sum -= factors[next->slot] * y[next->place];", "sum -= factors[next->slot] / y[next->place];"),
    ("const bool is_pair = known[k].value.imag() != 0.0;", "const bool is_pair = known[k].value.imag() == 0.0;"),
    ("constexpr double nearly_real = 1e-6;", "constexpr double nearly_real = 1e-05;"),
    ("multiply(factor, Op::transposed, entries, ones_.data(), 1.0, of_.columns(to));", ""),
    ("return {n * (50.0 + 0.3 * n) + 0.033 * (2.0 / 3.0) * n * n * n, n * (10.0 + 0.3 * n)};",
     "return {n * (50.0 + 0.3 * n) + 0.033 * (2.0 * 3.0) * n * n * n, n * (10.0 + 0.3 * n)};"),
    ("static bool has_carry(Carries carries) { return carries >> 63 != 0; }",
     "static bool has_carry(Carries carries) { return carries >> 63 == 0; }"),
    ("constexpr double blinding = 1e-2;", "constexpr double blinding = 0.00125;"),
    ("order.lower = order.upper = 0;", ""),
    ("const double n = static_cast<double>(order.row_place.size()), entries = 2.0 * order.lower + order.upper;",
     "const double n = static_cast<double>(order.row_place.size()), entries = 2.0 / order.lower + order.upper;"),
    ("if (forced ? forced == SparseMethod::klu : klu_is_available()) {",
     "if (forced ? forced != SparseMethod::klu : klu_is_available()) {"),
    ("constexpr int exponent_of_zero = -100000;", "constexpr int exponent_of_zero = -12500.0;"),
    ("numeric = static_cast<klu_numeric*>(klu_malloc(1, sizeof(klu_numeric), &common));", ""),
    ("work.sums[list.row_step[e] * width + c] += size;", "work.sums[list.row_step[e] * width + c] -= size;"),
    # linear
    ("const double noise = std::max(point.data.noise(mu), point.data.noise_f(mu)) / point.pivot;",
     "const double noise = std::max(point.data.noise(mu), point.data.noise_f(mu)) * point.pivot;"),
    ("if (order == 0) std::copy_n(from.data(), index(from.rows()) * index(from.cols()), to);",
     "if (order != 0) std::copy_n(from.data(), index(from.rows()) * index(from.cols()), to);"),
    ("constexpr double difference_reduction = 8.0;", "constexpr double difference_reduction = 80.0;"),
    ("point.form.replace_rhs(point.data, f_hat, {&problem_.prescribed(), prescribed_values_.data()}, arena_);", ""),
    ("const double weight = factor * method.D_at(i, j);", "const double weight = factor / method.D_at(i, j);"),
    ("if (probe.has_failed() || (change && change->new_values == known)) return std::nullopt;",
     "if (probe.has_failed() && (change && change->new_values == known)) return std::nullopt;"),
    ("constexpr double dip_within_step = 1e-3;", "constexpr double dip_within_step = 0.000125;"),
    ("differences.span = std::fabs(point.toward - point.t);", ""),
    ("const double flipped = (-next.value - last.value) / (next.t - last.t);",
     "const double flipped = (-next.value - last.value) * (next.t - last.t);"),
    ("const double kept = std::min(k1, k2);", "const double kept = std::max(k1, k2);"),
    # multibody
    ("return {point.t + nearest.tau, nearest.row, at_positions <= limit, at_velocities <= limit};",
     "return {point.t - nearest.tau, nearest.row, at_positions <= limit, at_velocities <= limit};"),
    ("if (status == PointStatus::ok) status = linearization_.build(equations_, arena_);",
     "if (status != PointStatus::ok) status = linearization_.build(equations_, arena_);"),
    ("constexpr double tolerances = 1e5;", "constexpr double tolerances = 1000000.0;"),
    ("status = equations.accelerations(point, form.velocities(), tangents_.of_velocities(), arena);", ""),
    ("whole = 2.0 / 3.0 * std::pow(nv + r, 3);", "whole = 2.0 * 3.0 * std::pow(nv + r, 3);"),
    (".has_room_for_whole = n + r <= largest_whole,", ".has_room_for_whole = n + r > largest_whole,"),
    ("constexpr double least_rate = 0.03;", "constexpr double least_rate = 0.3;"),
    ("functions_.constraints({t, q, nullptr}, g, error);", ""),
    ("constexpr double spacing = 1e-5, rough_spacing = 1.0 / 64.0;",
     "constexpr double spacing = 1e-5, rough_spacing = 1.0 * 64.0;"),
    ("if ((constraints_->record().dependence(node) & on_time) != 0) rheonomic_ = true;",
     "if ((constraints_->record().dependence(node) & on_time) == 0) rheonomic_ = true;"),
    ("constexpr double largest_move = 1e-13;", "constexpr double largest_move = 1e-12;"),
    ("end_.take_least_norm(partition(), arena_);", ""),
    ("const double limit = together * std::fabs(nearest.tau);",
     "const double limit = together / std::fabs(nearest.tau);"),
    ("if (error.code != 0) describe_code(name, error);", "if (error.code == 0) describe_code(name, error);"),
    ("constexpr double steps = 3.0;", "constexpr double steps = 0.375;"),
    ("copy_rows(-1.0, point_.terms.C, velocities.rows, of_v.block(rq, 0, rv, nv));", ""),
    ("K[work.terms.M.places[e].row * order + work.terms.M.places[e].column] = M[e];",
     "K[work.terms.M.places[e].row / order + work.terms.M.places[e].column] = M[e];"),
    ("const double rate = iteration > 0 ? norm / std::max(before, negligible) : 1.0;",
     "const double rate = iteration < 0 ? norm / std::max(before, negligible) : 1.0;"),
    # problem
    ("if (worst == nullptr || order < worst->entry / problem_.m() + 1) worst = &c;",
     "if (worst == nullptr || order < worst->entry / problem_.m() - 1) worst = &c;"),
    ("if (error.status == SFDAE_ORDER_MISSING) return false;",
     "if (error.status != SFDAE_ORDER_MISSING) return false;"),
    ("constexpr int spacings = 20;", "constexpr int spacings = 6;"),
    ("differences.apply(k, interval.half_width, samples.data(), count, derivative.data(), error.data());", ""),
    ("return *largest / *smallest;", "return *largest * *smallest;"),
    ("if (wrong && (!lowest || wrong->order < lowest->order)) lowest = wrong;",
     "if (wrong && (!lowest && wrong->order < lowest->order)) lowest = wrong;"),
    ("constexpr int gradients_between_probes = 10;", "constexpr int gradients_between_probes = 3;"),
    ("shares_one = shares_one || (factors.is_same(j) && recorder.number(factors.below[index(j)]) != 0.0);", ""),
    ("w(k, j) = ((x(i) - at) * w(k, j) - (k > 0 ? k * w(k - 1, j) : 0.0)) / gap;",
     "w(k, j) = ((x(i) - at) * w(k, j) - (k > 0 ? k * w(k - 1, j) : 0.0)) * gap;"),
    ("if (order > 0) compare_F(order);", "if (order < 0) compare_F(order);"),
    ("constexpr double roundings = 16.0;", "constexpr double roundings = 2.0;"),
    ("x[place] = before + side * part * levels_[level].sizes.size(j);", ""),
    ("return std::clamp((t - middle) / half_width, -1.0, 1.0);",
     "return std::clamp((t - middle) * half_width, -1.0, 1.0);"),
    ("if (spread > std::max(visible * size, noise)) return Evidence::unseen;",
     "if (spread < std::max(visible * size, noise)) return Evidence::unseen;"),
    # reduction
    ("const double part = 1.0 / j;", "const double part = 1.0 * j;"),
    ("if (factors()(i, i) < 0.0) sign = -sign;", "if (factors()(i, i) > 0.0) sign = -sign;"),
    ("constexpr double certain_roundings = 100.0;", "constexpr double certain_roundings = 1000.0;"),
    ("diagonal.null_rows = factors.rows - rank;", ""),
    ("constexpr double confirming_margin = clear_gap / perturbation_roundings;",
     "constexpr double confirming_margin = clear_gap * perturbation_roundings;"),
    ("if (is_differential[index(i)] == 0 && std::fabs(A(i, j)) > threshold)",
     "if (is_differential[index(i)] == 0 && std::fabs(A(i, j)) < threshold)"),
    ("inline constexpr double clear_significance = 30.0;", "inline constexpr double clear_significance = 300.0;"),
    ("result.significance.join(result.last.significance);", ""),
    ("const double difference = time - of_row + of_column;", "const double difference = time - of_row - of_column;"),
    ("weakest = std::min(weakest, other.weakest);", "weakest = std::max(weakest, other.weakest);"),
    ("constexpr double alike_bits = 6.0;", "constexpr double alike_bits = 60.0;"),
    ("norm = std::max(norm, sizes_.norm_E0);", ""),
    ("return norm > 0.0 ? data_.norm_f(level) / norm : 0.0;",
     "return norm > 0.0 ? data_.norm_f(level) * norm : 0.0;"),
    ("const bool is_visible = found.significance.is_plausible() || smallest_gap(decisions) >= gap_by_far;",
     "const bool is_visible = found.significance.is_plausible() && smallest_gap(decisions) >= gap_by_far;"),
    ("constexpr double rounding_significance = 2e-3;", "constexpr double rounding_significance = 0.02;"),
    # sensitivity
    ("right[entry.row] -= of_entries[entry.entry] * rest[entry.state];",
     "right[entry.row] -= of_entries[entry.entry] / rest[entry.state];"),
    ("rate_before = iteration > 0 ? rate : has_hidden ? 1.0 : 0.0;",
     "rate_before = iteration < 0 ? rate : has_hidden ? 1.0 : 0.0;"),
    ("constexpr int most_states_of_stages = 120;", "constexpr int most_states_of_stages = 40;"),
    ("size *= entry.of_slope ? work.units[entry.column] : work.units[entry.column] * work.unit_of_A;", ""),
    ("fits_ = values.mu == 0 && problem_.m() == n && values.d + values.a == n && analysis.v_hat == 0 &&",
     "fits_ = values.mu == 0 && problem_.m() == n && values.d - values.a == n && analysis.v_hat == 0 &&"),
    ("const bool has_all = std::find(d.begin(), d.end(), 0) == d.end();",
     "const bool has_all = std::find(d.begin(), d.end(), 0) != d.end();"),
    ("constexpr int most_iterated = 2;", "constexpr int most_iterated = 9;"),
    ("callback_error_ = parameters_.evaluate(next_data_, jet->x.data(), level, next_f_);", ""),
    ("if (xdot != nullptr) point.xdot.assign(xdot, xdot + jet.n);",
     "if (xdot != nullptr) point.xdot.assign(xdot, xdot - jet.n);"),
    ("if (rows.size() < index(count)) rows.resize(index(count));",
     "if (rows.size() > index(count)) rows.resize(index(count));"),
    ("constexpr double least_part = 1e-8;", "constexpr double least_part = 1.25e-09;"),
    ("stage_lanes_.keep(i, jet, xdot);", ""),
    # starts
    ("jet.column(0)[i] -= (1.0 - part) * unit * at.theta(i, 0);",
     "jet.column(0)[i] += (1.0 - part) * unit * at.theta(i, 0);"),
    ("while (result.rank < std::min(count, k) && std::fabs(result.R(result.rank, result.rank)) > measure.noise)",
     "while (result.rank < std::max(count, k) && std::fabs(result.R(result.rank, result.rank)) > measure.noise)"),
    ("constexpr double least_damping = 1e-14;", "constexpr double least_damping = 1.25e-15;"),
    ("result.R = transpose_product(Q, kernel.basis);", ""),
    ("jet.column(k)[i] += scale * std::sin(1.0 + 2.3 * i + 5.1 * k + 7.7 * part);",
     "jet.column(k)[i] -= scale * std::sin(1.0 + 2.3 * i + 5.1 * k + 7.7 * part);"),
    ("if (is_good(best) && (!keep || best.moved <= 1.0)) return best;",
     "if (is_good(best) || (!keep || best.moved <= 1.0)) return best;"),
    ("constexpr double largest_named = 1e6;", "constexpr double largest_named = 125000.0;"),
    ("largest[row] = std::max(largest[row], entry);", ""),
    ("if (equations_.norm() <= good_reduction * before) return true;",
     "if (equations_.norm() <= good_reduction / before) return true;"),
    ("if (sum > 0.0) worst = std::max(worst, std::fabs(left(i, j) + by_time + by_parameter) / scale);",
     "if (sum > 0.0) worst = std::min(worst, std::fabs(left(i, j) + by_time + by_parameter) / scale);"),
    # structure
    ("sample.jet[k] = (k < n ? x : 0.0) + near * size * symmetric_random(generator);",
     "sample.jet[k] = (k < n ? x : 0.0) - near * size * symmetric_random(generator);"),
    ("bool is_tight(int i, const Entry& entry) const { return reduced_cost(i, entry) == 0; }",
     "bool is_tight(int i, const Entry& entry) const { return reduced_cost(i, entry) != 0; }"),
    ("constexpr double few_roundings = 8.0;", "constexpr double few_roundings = 1.0;"),
    ("done(std::span<const int>(first, open_.end()));", ""),
    ("jet[k] += side * size * (part < 0.0 ? part - 1.0 : part + 1.0) / 2.0;",
     "jet[k] -= side * size * (part < 0.0 ? part - 1.0 : part + 1.0) / 2.0;"),
    ("if (chosen < 0 || order < 0) return {-1, 0.0};", "if (chosen < 0 && order < 0) return {-1, 0.0};"),
    ("constexpr int first_order = 1;", "constexpr int first_order = 5;"),
    ("column_distance_[index(j)] = distance;", ""),
    ("decide_rank(R, size, size + 1, {.noise = unit_roundoff, .dimension = size, .rank_tol = rank_tol});",
     "decide_rank(R, size, size - 1, {.noise = unit_roundoff, .dimension = size, .rank_tol = rank_tol});"),
    # system
    ("const double gamma = (dot(*second, d) - ratio * along * aa) / rest;",
     "const double gamma = (dot(*second, d) - ratio * along * aa) * rest;"),
    ("const double ratio = tolerance > 0.0 ? std::fabs(change) / tolerance : 0.0;",
     "const double ratio = tolerance < 0.0 ? std::fabs(change) / tolerance : 0.0;"),
    ("inline constexpr double largest_deviation = 0.25;", "inline constexpr double largest_deviation = 0.03125;"),
    ("tolerance += std::fabs(entry) * tolerances[j];", ""),
    ("const double rest = bb - ratio * ratio * aa;", "const double rest = bb + ratio * ratio * aa;"),
    ("if (bound >= enough) return bound;", "if (bound < enough) return bound;"),
    ("constexpr double near = 1.5;", "constexpr double near = 0.1875;"),
    ("multiply(1.0, Op::transposed, then, Op::plain, now, 0.0, K);", ""),
    # watch
    ("bool ZeroBracket::is_resolved() const { return std::fabs(after_ - before_) <= resolution(); }",
     "bool ZeroBracket::is_resolved() const { return std::fabs(after_ + before_) <= resolution(); }"),
    ("if (now_[i] < lowest_[i].value) lowest_[i] = {now_[i], distance, t};",
     "if (now_[i] > lowest_[i].value) lowest_[i] = {now_[i], distance, t};"),
    ("constexpr double clearly_larger = 4.0;", "constexpr double clearly_larger = 0.5;"),
    ("middle.t = from_.t + 0.5 * (to.t - from_.t);", ""),
    ("if (!((interval.to - after - margin) * margin > 0.0)) return;",
     "if (!((interval.to - after - margin) / margin > 0.0)) return;"),
    ("if (nodes.size() < fewest_nodes) continue;", "if (nodes.size() > fewest_nodes) continue;"),
    ("constexpr double suspicious_part = 0.25;", "constexpr double suspicious_part = 0.03125;"),
    ("before_ = before, after_ = after;", ""),
]


def sources(tree):
    return sorted(path for path in (tree / "src").rglob("*") if path.suffix in (".cpp", ".h"))


def places(tree):
    """For each mutant the files that contain its text, one entry for every time."""
    texts = {path: path.read_text() for path in sources(tree)}
    return [[path for path, text in texts.items() for _ in range(text.count(search))] for search, _ in MUTANTS]


def kind(found):
    return "there" if len(found) == 1 else "gone" if not found else f"in {len(found)} places"


def list_mutants(tree):
    found = places(tree)
    for number, (search, replacement) in enumerate(MUTANTS):
        where = found[number][0].relative_to(tree) if len(found[number]) == 1 else "-"
        print(f"{number}\t{kind(found[number])}\t{where}\t{search}\t{replacement or '(dropped)'}")
    print(f"{sum(len(entry) == 1 for entry in found)} of {len(MUTANTS)} exist")
    return 0


def apply(number, tree, copy):
    if not 0 <= number < len(MUTANTS):
        print(f"there is no mutant {number}", file=sys.stderr)
        return 2
    found = places(tree)[number]
    if len(found) != 1:
        print(f"mutant {number} is {kind(found)}")
        return 1
    if copy.exists():
        copy_sources(tree, copy)
    else:
        shutil.copytree(tree, copy, symlinks=True, ignore=shutil.ignore_patterns("build", "build-*", ".git"))
    path = copy / found[0].relative_to(tree)
    search, replacement = MUTANTS[number]
    path.write_text(path.read_text().replace(search, replacement))
    print(f"mutant {number} applied to {found[0].relative_to(tree)}")
    return 0


def copy_sources(tree, copy):
    """Writes only what differs: times of other files stay."""
    for path in sources(tree):
        target = copy / path.relative_to(tree)
        if not target.exists() or target.read_bytes() != path.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(path.read_bytes())
    wanted = {path.relative_to(tree) for path in sources(tree)}
    for path in sources(copy):
        if path.relative_to(copy) not in wanted:
            path.unlink()


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "list":
        return list_mutants(pathlib.Path(arguments[1]))
    if len(arguments) == 4 and arguments[0] == "apply" and arguments[1].isdigit():
        return apply(int(arguments[1]), pathlib.Path(arguments[2]), pathlib.Path(arguments[3]))
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
