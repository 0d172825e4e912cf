// Source text of an exported system.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/model_source.h"

#include <cctype>
#include <functional>

#include "linalg/format.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Leaves out characters that would end a comment, or continue its line.
std::string in_comment(const std::string& text) {
  std::string safe;
  for (char c : text)
    if (c != '*' && c != '\\' && c != '?' && static_cast<unsigned char>(c) >= ' ') safe += c;
  return safe;
}

class SourceWriter {
 public:
  SourceWriter(const ExportedSystem& system, const SourceRequest& request)
      : system_(system), request_(request), is_c_(request.language == Language::C) {}

  std::string write() {
    // The functions determine which helpers are needed.
    const std::string functions = start() + residual() + jacobian();
    return heading() + (is_c_ ? c_declarations() : fortran_declarations()) + functions + ending();
  }

 private:
  Language language() const { return request_.language; }
  const char* name() const { return request_.name.c_str(); }
  std::string at(const char* word, int i) const { return element(word, i, language()); }
  // Numbers of equations and unknowns as the language counts.
  int counted(int i) const { return is_c_ ? i : i + 1; }
  void say(std::string& text, const std::string& line) const {
    text += is_c_ ? " *" : "!";
    text += line.empty() ? "\n" : " " + line + "\n";
  }

  std::string name_of_unknown(const ExportedSystem::Unknown& z) const {
    const std::string x = at("x", z.unknown);
    return z.order <= 3 ? x + std::string(index(z.order), '\'') : x + format("^(%d)", z.order);
  }

  std::string heading() const {
    std::string text = is_c_ ? "/*\n" : "";
    const CharacteristicValues& values = request_.values;
    const int size = system_.size();
    say(text,
        format("%s: F(t, z, z') = 0, a strangeness-free system of %d equations, written by sfdae.", name(), size));
    say(text, "");
    say(text,
        format("It has the solutions of the %d recorded equations of strangeness index %d, d = %d, a = %d. These",
               values.d + values.a, values.mu, values.d, values.a));
    say(text,
        "and those of their derivatives that constrain the solution are all among F. Derivatives of unknowns that");
    say(text,
        "are entries of z are algebraic unknowns; only z' of the states is in F. Codes for implicit systems of");
    say(text, "differentiation index 1 (of the kind of DASSL or IDA) can integrate it.");
    say(text, "");
    say(text, "It was made at t = " + format("%.10g", system_.t) +
                  " and holds as long as the derivatives of F by z' of the");
    say(text, "states and by the other unknowns together form a regular matrix; where that becomes singular, other");
    say(text, "states are to be chosen: export the model again there.");
    say(text, "");
    for (int i = 0; i < size; ++i) {
      const ExportedSystem::Unknown& z = system_.unknowns[index(i)];
      say(text, at("z", i) + "  " + name_of_unknown(z) + (z.is_state ? ", state" : ""));
    }
    for (int i = 0; i < size; ++i) {
      const ExportedSystem::Equation& f = system_.equations[index(i)];
      const std::string count = f.order == 1 ? "once" : f.order == 2 ? "twice" : format("%d times", f.order);
      const std::string equation =
          request_.equation_names.appended_to(format("equation %d", counted(f.equation)), f.equation);
      say(text, at("r", i) + "  " + in_comment(equation) + (f.order > 0 ? ", differentiated " + count : ""));
    }
    const std::vector<Parameter>& parameters = system_.formulas->parameters();
    for (std::size_t i = 0; i < parameters.size(); ++i)
      say(text, at("p", static_cast<int>(i)) + "  " + in_comment(parameters[i].name));
    return text + (is_c_ ? " */\n" : "");
  }

  int num_parameters() const { return static_cast<int>(system_.formulas->parameters().size()); }

  std::string integers(const std::function<int(int)>& value) const {
    std::string list;
    for (int i = 0; i < system_.size(); ++i) list += (i > 0 ? ", " : "") + std::to_string(value(i));
    return list;
  }

  // Calls write(name, values) for each table.
  std::string tables(const std::function<std::string(const char*, const std::string&)>& write) const {
    const auto& z = system_.unknowns;
    return write("unknown", integers([&](int i) { return counted(z[index(i)].unknown); })) +
           write("order", integers([&](int i) { return z[index(i)].order; })) +
           write("is_state", integers([&](int i) { return z[index(i)].is_state ? 1 : 0; }));
  }

