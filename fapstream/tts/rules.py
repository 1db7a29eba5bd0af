"""Ordered four-part rewrite rules: left context, text, right context, output. The first that matches wins.

The rules of a table are compiled into one regular expression whose alternatives are the rules in order, so
that a whole string is rewritten in one pass of the matcher. Symbols are single characters; a table over
phones is handed an `encode` that names the character, or the several characters, that a phone stands for.

A context is a sequence of items separated by blanks: a symbol, a class defined by a line
`class NAME symbol ...` (several symbols wide alternatives are allowed on the right only), `!item` for
anything else, `item*` for any number (right only), and `#` for a word boundary.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from fapstream.errors import DataError
from fapstream.tts.tables import read_rows

BOUNDARY = " "


@dataclass(frozen=True, slots=True)
class Match:
    """Symbols [start, end) of the input became `output`."""

    start: int
    end: int
    output: tuple[str, ...]


Rule = tuple[str, str, str, str]
"""Left context, text, right context, output, as written in a table."""


class RuleSet:
    """A compiled list of rules."""

    def __init__(
        self,
        rules: Iterable[tuple[int | None, Rule]],
        classes: Mapping[str, str],
        encode: Callable[[str], Sequence[str]] = lambda symbol: (symbol,),
        path: str = "rules",
    ) -> None:
        """`rules`: with their line numbers in `path`; `classes`: name -> symbols separated by blanks;
        `encode`: a symbol as written -> any of what it stands for in the input.

        Raises DataError naming the rule that cannot be understood.
        """
        self._encode = encode
        self._classes: dict[str, list[str]] = {}
        for name, symbols in classes.items():
            self._classes[name] = [s for symbol in symbols.split() for s in self._symbols(symbol)]
        self._outputs: list[tuple[str, ...]] = []
        patterns = []
        for line, (left, text, right, output) in rules:
            try:
                pattern = self._pattern(left, text, right) + "()"
                re.compile(pattern)
            except (KeyError, ValueError, re.error) as error:
                raise DataError(path, line, f"cannot understand the rule ({error})") from error
            patterns.append(pattern)
            self._outputs.append(tuple(output.split()))
        self._regex = re.compile("|".join(patterns)) if patterns else re.compile("(?!)")

    @classmethod
    def read(cls, path: str) -> RuleSet:
        """The rules of a four-column table, in which lines `class NAME symbol ...` define classes.

        Raises DataError.
        """
        rules: list[tuple[int | None, Rule]] = []
        classes: dict[str, str] = {}
        for line, (left, text, right, output) in read_rows(path, 4):
            if left.startswith("class "):
                name, _, symbols = left.removeprefix("class ").partition(" ")
                classes[name] = symbols
            else:
                rules.append((line, (left, text, right, output)))
        return cls(rules, classes, path=path)

    def apply(self, text: str, at: int = 0) -> Iterator[Match]:
        """The rewriting of `text` from `at` on, left to right; symbols no rule matches are passed over."""
        outputs = self._outputs
        for found in self._regex.finditer(text, at):
            yield Match(*found.span(), outputs[(found.lastindex or 1) - 1])

    def _pattern(self, left: str, text: str, right: str) -> str:
        middle = "".join(self._item(item) for item in text.split())
        # Text first, contexts after it, the group that tells the rules apart last: so every alternative
        # begins with a literal, by which the matcher discards most of them at one glance.
        before = f"(?<={''.join(self._item(i) for i in left.split())}{middle})" if left.strip() else ""
        after = f"(?={''.join(self._item(i) for i in right.split())})" if right.strip() else ""
        return middle + before + after

    def _item(self, item: str) -> str:
        if item.startswith("!"):
            singles = "".join(re.escape(s) for s in self._symbols(item[1:]))
            return f"[^{singles}]"
        repeat = "*" if item.endswith("*") else ""
        symbols = self._symbols(item.removesuffix("*"))
        if all(len(s) == 1 for s in symbols):
            one = "".join(re.escape(s) for s in symbols)
            return (f"[{one}]" if len(symbols) > 1 else one) + repeat
        return f"(?:{'|'.join(re.escape(s) for s in symbols)}){repeat}"

    def _symbols(self, name: str) -> list[str]:
        if name == "#":
            return [BOUNDARY]
        return self._classes[name] if name in self._classes else list(self._encode(name))
