// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/tables.h"

#include <algorithm>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

enum class Beyond { hold, extend, repeat, forbid };

// The value for u < end and after the ends of the previous pieces; the last piece has no end.
struct Piece {
  double end = 0.0;
  Expression value;
};

class Table {
 public:
  Table(Elaboration& e, const Environment& in, const Call& call) : e_(e), in_(in), call_(call) {
    if (call.arguments.empty() || call.arguments[0].value.kind != Kind::function ||
        call.arguments[0].value.records.empty())
      e.fail(call.at, "a table whose object is not known; give it a binding");
    object_ = &call.arguments[0].value.records[0];
    const Value& table = field("table");
    if (!table.is_numeric() || table.dims.size() != 2 || table.scalars.empty())
      e.fail(call.at, "a table whose data do not stand in the model (on a file, or none); write them into the model");
    rows_ = static_cast<size_t>(table.dims[0]);
    columns_ = static_cast<size_t>(table.dims[1]);
    table_ = &table;
    is_constant_ = literal("smoothness", "LinearSegments") == "ConstantSegments";
    const std::string smoothness = literal("smoothness", "LinearSegments");
    if (!is_constant_ && smoothness != "LinearSegments")
      e.fail(call.at, "a table with the smoothness '" + smoothness +
                          "'; only LinearSegments and ConstantSegments are supported");
    const std::string beyond = literal("extrapolation", "LastTwoPoints");
    beyond_ = beyond == "HoldLastPoint"     ? Beyond::hold
              : beyond == "Periodic"        ? Beyond::repeat
              : beyond == "NoExtrapolation" ? Beyond::forbid
                                            : Beyond::extend;
  }

  Expression of_one(const Expression& u) {
    std::vector<Expression> y;
    const size_t column = column_of(call_, 1);
    for (size_t i = 0; i < rows_; ++i) y.push_back(at(i, column));
    return interpolate(abscissas(0, true), y, u);
  }

  // 0 before the start; then shifted in time.
  Expression of_time(const Expression& t) {
    const Expression start = scalar_field("startTime"),
                     shift = object_->find("shiftTime") ? scalar_field("shiftTime") : start;
    const Expression value = of_one(make(Operation::subtract, t, shift));
    return e_.pool.make(Operation::choose, {make(Operation::less, t, start), number(0.0), value}, call_.at);
  }

  // Linear in both; the first row and column are the abscissas.
  Expression of_two(const Expression& u1, const Expression& u2) {
    if (is_constant_ || beyond_ == Beyond::repeat)
      e_.fail(call_.at, "a table of two inputs that is not linear, or periodic; only LinearSegments are supported");
    std::vector<double> across;
    for (size_t j = 1; j < columns_; ++j) across.push_back(abscissa(0, j));
    check_increasing(across, true);
    std::vector<Expression> y;
    for (size_t i = 1; i < rows_; ++i) {
      std::vector<Expression> row;
      for (size_t j = 1; j < columns_; ++j) row.push_back(at(i, j));
      y.push_back(interpolate(across, row, u2));
    }
    return interpolate(abscissas(1, true), y, u1);
  }

  Expression limit(bool is_last) { return number(abscissa(is_last ? rows_ - 1 : 0, 0)); }

  // The next breakpoint after t; a large number after the last one.
  Expression next_event(const Expression& t) {
    const Expression start = scalar_field("startTime"),
                     shift = object_->find("shiftTime") ? scalar_field("shiftTime") : start;
    const Expression u = make(Operation::subtract, t, shift);
    std::vector<Piece> pieces;
    for (const double x : abscissas(0, false)) pieces.push_back({x, make(Operation::add, number(x), shift)});
    pieces.push_back({0.0, number(1e60)});
    return choose_piece(pieces, 0, pieces.size(), u);
  }

 private:
  const Value& field(const std::string& name) {
    const Value* found = object_->find(name);
    if (found == nullptr) e_.fail(call_.at, "a table whose constructor has no input '" + name + "'");
    return *found;
  }