  std::string c_declarations() const {
    std::string text = "#include <math.h>\n\n";
    text += "/* Numbers of equations, of states, of parameters; mu, d, a of the recorded equations. */\n";
    text += format(
        "enum {\n  %s_size = %d,\n  %s_num_states = %d,\n  %s_num_parameters = %d,\n  %s_mu = %d,\n"
        "  %s_d = %d,\n  %s_a = %d\n};\n\n",
        name(), system_.size(), name(), system_.num_states(), name(), num_parameters(), name(), request_.values.mu,
        name(), request_.values.d, name(), request_.values.a);
    text += "/* z[i] is derivative order[i] of x[unknown[i]]; is_state[i]: z'[i] is in F. */\n";
    text += tables([this](const char* table, const std::string& list) {
      return wrapped(format("const int %s_%s[%d] = {", name(), table, system_.size()) + list + "};", language()) +
             "\n";
    });
    text += format("\nvoid %s_start(double *t, double *z, double *zdot, double *p);\n", name());
    text += format("void %s_residual(double t, const double *z, const double *zdot, const double *p, double *r);\n",
                   name());
    text += format(
        "void %s_jacobian(double t, const double *z, const double *zdot, const double *p,\n"
        "    double *F_zdot, double *F_z);\n",
        name());
    if (helpers_.modulo)
      text +=
          "\n/* a - b floor(a / b) */\nstatic double modulo_of(double a, double b)\n{\n  const double r = fmod(a, "
          "b);\n"
          "  return r != 0.0 && (r < 0.0) != (b < 0.0) ? r + b : r;\n}\n";
    return text;
  }

  std::string fortran_declarations() const {
    std::string text = format("module %s_model\n  implicit none\n  private\n", name());
    text += format("  public :: %s_start, %s_residual, %s_jacobian\n\n", name(), name(), name());
    text += "  integer, parameter, private :: dp = kind(1.0d0)\n";
    text += "  !> Numbers of equations, of states, of parameters; mu, d, a of the recorded equations.\n";
    const std::pair<const char*, int> numbers[] = {{"size", system_.size()},
                                                   {"num_states", system_.num_states()},
                                                   {"num_parameters", num_parameters()},
                                                   {"mu", request_.values.mu},
                                                   {"d", request_.values.d},
                                                   {"a", request_.values.a}};
    for (const auto& [number, value] : numbers)
      text += format("  integer, parameter, public :: %s_%s = %d\n", name(), number, value);
    text += "  !> z(i) is derivative order(i) of x(unknown(i)); is_state(i): z'(i) is in F.\n";
    text += tables([this](const char* table, const std::string& list) {
      return wrapped(
                 format("  integer, parameter, public :: %s_%s(%d) = [", name(), table, system_.size()) + list + "]",
                 language()) +
             "\n";
    });
    return text + "\ncontains\n";
  }

  std::string ending() const {
    if (is_c_) return "";
    const std::string floor_of =
        "\n  !> The largest integer up to a.\n  elemental function floor_of(a)\n    real(dp), intent(in) :: a\n"
        "    real(dp) :: floor_of\n\n    floor_of = aint(a) - merge(1.0_dp, 0.0_dp, a < aint(a))\n"
        "  end function floor_of\n";
    return (helpers_.floor ? floor_of : "") + format("end module %s_model\n", name());
  }

  std::string start() const {
    std::string text, statements;
    const std::string indent = is_c_ ? "  " : "    ", end = is_c_ ? ";\n" : "\n";
    const auto assign = [&](const std::string& target, double value) {
      statements += indent + target + " = " + source_of(value, language()) + end;
    };
    assign(is_c_ ? "*t" : "t", system_.t);
    for (int i = 0; i < system_.size(); ++i) assign(at("z", i), system_.z[index(i)]);
    for (int i = 0; i < system_.size(); ++i) assign(at("zdot", i), system_.zdot[index(i)]);
    for (int i = 0; i < num_parameters(); ++i) assign(at("p", i), system_.formulas->parameters()[index(i)].value);
    if (is_c_) {
      text = format(
          "\n/* The point at which this was made, and the parameters there. */\n"
          "void %s_start(double *t, double *z, double *zdot, double *p)\n{\n",
          name());
      return text + (num_parameters() == 0 ? "  (void)p;\n" : "") + statements + "}\n";
    }
    text = format(
        "\n  !> The point at which this was made, and the parameters there.\n"
        "  pure subroutine %s_start(t, z, zdot, p)\n",
        name());
    text += "    real(dp), intent(out) :: t\n";
    text += format("    real(dp), intent(out) :: z(%s_size), zdot(%s_size)\n", name(), name());
    text += format("    real(dp), intent(out) :: p(%s_num_parameters)\n\n", name());
    if (num_parameters() == 0) statements += "    p = [real(dp) ::]\n";
    return text + statements + format("  end subroutine %s_start\n", name());
  }

