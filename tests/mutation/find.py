# SPDX-License-Identifier: Apache-2.0
"""Finds the places of a C++ file at which a mutant can be made.

A mutant is a piece of source text and what replaces it, such as "a < b" and "a <= b". The pieces come from libclang's syntax tree, so a
mutant compiles in nearly every case, and text in comments, strings, templates' arguments and constants of the type system is left alone.
"""
import bisect
import ctypes
import re

import clang.cindex as cindex
from clang.cindex import CursorKind as Kind
from clang.cindex import TypeKind

from mutant import Mutant

OPPOSITES = {
    "&&": ["||"], "||": ["&&"],
    "<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["*"],
    "&": ["|"], "|": ["&"], "<<": [">>"], ">>": ["<<"],
    "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="], "|=": ["&="], "&=": ["|="],
}
FAMILY = {"&&": "condition", "||": "condition", "<": "comparison", "<=": "comparison", ">": "comparison", ">=": "comparison",
          "==": "comparison", "!=": "comparison"}
INTEGERS = {TypeKind.CHAR_U, TypeKind.UCHAR, TypeKind.CHAR_S, TypeKind.SCHAR, TypeKind.USHORT, TypeKind.UINT, TypeKind.ULONG,
            TypeKind.ULONGLONG, TypeKind.SHORT, TypeKind.INT, TypeKind.LONG, TypeKind.LONGLONG}
FLOATS = {TypeKind.FLOAT, TypeKind.DOUBLE, TypeKind.LONGDOUBLE}
# What is inside one of these is evaluated by the compiler, or is no expression.
CONSTANT = {Kind.STATIC_ASSERT, Kind.ENUM_DECL, Kind.TEMPLATE_TYPE_PARAMETER, Kind.TEMPLATE_NON_TYPE_PARAMETER, Kind.CONCEPT_DECL,
            Kind.REQUIRES_EXPR, Kind.CONCEPT_SPECIALIZATION_EXPR, Kind.ALIGNED_ATTR, Kind.TYPE_REF, Kind.TEMPLATE_REF, Kind.NAMESPACE_REF,
            Kind.PARM_DECL, Kind.FIELD_DECL}
# Text that is not worth a test: what the log says.
UNTESTED = re.compile(r"^(core::)?log\w*\s*[(.]|^(core::)?(info|warn|debug|error|critical)\(|spdlog::|\.(info|warn|debug|error|critical)\(")

# An expression that begins with one of our macros: only what is written in its arguments is a place.
MACRO = re.compile(rb"DTS_[A-Z_]+\(")


def written_at(location) -> tuple[str | None, int]:
    """The file, and the byte in it. For an argument of a macro, where the argument is written; `location.offset` is that of the macro."""
    file, line, column, offset = cindex.c_object_p(), ctypes.c_uint(), ctypes.c_uint(), ctypes.c_uint()
    cindex.conf.lib.clang_getFileLocation(location, *map(ctypes.byref, (file, line, column, offset)))
    return cindex.File(file).name if file else None, offset.value


