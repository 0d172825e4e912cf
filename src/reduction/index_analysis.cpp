// Strangeness index and characteristic values of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/index_analysis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "problem/failure.h"
#include "reduction/balanced_units.h"
#include "reduction/elimination.h"
#include "reduction/null_space_form.h"

namespace sfdae::core {

namespace {

// Amplitude of trial perturbations in units of the noise of the data.
constexpr double perturbation_roundings = 4.0;
// Kept values against their changes: to confirm a rank that the propagated noise allows, and to keep values that it does
// not allow, where errors of the callbacks of some ten roundings have to be reckoned with.
constexpr double confirming_margin = clear_gap / perturbation_roundings;
constexpr double keeping_margin = 1e4;
// Dropped values against their changes: rounding errors change by about their own size.
constexpr double moving_margin = 10.0;
// Ranks with smaller gaps must follow from those of the level below; wrong ranks that did not had gaps below 2e6.
constexpr double decisive_gap = 1e9;

// What perturbations need not confirm: decisions that the propagated noise makes clear, or none at all.
enum class Trust { clear_ones, none };

// What level l of the array says at one point.
struct LevelReading {
  PointRanks ranks;
  double time_scale = 1.0;
  bool clear = true;
  NoiseModel noise = NoiseModel::carried;  // others are confirmed by perturbations
  RankDecision doubtful;  // the first unclear decision
  RankDecision weakest;   // the one that stands out least
  bool follows = true;    // from the level below
};

// How far a value that is not zero stands, or would have stood, above those that are.
double clearness(const RankDecision& decision) {
  return decision.rank > 0 ? decision.gap : 1.0 / std::max(decision.noise, 1e-300);
}
bool is_weaker(const RankDecision& one, const RankDecision& other) { return clearness(one) < clearness(other); }

// A search up the levels at one point.
struct Search {
  CharacteristicValues values;
  LevelReading last;
  std::vector<CharacteristicValues> levels;  // for messages: what each level said, d that of rank(E T2)
};

class Searcher {
 public:
  Searcher(CoefficientSource& problem, double t, const AnalysisSettings& settings, Arena& arena,
           std::vector<RankDecision>* log)
      : problem_(problem),
        t_(t),
        settings_(settings),
        arena_(arena),
        log_(log),
        judging_{settings.rank_tol, settings.by_svd, NoiseModel::carried},
        rows_(settings.rows),
        differentiations_(problem.differentiations()) {}

  LevelReading read(int level, double time_scale) {
    evaluate(level, time_scale);
    return judge_level(level);
  }

  // A level whose decisions are clear, or confirmed by another reading.
  LevelReading read_confirmed(int level) {
    LevelReading reading = read(level, settings_.time_scale);
    std::vector<RankDecision> decisions = latest_;
    if (!reading.clear && data_.row_scale_ratio() <= moderate_row_ratio) {
      rows_ = RowScaling::common;
      const LevelReading unscaled = read(level, settings_.time_scale);
      if (unscaled.clear) {
        reading = unscaled;
        decisions = latest_;
      }
      rows_ = settings_.rows;
    }
    if (!reading.clear) measure(level, reading, decisions);
    if (log_ != nullptr) log_->insert(log_->end(), decisions.begin(), decisions.end());
    return reading;
  }

  // Values at a level known to be mu; v^ of the level below is found on the way.
  CharacteristicValues values_at(int level) {
    const int below = level > 0 ? read_confirmed(level - 1).ranks.v_hat : 0;
    return values_of(level, read_confirmed(level), below);
  }

  // Whether the ranks are those expected, and stay so under perturbations.
  bool has_ranks(int level, double time_scale, const PointRanks& expected) {
    judging_.noise = NoiseModel::data;
    judging_.by_singular_values = true;
    const LevelReading reading = read(level, time_scale);
    if (reading.ranks.a != expected.a || reading.ranks.d != expected.d || reading.ranks.v_hat != expected.v_hat)
      return false;
    std::vector<RankDecision> decisions = latest_;
    for (RankDecision& decision : decisions) decision.verdict = Verdict::unclear;  // have to be confirmed
    return survives_perturbations(level, reading.time_scale, decisions, confirming_margin, Trust::clear_ones);
  }

