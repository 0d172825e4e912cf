// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/library_calls.h"

#include <chrono>
#include <future>
#include <regex>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Number of unknowns above which an analysis may take long enough to be stopped; below, a thread costs more than it
// gains.
constexpr int large = 60;
constexpr std::chrono::milliseconds polling_interval{20};

}  // namespace

void LibraryCalls::check_stop(double t, double h, int order) const {
  if (settings_.progress && !settings_.progress(t, h, order))
    throw Failure(Outcome::stopped, SFDAE_STOPPED, "stopped at t = " + to_text(t));
}

// Polls the progress callback on the caller's thread while the library works on another one.
int LibraryCalls::run_while_polling(Mode& mode, const std::function<int()>& call) {
  std::future<int> result = std::async(std::launch::async, call);
  bool is_stopped = false;
  while (result.wait_for(polling_interval) != std::future_status::ready) {
    if (!is_stopped) {
      try {
        check_stop(settings_.start, 0.0, 0);
      } catch (const Failure&) {
        is_stopped = true;
        mode.solver.request_stop();
      }
    }
  }
  return result.get();
}

int LibraryCalls::attempt(Mode& mode, const std::function<int()>& call) {
  message_.clear();
  last_mode_ = mode.shared_from_this();
  try {
    const bool polls = settings_.progress && mode.solver.num_unknowns() > large;
    const int status = polls ? run_while_polling(mode, call) : call();
    if (status == SFDAE_STOPPED) throw Failure(Outcome::stopped, SFDAE_STOPPED, "stopped");
    if (status != SFDAE_OK) message_ = translated(mode.solver.message());
    return status;
  } catch (const sfdae::Error& error) {
    message_ = translated(error.what());
    return error.status();
  }
}

int LibraryCalls::run(Mode& mode, Phase phase, const std::string& where, const std::function<int()>& call) {
  const int status = attempt(mode, call);
  if (status < 0) throw Failure(outcome_of(status, phase), status, where + ": " + message_);
  return status;
}

// Event functions belong to switches with roots; floor and trunc have two (Switches).
std::string LibraryCalls::with_relations(const std::string& text) const {
  static const std::regex event_function("\\bg\\[([0-9]+)\\] of the event function");
  std::smatch match;
  if (!std::regex_search(text, match, event_function)) return text;
  std::size_t number = std::stoul(match[1].str());
  for (const Switch& it : system_.switches) {
    const std::size_t count = !it.has_root ? 0 : it.kind == Switch::Kind::relation ? 1 : 2;
    if (number < count)
      return match.prefix().str() + "the argument of " + it.text + " (" + place(system_.model, it.at) + ")" +
             match.suffix().str();
    number -= count;
  }
  return text;
}

std::string LibraryCalls::translated(const std::string& given) const {
  // Equation numbers refer to the mode; equation names are positions in the file.
  static const std::regex number_before_name("\\bequation [0-9]+ \\(");
  const std::string text = with_relations(std::regex_replace(given, number_before_name, "equation ("));
  static const std::regex number("\\b(?:component |x\\[)([0-9]+)\\b\\]?");
  std::string result;
  auto position = text.cbegin();
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it) {
    const std::smatch& match = *it;
    result.append(position, match[0].first);
    position = match[0].second;
    const std::size_t i = std::stoul(match[1].str());
    if (i < unknowns_.size() && unknowns_[i] >= 0) {
      result += system_.model.variables[at(unknowns_[i])].name;
    } else {
      result += match[0].str();
    }
  }
  return result.append(position, text.cend());
}

Outcome outcome_of(int status, Phase phase) {
  if (phase == Phase::integration) return Outcome::not_finished;
  const bool is_of_structure = status <= SFDAE_INDEX_TOO_HIGH && status > SFDAE_INCONSISTENT_VALUES;
  return is_of_structure || phase == Phase::analysis ? Outcome::not_analyzed : Outcome::not_started;
}

}  // namespace sfdae::cli
