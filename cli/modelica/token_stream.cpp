// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/token_stream.h"

#include <utility>

#include "model/flat_model.h"

namespace sfdae::cli {

namespace {

std::string shown(const Token& token) {
  switch (token.kind) {
    case TokenKind::end: return token.text;
    case TokenKind::text: return "a string";
    case TokenKind::identifier: return "the name '" + plain(token.text) + "'";
    default: return "'" + token.text + "'";
  }
}

}  // namespace

TokenStream::TokenStream(std::string file, Tokens tokens) : file_(std::move(file)) {
  bool has_decorations = false;
  std::vector<Token>& all = tokens.tokens;
  tokens_.reserve(all.size());
  for (size_t k = 0; k < all.size(); ++k) {
    if (all[k].is("@") && k + 1 < all.size() && all[k + 1].kind == TokenKind::integer) {
      if (!std::exchange(has_decorations, true)) warn(all[k].at, "decorations (@ and a number) are ignored");
      ++k;
    } else {
      tokens_.push_back(std::move(all[k]));
    }
  }
}

const Token& TokenStream::peek(size_t ahead) const {
  return i_ + ahead < tokens_.size() ? tokens_[i_ + ahead] : tokens_.back();
}

Token TokenStream::take() {
  if (i_ + 1 >= tokens_.size()) return tokens_.back();
  return std::move(tokens_[i_++]);
}

bool TokenStream::accept(std::string_view word) {
  if (!at(word)) return false;
  take();
  return true;
}

Location TokenStream::expect(std::string_view word, std::string_view where) {
  const Location here = location();
  if (!accept(word)) fail_here("'" + std::string(word) + "'", where);
  return here;
}

Token TokenStream::expect_identifier(std::string_view where) {
  if (!at_identifier()) fail_here("a name", where);
  return take();
}

void TokenStream::skip_parentheses() {
  const Location begin = location();
  int depth = 0;
  do {
    if (peek().kind == TokenKind::invalid) fail_here("", "");
    if (peek().kind == TokenKind::end) fail(begin, "this '(' is not closed; add ')'");
    if (at("(")) ++depth;
    if (at(")")) --depth;
    take();
  } while (depth > 0);
}

void TokenStream::fail(Location at, const std::string& text) const { throw ModelError(file_, at, text); }

void TokenStream::fail_here(std::string_view expected, std::string_view where) const {
  const Token& token = peek();
  if (token.kind == TokenKind::invalid) fail(token.at, token.text);
  fail(token.at, "expected " + std::string(expected) + " " + std::string(where) + ", found " + shown(token));
}

TokenStream::Nesting::Nesting(TokenStream& stream) : stream_(stream) {
  if (stream_.depth_ >= kMaxNesting)
    stream_.fail(stream_.location(), "nested deeper than " + std::to_string(kMaxNesting) +
                                         " levels; introduce variables for parts of it");
  ++stream_.depth_;
}

}  // namespace sfdae::cli
