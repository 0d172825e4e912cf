// Tokens of flat Modelica.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/expression.h"

namespace sfdae::cli {

enum class TokenKind {
  identifier,
  integer,
  real,
  text,  // a string
  keyword,
  symbol,   // operators and punctuation
  invalid,  // its text is the error; the last token
  end
};

// The text of an identifier is decoded; that of a quoted one ('x' differs from x) begins with a single quote.
struct Token {
  TokenKind kind = TokenKind::end;
  std::string text;
  Location at;

  bool is(std::string_view word) const {
    return (kind == TokenKind::symbol || kind == TokenKind::keyword) && text == word;
  }
};

struct Tokens {
  std::vector<Token> tokens;  // the last one is `end` or `invalid`
  std::string version;        // from the line "//! base N.N.N"; empty: no such line
};

Tokens tokenize(std::string_view text);

// An identifier without the quote that marks it.
std::string plain(const std::string& identifier);

}  // namespace sfdae::cli
