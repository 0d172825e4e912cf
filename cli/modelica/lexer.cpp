// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/lexer.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace sfdae::cli {

namespace {

constexpr std::array<std::string_view, 47> kKeywords = {
    "algorithm", "and",       "annotation",   "break",     "class",       "constant", "discrete", "each",
    "else",      "elseif",    "elsewhen",     "end",       "enumeration", "equation", "extends",  "external",
    "false",     "final",     "flow",         "for",       "function",    "if",       "impure",   "in",
    "initial",   "input",     "loop",         "model",     "not",         "operator", "or",       "output",
    "package",   "parameter", "partial",      "partition", "protected",   "public",   "pure",     "record",
    "return",    "stream",    "subpartition", "then",      "true",        "type",     "when"};

constexpr std::array<std::string_view, 27> kSymbols = {":=", "==", "<>", "<=", ">=", ".+", ".-", ".*", "./",
                                                       ".^", "+",  "-",  "*",  "/",  "^",  "<",  ">",  "=",
                                                       "(",  ")",  "[",  "]",  "{",  "}",  ",",  ";",  ":"};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Tokens run() {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") text_.remove_prefix(3);  // a byte order mark
    read_version();
    for (;;) {
      if (!skip_blanks()) return finish(invalid("a comment /* is not closed; add */"));
      const Token token = next();
      result_.tokens.push_back(token);
      if (token.kind == TokenKind::end || token.kind == TokenKind::invalid) return std::move(result_);
    }
  }

 private:
  Tokens finish(Token last) {
    result_.tokens.push_back(std::move(last));
    return std::move(result_);
  }

  char peek(size_t ahead = 0) const { return i_ + ahead < text_.size() ? text_[i_ + ahead] : '\0'; }
  bool at_end() const { return i_ >= text_.size(); }

  char take() {
    const char c = text_[i_++];
    if (c == '\n') {
      ++at_.line;
      at_.column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) {  // not a continuation byte of UTF-8
      ++at_.column;
    }
    return c;
  }

  Token invalid(const std::string& what) const { return {TokenKind::invalid, what, at_}; }

  void read_version() {
    constexpr std::string_view mark = "//! base ";
    if (text_.substr(0, mark.size()) != mark) return;
    const size_t end = text_.find_first_of("\r\n", mark.size());
    result_.version = std::string(text_.substr(mark.size(), end == text_.npos ? text_.npos : end - mark.size()));
  }

  // False if a comment is not terminated.
  bool skip_blanks() {
    while (!at_end()) {
      const char c = peek();
      if (c == ' ' || (c >= '\t' && c <= '\r')) {
        take();
      } else if (c == '/' && peek(1) == '/') {
        while (!at_end() && peek() != '\n') take();
      } else if (c == '/' && peek(1) == '*') {
        const Location begin = at_;
        take(), take();
        while (!at_end() && !(peek() == '*' && peek(1) == '/')) take();
        if (at_end()) {
          at_ = begin;
          return false;
        }
        take(), take();
      } else {
        break;
      }
    }
    return true;
  }

  Token next() {
    if (at_end()) return {TokenKind::end, "the end of the file", at_};
    const char c = peek();
    if (is_letter(c)) return word();
    if (c == '\'') return quoted();
    if (is_digit(c)) return number();
    if (c == '"') return text();
    for (const std::string_view symbol : kSymbols)
      if (text_.substr(i_, symbol.size()) == symbol) return take_symbol(symbol.size());
    if (c == '.' || c == '@') return take_symbol(1);
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7F)
      return invalid("a character that is not allowed outside of strings and comments (byte " +
                     std::to_string(static_cast<int>(static_cast<unsigned char>(c))) + "); remove it");
    return invalid(std::string("'") + c + "' is not a token of the language; remove it");
  }

  Token take_symbol(size_t size) {
    Token token{TokenKind::symbol, std::string(text_.substr(i_, size)), at_};
    for (size_t k = 0; k < size; ++k) take();
    return token;
  }

  Token word() {
    Token token{TokenKind::identifier, "", at_};
    while (!at_end() && (is_letter(peek()) || is_digit(peek()))) token.text += take();
    if (std::find(kKeywords.begin(), kKeywords.end(), token.text) != kKeywords.end() || token.text == "while")
      token.kind = TokenKind::keyword;
    return token;
  }

  Token quoted() {
    Token token{TokenKind::identifier, "'", at_};
    take();
    while (!at_end() && peek() != '\'' && peek() != '\n') {
      if (peek() == '\\') take();
      if (!at_end()) token.text += take();
    }
    if (at_end() || peek() == '\n') {
      at_ = token.at;
      return invalid("a quoted name is not closed in its line; add '");
    }
    take();
    if (token.text.size() == 1) {
      at_ = token.at;
      return invalid("a quoted name is empty; give it a name");
    }
    return token;
  }

  Token number() {
    Token token{TokenKind::integer, "", at_};
    while (is_digit(peek())) token.text += take();
    if (peek() == '.') {
      token.kind = TokenKind::real;
      token.text += take();
      while (is_digit(peek())) token.text += take();
    }
    const size_t sign = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
    if ((peek() == 'e' || peek() == 'E') && is_digit(peek(1 + sign))) {
      token.kind = TokenKind::real;
      for (size_t k = 0; k < 1 + sign; ++k) token.text += take();
      while (is_digit(peek())) token.text += take();
    }
    if (is_letter(peek())) return invalid("a letter follows a number; separate them");
    return token;
  }

  Token text() {
    Token token{TokenKind::text, "", at_};
    take();
    while (!at_end() && peek() != '"') {
      char c = take();
      if (c == '\\' && !at_end()) {
        const std::string_view codes = "abfnrtv", values = "\a\b\f\n\r\t\v";
        c = take();
        if (const size_t k = codes.find(c); k != codes.npos) c = values[k];
      }
      token.text += c;
    }
    if (at_end()) {
      at_ = token.at;
      return invalid("a string is not closed; add \"");
    }
    take();
    return token;
  }

  std::string_view text_;
  size_t i_ = 0;
  Location at_{1, 1};
  Tokens result_;
};

}  // namespace

Tokens tokenize(std::string_view text) { return Lexer(text).run(); }

std::string plain(const std::string& identifier) {
  return !identifier.empty() && identifier[0] == '\'' ? identifier.substr(1) : identifier;
}

}  // namespace sfdae::cli
