# SPDX-License-Identifier: Apache-2.0
"""Finds the English in a file: the prose of a document, comments, and messages.

A paragraph is a list of pairs (line number, text), so that words at the end of a line are seen together with the next line.
"""

import io
import re
import tokenize

COMMENTED = (".h", ".cpp", ".proto", ".ts", ".tsx", ".py")

# A string, or a comment, of C++, TypeScript and .proto. A string is matched so that a // in it is no comment.
TOKEN = re.compile(
    r'R"(?P<delimiter>[^()\\ ]{0,16})\((?P<raw>.*?)\)(?P=delimiter)"'
    r'|"(?P<double>(?:\\.|[^"\\\n])*)"'
    r"|'(?P<single>(?:\\.|[^'\\\n])*)'"
    r"|`(?P<template>(?:\\.|[^`\\])*)`"
    r"|//(?P<line>[^\n]*)"
    r"|/\*(?P<block>.*?)\*/",
    re.DOTALL,
)
COMMENT_GROUPS = ("line", "block")
STRING_GROUPS = ("raw", "double", "single", "template")
SQL = re.compile(r"\b(?:SELECT|INSERT|WHERE|NOT NULL)\b")  # names of columns are part of a file format and no sentences


def blank(match):
    """Returns as many lines as the match has, without their text."""
    return re.sub(r"[^\n]", " ", match.group(0))


def without_blocks(text):
    """Returns a document without its blocks of code: fenced, or indented by four spaces (in a list by more)."""
    text = re.sub(r"^```.*?^```[^\n]*$", blank, text, flags=re.DOTALL | re.MULTILINE)
    kept, is_code, in_list = [], False, False
    for line in text.split("\n"):
        if re.match(r"\s*(?:[-*]|\d+\.)\s", line) and not is_code:
            in_list = True
        elif line.strip() and not line.startswith(" "):
            in_list = False
        follows_blank = not kept or not kept[-1].strip()
        depth = 7 if in_list else 4
        is_code = line.startswith(" " * depth) and (is_code or follows_blank) if line.strip() else is_code
        kept.append("" if is_code and line.strip() else line)
    return "\n".join(kept)


def without_code(text):
    """Returns a document without any code, also without what is between backticks."""
    return re.sub(r"`[^`]*`", blank, without_blocks(text))


def paragraphs(lines):
    """Groups lines that follow each other without an empty line."""
    collected = []
    for number, line in lines:
        if collected and (number != collected[-1][0] + 1 or not line.strip()):
            yield collected
            collected = []
        if line.strip():
            collected.append((number, line.strip()))
    if collected:
        yield collected


def prose(_, text):
    """Returns the paragraphs of a document, without code, targets of links, and quoted messages."""
    text = re.sub(r"\]\([^)]*\)", "]", without_code(text))
    text = re.sub(r'"[^"\n]*(?:\n[^"\n]+)?"', blank, text)
    return list(paragraphs(enumerate(text.split("\n"), start=1)))


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def tokens(text, groups):
    for match in TOKEN.finditer(text):
        for group in groups:
            if match.group(group) is not None:
                for index, line in enumerate(match.group(group).split("\n")):
                    yield line_of(text, match.start(group)) + index, line.lstrip("/*! ")


def comments(path, text):
    """Returns the paragraphs of the comments of a source file, without code between backticks or quotes."""
    if path.suffix == ".py":
        found = python_comments(text)
    else:
        found = tokens(text, COMMENT_GROUPS)
    return list(paragraphs((number, re.sub(r"`[^`]*`|\"[^\"]*\"", " ", line)) for number, line in found))


def python_comments(text):
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.COMMENT:
                yield token.start[0], token.string.lstrip("# ")
            elif token.type == tokenize.STRING and token.string.lstrip("rRbBuU").startswith(('"""', "'''")):
                for index, line in enumerate(token.string.split("\n")):
                    yield token.start[0] + index, line.strip("\"' ")
    except (tokenize.TokenError, SyntaxError):  # not ours to judge
        return


def messages(_, text):
    """Returns the strings of a source file that have at least two words and are not SQL, each as a paragraph."""
    return [
        [(number, line)]
        for number, line in tokens(text, STRING_GROUPS)
        if re.search(r"[A-Za-z]+ [A-Za-z]+", line) and not SQL.search(line)
    ]
