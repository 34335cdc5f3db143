# SPDX-License-Identifier: Apache-2.0
"""Writes mutants into a file: all of them at once, each behind a switch, so that one build serves them all.

    a < b && c        becomes        (on(1) ? (a <= b) : (on(2) ? ((a < b || c)) : ((a < b && c))))

Only one mutant is active at a time, so what a mutant puts in place of a piece holds no other mutant, and the text grows by one copy for each.
"""
from mutant import Mutant


def weave(text: bytes, chosen: dict[str, Mutant], switch=None) -> bytes:
    """`switch` writes the alternatives of one place; by default in C++."""
    for at in {text.rindex(b"constexpr", 0, mutant.begin) for mutant in chosen.values() if mutant.form == "named"}:
        text = text[:at] + b"const    " + text[at + 9:]  # initialized when the program starts
    order = sorted(chosen.items(), key=lambda item: (item[1].begin, -item[1].end, item[0]))
    woven, _ = _weave(text, order, 0, 0, len(text), switch or _switch)
    return woven


def _weave(text: bytes, order, at: int, begin: int, end: int, switch):
    """The text from `begin` to `end` with the mutants order[at:] that lie in it; and the first mutant that does not."""
    made, position = [], begin
    while at < len(order) and order[at][1].end <= end:
        mutant = order[at][1]
        if mutant.begin < position:  # crosses the one before
            at += 1
            continue
        same = at
        while same < len(order) and (order[same][1].begin, order[same][1].end) == (mutant.begin, mutant.end):
            same += 1
        inner, after = _weave(text, order, same, mutant.begin, mutant.end, switch)
        made += [text[position:mutant.begin], switch(order[at:same], inner)]
        position, at = mutant.end, after
    made.append(text[position:end])
    return b"".join(made), at


def _switch(alternatives, inner: bytes) -> bytes:
    for name, mutant in reversed(alternatives):
        test = f"::dts::mutation::{'live' if mutant.form == 'named' else 'on'}(0x{name}ULL)".encode()
        new = " ".join(mutant.replacement.split()).encode()
        if mutant.form == "statement":
            inner = b"if (!" + test + b") " + inner
        elif mutant.form == "condition":
            inner = b"(" + test + b" ? static_cast<bool>(" + new + b") : static_cast<bool>(" + inner + b"))"
        else:
            inner = b"(" + test + b" ? (" + new + b") : (" + inner + b"))"
    return inner
