// SPDX-License-Identifier: BSD-3-Clause
#include "json.h"

#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace sfdae_test {

namespace {

class Reader {
 public:
  explicit Reader(std::string_view source) : source_(source) {}

  Json document() {
    Json value = any();
    if (peek() != '\0') fail("text after the end");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("JSON, character " + std::to_string(at_) + ": " + what);
  }
  char peek() {
    while (at_ < source_.size() && std::isspace(static_cast<unsigned char>(source_[at_]))) ++at_;
    return at_ < source_.size() ? source_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(std::string("expected ") + c);
  }

  Json any() {
    switch (peek()) {
      case '{': return object();
      case '[': return list();
      case '"': {
        Json value{.kind = Json::Kind::text};
        value.text = text();
        return value;
      }
      case 'n': return null();
      default: return number();
    }
  }
  Json null() {
    if (source_.substr(at_, 4) != "null") fail("expected null");
    at_ += 4;
    return {};
  }
  Json number() {
    const std::string digits(source_.substr(at_, source_.find_first_not_of("+-.0123456789eE", at_) - at_));
    char* end = nullptr;
    Json value{.kind = Json::Kind::number};
    value.number = std::strtod(digits.c_str(), &end);
    if (digits.empty() || *end != '\0') fail("expected a value");
    at_ += digits.size();
    return value;
  }
  std::string text() {
    expect('"');
    const std::size_t end = source_.find('"', at_);
    if (end == std::string_view::npos) fail("unfinished string");
    std::string content(source_.substr(at_, end - at_));
    if (content.find('\\') != std::string::npos) fail("escapes are not supported");
    at_ = end + 1;
    return content;
  }
  Json list() {
    Json value{.kind = Json::Kind::list};
    expect('[');
    if (take(']')) return value;
    do value.items.push_back(any());
    while (take(','));
    expect(']');
    return value;
  }
  Json object() {
    Json value{.kind = Json::Kind::object};
    expect('{');
    if (take('}')) return value;
    do {
      if (peek() != '"') fail("expected a name");
      std::string key = text();
      expect(':');
      value.members.emplace_back(std::move(key), any());
    } while (take(','));
    expect('}');
    return value;
  }

  std::string_view source_;
  std::size_t at_ = 0;
};

}  // namespace

const Json* Json::find(std::string_view key) const {
  for (const auto& [name, value] : members)
    if (name == key) return &value;
  return nullptr;
}

const Json& Json::at(std::string_view key) const {
  const Json* value = find(key);
  if (value == nullptr) throw std::runtime_error("JSON: no member " + std::string(key));
  return *value;
}

Json read_json(std::string_view source) { return Reader(source).document(); }

Json read_json_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return read_json(std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace sfdae_test