  Expression scalar_field(const std::string& name) {
    const Value& value = field(name);
    if (!value.is_scalar() || !value.is_numeric())
      e_.fail(call_.at, "the input '" + name + "' of a table is " + shown_type(value));
    return value.scalars[0];
  }

  std::string literal(const std::string& name, const std::string& otherwise) {
    const Value* value = object_->find(name);
    if (value == nullptr) return otherwise;
    const std::optional<double> k =
        value->kind == Kind::enumeration && value->is_scalar() ? constant_value(e_, value->scalars[0]) : std::nullopt;
    if (!k || *k < 1.0 || *k > static_cast<double>(value->definition->literals.size()))
      e_.fail(call_.at, "the input '" + name + "' of a table is not constant");
    return plain(value->definition->literals[static_cast<size_t>(*k) - 1].name);
  }

  size_t column_of(const Call& call, size_t argument) {
    const int k = integer_argument(e_, call, argument);
    const Value& columns = field("columns");
    if (k < 1 || columns.dims.size() != 1 || k > columns.dims[0])
      e_.fail(call.at, "a column that the table does not have");
    const std::optional<double> column = constant_value(e_, columns.scalars[static_cast<size_t>(k) - 1]);
    if (!column || *column < 1.0 || *column > static_cast<double>(columns_))
      e_.fail(call.at, "a column that the table does not have");
    return static_cast<size_t>(*column) - 1;
  }

  const Expression& at(size_t i, size_t j) const { return table_->scalars[i * columns_ + j]; }

  double abscissa(size_t i, size_t j) {
    const std::optional<double> x = constant_value(e_, at(i, j));
    if (!x) e_.fail(call_.at, "a table whose abscissas vary; use constants and parameters");
    return *x;
  }

  void check_increasing(const std::vector<double>& x, bool is_strict) {
    if (x.empty()) e_.fail(call_.at, "a table without data");
    for (size_t k = 1; k < x.size(); ++k)
      if (x[k] < x[k - 1] || (is_strict && x[k] == x[k - 1] && !is_of_time()))
        e_.fail(call_.at, "the abscissas of a table do not increase");
  }

  bool is_of_time() const { return object_->find("startTime") != nullptr; }

  std::vector<double> abscissas(size_t first, bool is_strict) {
    std::vector<double> x;
    for (size_t i = first; i < rows_; ++i) x.push_back(abscissa(i, 0));
    check_increasing(x, is_strict);
    return x;
  }

  Expression number(double value) { return e_.pool.number(value, call_.at); }
  Expression make(Operation operation, const Expression& a, const Expression& b) {
    return operate(e_, operation, {a, b}, {call_.at});
  }

  // Selects among pieces[first] to pieces[last - 1] by bisection.
  Expression choose_piece(const std::vector<Piece>& pieces, size_t first, size_t last, const Expression& u) {
    if (last - first == 1) return pieces[first].value;
    const size_t middle = (first + last) / 2;
    const Expression is_before = make(Operation::less, u, number(pieces[middle - 1].end));
    return e_.pool.make(Operation::choose,
                        {is_before, choose_piece(pieces, first, middle, u), choose_piece(pieces, middle, last, u)},
                        call_.at);
  }

  // u moved into the first period.
  Expression wrapped(const std::vector<double>& x, const Expression& u) {
    const double period = x.back() - x.front();
    const Expression ratio = make(Operation::divide, make(Operation::subtract, u, number(x.front())), number(period));
    const Expression count = operate(e_, Operation::floor, {ratio}, {call_.at});
    return make(Operation::subtract, u, make(Operation::multiply, number(period), count));
  }

  void forbid_beyond(const std::vector<double>& x, const Expression& u) {
    Assertion assertion;
    assertion.condition = make(Operation::and_, make(Operation::greater_equal, u, number(x.front())),
                               make(Operation::less_equal, u, number(x.back())));
    assertion.message = "the input of a table is out of range";
    assertion.at = call_.at;
    add_assertion(e_, in_, std::move(assertion));
  }