  Search search(int max_index) {
    Search result;
    int v_hat_below = 0;
    for (int level = 0; level <= std::min(max_index, highest_level()); ++level) {
      const RankDecision weakest_below = result.last.weakest;
      result.last = read_confirmed(level);
      if (!result.last.clear) return result;
      const CharacteristicValues values = values_of(level, result.last, v_hat_below);
      if (level > 0 && !follows(result.levels.back(), values, result.last.ranks)) {
        result.last.follows = false;
        result.last.doubtful = std::min(weakest_below, result.last.weakest, is_weaker);
        result.last.clear = settings_.rank_tol > 0.0 || clearness(result.last.doubtful) >= decisive_gap;
        if (!result.last.clear) return result;
      }
      result.levels.push_back(values);
      result.levels.back().d = result.last.ranks.d;
      if (values.mu >= 0 && holds_above(level, values, result.last.ranks)) {
        result.values = values;
        return result;
      }
      v_hat_below = result.last.ranks.v_hat;
    }
    return result;
  }

 private:
  // Whether level l + 1 has the same values. Where it is not available or unclear, nothing speaks against them.
  bool holds_above(int level, const CharacteristicValues& values, const PointRanks& ranks) {
    if (!problem_.checks_next_level() || level >= std::min(max_derivative_order, highest_level())) return true;
    try {
      const LevelReading above = read_confirmed(level + 1);
      if (leaves_out_rows()) return !above.clear || (above.ranks.a == values.a && above.ranks.d == values.d);
      return !above.clear || (above.ranks.a == values.a && above.ranks.d == values.d &&
                              above.ranks.v_hat == ranks.v_hat + values.v);
    } catch (const Failure& failure) {
      if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
      return true;
    }
  }

  // The propagated noise is an upper bound, at times by far: values between it and the rounding errors of the matrix
  // itself are undecided. Which of them are signals is measured by perturbing the data by a few roundings: first a
  // reading that keeps them all, then one that drops those below the noise of the smallest pivot, then one that drops
  // them all, then other time scales. What survives is confirmed.
  void measure(int level, LevelReading& reading, std::vector<RankDecision>& decisions) {
    struct Attempt {
      NoiseModel noise;
      double margin;
      Trust trust;
    };
    bool confirmed = false;
    const double tau = reading.time_scale;
    // Singular values throughout: pivots may change their order under perturbations.
    judging_.by_singular_values = true;
    for (const Attempt& attempt : {Attempt{NoiseModel::data, keeping_margin, Trust::none},
                                   Attempt{NoiseModel::pivots, confirming_margin, Trust::none},
                                   Attempt{NoiseModel::carried, confirming_margin, Trust::clear_ones}}) {
      judging_.noise = attempt.noise;
      LevelReading candidate = read(level, tau);
      candidate.noise = attempt.noise;
      const std::vector<RankDecision> made = latest_;
      if (attempt.noise == NoiseModel::pivots && !candidate.clear) continue;
      if (!survives_perturbations(level, tau, made, attempt.margin, attempt.trust)) continue;
      confirmed = true;
      reading = candidate;
      decisions = made;
      break;
    }
    judging_.noise = NoiseModel::carried;
    judging_.by_singular_values = settings_.by_svd;
    if (!confirmed && !agrees_with_other_time_scales(level, reading)) return;
    reading.clear = true;
    for (RankDecision& decision : decisions)
      if (decision.verdict == Verdict::unclear) decision.verdict = Verdict::confirmed;
  }

  bool agrees_with_other_time_scales(int level, const LevelReading& reading) {
    bool agrees = false;
    for (double factor : {1.0 / 8.0, 4.0}) {
      const LevelReading other = read(level, reading.time_scale * factor);
      if (!other.clear) continue;
      if (other.ranks.a != reading.ranks.a || other.ranks.d != reading.ranks.d ||
          other.ranks.v_hat != reading.ranks.v_hat)
        return false;
      agrees = true;
    }
    return agrees;
  }

