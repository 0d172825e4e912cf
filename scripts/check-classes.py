#!/usr/bin/env python3
"""Fails where a class of src or cli has more than 20 data members of its own.

What is alive together belongs in a type of its own, which is handed to functions as an argument. Static members are
constants and do not count. Without arguments: the check, after one of itself. --all: every class with its number.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("src", "cli")
MOST = 20

TOKEN = re.compile(r"[A-Za-z_]\w*|::|->|\d[\w.']*|[^\s\w]")
OPEN, CLOSE = "([{", ")]}"
NOT_DATA = {"using", "typedef", "friend", "static", "template", "static_assert", "virtual", "explicit", "operator"}


def tokens_of(text):
    """Without comments, preprocessor lines and contents of literals."""
    text = re.sub(r'//[^\n]*|/\*.*?\*/|R"\((.*?)\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'',
                  lambda found: " " if found.group(0).startswith("/") else " 0 ", text, flags=re.S)
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.M)
    return TOKEN.findall(text)


def end_of_group(tokens, at):
    """Behind the bracket that closes the one at `at`."""
    depth = 0
    while at < len(tokens):
        if tokens[at] in OPEN:
            depth += 1
        elif tokens[at] in CLOSE:
            depth -= 1
            if depth == 0:
                return at + 1
        at += 1
    return at


def start_of_body(tokens, at):
    """Of the class whose keyword is at `at`: where its brace is; None where none is defined."""
    if at > 0 and tokens[at - 1] in ("enum", "<", ","):
        return None
    while at < len(tokens) and tokens[at] not in "{;()=":
        at += 1
    return at if at < len(tokens) and tokens[at] == "{" else None


def name_of(tokens, at):
    while tokens[at + 1] == "alignas":
        at = end_of_group(tokens, at + 2) - 1
    return tokens[at + 1] if tokens[at + 1] != "{" else "(unnamed)"


def declarators(statement):
    """How many data members a statement declares, whose groups in braces are left out."""
    if not statement or NOT_DATA & set(statement):
        return 0
    if statement[0] in ("class", "struct", "enum", "union") and "{}" not in statement:
        return 0  # declared only
    depth = angles = 0
    count, is_value = 1, False
    for k, token in enumerate(statement):
        following = statement[k + 1] if k + 1 < len(statement) else ""
        if token == "(" and depth == 0 and angles == 0 and not is_value:
            if following != "*":
                return 0  # a function
            return 1  # a pointer to one
        if token in OPEN:
            depth += 1
        elif token in CLOSE:
            depth -= 1
        elif depth > 0:
            continue
        elif token == "<" and not is_value:
            angles += 1
        elif token == ">" and not is_value:
            angles -= 1
        elif token == "=":
            is_value = True
        elif token == "," and angles == 0:
            count += 1
            is_value = False
        elif token == "{}" and statement[0] in ("class", "struct", "enum", "union") and following == "":
            return 0  # no object of this type
    return count


def members(tokens, at, found):
    """Of the body whose brace is at `at`: the number of data members; classes in it are added to `found`."""
    count, statement, end = 0, [], end_of_group(tokens, at) - 1
    at += 1
    while at < end:
        token = tokens[at]
        if token in ("class", "struct", "union"):
            body = start_of_body(tokens, at)
            if body is not None:
                inside = members(tokens, body, found)
                after = end_of_group(tokens, body)
                if tokens[at + 1] == "{" and tokens[after] == ";":
                    count += inside  # unnamed, without an object of its own: members of this class
                else:
                    found.append((name_of(tokens, at), inside))
                statement += [token, "{}"]
                at = after
                continue
        if token == ";":
            count += declarators(statement)
            statement = []
        elif token == ":" and statement in (["public"], ["private"], ["protected"]):
            statement = []
        elif token == "{":
            after = end_of_group(tokens, at)
            is_function = "(" in statement and declarators(statement) == 0 and "=" not in statement
            is_function = is_function or "operator" in statement
            statement = [] if is_function else statement + ["{}"]
            at = after
            if is_function and at < end and tokens[at] == "{":
                continue
            continue
        elif token == "(":
            after = end_of_group(tokens, at)
            statement += tokens[at:after]
            at = after
            continue
        else:
            statement.append(token)
        at += 1
    return count


def classes(text):
    """(name, number of data members) of all classes."""
    tokens, found, at = tokens_of(text), [], 0
    while at < len(tokens):
        body = start_of_body(tokens, at) if tokens[at] in ("class", "struct", "union") else None
        if body is None:
            at += 1
            continue
        found.append((name_of(tokens, at), members(tokens, body, found)))
        at = end_of_group(tokens, body)
    return found


SAMPLE = """
template <class T>
class Sample final : public Base<T, 3> {
 public:
  Sample(int a, const std::vector<int>& b) : a_(a), b_{b} { if (a < 3) { a_ = 3; } }
  explicit Sample(int);
  const std::vector<int>& rows() const { return rows_; }  // int not_there;
  int value = 0, *first, second[3] = {1, 2, 3};
  static constexpr int most = 3;
  using Type = std::pair<int, int>;
  enum class Kind { one, two } kind = Kind::one;
  enum class Other { one, two };
  struct Inside { int i, j; std::function<void(int, int)> call; };
  std::map<std::string, std::vector<double>> a_, b_{};
  int (*function)(int, void*) = nullptr;
  const char* text = "a; int b;";
  bool operator==(const Sample&) const = default;
  virtual int pure() = 0;
  template <class Action> void each(Action action) { for (int i = 0; i < 3; ++i) action(i); }
  friend class Friend;
  std::array<int, (1 << 3)> array_;
%s};
"""


def check_itself():
    """Fails where the numbers of a sample are not right."""
    more = "".join(f"  int more_{k} = 0;\n" for k in range(12))
    for text, own in ((SAMPLE % "", 9), (SAMPLE % more, 21)):
        found = classes(text)
        if found != [("Inside", 3), ("Sample", own)]:
            sys.exit(f"FAILED: the check of classes counts {found} in its sample of {own}")


def main():
    check_itself()
    found = [(count, name, path.relative_to(ROOT)) for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*"))
             if path.suffix in (".h", ".hpp", ".cpp") for name, count in classes(path.read_text(encoding="utf-8"))]
    if "--all" in sys.argv:
        for count, name, path in sorted(found, key=lambda one: one[0]):
            print(count, name, path)
        return 0
    wrong = [(count, name, path) for count, name, path in found if count > MOST]
    for count, name, path in wrong:
        print(f"{path}: {name} has {count} data members")
    if wrong:
        print(f"FAILED: {len(wrong)} classes have more than {MOST} data members")
        return 1
    print(f"none of {len(found)} classes has more than {MOST} data members")
    return 0


if __name__ == "__main__":
    sys.exit(main())
