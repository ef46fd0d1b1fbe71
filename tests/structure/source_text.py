"""Comments and literals of a source, for the checks of this folder."""
import re

# Words that begin a sentence of which the first half is missing.
FRAGMENT = re.compile(r"(Of|As|That|Which|Who|Whose|Whom|Likewise|The same)\b")
# A raw literal, a literal of one line, a template, a character, or a comment: whichever begins first.
TOKEN = re.compile(
    r"""R"(?P<mark>[^ ()\\\n]*)\((?P<raw>.*?)\)(?P=mark)"|"(?P<text>(?:[^"\\\n]|\\.)*)"|"""
    r"""`(?P<template>(?:[^`\\]|\\.)*)`|'(?:[^'\\\n]|\\.)'|(?P<comment>//[^\n]*)|/\*.*?\*/""", re.DOTALL)


def tokens(text):
    """Line, start of the line, and match of each token."""
    line = at = start = 0
    for found in TOKEN.finditer(text):
        line += text.count("\n", at, found.start())
        at = found.start()
        start = text.rfind("\n", 0, at) + 1
        yield line + 1, start, found


def literals(text):
    """Line and text of each literal; literals with nothing between them are one."""
    line, whole, end = 0, None, 0
    for number, _, found in tokens(text):
        part = next((found[name] for name in ("raw", "text", "template") if found[name] is not None), None)
        if part is None:
            continue
        if whole is not None and not text[end:found.start()].strip():
            whole += part
        else:
            if whole is not None:
                yield line, whole
            line, whole = number, part
        end = found.end()
    if whole is not None:
        yield line, whole


def comments(text):
    """Line and text of each line comment, and whether it begins a block: one on a line of its own
    belongs to the comment above it, and below a comment beside code if it is aligned with that."""
    last_line, last_column, last_alone = -1, 0, False
    for number, start, found in tokens(text):
        if not found["comment"]:
            continue
        column = found.start() - start
        alone = not text[start:found.start()].strip()
        continues = alone and number == last_line + 1 and (last_alone or column == last_column)
        yield number, re.sub(r"^//[/!]?<?\s*", "", found["comment"]), not continues
        last_line, last_column, last_alone = number, column, alone