  // Kept values must stay put to 1 / margin; dropped ones above the rounding errors of the matrix must not.
  bool survives_perturbations(int level, double time_scale, const std::vector<RankDecision>& decisions, double margin,
                              Trust trust) {
    std::minstd_rand generator(1);
    std::vector<char> moved(decisions.size(), 0);
    for (int trial = 0; trial < 3; ++trial) {
      evaluate(level, time_scale);
      perturb(level, generator);
      judge_level(level);
      for (std::size_t q = 0; q < decisions.size(); ++q) {
        if (q == latest_.size()) return false;
        const RankDecision& was = decisions[q];
        const RankDecision& is = latest_[q];
        // A dropped value that a perturbation lifts above the threshold is noise; what follows cannot be compared.
        const bool lifted = trust == Trust::clear_ones && is.rank == was.rank + 1;
        if (lifted && confirming_margin * (is.kept - was.dropped) > was.dropped) {
          moved[q] = 1;
          break;
        }
        if (is.rank != was.rank) return false;
        if (moving_margin * std::fabs(is.dropped - was.dropped) > was.dropped) moved[q] = 1;
        if (was.rank == 0 || (was.verdict != Verdict::unclear && trust == Trust::clear_ones)) continue;
        // What stands clear of the propagated noise may move a little.
        const bool stands_clear = trust == Trust::clear_ones && was.gap >= clear_gap;
        const double moves = stands_clear ? 0.0 : std::fabs(is.kept - was.kept);
        const double measured = std::max({moves, is.dropped, was.dropped});
        if (was.kept < margin * measured) return false;
      }
    }
    for (std::size_t q = 0; q < decisions.size(); ++q)
      if (decisions[q].dropped > 100.0 * problem_.n() * unit_roundoff && moved[q] == 0) return false;
    return true;
  }

  void perturb(int level, std::minstd_rand& generator) {
    const double amplitude = perturbation_roundings * data_.noise(level);
    const auto add_noise = [&](View block, double norm) {
      for (int j = 0; j < block.cols; ++j)
        for (int i = 0; i < block.rows; ++i)
          block(i, j) += amplitude * norm * (2e-9 * static_cast<double>(generator() % 1000000001u) - 1.0);
    };
    const double norm_E = data_.norm_E(level), norm_A = data_.norm_A(level);
    for (int k = 0; k <= level; ++k) {
      add_noise(data_.E(k), norm_E);
      add_noise(data_.A(k), norm_A);
    }
    data_.measure();
  }

  // Constraints and redundant equations only get more from level to level, and m - a - v is rank(E T2) of the level
  // before: what E T2 loses is what differentiation turns into constraints ([KM06], section 3.1: r_(i+1) = r_i - s_i).
  // Exceptional points may differ, but then all ranks are clear by far. Ranks given by rank_tol are the user's.
  bool follows(const CharacteristicValues& below, const CharacteristicValues& values, const PointRanks& ranks) const {
    if (leaves_out_rows()) return ranks.d <= below.d && values.a >= below.a;
    return ranks.d <= values.d && values.d == below.d && values.a >= below.a && values.v >= below.v;
  }

  bool leaves_out_rows() const { return !differentiations_.empty(); }
  // Higher ones have no more rows.
  int highest_level() const {
    if (!leaves_out_rows()) return max_derivative_order;
    return *std::max_element(differentiations_.begin(), differentiations_.end());
  }

  // Without all rows: each constraint that differentiation adds takes one from rank(E T2) at most, so that d + a
  // never becomes smaller. Once it is m, or d and a are those expected, all have been found.
  CharacteristicValues values_of(int level, const LevelReading& reading, int v_hat_below) const {
    if (leaves_out_rows()) {
      const CharacteristicValues& expected = settings_.expected;
      const int d = reading.ranks.d, a = reading.ranks.a, v = problem_.m() - d - a;
      const bool found = expected.mu < 0 ? v == 0 : d == expected.d && a == expected.a;
      return {found ? level : -1, d, a, problem_.n() - a - d, v};
    }
    const int a = reading.ranks.a, v = reading.ranks.v_hat - v_hat_below, d = problem_.m() - a - v;
    return {reading.ranks.d == d ? level : -1, d, a, problem_.n() - a - d, v};
  }

  void evaluate(int level, double time_scale) {
    const Trouble trouble = problem_.evaluate(t_, {level, level, 0}, time_scale, data_, rows_);
    if (trouble.status != SFDAE_OK) throw Failure(trouble.status, trouble.message());
  }