  Expression interpolate(const std::vector<double>& x, const std::vector<Expression>& y, Expression u) {
    if (x.size() == 1 || x.front() == x.back()) return y.back();
    if (beyond_ == Beyond::repeat) u = wrapped(x, u);
    if (beyond_ == Beyond::forbid) forbid_beyond(x, u);
    std::vector<Piece> pieces;
    if (beyond_ == Beyond::hold) pieces.push_back({x.front(), y.front()});
    for (size_t i = 0; i + 1 < x.size(); ++i) {
      if (x[i] == x[i + 1]) continue;  // a jump
      if (is_constant_) {
        pieces.push_back({x[i + 1], y[i]});
        continue;
      }
      const Expression slope =
          make(Operation::divide, make(Operation::subtract, y[i + 1], y[i]), number(x[i + 1] - x[i]));
      pieces.push_back(
          {x[i + 1],
           make(Operation::add, y[i], make(Operation::multiply, slope, make(Operation::subtract, u, number(x[i]))))});
    }
    if (beyond_ == Beyond::hold || is_constant_) pieces.push_back({0.0, y.back()});
    return choose_piece(pieces, 0, pieces.size(), u);
  }

  Elaboration& e_;
  const Environment& in_;
  const Call& call_;
  const RecordValue* object_ = nullptr;
  const Value* table_ = nullptr;
  size_t rows_ = 0, columns_ = 0;
  bool is_constant_ = false;
  Beyond beyond_ = Beyond::extend;
};

}  // namespace

Value construct_external_object(Elaboration& e, const syntax::Definition& object,
                                const std::vector<Argument>& arguments, Location at) {
  Value result;
  result.kind = Kind::function;
  result.definition = &object;
  result.records.emplace_back();
  size_t position = 0;
  for (const syntax::Declaration& input : object.elements) {
    if (input.direction != syntax::Direction::input) continue;
    const Argument* found =
        position < arguments.size() && arguments[position].name.empty() ? &arguments[position] : nullptr;
    ++position;
    for (const Argument& one : arguments)
      if (!one.name.empty() && plain(one.name) == plain(input.name)) found = &one;
    if (found != nullptr) {
      result.records[0].fields.emplace_back(plain(input.name), found->value);
    } else if (input.binding != nullptr) {
      Environment in;
      in.scope = &e.symbols->package();
      result.records[0].fields.emplace_back(plain(input.name), evaluate(e, in, *input.binding));
    }
  }
  if (position < arguments.size())
    e.fail(at, "more arguments than the constructor of '" + plain(object.name) + "' has inputs");
  return result;
}

std::optional<Value> call_table_function(Elaboration& e, const Environment& in, const Call& call) {
  const std::string prefix = "ModelicaStandardTables_Combi";
  if (call.name.rfind(prefix, 0) != 0) return std::nullopt;
  const std::string name = call.name.substr(prefix.size());
  const auto real = [&](size_t k) { return scalar_argument(e, call, k, Kind::real); };
  const auto result = [](Expression x) { return scalar_value(Kind::real, std::move(x)); };
  if (name == "Table1D_getValue") return check_count(e, call, 3, 3), result(Table(e, in, call).of_one(real(2)));
  if (name == "Table2D_getValue")
    return check_count(e, call, 3, 3), result(Table(e, in, call).of_two(real(1), real(2)));
  if (name == "TimeTable_getValue") return check_count(e, call, 3, 5), result(Table(e, in, call).of_time(real(2)));
  if (name == "TimeTable_nextTimeEvent")
    return check_count(e, call, 2, 2), result(Table(e, in, call).next_event(real(1)));
  if (name == "Table1D_minimumAbscissa" || name == "TimeTable_minimumTime")
    return check_count(e, call, 1, 1), result(Table(e, in, call).limit(false));
  if (name == "Table1D_maximumAbscissa" || name == "TimeTable_maximumTime")
    return check_count(e, call, 1, 1), result(Table(e, in, call).limit(true));
  return std::nullopt;
}

}  // namespace sfdae::cli
