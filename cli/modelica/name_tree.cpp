// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/name_tree.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "modelica/arithmetic.h"

namespace sfdae::cli {

namespace {

constexpr size_t kMaxSteps = 100;  // per name; assembling recurses

// "1,2" as numbers; empty for other texts.
std::vector<int> subscripts_of(const std::string& text) {
  std::vector<int> result;
  size_t begin = 0;
  while (begin <= text.size()) {
    const size_t end = std::min(text.find(',', begin), text.size());
    std::string one = text.substr(begin, end - begin);
    one.erase(std::remove(one.begin(), one.end(), ' '), one.end());
    if (one.empty() || one.size() > 7 ||
        !std::all_of(one.begin(), one.end(), [](unsigned char c) { return std::isdigit(c); }))
      return {};
    result.push_back(std::stoi(one));
    begin = end + 1;
  }
  return result;
}

}  // namespace

std::vector<NameTree::Step> NameTree::steps(const std::string& name) {
  std::vector<Step> result;
  std::string member;
  const auto finish = [&] {
    if (!member.empty()) result.push_back({std::exchange(member, ""), {}});
  };
  for (size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '.') {
      finish();
    } else if (name[i] == '[') {
      const size_t end = name.find(']', i);
      std::vector<int> subscripts;
      if (end != name.npos) subscripts = subscripts_of(name.substr(i + 1, end - i - 1));
      if (subscripts.empty()) {
        member += name[i];
        continue;
      }
      finish();
      result.push_back({"", std::move(subscripts)});
      i = end;
    } else {
      member += name[i];
    }
  }
  finish();
  return result;
}

void NameTree::add(const std::string& name, const std::string& key) {
  const std::vector<Step> path = steps(name);
  if (path.size() > kMaxSteps) return;
  Part* part = &root_;
  for (const Step& step : path)
    part = step.member.empty() ? &part->elements[step.subscripts] : &part->members[step.member];
  part->key = key;
}

std::optional<Value> NameTree::find(Elaboration& e, const std::string& name, Location at,
                                    const Lookup& lookup) const {
  const std::vector<Step> path = steps(name);
  const Part* part = &root_;
  for (size_t k = 0; k < path.size(); ++k) {
    if (!part->key.empty()) {
      const ValuePointer value = lookup(part->key);
      return value ? descend(e, *value, path, k, at) : std::nullopt;
    }
    if (path[k].member.empty()) {
      const auto found = part->elements.find(path[k].subscripts);
      if (found == part->elements.end()) return std::nullopt;
      part = &found->second;
    } else {
      const auto found = part->members.find(path[k].member);
      if (found == part->members.end()) return std::nullopt;
      part = &found->second;
    }
  }
  return assemble(e, *part, at, lookup);
}

Value NameTree::assemble(Elaboration& e, const Part& part, Location at, const Lookup& lookup) {
  e.charge(1, at);
  if (!part.key.empty()) return *lookup(part.key);
  if (!part.elements.empty()) return assemble_array(e, part, at, lookup);
  Value result;
  result.kind = Kind::record;
  result.records.emplace_back();
  for (const auto& [name, member] : part.members)
    result.records[0].fields.emplace_back(name, assemble(e, member, at, lookup));
  return result;
}

Value NameTree::assemble_array(Elaboration& e, const Part& part, Location at, const Lookup& lookup) {
  std::vector<int> dims(part.elements.begin()->first.size(), 0);
  for (const auto& [subscripts, element] : part.elements) {
    if (subscripts.size() != dims.size())
      e.fail(at, "an array whose declared elements have different numbers of subscripts");
    for (size_t k = 0; k < dims.size(); ++k) dims[k] = std::max(dims[k], subscripts[k]);
  }
  check_dims(e, dims, at);
  // If no subscript is missing or 0, there are product(dims) elements, sorted by rows.
  if (product(dims) != part.elements.size() ||
      *std::min_element(part.elements.begin()->first.begin(), part.elements.begin()->first.end()) < 1)
    e.fail(at, "an array of which not all elements are declared; declare all or name single ones");
  std::vector<Value> elements;
  for (const auto& [subscripts, element] : part.elements) elements.push_back(assemble(e, element, at, lookup));
  Value result = array_of(e, elements, at);
  dims.insert(dims.end(), elements[0].dims.begin(), elements[0].dims.end());
  result.dims = std::move(dims);
  return result;
}

std::optional<Value> NameTree::descend(Elaboration& e, Value value, const std::vector<Step>& rest, size_t first,
                                       Location at) {
  for (size_t k = first; k < rest.size(); ++k) {
    if (!rest[k].member.empty()) {
      if (value.kind != Kind::record || !value.is_scalar()) return std::nullopt;
      const Value* field = value.records[0].find(rest[k].member);
      if (field == nullptr) return std::nullopt;
      value = Value(*field);
      continue;
    }
    if (rest[k].subscripts.size() != value.dims.size()) return std::nullopt;
    size_t position = 0;
    for (size_t d = 0; d < value.dims.size(); ++d) {
      const int i = rest[k].subscripts[d];
      if (i < 1 || i > value.dims[d]) e.fail(at, "the subscript " + std::to_string(i) + " is out of range");
      position = position * static_cast<size_t>(value.dims[d]) + static_cast<size_t>(i - 1);
    }
    value = element(value, position);
  }
  return value;
}

}  // namespace sfdae::cli