  // Ranks of level `level` from the data evaluated; the decisions are left in latest_.
  LevelReading judge_level(int level) {
    latest_.clear();
    Judge judge(data_, level, judging_, &latest_);
    const Arena::Frame frame(arena_);
    const Matrix no_rhs((level + 1) * problem_.m(), 1);
    const Carried carried = settings_.by_svd ? eliminate_by_svd(data_, level, no_rhs, judge, arena_)
                                             : eliminate(data_, level, no_rhs, 1, judge, arena_);
    form_.resize(problem_.m(), problem_.n(), 0, carried.rows);
    LevelReading reading;
    reading.ranks = form_.build(data_, carried, {}, LeadingTerm::identity, judge, arena_);
    reading.time_scale = data_.time_scale;
    reading.clear = judge.all_clear();
    if (!latest_.empty()) reading.weakest = *std::min_element(latest_.begin(), latest_.end(), is_weaker);
    for (const RankDecision& decision : latest_)
      if (decision.verdict == Verdict::unclear && reading.doubtful.verdict == Verdict::clear)
        reading.doubtful = decision;
    return reading;
  }

  CoefficientSource& problem_;
  double t_;
  const AnalysisSettings& settings_;
  Arena& arena_;
  std::vector<RankDecision>* log_;
  Judge::Settings judging_;
  RowScaling rows_;
  std::vector<int> differentiations_;
  TaylorData data_;
  NullSpaceForm form_;
  std::vector<RankDecision> latest_;
};

// What the analysis would say if the doubtful value were decided by rank_tol.
std::string reading_with(CoefficientSource& problem, double t, AnalysisSettings settings, double rank_tol, Arena& arena) {
  settings.rank_tol = rank_tol;
  const CharacteristicValues values = find_local_values(problem, t, settings, arena);
  return values.mu >= 0 ? "the characteristic values are " + describe(values)
                        : "no level up to max_index fulfils the hypothesis";
}

[[noreturn]] void report_unclear(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                                 const LevelReading& reading, Arena& arena) {
  const RankDecision& decision = reading.doubtful;
  // The value in doubt is the smallest one kept, or, where that stands clear or there is none, the largest one dropped.
  const bool doubts_kept = decision.rank > 0 && (decision.gap < clear_gap || decision.dropped <= decision.noise);
  const double value = std::max(doubts_kept ? decision.kept : decision.dropped, decision.noise);
  const double below = doubts_kept ? std::max({decision.dropped, decision.noise, 1e-300}) : 1e-2 * value;
  const double keep_tol = std::min(std::sqrt(value * below), 0.5);
  const double drop_tol = std::min(3.0 * value, 0.5);
  const int rank = doubts_kept ? decision.rank : decision.rank + 1;
  const std::string kept = reading_with(problem, t, settings, keep_tol, arena);
  const std::string dropped = reading_with(problem, t, settings, drop_tol, arena);
  throw Failure(SFDAE_RANK_UNCLEAR,
                describe(decision) + (reading.follows ? " is not clear." : " does not fit the ranks of the level below.") +
                    format(" With rank %d ", rank) + kept + format("; with rank %d ", rank - 1) + dropped +
                    format(". Try rank_tol = %.1e or %.1e, or scale the equations.", keep_tol, drop_tol));
}

std::string describe_levels(const std::vector<CharacteristicValues>& levels, int m) {
  std::string text;
  for (std::size_t l = 0; l < levels.size(); ++l)
    text += format(" level %d: a = %d, rank(E T2) = %d of %d;", static_cast<int>(l), levels[l].a, levels[l].d,
                   m - levels[l].a - levels[l].v);
  return text;
}

IndexAnalysis search_at(CoefficientSource& problem, double t, const AnalysisSettings& settings, Arena& arena,
                        std::vector<RankDecision>& decisions) {
  Searcher searcher(problem, t, settings, arena, &decisions);
  const Search found = searcher.search(settings.max_index);
  if (!found.last.clear) report_unclear(problem, t, settings, found.last, arena);
  if (found.values.mu < 0)
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("no strangeness index up to max_index = %d at t = %.15g:", settings.max_index, t) +
                      describe_levels(found.levels, problem.m()) + " raise max_index, or check that the problem is regular.");
  IndexAnalysis analysis;
  analysis.values = found.values;
  analysis.t = t;
  analysis.time_scale = found.last.time_scale;
  analysis.v_hat = found.last.ranks.v_hat;
  analysis.rank_E = found.last.ranks.rank_E;
  analysis.noise = found.last.noise;
  return analysis;
}

// Far enough for a coefficient that vanishes at t to be seen, near enough to stay on the same smooth piece.
double nearby_point(double t, double toward, double time_scale) {
  const double distance = std::min(std::fabs(toward - t), time_scale) * 0.7e-3;
  const double resolvable = 1e6 * unit_roundoff * std::fabs(t);
  return t + std::copysign(std::min(std::max(distance, resolvable), std::fabs(toward - t)), toward - t);
}

// Units of the unknowns: columns of [E A] that differ by more than moderate_column_ratio are scaled to comparable size.
// Columns below smallest_column are left alone: they may be rounding errors.
std::vector<double> choose_column_scale(CoefficientSource& problem, double t) {
  constexpr double moderate_column_ratio = 1024.0, smallest_column = 1e-12;
  const std::size_t n = static_cast<std::size_t>(problem.n());
  std::vector<double> scale(n, 1.0);
  bool needed = false;
  // Scaling of rows and columns depends on each other: two sweeps.
  for (int sweep = 0; sweep < 2; ++sweep) {
    problem.set_column_scale(scale);
    TaylorData data;
    const Trouble trouble = problem.evaluate(t, {0, 0, -1}, 0.0, data);
    if (trouble.status != SFDAE_OK) throw Failure(trouble.status, trouble.message());
    std::vector<double> size(n);
    double largest = 0.0, smallest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < n; ++j) {
      const int column = static_cast<int>(j);
      size[j] = std::max(max_abs(data.E(0).column(column), data.m), max_abs(data.A(0).column(column), data.m));
      largest = std::max(largest, size[j]);
      if (size[j] > 0.0) smallest = std::min(smallest, size[j]);
    }
    needed = needed || largest > moderate_column_ratio * smallest;
    for (std::size_t j = 0; j < n; ++j)
      if (size[j] > smallest_column * largest) scale[j] *= std::ldexp(1.0, -std::ilogb(size[j]));
  }
  return needed ? scale : std::vector<double>();
}