class Finder:
    def __init__(self, path: str, absolute: str, unit):
        self.path, self.absolute, self.unit = path, absolute, unit
        with open(absolute, "rb") as file:
            self.text = file.read()
        self.lines = [0] + [match.end() for match in re.finditer(rb"\n", self.text)]
        self.found: list[Mutant] = []

    def all(self) -> list[Mutant]:
        for cursor in self.unit.cursor.get_children():
            if cursor.location.file and cursor.location.file.name == self.absolute:
                self.visit(cursor)
        unique = {(mutant.begin, mutant.end, mutant.replacement): mutant for mutant in self.found}
        return sorted(unique.values(), key=lambda mutant: (mutant.begin, mutant.end, mutant.replacement))

    # The tree ------------------------------------------------------------------------------------------------------------------------

    def visit(self, cursor, inside_function=False):
        kind = cursor.kind
        if kind in CONSTANT or self.is_foreign(cursor):
            return
        if kind == Kind.VAR_DECL and not self.visit_variable(cursor, inside_function):
            return
        children = list(cursor.get_children())
        if kind in (Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR, Kind.FUNCTION_TEMPLATE,
                    Kind.CONVERSION_FUNCTION, Kind.LAMBDA_EXPR):
            if self.tokens_before_body(cursor, {"consteval"}):
                return
            inside_function = True
        if kind == Kind.CASE_STMT:  # its constant is no place; its statement is
            children = children[1:]
        if kind == Kind.VAR_DECL:  # numbers before the initializer are arguments of a template
            children = children[-1:]
        if kind in (Kind.DECL_REF_EXPR, Kind.MEMBER_REF_EXPR):
            children = [child for child in children if child.kind not in (Kind.INTEGER_LITERAL, Kind.CXX_BOOL_LITERAL_EXPR)]
        if kind == Kind.COMPOUND_STMT:
            for child in children:
                self.visit_statement(child)
        elif kind == Kind.IF_STMT:
            self.visit_if(cursor, children)
        elif kind in (Kind.WHILE_STMT,):
            pass  # a turned condition never ends; its comparisons are places of their own
        elif kind == Kind.BINARY_OPERATOR or kind == Kind.COMPOUND_ASSIGNMENT_OPERATOR:
            self.visit_binary(cursor, children)
        elif kind == Kind.UNARY_OPERATOR:
            self.visit_unary(cursor, children)
        elif kind in (Kind.INTEGER_LITERAL, Kind.FLOATING_LITERAL):
            if inside_function:
                self.visit_literal(cursor)
        elif kind == Kind.CXX_BOOL_LITERAL_EXPR:
            if inside_function:
                word = self.source(cursor)
                self.add(cursor, "constant", {"true": "false", "false": "true"}.get(word, ""), "expression")
        elif kind == Kind.CALL_EXPR:
            self.visit_call(cursor)
        elif kind == Kind.CONDITIONAL_OPERATOR and len(children) == 3:
            self.turn(children[0])
        elif kind == Kind.RETURN_STMT and children and self.plain(children[0]) == TypeKind.BOOL:
            self.turn(children[0])
        for child in children:
            self.visit(child, inside_function)

    def visit_variable(self, cursor, inside_function) -> bool:
        """True if the initializer is evaluated while the program runs."""
        words = self.tokens_before_body(cursor, {"constexpr", "constinit", "const", "static"})
        if "constexpr" in words or "constinit" in words or ("const" in words and cursor.type.get_canonical().kind in INTEGERS | {TypeKind.BOOL}):
            self.visit_constant(cursor, words)
            return False
        return inside_function and "static" not in words

    def visit_constant(self, cursor, words):
        """A named number: it may be an ordinary constant if nothing of the type system depends on it, which the compiler decides."""
        if cursor.type.get_canonical().kind not in INTEGERS | FLOATS or cursor.semantic_parent.kind in (
                Kind.CLASS_DECL, Kind.STRUCT_DECL, Kind.CLASS_TEMPLATE) or "constexpr" not in words:
            return
        children = [child for child in cursor.get_children() if child.kind.is_expression()]
        if not children:
            return
        begin, end = self.extent(cursor)
        declaration = self.text[begin:end].decode()
        value = children[-1]
        value_begin, value_end = self.extent(value)
        if value_begin < 0 or not declaration.startswith(("constexpr", "inline constexpr")) or self.is_foreign(value):
            return
        old = self.text[value_begin:value_end].decode()
        is_float = cursor.type.get_canonical().kind in FLOATS
        for new in ([f"({old}) * 1.25", f"({old}) * 0.8"] if is_float else [f"({old}) + 1", f"({old}) - 1"]):
            self.found.append(Mutant(self.path, cursor.location.line, value_begin, value_end, "constant", new, "named"))

    def visit_statement(self, cursor):
        while cursor.kind == Kind.UNEXPOSED_EXPR and len(list(cursor.get_children())) == 1:
            cursor = next(cursor.get_children())
        if cursor.kind == Kind.DO_STMT:
            self.visit_check(cursor)
        if cursor.kind in (Kind.CALL_EXPR, Kind.COMPOUND_ASSIGNMENT_OPERATOR, Kind.UNARY_OPERATOR) or (
                cursor.kind == Kind.BINARY_OPERATOR and self.operator(cursor, list(cursor.get_children())) == "="):
            begin, end = self.extent(cursor)
            if begin < 0 or not self.text[end:end + 1] == b";" or UNTESTED.search(self.text[begin:end].decode()):
                return
            self.add(cursor, "statement", "", "statement")

    def visit_check(self, cursor):
        """DTS_TRY(f());  The mutant does not call f."""
        begin, end = written_at(cursor.extent.start)[1], written_at(cursor.extent.end)[1]
        if self.text.startswith(b"DTS_TRY(", begin) and self.text[end - 1:end + 1] == b");":
            self.found.append(Mutant(self.path, bisect.bisect(self.lines, begin), begin, end, "error check", "", "statement"))

    def visit_if(self, cursor, children):
        if self.text[self.extent(cursor)[0]:].startswith((b"if constexpr", b"if consteval")):
            return
        conditions = [child for child in children if child.kind.is_expression()]
        if not conditions or any(child.kind == Kind.DECL_STMT or child.kind == Kind.VAR_DECL for child in children[:2]):
            return
        condition = conditions[0]
        body = children[children.index(condition) + 1] if children.index(condition) + 1 < len(children) else None
        self.turn(condition)
        if body is not None and self.leaves(body):
            self.add(condition, "error check", "false", "condition")

    def turn(self, condition):
        """The opposite of a condition, unless that is a place of its own."""
        source = self.source(condition)
        children = list(condition.get_children())
        is_comparison = condition.kind == Kind.BINARY_OPERATOR and self.operator(condition, children) in ("<", "<=", ">", ">=", "==", "!=")
        if not is_comparison and not source.startswith("!") and source not in ("true", "false"):
            self.add(condition, "condition", f"!({source})", "condition")

    def leaves(self, body) -> bool:
        if body.kind == Kind.COMPOUND_STMT:
            children = list(body.get_children())
            return bool(children) and self.leaves(children[-1])
        return body.kind in (Kind.RETURN_STMT, Kind.CONTINUE_STMT, Kind.BREAK_STMT)

    def visit_binary(self, cursor, children):
        if len(children) != 2:
            return
        operator = self.operator(cursor, children)
        if operator not in OPPOSITES:
            return
        types = [self.plain(child) for child in children]
        if operator not in ("&&", "||", "==", "!=") and not all(kind in INTEGERS | FLOATS for kind in types):
            return
        if operator in ("%", "&", "|", "<<", ">>", "|=", "&=") and not all(kind in INTEGERS for kind in types):
            return
        left, right = self.source(children[0]), self.source(children[1])
        for other in OPPOSITES[operator]:
            self.add(cursor, FAMILY.get(operator, "arithmetic"), f"{left} {other} {right}", "expression")

    def visit_unary(self, cursor, children):
        begin, end = self.extent(cursor)
        if begin < 0 or len(children) != 1:
            return
        source = self.text[begin:end].decode()
        if source.startswith("!") and not source.startswith("!="):  # C++20 rewrites a != b as !(a == b)
            self.add(cursor, "condition", f"static_cast<bool>({source[1:]})", "expression")
        elif source.startswith("-") and not source.startswith("--") and self.plain(children[0]) in INTEGERS | FLOATS:
            self.add(cursor, "sign", f"({source[1:]})", "expression")

    def visit_literal(self, cursor):
        source = self.source(cursor)
        if not source or source[0] not in "0123456789.":
            return
        if cursor.kind == Kind.INTEGER_LITERAL:
            self.add(cursor, "constant", f"({source} + 1)", "literal")
            if source.rstrip("uUlLzZ") not in ("0",):
                self.add(cursor, "constant", f"({source} - 1)", "literal")
        else:
            is_zero = not re.search("[1-9a-fA-F]", re.split("[ep]", source.removeprefix("0x"))[0])
            self.add(cursor, "constant", "1.0" if is_zero else f"({source} * 1.25)", "literal")

    def visit_call(self, cursor):
        arguments = list(cursor.get_arguments())
        begin, end = self.extent(cursor)
        if begin < 0 or any(argument is None for argument in arguments) or not self.text[begin:end].endswith(b")"):
            return
        if UNTESTED.search(self.text[begin:end].decode()):
            return
        if arguments and self.extent(arguments[0])[0] <= begin:  # an operator
            return
        for first, second in zip(arguments, arguments[1:]):
            if first.type.get_canonical().spelling != second.type.get_canonical().spelling:
                continue
            (b1, e1), (b2, e2) = self.extent(first), self.extent(second)
            if b1 < 0 or b2 < 0 or not begin <= b1 < e1 <= b2 < e2 <= end or self.text[b1:e1] == self.text[b2:e2]:
                continue
            swapped = self.text[begin:b1] + self.text[b2:e2] + self.text[e1:b2] + self.text[b1:e1] + self.text[e2:end]
            self.add(cursor, "arguments", swapped.decode(), "expression")

    # The text ------------------------------------------------------------------------------------------------------------------------

    def add(self, cursor, kind, replacement, form):
        begin, end = self.extent(cursor)
        if begin < 0 or (replacement == "" and form != "statement") or "//" in replacement:
            return
        self.found.append(Mutant(self.path, bisect.bisect(self.lines, begin), begin, end, kind, replacement, form))

    def is_foreign(self, cursor) -> bool:
        file = cursor.extent.start.file
        return cursor.kind != Kind.TRANSLATION_UNIT and (file is None or file.name != self.absolute)

    def extent(self, cursor) -> tuple[int, int]:
        """In bytes; (-1, -1) for what a macro made."""
        (start_file, begin), (end_file, end) = written_at(cursor.extent.start), written_at(cursor.extent.end)
        if start_file != self.absolute or end_file != self.absolute or begin >= end or MACRO.match(self.text, begin):
            return -1, -1
        return begin, end

    def source(self, cursor) -> str:
        begin, end = self.extent(cursor)
        return self.text[begin:end].decode() if begin >= 0 else ""

    def plain(self, cursor):
        return cursor.type.get_canonical().kind

    def operator(self, cursor, children) -> str:
        if len(children) != 2:
            return ""
        left_end, right_begin = self.extent(children[0])[1], self.extent(children[1])[0]
        if left_end < 0 or right_begin < left_end:
            return ""
        between = re.sub(rb"//[^\n]*", b"", self.text[left_end:right_begin]).decode()
        return between.strip().lstrip(")").rstrip("(").strip()

    def tokens_before_body(self, cursor, wanted) -> set[str]:
        begin, _ = self.extent(cursor)
        if begin < 0:
            return set()
        head = re.split(r"[({=;]", self.text[begin:begin + 200].decode(errors="replace"), maxsplit=1)[0]
        return wanted & set(head.split())


def find(path: str, absolute: str, arguments: list[str], index=None) -> list[Mutant]:
    """Mutants of a file that is compiled with `arguments`, by place. Raises RuntimeError if libclang cannot read it."""
    index = index or cindex.Index.create()
    unit = index.parse(absolute, args=arguments)
    fatal = [str(diagnostic) for diagnostic in unit.diagnostics if diagnostic.severity >= cindex.Diagnostic.Error]
    if fatal:
        raise RuntimeError(f"{path}: {fatal[0]}")
    return Finder(path, absolute, unit).all()