  // Statements for arguments that no formula contains.
  std::string unused(const Statements& statements) const {
    std::string text;
    const std::pair<char, const char*> all[] = {{'t', "t"}, {'z', "z"}, {'d', "zdot"}, {'p', "p"}};
    for (const auto& [mark, argument] : all) {
      if (statements.uses_values_of(mark)) continue;
      text += is_c_ ? format("  (void)%s;\n", argument)
                    : format("    associate (unused => %s)\n    end associate\n", argument);
    }
    return text;
  }

  std::string fortran_arguments(int num_values) const {
    std::string text = "    real(dp), intent(in) :: t\n";
    text += format("    real(dp), intent(in) :: z(%s_size), zdot(%s_size)\n", name(), name());
    text += format("    real(dp), intent(in) :: p(%s_num_parameters)\n", name());
    if (num_values > 0) text += format("    real(dp) :: v(%d)\n", num_values);
    return text;
  }

  std::string residual() {
    std::vector<Assignment> assignments;
    for (int i = 0; i < system_.size(); ++i) assignments.push_back({at("r", i), system_.formulas->residual(i)});
    const Statements statements = statements_of(*system_.formulas, assignments, language(), helpers_);
    const std::string body = unused(statements) + statements.text;
    if (is_c_)
      return format(
                 "\n/* r = F(t, z, z') */\n"
                 "void %s_residual(double t, const double *z, const double *zdot, const double *p, double *r)\n{\n",
                 name()) +
             body + "}\n";
    return format("\n  !> r = F(t, z, z')\n  pure subroutine %s_residual(t, z, zdot, p, r)\n", name()) +
           fortran_arguments(statements.num_values) + format("    real(dp), intent(out) :: r(%s_size)\n\n", name()) +
           body + format("  end subroutine %s_residual\n", name());
  }

  std::string jacobian() {
    std::vector<Assignment> assignments;
    for (std::size_t e = 0; e < system_.partials.size(); ++e) {
      const ExportedSystem::Partial& partial = system_.partials[e];
      const char* const matrix = partial.derivative ? "F_zdot" : "F_z";
      const std::string target = is_c_
                                     ? format("%s[%d + %d * %d]", matrix, partial.row, partial.column, system_.size())
                                     : format("%s(%d, %d)", matrix, partial.row + 1, partial.column + 1);
      assignments.push_back({target, system_.formulas->residual(system_.size() + static_cast<int>(e))});
    }
    const Statements statements = statements_of(*system_.formulas, assignments, language(), helpers_);
    const std::string body = unused(statements) + statements.text;
    if (is_c_)
      return format(
                 "\n/* dF/dz' and dF/dz, by columns: row i, column j is element i + j * %s_size. */\n"
                 "void %s_jacobian(double t, const double *z, const double *zdot, const double *p,\n"
                 "    double *F_zdot, double *F_z)\n{\n"
                 "  int i;\n  for (i = 0; i < %s_size * %s_size; ++i) F_zdot[i] = F_z[i] = 0.0;\n",
                 name(), name(), name(), name()) +
             body + "}\n";
    return format("\n  !> dF/dz' and dF/dz\n  pure subroutine %s_jacobian(t, z, zdot, p, F_zdot, F_z)\n", name()) +
           fortran_arguments(statements.num_values) +
           format("    real(dp), intent(out) :: F_zdot(%s_size, %s_size), F_z(%s_size, %s_size)\n\n", name(), name(),
                  name(), name()) +
           "    F_zdot = 0.0_dp\n    F_z = 0.0_dp\n" + body + format("  end subroutine %s_jacobian\n", name());
  }

  const ExportedSystem& system_;
  const SourceRequest& request_;
  bool is_c_;
  HelpersUsed helpers_;
};

}  // namespace

std::string complaint_about_name(const std::string& name) {
  constexpr std::size_t most = 40;  // of 63 in Fortran, where endings follow
  if (name.empty() || name.size() > most)
    return format("the name has %zu characters, not 1 ... %zu", name.size(), most);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const unsigned char c = static_cast<unsigned char>(name[i]);
    const bool is_letter = c < 128 && std::isalpha(c) != 0, is_other = c < 128 && (std::isdigit(c) != 0 || c == '_');
    if (!is_letter && (i == 0 || !is_other))
      return format("character %zu of the name is not allowed: a letter comes first, letters, digits and _ follow",
                    i + 1);
  }
  return {};
}

std::string source_of(const ExportedSystem& system, const SourceRequest& request) {
  return SourceWriter(system, request).write();
}

}  // namespace sfdae::core
