// Parser of flat Modelica by recursive descent (grammar: MCP-0031, with the deviations of OpenModelica's exports).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modelica/syntax_tree.h"
#include "modelica/token_stream.h"

namespace sfdae::cli {

// A whole file: package 'M' ... end 'M'; text after it is ignored. All throw ModelError.
syntax::File parse_file(const std::string& text, const std::string& file);

syntax::ExpressionPointer parse_expression(TokenStream& tokens);
// [ ... ] after names and types.
std::vector<syntax::ExpressionPointer> parse_subscripts(TokenStream& tokens);
// 'A'.'B' as one name 'A.B'.
std::string parse_dotted_name(TokenStream& tokens, std::string_view where);

// Equations or statements, up to a word that cannot begin one.
std::vector<syntax::Statement> parse_statements(TokenStream& tokens, bool is_algorithm);
// "comment" and annotation(...); returns the text of the comment.
std::string parse_comment(TokenStream& tokens);
std::vector<syntax::Modification> parse_modifications(TokenStream& tokens);

// Appends the declarations of one element: Type 'a'[n](start = 1) = 2 "comment", 'b'
void parse_element(TokenStream& tokens, std::vector<syntax::Declaration>& declarations);
bool at_definition(const TokenStream& tokens);
syntax::Definition parse_definition(TokenStream& tokens);

}  // namespace sfdae::cli
