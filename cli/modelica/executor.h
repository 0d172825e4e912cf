// Symbolic execution of algorithms: afterwards, every variable is a formula in values known before.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "modelica/elaboration.h"

namespace sfdae::cli {

// The variables that an algorithm assigns; each store defines its own keys.
class Store : public Scope {
 public:
  using State = std::map<int, std::shared_ptr<Value>>;

  // Assigns to `left`, a name with subscripts and members, if `active` (a Boolean formula) holds.
  virtual void assign(const Environment& in, const syntax::Expression& left, const Value& value,
                      const Expression& active) = 0;
  // The value for a key without an entry in the state; none: no value.
  virtual std::shared_ptr<Value> initial_value(int key) = 0;
  // reinit and terminate; false if not in a when clause.
  virtual bool act(const Environment& in, const syntax::Expression& call) = 0;
  // A when statement; only models have them.
  virtual void when(const Environment& in, const syntax::Statement& statement) = 0;

  State& state() { return state_; }

 protected:
  State state_;
};

class Executor {
 public:
  Executor(Elaboration& e, Store& store, const Environment& in);

  void run(const std::vector<syntax::Statement>& body);

 private:
  // Conditions that skip the remaining statements: until the end of the algorithm, or of the loop.
  struct Flow {
    Expression returned, broken;
  };

  Expression active();
  void statement(const Environment& in, const syntax::Statement& one);
  void block(const Environment& in, const std::vector<syntax::Statement>& body);
  void assignment(const Environment& in, const syntax::Statement& one);
  void if_statement(const Environment& in, const syntax::Statement& one, size_t first);
  void both(const Environment& in, const Expression& condition, const syntax::Statement& one, size_t k);
  void for_loop(const Environment& in, const syntax::Statement& one);
  void while_loop(const Environment& in, const syntax::Statement& one);
  void assert_ended(const Environment& in, Location at);
  void call(const Environment& in, const syntax::Statement& one);
  Store::State merged(const Expression& condition, const Store::State& first, const Store::State& second,
                      Location at);
  bool is_decided_by_parameters(const Expression& condition) const;

  Elaboration& e_;
  Store& store_;
  Environment in_;
  Flow flow_;
};

// assert(condition, message, level) as an assertion that applies if the guards of `in` hold.
Assertion evaluate_assertion(Elaboration& e, const Environment& in, const syntax::Expression& call);

}  // namespace sfdae::cli