// The analysis in the units of the unknowns that the problem has.
IndexAnalysis analyze_in_units(CoefficientSource& problem, double t, double toward, const AnalysisSettings& settings,
                               Arena& arena, std::vector<RankDecision>& decisions) {
  IndexAnalysis here = search_at(problem, t, settings, arena, decisions);
  if (!problem.is_constant()) {
    const double nearby = nearby_point(t, toward, here.time_scale);
    const IndexAnalysis there = search_at(problem, nearby, settings, arena, decisions);
    here.rank_E_constant = here.rank_E == there.rank_E;
    const int mu = std::max(here.values.mu, there.values.mu);
    if (here.values.mu != there.values.mu) {
      // At the level that counts both points must agree: E = [0 t; 0 0], A = I does at mu = 1.
      const bool raise_here = here.values.mu < mu;
      Searcher again(problem, raise_here ? t : nearby, settings, arena, &decisions);
      const CharacteristicValues raised = again.values_at(mu);
      if (raise_here) {
        here.values = raised;
        const LevelReading reading = again.read_confirmed(mu);
        here.time_scale = reading.time_scale;
        here.v_hat = reading.ranks.v_hat;
        here.noise = reading.noise;
      }
      const CharacteristicValues& other = raise_here ? there.values : raised;
      if (!(here.values == other))
        throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                      format("t = %.15g is an exceptional point: ", t) + describe(here.values) + " there, but " +
                          describe(other) + format(" at t = %.15g. Start beside it.", nearby));
    } else if (!(here.values == there.values)) {
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    format("t = %.15g is an exceptional point: ", t) + describe(here.values) + " there, but " +
                        describe(there.values) + format(" at t = %.15g. Start beside it.", nearby));
    }
  }
  return here;
}

double smallest_gap(const std::vector<RankDecision>& decisions) {
  double gap = std::numeric_limits<double>::infinity();
  for (const RankDecision& decision : decisions) gap = std::min(gap, decision.gap);
  return gap;
}

double smallest_kept(const std::vector<RankDecision>& decisions) {
  double kept = 1.0;
  for (const RankDecision& decision : decisions)
    if (decision.rank > 0) kept = std::min(kept, decision.kept);
  return kept;
}

