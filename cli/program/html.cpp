// A page with everything in it. page.html, curves.js and reports.js are part of the program.
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

// JSON has '<' within strings only; without it no text can end the element that it stands in.
std::string embedded(const std::string& json) { return replaced(json, "<", "\\u003c"); }

// Text before and after the first place where `what` stands.
std::string with(const std::string& page, const std::string& what, const std::string& by) {
  const std::size_t at = page.find(what);
  return page.substr(0, at) + by + page.substr(at + what.size());
}

}  // namespace

std::string html_text(const Presentation& presentation) {
  // In this order no text that is filled in can contain what is looked for next before its place.
  std::string page = with(page_html, "{{script}}", page_script);
  page = with(page, "{{data}}", embedded(json_text(presentation)));
  return with(page, "{{title}}", escaped(presentation.model.name) + " - sfdae");
}

}  // namespace sfdae::cli
