// A self-contained page. page.html, curves.js and reports.js are compiled into the program.
// SPDX-License-Identifier: BSD-3-Clause
#include "program/page.h"

#include "program/presentation.h"

namespace sfdae::cli {

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

std::string escaped(const std::string& text) { return replaced(replaced(text, "&", "&amp;"), "<", "&lt;"); }

// JSON contains '<' only in strings; escaping it prevents texts from closing the enclosing element.
std::string embedded(const std::string& json) { return replaced(json, "<", "\\u003c"); }

// The page with the first occurrence of `what` replaced.
std::string with(const std::string& page, const std::string& what, const std::string& by) {
  const std::size_t at = page.find(what);
  return page.substr(0, at) + by + page.substr(at + what.size());
}

}  // namespace

std::string html_text(const Presentation& presentation) {
  // In this order, no inserted text can contain a later placeholder before its place.
  std::string page = with(page_html, "{{script}}", page_script);
  page = with(page, "{{data}}", embedded(json_text(presentation)));
  return with(page, "{{title}}", escaped(presentation.model.name) + " - sfdae");
}

}  // namespace sfdae::cli
