// Times at which functions of t alone in recorded equations switch to another branch.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/switching_times.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Fraction of the size of times: gaps about smaller times are as wide as about this one. (Design, section 17.)
constexpr double least_size = 1e-3;
// Largest number of pieces in one search. (Design, section 17: 60 were the most in 35 kinds of inputs.)
constexpr int most_pieces = 256;
// Number of gaps in memory. Steps and outputs within them ask for the last two.
constexpr std::size_t most_gaps = 8;
// Start of a search before the requested time, in half gaps; most gaps are narrower.
constexpr double looks_back = 1024.0;

bool is_undecided(const Branch& branch) { return branch.is_used && std::isnan(branch.number); }

}  // namespace

SwitchingTimes::SwitchingTimes(const std::vector<const TaylorEvaluator*>& evaluators) {
  std::size_t count = 0;
  for (const TaylorEvaluator* const evaluator : evaluators) {
    if (evaluator->has_source() || evaluator->tape().time < 0) continue;
    SwitchingFunctions part(*evaluator);
    if (part.count() == 0) continue;
    count += part.count();
    parts_.push_back(std::move(part));
  }
  branches_.resize(count);
  before_.resize(count);
  if (count == 0) return;
  gaps_.reserve(most_gaps + 1);
  pieces_.reserve(most_pieces);
}

double SwitchingTimes::half_gap(double t) const { return half_of_gap(t, least_size * size_); }

// Restarts the search at a time before `from`, outside of gaps.
void SwitchingTimes::forget(double from, double beside) {
  constexpr double farther = 4.0;
  constexpr int most = 16;
  for (int k = 0; k < most; ++k) {
    find_branches(Interval::of(beside));
    if (std::none_of(branches_.begin(), branches_.end(), is_undecided)) break;
    beside = from + farther * (beside - from);
  }
  gaps_.clear();
  low_ = high_ = beside;
}

const std::vector<SwitchingGap>& SwitchingTimes::find(double from, double toward) {
  const QuietArithmetic quiet;
  long version = 0;
  for (const SwitchingFunctions& part : parts_) version += part.version();
  direction_ = toward < from ? -1.0 : 1.0;
  // `from` may be in a gap that begins before it.
  const double beside = from - direction_ * looks_back * half_gap(from);
  if (version != version_ || !(low_ <= beside && beside <= high_)) forget(from, beside);
  version_ = version;
  const auto is_known = [&] {
    known_to_ = direction_ > 0.0 ? high_ : low_;
    const bool has_next = std::any_of(gaps_.begin(), gaps_.end(), [&](const SwitchingGap& gap) {
      return ((direction_ > 0.0 ? gap.start : gap.end) - from) * direction_ > 0.0;
    });
    return has_next || (known_to_ - toward) * direction_ >= 0.0;
  };
  while (!is_known()) {
    if (extend(toward)) continue;
    is_known();
    if (!((known_to_ - from) * direction_ > 4.0 * half_gap(from))) known_to_ = from;
    break;
  }
  return gaps_;
}

// Extends the search up to the next gap, at most a while beyond `toward`. False: the search ended early.
bool SwitchingTimes::extend(double toward) {
  double& known = direction_ > 0.0 ? high_ : low_;
  const double ahead = known + looks_ahead_ * (toward - known);
  pieces_.clear();
  pieces_.push_back({known, std::isfinite(ahead) ? ahead : toward, false});
  open_ = {};
  find_branches(Interval::of(known));
  before_ = branches_;
  for (int looks = 0; (known - toward) * direction_ < 0.0; ++looks) {
    // Behind a gap at the end a short piece remains to be searched.
    if (pieces_.empty()) pieces_.push_back({open_.end, open_.end + 4.0 * direction_ * half_gap(open_.end), false});
    const Piece piece = pieces_.back();
    if (looks >= most_pieces || pieces_.size() + 3 > most_pieces) return false;
    pieces_.pop_back();
    if ((piece.end - piece.start) * direction_ > 0.0 && look_at(piece)) return true;
  }
  return true;
}

