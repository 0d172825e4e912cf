// A search up the levels of the derivative array at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/index_search.h"

#include <algorithm>
#include <cmath>

#include "linalg/random.h"
#include "problem/failure.h"
#include "reduction/elimination.h"

namespace sfdae::core {

namespace {

// Amplitude of trial perturbations in units of the noise of the data, and how many are tried. These, the margins
// below and the time scales: docs/design/rank_decisions.md.
constexpr double perturbation_roundings = 4.0;
constexpr int perturbations = 3;
// Margin of kept values over their changes: to confirm a rank that the propagated noise allows, and to keep values that
// it does not allow, as errors of the callbacks of about ten roundings are possible.
constexpr double confirming_margin = clear_gap / perturbation_roundings;
constexpr double keeping_margin = 1e4;
// Margin of dropped values over their changes: rounding errors change by about their own size.
constexpr double moving_margin = 10.0;
// Dropped values above n of these roundings have to move: ten times the threshold of a rank whose noise is that of the
// data (rank.cpp), by judgment.
constexpr double certain_roundings = 100.0;
// Units of time that have to agree if perturbations decide nothing, relative to the one chosen.
constexpr double other_time_scales[] = {1.0 / 8.0, 4.0};
// Smaller relative values may be zeros with rounding errors of the user's arithmetic, unknown to the data. They are if
// relative changes of this size of all entries move them by more than this: small entries stay, sums that cancel do
// not. 8 wrong indices in 400,000 slow and stiff random problems without that, none with it.
constexpr double least_trusted = 1e-11, callback_errors = 1e-13, firm = 1e-3;
// Ranks with smaller gaps must follow from those of the level below; wrong ranks that did not had gaps below 2e6
// (docs/design/rank_decisions.md).
constexpr double decisive_gap = 1e9;

// Ranks of a regular problem with such gaps are those of the level above (docs/design/rank_decisions.md).
constexpr double gap_of_final_ranks = 1e6;

// Distance of the smallest nonzero value, actual or hypothetical, from the zeros; 1e-300 avoids a division by zero.
double clearness(const RankDecision& decision) {
  return decision.rank > 0 ? decision.gap : 1.0 / std::max(decision.noise, 1e-300);
}
bool is_weaker(const RankDecision& one, const RankDecision& other) { return clearness(one) < clearness(other); }

}  // namespace

IndexSearch::IndexSearch(const SearchTask& task, double t)
    : task_(task),
      t_(t),
      judging_{task_.settings.rank_tol, task_.settings.by_svd, NoiseModel::carried},
      rows_(task.units != nullptr ? RowScaling::timed : task_.settings.rows),
      differentiations_(task_.problem.differentiations()) {}

LevelResult IndexSearch::determine(int level, double time_scale) {
  evaluate(level, time_scale);
  return judge_level(level);
}

LevelResult IndexSearch::certify(int level) {
  evaluate(level, task_.settings.time_scale);
  TrialPerturbations& random = task_.perturbations != nullptr ? *task_.perturbations : perturbations_;
  const BalancedUnits no_suspects;
  const BalancedUnits& units = task_.units != nullptr ? *task_.units : no_suspects;
  const CertifiedRanks certified =
      certified_ranks(data_, level, {units, random, task_.omits_suspects, task_.settings.rank_tol, task_.suggested});
  LevelResult found;
  found.ranks = certified.ranks;
  found.time_scale = data_.time_scale;
  found.significance = certified.significance;
  found.known_ranks = task_.settings.by_svd ? certified.list_by_svd : certified.list;
  found.clear = task_.settings.rank_tol > 0.0 || certified.significance.is_clear();
  return found;
}

std::vector<RankDecision> IndexSearch::decisions_with(int level, const RankSequence& certified, double time_scale) {
  judging_.known_ranks = &certified;
  const bool fits = determine(level, time_scale).fits_known_ranks;
  judging_.known_ranks = nullptr;
  return fits ? latest_ : std::vector<RankDecision>();
}

LevelResult IndexSearch::determine_confirmed(int level) {
  if (task_.certified) return certify(level);
  LevelResult found = determine(level, task_.settings.time_scale);
  std::vector<RankDecision> decisions = latest_;
  const RowScaling scaling = rows_;
  if (!found.clear && data_.row_scale_ratio() <= moderate_row_ratio) {
    rows_ = RowScaling::common;
    const LevelResult unscaled = determine(level, task_.settings.time_scale);
    if (unscaled.clear) {
      found = unscaled;
      decisions = latest_;
    }
    rows_ = scaling;
  }
  if (!found.clear) measure(level, found, decisions);
  if (found.clear && task_.settings.rank_tol == 0.0) doubt_cancellations(level, found, decisions);
  found.gap = smallest_gap(decisions);
  found.kept = smallest_kept(decisions);
  if (task_.log != nullptr) task_.log->insert(task_.log->end(), decisions.begin(), decisions.end());
  return found;
}

CharacteristicValues IndexSearch::values_at(int level) {
  const int below = level > 0 ? determine_confirmed(level - 1).ranks.v_hat : 0;
  return values_of(level, determine_confirmed(level), below);
}

bool IndexSearch::has_ranks(int level, double time_scale, const PointRanks& expected) {
  judging_.noise = NoiseModel::data;
  judging_.by_singular_values = true;
  const LevelResult found = determine(level, time_scale);
  if (found.ranks.a != expected.a || found.ranks.d != expected.d || found.ranks.v_hat != expected.v_hat) return false;
  std::vector<RankDecision> decisions = latest_;
  for (RankDecision& decision : decisions) decision.verdict = Verdict::unclear;  // to be confirmed
  return survives_perturbations(level, found.time_scale, decisions, confirming_margin, Trust::clear_ones);
}

SearchResult IndexSearch::search(int max_index) {
  SearchResult result;
  int v_hat_below = 0;
  for (int level = 0; level <= std::min(max_index, highest_level()); ++level) {
    const RankDecision weakest_below = result.last.weakest;
    result.last = determine_confirmed(level);
    result.significance.join(result.last.significance);
    result.is_clear = result.is_clear && result.last.clear;
    if (!result.last.clear && !task_.certified) return result;
    const CharacteristicValues values = values_of(level, result.last, v_hat_below);
    if (level > 0 && !follows(result.levels.back(), values, result.last.ranks)) {
      result.last.follows = false;
      result.last.doubtful = std::min(weakest_below, result.last.weakest, is_weaker);
      result.last.clear =
          task_.settings.rank_tol > 0.0 || (!task_.certified && clearness(result.last.doubtful) >= decisive_gap);
      result.is_clear = result.is_clear && result.last.clear;
      if (!result.last.clear && !task_.certified) return result;
    }
    result.levels.push_back(values);
    result.levels.back().d = result.last.ranks.d;
    if (values.mu >= 0 && (is_final(values, result.last) || holds_above(level, values, result.last.ranks))) {
      result.values = values;
      return result;
    }
    v_hat_below = result.last.ranks.v_hat;
  }
  return result;
}

// As many equations as unknowns, and none of them redundant: [M N] has full row rank, also nearby, so that F_mu = 0 is
// a manifold on which a can only become smaller. The nearby point shows that it does not. Kept values that may be
// residuals of the jet are in doubt.
bool IndexSearch::is_final(const CharacteristicValues& values, const LevelResult& found) {
  const bool is_regular = values.u == 0 && values.v == 0 && found.ranks.v_hat == 0;
  const bool is_clear = is_regular && task_.settings.rank_tol == 0.0 && found.gap >= gap_of_final_ranks &&
                        found.kept >= clear_gap * found.residual;
  return is_clear && (found.noise == NoiseModel::carried || stands_firm(values.mu, found));
}

// True if decisions confirmed by perturbations also hold with this margin.
bool IndexSearch::stands_firm(int level, const LevelResult& found) {
  judging_.noise = found.noise;
  judging_.by_singular_values = true;
  const PointRanks ranks = determine(level, found.time_scale).ranks;
  const std::vector<RankDecision> decisions = latest_;
  const bool is_same = ranks.a == found.ranks.a && ranks.d == found.ranks.d && ranks.v_hat == found.ranks.v_hat;
  const bool is_firm =
      is_same && survives_perturbations(level, found.time_scale, decisions, gap_of_final_ranks, Trust::none);
  judging_.noise = NoiseModel::carried;
  judging_.by_singular_values = task_.settings.by_svd;
  return is_firm;
}

// True if level l + 1 has the same values, or is not available or unclear. A precedent implies it: then only the jet is
// solved for as without one, so that results are the same.
bool IndexSearch::holds_above(int level, const CharacteristicValues& values, const PointRanks& ranks) {
  if (!task_.problem.checks_next_level() || level >= std::min(max_derivative_order, highest_level())) return true;
  try {
    if (values == task_.settings.precedent.values) {
      evaluate(level + 1, task_.settings.time_scale);
      return true;
    }
    const LevelResult above = determine_confirmed(level + 1);
    if (leaves_out_rows()) return !above.clear || (above.ranks.a == values.a && above.ranks.d == values.d);
    return !above.clear ||
           (above.ranks.a == values.a && above.ranks.d == values.d && above.ranks.v_hat == ranks.v_hat + values.v);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return true;
  }
}

// The propagated noise is an upper bound, sometimes by far: values between it and the rounding errors of the matrix
// itself are undecided. Perturbing the data by a few roundings shows which are signals: first with the ranks that keep
// them all, then with those that drop values below the noise of the smallest pivot, then with those that drop them all,
// then with other time scales. Ranks that survive are confirmed.
void IndexSearch::measure(int level, LevelResult& found, std::vector<RankDecision>& decisions) {
  struct Attempt {
    NoiseModel noise;
    double margin;
    Trust trust;
  };
  bool confirmed = false;
  const double tau = found.time_scale;
  // Singular values throughout: pivots may change their order under perturbations.
  judging_.by_singular_values = true;
  for (const Attempt& attempt : {Attempt{NoiseModel::data, keeping_margin, Trust::none},
                                 Attempt{NoiseModel::pivots, confirming_margin, Trust::none},
                                 Attempt{NoiseModel::carried, confirming_margin, Trust::clear_ones}}) {
    judging_.noise = attempt.noise;
    LevelResult candidate = determine(level, tau);
    candidate.noise = attempt.noise;
    const std::vector<RankDecision> made = latest_;
    if (attempt.noise == NoiseModel::pivots && !candidate.clear) continue;
    if (!survives_perturbations(level, tau, made, attempt.margin, attempt.trust)) continue;
    confirmed = true;
    found = candidate;
    decisions = made;
    break;
  }
  judging_.noise = NoiseModel::carried;
  judging_.by_singular_values = task_.settings.by_svd;
  if (!confirmed && !agrees_with_other_time_scales(level, found)) return;
  found.clear = true;
  for (RankDecision& decision : decisions)
    if (decision.verdict == Verdict::unclear) decision.verdict = Verdict::confirmed;
}

bool IndexSearch::agrees_with_other_time_scales(int level, const LevelResult& found) {
  bool agrees = false;
  for (double factor : other_time_scales) {
    const LevelResult other = determine(level, found.time_scale * factor);
    if (!other.clear) continue;
    if (other.ranks.a != found.ranks.a || other.ranks.d != found.ranks.d || other.ranks.v_hat != found.ranks.v_hat)
      return false;
    agrees = true;
  }
  return agrees;
}

// Kept values must stay put to 1 / margin; dropped ones above the rounding errors of the matrix must move.
bool IndexSearch::survives_perturbations(int level, double time_scale, const std::vector<RankDecision>& decisions,
                                         double margin, Trust trust) {
  std::minstd_rand generator(1);
  std::vector<char> moved(decisions.size(), 0);
  for (int trial = 0; trial < perturbations; ++trial) {
    evaluate(level, time_scale);
    perturb(level, generator);
    judge_level(level);
    for (std::size_t q = 0; q < decisions.size(); ++q) {
      if (q == latest_.size()) return false;
      const RankDecision& was = decisions[q];
      const RankDecision& is = latest_[q];
      // A dropped value that a perturbation lifts above the threshold is noise; later decisions cannot be compared.
      const bool lifted = trust == Trust::clear_ones && is.rank == was.rank + 1;
      if (lifted && confirming_margin * (is.kept - was.dropped) > was.dropped) {
        moved[q] = 1;
        break;
      }
      if (is.rank != was.rank) return false;
      if (moving_margin * std::fabs(is.dropped - was.dropped) > was.dropped) moved[q] = 1;
      if (was.rank == 0 || (was.verdict != Verdict::unclear && trust == Trust::clear_ones)) continue;
      // A value clear of the propagated noise may move a little.
      const bool stands_clear = trust == Trust::clear_ones && was.gap >= clear_gap;
      const double moves = stands_clear ? 0.0 : std::fabs(is.kept - was.kept);
      const double measured = std::max({moves, is.dropped, was.dropped});
      if (was.kept < margin * measured) return false;
    }
  }
  for (std::size_t q = 0; q < decisions.size(); ++q)
    if (decisions[q].dropped > certain_roundings * task_.problem.n() * unit_roundoff && moved[q] == 0) return false;
  return true;
}

void IndexSearch::doubt_cancellations(int level, LevelResult& found, std::vector<RankDecision>& decisions) {
  const auto is_tiny = [](const RankDecision& d) { return d.rank > 0 && d.kept < least_trusted; };
  if (std::none_of(decisions.begin(), decisions.end(), is_tiny)) return;
  determine(level, found.time_scale);
  const std::vector<RankDecision> before = latest_;
  std::minstd_rand generator(1);
  evaluate(level, found.time_scale);
  const auto change = [&](View block) {
    for (int j = 0; j < block.cols; ++j)
      for (int i = 0; i < block.rows; ++i) block(i, j) *= 1.0 + callback_errors * symmetric_random(generator);
  };
  for (int k = 0; k <= level; ++k) {
    change(data_.E(k));
    change(data_.A(k));
  }
  data_.measure();
  judge_level(level);
  bool moves = latest_.size() != before.size();
  for (std::size_t q = 0; q < before.size() && !moves; ++q)
    moves = latest_[q].rank != before[q].rank ||
            (is_tiny(before[q]) && std::fabs(latest_[q].kept - before[q].kept) > firm * before[q].kept);
  if (!moves) return;
  found.clear = false;
  for (RankDecision& decision : decisions) {
    if (!is_tiny(decision)) continue;
    decision.verdict = Verdict::unclear;
    found.doubtful = decision;
  }
}

void IndexSearch::perturb(int level, std::minstd_rand& generator) {
  const auto add_noise = [&](View block, double noise) {
    const double amplitude = perturbation_roundings * noise;
    for (int j = 0; j < block.cols; ++j)
      for (int i = 0; i < block.rows; ++i) block(i, j) += amplitude * symmetric_random(generator);
  };
  const double noise_E = data_.noise(level) * data_.norm_E(level),
               noise_A = data_.noise_A(level) * data_.norm_A(level);
  for (int k = 0; k <= level; ++k) {
    add_noise(data_.E(k), noise_E);
    add_noise(data_.A(k), noise_A);
  }
  data_.measure();
}

// Constraints and redundant equations only increase from level to level, and m - a - v is rank(E T2) of the level
// before: differentiation turns the rank lost by E T2 into constraints ([KM06], section 3.1: r_(i+1) = r_i - s_i).
// Exceptional points may differ, but then all ranks are clear by far. Ranks given by rank_tol are the user's.
bool IndexSearch::follows(const CharacteristicValues& below, const CharacteristicValues& values,
                          const PointRanks& ranks) const {
  if (leaves_out_rows()) return ranks.d <= below.d && values.a >= below.a;
  return ranks.d <= values.d && values.d == below.d && values.a >= below.a && values.v >= below.v;
}

// Higher levels have no more rows.
int IndexSearch::highest_level() const {
  if (!leaves_out_rows()) return max_derivative_order;
  return *std::max_element(differentiations_.begin(), differentiations_.end());
}

// Without all rows: each constraint that differentiation adds reduces rank(E T2) by at most one, so that d + a never
// becomes smaller. Once it is m, or d and a are those expected, all have been found.
CharacteristicValues IndexSearch::values_of(int level, const LevelResult& found, int v_hat_below) const {
  if (leaves_out_rows()) {
    const CharacteristicValues& expected = task_.settings.expected;
    const int d = found.ranks.d, a = found.ranks.a, v = task_.problem.m() - d - a;
    const bool is_found = expected.mu < 0 ? v == 0 : d == expected.d && a == expected.a;
    return {is_found ? level : -1, d, a, task_.problem.n() - a - d, v};
  }
  const int a = found.ranks.a, v = found.ranks.v_hat - v_hat_below, d = task_.problem.m() - a - v;
  return {found.ranks.d == d ? level : -1, d, a, task_.problem.n() - a - d, v};
}

void IndexSearch::evaluate(int level, double time_scale) {
  const bool chooses = time_scale == 0.0 && task_.units != nullptr;
  const double unit = chooses ? task_.units->time : time_scale;
  const int order_of_f = task_.problem.is_along_jet() ? level : 0;
  const CallbackError error = task_.problem.evaluate(t_, {level, level, order_of_f}, unit, data_, rows_);
  if (error.status != SFDAE_OK) error.raise();
  if (const double grown = data_.growth_time(); chooses && std::isfinite(grown))
    data_.rescale_time(std::exp2(std::round(std::log2(std::clamp(grown, shortest_growth, longest_growth)))));
}

// Ranks of level `level` from the data evaluated; the decisions are left in latest_.
LevelResult IndexSearch::judge_level(int level) {
  latest_.clear();
  Judge judge(data_, level, judging_, &latest_);
  const Arena::Frame frame(task_.arena);
  const Matrix no_rhs((level + 1) * task_.problem.m(), 0);
  const Carried carried = task_.settings.by_svd ? eliminate_by_svd(data_, level, no_rhs, judge, task_.arena)
                                                : eliminate(data_, level, no_rhs, 1, judge, task_.arena);
  form_.resize_for_ranks(task_.problem.m(), task_.problem.n(), carried.rows);
  LevelResult found;
  found.ranks = form_.find_ranks(data_, carried, judge, task_.arena);
  found.time_scale = data_.time_scale;
  if (task_.problem.is_along_jet()) found.residual = residual(level);
  found.clear = judge.all_clear();
  found.fits_known_ranks = judge.fits_known_ranks();
  if (!latest_.empty()) found.weakest = *std::min_element(latest_.begin(), latest_.end(), is_weaker);
  for (const RankDecision& decision : latest_)
    if (decision.verdict == Verdict::unclear && found.doubtful.verdict == Verdict::clear) found.doubtful = decision;
  return found;
}

// Signs of F, which is -f along a jet.
double IndexSearch::residual(int level) const {
  const double norm = data_.norm(level);
  return norm > 0.0 ? data_.norm_f(level) / norm : 0.0;
}

CharacteristicValues local_values(const SearchTask& task, double t) {
  try {
    IndexSearch upward(task, t);
    const SearchResult found = upward.search(task.settings.max_index);
    return found.is_clear ? found.values : CharacteristicValues{};
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return {};
  }
}

}  // namespace sfdae::core
