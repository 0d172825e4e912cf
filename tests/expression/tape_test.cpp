// SPDX-License-Identifier: BSD-3-Clause
// Equations of one form share their edges, and nothing else: derivatives are those of each equation recorded alone.
#include "expression/tape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "matrix_checks.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;
using Equation = std::function<Term(Recording&)>;

std::size_t forms_of(const std::vector<Equation>& equations, int n) {
  Recording recording(n);
  std::vector<Term> residuals;
  for (const Equation& equation : equations) residuals.push_back(equation(recording));
  return Tape(*recording.finish(residuals)).first_edge.size() - 1;
}

Numbers entries_of(TaylorEvaluator& source, const Matrix& jet, int order) {
  Numbers entries(source.tape().targets.size() * size(order + 1));
  const std::vector<int> limits(size(source.record().m()), order);
  EXPECT_TRUE(source.entries(0.3, jet.data(), order, limits, entries.data())) << source.failure().message;
  return entries;
}

void expect_as_alone(const std::vector<Equation>& equations, int n) {
  Recording together(n);
  std::vector<Term> residuals;
  for (const Equation& equation : equations) residuals.push_back(equation(together));
  TaylorEvaluator all(together.finish(residuals));
  for (const int order : {0, 2, 1}) {
    const Matrix jet = random_matrix(n, order + 2, 7);
    const Numbers of_all = entries_of(all, jet, order);
    for (std::size_t i = 0; i < equations.size(); ++i) {
      Recording recording(n);
      const Term residual = equations[i](recording);
      TaylorEvaluator alone(recording.finish({residual}));
      const Numbers own = entries_of(alone, jet, order);
      const std::size_t first = all.tape().first_target[i], last = all.tape().first_target[i + 1];
      ASSERT_EQ(last - first, alone.tape().targets.size());
      // Operands of sums and products are in the order in which they were recorded first.
      for (std::size_t e = first; e < last; ++e)
        for (std::size_t own_e = 0; own_e < last - first; ++own_e) {
          const Tape::Variable &leaf = all.tape().targets[e], &own_leaf = alone.tape().targets[own_e];
          if (leaf.unknown != own_leaf.unknown || leaf.derivative != own_leaf.derivative) continue;
          for (std::size_t k = 0; k < size(order + 1); ++k)
            EXPECT_NEAR(of_all[e * size(order + 1) + k], own[own_e * size(order + 1) + k], rounding(100));
        }
    }
  }
}

Equation diffusion(int i, double factor) {
  return [i, factor](Recording& r) {
    const Term u = r.x[size(i)], before = r.x[size(i - 1)], after = r.x[size(i + 1)];
    return r.xdot[size(i)] - (factor * u * u * before + r.parameter("p", 0.3) * (before - u * 2.0 + after));
  };
}

TEST(Tape, SharesEdgesOfEquationsOfOneForm) {
  std::vector<Equation> equations;
  for (int i = 1; i < 9; ++i) equations.push_back(diffusion(i, 1.0 + 0.5 * i));
  EXPECT_LE(forms_of(equations, 10), 2u);
  expect_as_alone(equations, 10);
}

// What is a number in one of them varies in the other, so that series of their derivatives are other ones.
TEST(Tape, TellsFormsApart) {
  const std::vector<Equation> equations = {[](Recording& r) { return r.xdot[0] - 2.0 * r.x[1]; },
                                           [](Recording& r) { return r.xdot[0] - r.t * r.x[1]; },
                                           [](Recording& r) { return r.xdot[0] - r.x[0] * r.x[1]; },
                                           [](Recording& r) { return r.xdot[0] + r.x[0] * r.x[1]; },
                                           [](Recording& r) { return r.xdot[0] - sin(r.x[1]); },
                                           [](Recording& r) { return r.xdot[0] - cos(r.x[1]); },
                                           [](Recording& r) { return r.xdot[0] - max(r.x[0], r.x[1]); },
                                           [](Recording& r) { return r.xdot[0] - 3.0 * (r.x[1] + r.x[0] * r.x[0]); },
                                           [](Recording& r) { return r.xdot[0] - r.t * (r.x[1] + r.x[0] * r.x[0]); }};
  expect_as_alone(equations, 2);
  std::vector<Equation> twice = equations;
  twice.insert(twice.end(), equations.begin(), equations.end());
  EXPECT_EQ(forms_of(twice, 2), forms_of(equations, 2));
}

TEST(InstructionList, KeepsTheOrder) {
  const std::vector<Instruction> instructions = {
      {Code::add, 3, 1, 2, 0, 0, 0},   {Code::add, 4, 3, 2, 0, 0, 0},      {Code::sin_cos, 5, 4, 0, 0, 6, 0},
      {Code::sqrt, 7, 3, 0, 0, 8, 0},  {Code::multiply, 9, 5, 7, 0, 0, 0}, {Code::choose, 10, 9, 5, 7, 0, 0},
      {Code::scale, 11, 9, 1, 0, 0, 0}};
  InstructionList list;
  for (const Instruction& instruction : instructions) list.push_back(instruction);
  for (const int stride : {1, 3}) {
    const std::vector<Instruction> all = list.in_offsets(stride).all();
    ASSERT_EQ(all.size(), instructions.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      EXPECT_EQ(all[k].code, instructions[k].code);
      for (const auto slot :
           {&Instruction::v, &Instruction::a, &Instruction::b, &Instruction::c, &Instruction::p, &Instruction::q})
        EXPECT_EQ(all[k].*slot, stride * instructions[k].*slot);
    }
  }
}

TEST(Record, KeepsAllOperandsOfNodes) {
  Recording recording(3);
  const auto& x = recording.x;
  const std::vector<Term> residuals = {choose(x[0], x[1], x[2]) + recording.xdot[0],
                                       choose(x[1] * x[2], sin(x[0]), 2.0) - recording.xdot[1],
                                       max(x[0], max(x[1], x[2])) * recording.t};
  std::vector<Node> nodes;
  for (int i = 0; i < recording.recorder.num_nodes(); ++i) nodes.push_back(recording.recorder.node(i));
  const std::shared_ptr<const Record> record = recording.finish(residuals);
  ASSERT_EQ(record->num_nodes(), static_cast<int>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node node = record->node(static_cast<int>(i));
    EXPECT_EQ(node.operation, nodes[i].operation);
    const Operands operands = record->operands(static_cast<int>(i));
    for (int k = 0; k < operands.size(); ++k)
      EXPECT_EQ(operands[k], k == 0 ? nodes[i].a : k == 1 ? nodes[i].b : nodes[i].c);
  }
}

// Operands are kept in as many bytes as the largest one needs.
TEST(Nodes, HaveOperandsOfAnySize) {
  for (const int largest : {0, 254, 0xfffe, 0xffff, 0x10000, 0xfffffe, 0xffffff, 0x7ffffffe}) {
    const std::vector<Node> given = {{Operation::unknown, 0},
                                     {Operation::add, largest, largest / 3},
                                     {Operation::sin, largest / 257},
                                     {Operation::choose, 1, largest, largest / 2},
                                     {Operation::add, std::min(largest, 0xffff), std::min(largest, 255)}};
    const Nodes nodes(given);
    ASSERT_EQ(nodes.size(), given.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
      EXPECT_EQ(nodes[i].operation, given[i].operation);
      EXPECT_EQ(nodes[i].a, given[i].a) << largest;
      EXPECT_EQ(nodes[i].b, given[i].b) << largest;
      EXPECT_EQ(nodes[i].c, given[i].c) << largest;
    }
  }
}

}  // namespace

}  // namespace sfdae::core