// Returns true if a gap is found.
bool SwitchingTimes::look_at(const Piece& piece) {
  if (piece.is_gap) {
    if (!open_.is_open) open_ = {piece.start, piece.end, true};
    open_.end = piece.end;
    return false;
  }
  const Interval t = between(std::min(piece.start, piece.end), std::max(piece.start, piece.end));
  find_branches(t);
  if (std::any_of(branches_.begin(), branches_.end(), is_undecided)) {
    Branch* branches = branches_.data();
    for (std::size_t part = 0; part < parts_.size(); branches += parts_[part++].count())
      if (const auto crossing = parts_[part].find_crossing(t, piece.start, branches)) {
        split(piece, part, *crossing);
        return false;
      }
    if (std::any_of(branches_.begin(), branches_.end(), is_undecided)) {
      const double middle = piece.start + 0.5 * (piece.end - piece.start);
      const bool is_next_to_nothing = std::fabs(piece.end - piece.start) <= half_gap(piece.end);
      if (is_next_to_nothing) pieces_.push_back({piece.start, piece.end, true});
      else {
        pieces_.push_back({middle, piece.end, false});
        pieces_.push_back({piece.start, middle, false});
      }
      return false;
    }
  }
  const bool is_gap = close(piece.start);
  (direction_ > 0.0 ? high_ : low_) = is_gap ? piece.start : piece.end;
  before_ = branches_;
  return is_gap;
}

void SwitchingTimes::split(const Piece& piece, std::size_t part, const Crossing& crossing) {
  const Interval t = between(std::min(piece.start, piece.end), std::max(piece.start, piece.end));
  const double place = parts_[part].locate(crossing, t);
  const double half = gap_about(place, part, crossing.which, t.high - t.low);
  const double start = place - direction_ * half, end = place + direction_ * half;
  if ((piece.end - end) * direction_ > 0.0) pieces_.push_back({end, piece.end, false});
  pieces_.push_back({start, end, true});
  if ((start - piece.start) * direction_ > 0.0) pieces_.push_back({piece.start, start, false});
}

// Half of a gap, just wide enough that the branches on both sides are known.
double SwitchingTimes::gap_about(double t, std::size_t part, std::size_t which, double room) {
  constexpr double wider = 4.0;
  double half = half_gap(t);
  std::vector<Branch>& beside = branches_;
  for (; half < room; half *= wider) {
    bool is_decided = true;
    for (const double time : {t - half, t + half}) {
      parts_[part].find_branches(Interval::of(time), beside.data());
      is_decided = is_decided && !std::isnan(beside[which].number);
    }
    if (is_decided) break;
  }
  return half;
}

// Closes the open gap at the start of a piece with known branches. True: something has switched in it, or just there.
bool SwitchingTimes::close(double at) {
  int order = std::numeric_limits<int>::max();
  bool has_switched = false;
  std::size_t k = 0;
  for (const SwitchingFunctions& part : parts_)
    for (std::size_t which = 0; which < part.count(); ++which, ++k) {
      const Branch &old = before_[k], &now = branches_[k];
      if (!old.is_used || !now.is_used || old.number == now.number) continue;
      if (std::isnan(old.number) && !open_.is_open) continue;
      has_switched = true;
      order = std::min(order, part.jumping_order(which, old.number, now.number));
    }
  const Borders gap = open_.is_open ? open_ : Borders{at, at, false};
  open_ = {};
  if (has_switched) keep({std::min(gap.start, gap.end), std::max(gap.start, gap.end), order});
  return has_switched;
}

void SwitchingTimes::keep(SwitchingGap gap) {
  if (!(gap.end > gap.start)) {
    const double half = half_gap(gap.start);
    gap = {gap.start - half, gap.end + half, gap.jumping_order};
  }
  if (direction_ > 0.0) gaps_.push_back(gap);
  else gaps_.insert(gaps_.begin(), gap);
  if (gaps_.size() <= most_gaps) return;
  if (direction_ > 0.0) {
    low_ = gaps_.front().end;
    gaps_.erase(gaps_.begin());
  } else {
    high_ = gaps_.back().start;
    gaps_.pop_back();
  }
}

void SwitchingTimes::find_branches(Interval t) {
  Branch* branches = branches_.data();
  for (SwitchingFunctions& part : parts_) {
    part.find_branches(t, branches);
    branches += part.count();
  }
}

}  // namespace sfdae::core