// Reads the problem in faster and faster units of time, the units of the unknowns balanced for each. What is clear by far
// in two of them, supported by a third, and contradicted in none, counts: the reading with the largest gap. Units that are
// much too fast shrink every value by the same factor from level to level: where the smallest one kept is small, the next
// one would be lost among rounding errors, and ranks agree in being wrong.
struct Reading {
  IndexAnalysis analysis;
  std::vector<RankDecision> decisions;
  std::vector<double> columns;
};

std::optional<Reading> read_in_other_units(CoefficientSource& problem, double t, double toward,
                                           const AnalysisSettings& settings, Arena& arena) {
  constexpr double clear_by_far = 1e6, supporting = 1e4, ratio = 1.0 / 8.0, least_kept = 1e-6;
  std::optional<Reading> best;
  int agreeing = 0, clear = 0;
  double tau = 1.0;
  for (int attempt = 0; attempt < 13; ++attempt, tau *= ratio) {
    Reading reading;
    AnalysisSettings scaled = settings;
    scaled.time_scale = tau;
    try {
      reading.columns = balanced_units(problem, t, tau);
      problem.set_column_scale(reading.columns);
      reading.analysis = analyze_in_units(problem, t, toward, scaled, arena, reading.decisions);
    } catch (const Failure& failure) {
      if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
      continue;
    }
    const bool is_clear = std::all_of(reading.decisions.begin(), reading.decisions.end(),
                                      [](const RankDecision& d) { return d.verdict == Verdict::clear; });
    const double gap = smallest_gap(reading.decisions);
    if (!is_clear || gap < supporting) continue;
    if (best && !(best->analysis.values == reading.analysis.values)) return std::nullopt;
    ++agreeing;
    if (gap >= clear_by_far) ++clear;
    if (!best || smallest_gap(reading.decisions) > smallest_gap(best->decisions)) best = std::move(reading);
  }
  const bool counts = agreeing >= 3 && clear >= 2 && smallest_kept(best->decisions) >= least_kept;
  return counts ? std::move(best) : std::nullopt;
}

}  // namespace

std::string describe(const CharacteristicValues& values) {
  if (values.mu < 0) return "undetermined";
  return format("mu = %d, d = %d, a = %d, u = %d, v = %d", values.mu, values.d, values.a, values.u, values.v);
}

std::string describe(const RankDecision& decision) {
  const char* subject = decision.subject == Subject::stage         ? "diagonal block"
                        : decision.subject == Subject::constraints ? "constraints"
                        : decision.subject == Subject::array       ? "derivative array"
                                                                   : "E T2";
  return format("rank decision at t = %.15g, level %d (%s, %d x %d): kept %.1e, dropped %.1e, noise %.1e (gap %.2g)",
                decision.t, decision.level, subject, decision.rows, decision.cols, decision.kept, decision.dropped,
                decision.noise, decision.gap);
}

CharacteristicValues find_local_values(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                                       Arena& arena) {
  try {
    Searcher searcher(problem, t, settings, arena, nullptr);
    const Search found = searcher.search(settings.max_index);
    return found.last.clear ? found.values : CharacteristicValues{};
  } catch (const Failure& failure) {
    if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
    return {};
  }
}

bool known_values_hold(CoefficientSource& problem, double t, const AnalysisSettings& settings, const IndexAnalysis& known,
                       Arena& arena) {
  Searcher searcher(problem, t, settings, arena, nullptr);
  PointRanks expected;
  expected.a = known.values.a;
  expected.d = known.values.d;
  expected.v_hat = known.v_hat;
  return searcher.has_ranks(known.values.mu, known.time_scale, expected);
}

IndexAnalysis analyze_index(CoefficientSource& problem, double t, double toward, const AnalysisSettings& settings,
                            Arena& arena, std::vector<RankDecision>& decisions) {
  decisions.clear();
  problem.set_column_scale({});
  problem.set_column_scale(choose_column_scale(problem, t));
  try {
    return analyze_in_units(problem, t, toward, settings, arena, decisions);
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_RANK_UNCLEAR || settings.rank_tol > 0.0 || settings.time_scale > 0.0) throw;
    if (std::optional<Reading> reading = read_in_other_units(problem, t, toward, settings, arena)) {
      problem.set_column_scale(reading->columns);
      decisions = std::move(reading->decisions);
      return reading->analysis;
    }
    problem.set_column_scale({});
    problem.set_column_scale(choose_column_scale(problem, t));
    throw;
  }
}

}  // namespace sfdae::core
