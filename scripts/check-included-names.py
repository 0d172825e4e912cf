#!/usr/bin/env python3
"""Fails where a source uses a name without an #include, of its own or of headers that it includes, that declares it.

Precompiled headers, and sources that are compiled together, hide this from compilers. Names are those of the standard library
(std::...), and what headers of the project declare at the beginning of a line: types, functions and constants of one header.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("src", "fortran_bindings/f77", "cli")
ROOTS = ("src", "include", "fortran_bindings", "cli", "cli/modelica", "cli/simulation", "cli/program", "cli/model")

# Of each header what is used; a name of several headers may come from any of them.
STANDARD = {
    "algorithm": "adjacent_find all_of any_of binary_search clamp copy copy_if copy_n count count_if equal equal_range fill fill_n find "
                 "find_if find_if_not find_first_of for_each for_each_n generate generate_n includes is_sorted "
                 "lexicographical_compare lower_bound make_heap max max_element merge min min_element minmax minmax_element mismatch "
                 "next_permutation none_of nth_element partial_sort partition pop_heap push_heap remove remove_if replace reverse "
                 "rotate search set_difference set_intersection set_union shuffle sort stable_partition stable_sort swap_ranges "
                 "transform unique upper_bound move_backward copy_backward iter_swap",
    "array": "array",
    "atomic": "atomic memory_order_relaxed memory_order_acquire memory_order_release",
    "bit": "bit_cast bit_width bit_ceil countl_zero countr_zero has_single_bit popcount",
    "cctype": "isalnum isalpha isdigit isspace isupper islower tolower toupper isxdigit isprint",
    "cerrno": "",
    "cfenv": "feholdexcept feraiseexcept fetestexcept fesetenv fegetenv feclearexcept fenv_t",
    "charconv": "to_chars from_chars chars_format",
    "chrono": "chrono",
    "cmath": "abs acos asin atan atan2 cbrt ceil copysign cos cosh erf exp exp2 expm1 fabs floor fma fmax fmin fmod frexp hypot ilogb "
             "isfinite isgreater isinf isless islessequal isgreaterequal isnan ldexp lgamma llround log log10 log1p log2 logb lround "
             "lrint modf nan nearbyint nextafter pow remainder rint round scalbn signbit sin sinh sqrt tan tanh tgamma trunc",
    "complex": "complex conj polar",
    "concepts": "integral floating_point invocable same_as convertible_to",
    "csignal": "signal raise sig_atomic_t",
    "cstdarg": "va_list",
    "cstddef": "byte max_align_t",
    "cstdint": "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t uintptr_t intptr_t uint_least32_t",
    "cstdio": "FILE fclose fflush fgets fopen fprintf fputc fputs fread fscanf fwrite printf puts remove rename snprintf vsnprintf "
              "vfprintf",
    "cstdlib": "abort atexit atof exit free getenv malloc strtod strtol strtoul system",
    "cstring": "memchr memcmp memcpy memmove memset strchr strcmp strerror strlen strncmp strrchr strstr",
    "deque": "deque",
    "exception": "current_exception exception exception_ptr rethrow_exception terminate uncaught_exceptions make_exception_ptr",
    "filesystem": "filesystem",
    "fstream": "ifstream ofstream fstream",
    "functional": "bit_and bit_or function greater hash less minus multiplies negate not_fn plus reference_wrapper ref cref",
    "future": "async future promise launch future_status packaged_task",
    "initializer_list": "initializer_list",
    "iomanip": "setprecision setw setfill",
    "ios": "ios streamsize",
    "iostream": "cin cout cerr clog",
    "iterator": "advance back_inserter distance istreambuf_iterator inserter make_move_iterator move_iterator next prev "
                "reverse_iterator make_reverse_iterator ostream_iterator",
    "limits": "numeric_limits",
    "list": "list",
    "map": "map multimap",
    "memory": "addressof allocator enable_shared_from_this make_shared make_unique shared_ptr unique_ptr weak_ptr "
              "static_pointer_cast dynamic_pointer_cast",
    "mutex": "lock_guard mutex once_flag scoped_lock unique_lock call_once recursive_mutex",
    "new": "bad_alloc nothrow launder align_val_t",
    "numbers": "numbers",
    "numeric": "accumulate adjacent_difference gcd inner_product iota lcm midpoint partial_sum reduce",
    "optional": "nullopt optional make_optional",
    "queue": "priority_queue queue",
    "random": "minstd_rand mt19937 mt19937_64 normal_distribution random_device uniform_int_distribution uniform_real_distribution",
    "regex": "regex regex_match regex_replace regex_search regex_error smatch sregex_iterator cmatch",
    "set": "multiset set",
    "span": "span",
    "sstream": "istringstream ostringstream stringstream",
    "stdexcept": "domain_error invalid_argument length_error logic_error out_of_range range_error runtime_error overflow_error",
    "string": "getline stod stoi stol stoul stoll string to_string",
    "string_view": "string_view",
    "system_error": "error_code system_error errc error_category",
    "thread": "jthread thread this_thread",
    "tuple": "apply make_tuple tie tuple tuple_element tuple_size",
    "type_traits": "conditional_t decay_t enable_if_t false_type integral_constant invoke_result_t is_arithmetic_v is_base_of_v "
                   "is_convertible_v is_floating_point_v is_integral_v is_same_v is_trivially_copyable_v remove_cv_t "
                   "remove_cvref_t remove_reference_t true_type underlying_type_t is_invocable_v is_void_v",
    "unordered_map": "unordered_map unordered_multimap",
    "unordered_set": "unordered_set unordered_multiset",
    "utility": "declval exchange forward index_sequence make_index_sequence make_pair move pair swap as_const in_place cmp_less "
               "integer_sequence make_integer_sequence in_place_type",
    "variant": "get_if holds_alternative monostate variant visit bad_variant_access",
    "vector": "vector erase erase_if",
}
# Declared by others, too, as the standard says or as it follows from what these are.
ALSO = {
    "remove": ("algorithm", "cstdio"), "move": ("utility", "algorithm"),
    "erase": ("vector", "string", "deque"), "erase_if": ("vector", "map", "unordered_map", "set", "unordered_set", "string", "deque"),
    "hash": ("functional", "string", "memory", "optional", "variant", "string_view"),
    "errc": ("system_error", "charconv"), "error_code": ("system_error", "filesystem"),
    "pair": ("utility", "map", "unordered_map"), "make_pair": ("utility", "map", "unordered_map"), "abs": ("cmath", "cstdlib", "complex"),
    "initializer_list": ("initializer_list", "vector", "string", "map", "array", "span", "utility", "functional"),
    "swap": ("utility", "algorithm", "vector", "string"), "exception": ("exception", "stdexcept", "new"),
    "ios": ("ios", "iostream", "fstream", "sstream"), "byte": ("cstddef",), "conj": ("complex",), "norm": ("complex",),
    "bad_alloc": ("new", "memory"), "next": ("iterator", "vector", "map", "string"), "prev": ("iterator", "vector", "map", "string"),
    "distance": ("iterator", "vector", "map", "string"), "back_inserter": ("iterator",), "max_align_t": ("cstddef",),
    "integral": ("concepts", "type_traits"), "string_view": ("string_view", "string"), "forward": ("utility", "memory", "functional"),
    "declval": ("utility", "type_traits"), "integral_constant": ("type_traits", "memory", "utility", "functional"),
}

STANDARD_HEADERS = {name: ALSO.get(name, ()) for header, names in STANDARD.items() for name in names.split()}
for HEADER, NAMES in STANDARD.items():
    for NAME in NAMES.split():
        STANDARD_HEADERS[NAME] = tuple({*STANDARD_HEADERS[NAME], HEADER})

COMMENTS = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)
TYPE = re.compile(r"^(?:class|struct|enum class|enum|union) (\w+)[^;(]*(?:\{|$)|^using (\w+) =", re.MULTILINE)
FUNCTION = re.compile(r"^(?!return\b|using\b|namespace\b|#|template\b|friend\b|class\b|struct\b|enum\b)[\w:][\w:<>,&*\s\[\]]*?[\s&*](\w+)\(",
                      re.MULTILINE)
# Declared within classes and functions.
MEMBER = re.compile(r"^[ \t]+(?:struct|class|enum) (\w+)|^[ \t]+(?!return\b|else\b|throw\b|new\b)[\w:][\w:<>,&* ]*?[ &*](\w+)(?:\(|;| =|\{)", re.MULTILINE)
# Names of one word are those of many things.
LONG = re.compile(r"[a-z0-9](?:_|[A-Z])[A-Za-z0-9]")
# Parts of one file, in an order.
FRAGMENTS = {path.name for path in (ROOT / "src/linalg").glob("kernel_*.h")}


def tree_of(path):
    return path.relative_to(ROOT).parts[0] == "cli"


class Source:
    """A file: its text without comments and strings, and what it includes."""

    def __init__(self, path):
        text = path.read_text(encoding="utf-8")
        self.path = path
        self.includes = re.findall(r'^[ \t]*#[ \t]*include[ \t]*(["<][^">]+)', text, re.MULTILINE)
        self.text = COMMENTS.sub('""', re.sub(r"^[ \t]*#[ \t]*include.*$", "", text, flags=re.MULTILINE))
        types = TYPE.findall(self.text)
        self.types = {a or b for a, b in types}
        self.functions = set(FUNCTION.findall(self.text))


def resolve(include, source):
    name = include[1:]
    for folder in (source.path.parent, *(ROOT / part for part in ROOTS)):
        if (folder / name).is_file():
            return (folder / name).resolve()
    return None


def closure(source, sources, known):
    """All headers that are seen: names of the standard library's, paths of the project's."""
    if source.path in known:
        return known[source.path]
    known[source.path] = seen = set()
    for include in source.includes:
        path = resolve(include, source)
        if path is None or path not in sources:
            seen.add(include[1:])
        if path in sources:
            seen |= {path} | closure(sources[path], sources, known)
    return seen


def main():
    files = [path.resolve() for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*")) if path.suffix in (".h", ".cpp")]
    files += [path.resolve() for path in (ROOT / "include").rglob("*.h*")]
    sources = {path: Source(path) for path in files}
    owners = {}
    for path, source in sources.items():
        if path.suffix != ".cpp":
            for name in source.types | source.functions:
                owners.setdefault(name, set()).add(path)
    members = {name for source in sources.values() for names in MEMBER.findall(source.text) for name in names}
    own_names = {name: paths for name, paths in owners.items()
                 if len(paths) == 1 and name not in members and LONG.search(name)}
    complaints, uses, known = [], 0, {}
    for path, source in sources.items():
        seen = closure(source, sources, known)
        for name in sorted(set(re.findall(r"\bstd::(\w+)", source.text))):
            headers = STANDARD_HEADERS.get(name)
            if headers is None:
                continue
            uses += 1
            if not seen & set(headers):
                complaints.append(f"{path.relative_to(ROOT)}: std::{name} without <{'> or <'.join(sorted(headers))}>")
        if "assert(" in source.text.replace("static_assert(", "") and "cassert" not in seen and "assert.h" not in seen:
            complaints.append(f"{path.relative_to(ROOT)}: assert without <cassert>")
        if path.name in FRAGMENTS or "include" in path.relative_to(ROOT).parts:
            continue
        words = set(re.findall(r"(?<![\w.>:])(\w+)\b", source.text))
        calls = set(re.findall(r"(?<![\w.>:])(?<!\w )(?<!& )(?<!\* )(\w+)\(", source.text))
        for name in sorted((words | calls) & own_names.keys()):
            (owner,) = own_names[name]
            is_type = name in sources[owner].types
            if tree_of(path) != tree_of(owner):
                continue
            if owner == path or owner in seen or name in source.types or name in source.functions:
                continue
            if not is_type and name not in calls:
                continue
            if is_type and re.search(rf"\b(?:class|struct|enum class|enum) {name}\b|\btypename {name}\b", source.text):
                continue
            uses += 1
            complaints.append(f"{path.relative_to(ROOT)}: {name} without \"{owner.relative_to(ROOT)}\"")
    for complaint in complaints:
        print(complaint)
    if not complaints:
        print(f"{uses} names of the standard library in {len(sources)} files, all included, and {len(own_names)} names of the project")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
