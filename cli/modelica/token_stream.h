// The tokens of a file, consumed in order by the parser.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "modelica/lexer.h"
#include "modelica/syntax_tree.h"

namespace sfdae::cli {

class TokenStream {
 public:
  // Omits tokens @ 17, which give positions in the user's model.
  TokenStream(std::string file, Tokens tokens);

  const Token& peek(size_t ahead = 0) const;
  bool at(std::string_view word, size_t ahead = 0) const { return peek(ahead).is(word); }
  bool at_identifier() const { return peek().kind == TokenKind::identifier; }
  Location location() const { return peek().at; }

  Token take();
  bool accept(std::string_view word);
  // where: the construct being read, for the message.
  Location expect(std::string_view word, std::string_view where);
  Token expect_identifier(std::string_view where);
  // Skips ( ... ).
  void skip_parentheses();

  [[noreturn]] void fail(Location at, const std::string& text) const;
  [[noreturn]] void fail_here(std::string_view expected, std::string_view where) const;
  void warn(Location at, const std::string& text) { warnings_.push_back({at, text}); }
  std::vector<syntax::Warning>& warnings() { return warnings_; }

  // Nesting of expressions, statements and modifications; its limit prevents stack overflow.
  class Nesting {
   public:
    explicit Nesting(TokenStream& stream);
    ~Nesting() { --stream_.depth_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;

   private:
    TokenStream& stream_;
  };
  static constexpr int kMaxNesting = 200;

 private:
  std::string file_;
  std::vector<Token> tokens_;
  size_t i_ = 0;
  int depth_ = 0;
  std::vector<syntax::Warning> warnings_;
};

}  // namespace sfdae::cli
