"""Ordered four-part rewrite rules: left context, text, right context, output. The first that matches wins.

The rules that begin with the same symbol are compiled into one regular expression whose alternatives are
the rules in order, so that at each place one call of the matcher finds the rule; not even that is needed
where the symbols next to it exclude all of them but the last, which has no contexts. Symbols are single
characters; a table over phones is handed an `encode` that names the character, or the several characters,
that a phone stands for.

A context is a sequence of items separated by blanks: a symbol, a class defined by a line
`class NAME symbol ...` (its symbols may be several characters wide; a second line adds to it), `!item` for
anything else, `item*` for any number (right only), and `#` for a word boundary.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from itertools import product
from typing import Final

from fapstream.errors import DataError
from fapstream.tts.tables import read_rows

BOUNDARY: Final = " "


class Match:
    """Symbols [start, end) of the input became `output`."""

    __slots__ = ("end", "output", "start")

    def __init__(self, start: int, end: int, output: tuple[str, ...]) -> None:
        self.start = start
        self.end = end
        self.output = output


Rule = tuple[str, str, str, str]
"""Left context, text, right context, output, as written in a table."""
Output = tuple[str, ...]
Neighbours = tuple[AbstractSet[str], AbstractSet[str]]
"""Symbols that come before, and symbols that come after."""
_Compiled = tuple[int | None, str, Output, Neighbours | None]
"""Line, pattern, output, and what `RuleSet._neighbours` says of it."""


class _Rules:
    """Those that begin with one symbol. `rest`: the output where the symbols on either side of it are none of
    `neighbours`; None if those never decide."""

    def __init__(
        self, pattern: re.Pattern[str], outputs: list[Output], neighbours: Neighbours, rest: Output | None
    ) -> None:
        self.match = pattern.match
        self.outputs = outputs
        self.before, self.after = neighbours
        self.rest = rest


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
        begin: dict[str, list[_Compiled]] = {}
        past = []
        for line, (left, text, right, output) in rules:
            try:
                pattern = self._pattern(left, text, right) + "()"
                near = self._neighbours(left, text, right)
                for symbol in {s[0] for s in self._symbols(text.split()[0])}:
                    begin.setdefault(symbol, []).append((line, pattern, tuple(output.split()), near))
                past += self._past(left, text, right)
            except (KeyError, IndexError, ValueError) as error:
                raise _not_understood(path, line, error) from error
        self._by_symbol = {symbol: _together(compiled, path) for symbol, compiled in begin.items()}
        self._past_end = re.compile("|".join(past) or "(?!)")

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
                classes[name] = f"{classes.get(name, '')} {symbols}"
            else:
                rules.append((line, (left, text, right, output)))
        return cls(rules, classes, path=path)

    def apply(self, text: str, at: int = 0) -> list[Match]:
        """The rewriting of `text` from `at` on, left to right; symbols no rule matches are passed over."""
        out: list[Match] = []
        symbols = [*text, ""]  # one string a place, so that each is hashed once
        n = len(text)
        while at < n:
            rules = self._by_symbol.get(symbols[at])
            if rules is None:
                at += 1
            elif rules.rest is not None and not (
                symbols[at + 1] in rules.after or (at and symbols[at - 1] in rules.before)
            ):
                out.append(Match(at, at + 1, rules.rest))
                at += 1
            elif found := rules.match(text, at):
                end = found.end()
                out.append(Match(at, end, rules.outputs[(found.lastindex or 1) - 1]))
                at = end
            else:
                at += 1
        return out

    def looks_past(self, word: str) -> bool:
        """Whether what follows can matter to a word: if not, no following word changes its rewriting."""
        return self._past_end.search(BOUNDARY + word + BOUNDARY) is not None

    def _past(self, left: str, text: str, right: str) -> list[str]:
        """The words at whose end this rule looks past the boundary, as a pattern; none if it never does."""
        items = text.split() + right.split()
        end = items.index("#") if "#" in items else 0
        if not 0 < end < len(items) - 1:
            return []
        before = left.split()
        while "#" in before[1:]:  # what the word before is like is not known
            before = before[1:]
        return [self._pattern(" ".join(before), " ".join(items[:end]), "") + re.escape(BOUNDARY) + r"\Z"]

    def _neighbours(self, left: str, text: str, right: str) -> Neighbours | None:
        """Symbols one of which is next to the first wherever the rule matches, on either side: none if it
        needs no neighbour, None if nothing can be said."""
        nobody: frozenset[str] = frozenset()
        before, (first, *after) = left.split(), text.split() + right.split()
        if any(len(symbol) > 1 for symbol in self._symbols(first)):
            return None
        if after and not after[0].startswith("!") and not after[0].endswith("*"):
            return nobody, frozenset(symbol[0] for symbol in self._symbols(after[0]))
        if before and not before[-1].startswith("!"):
            return frozenset(symbol[-1] for symbol in self._symbols(before[-1])), nobody
        return None if before or after else (nobody, nobody)

    def _pattern(self, left: str, text: str, right: str) -> str:
        middle = "".join(self._item(item) for item in text.split())
        # Text first, contexts after it, the group that tells the rules apart last: so every alternative
        # begins with a literal, by which the matcher discards most of them at one glance.
        before = self._before(left.split(), middle) if left.strip() else ""
        after = f"(?={''.join(self._item(i) for i in right.split())})" if right.strip() else ""
        return middle + before + after

    def _before(self, items: list[str], middle: str) -> str:
        """Looks behind past the text: once for each width of the context, as the matcher wants it fixed."""
        behind = [f"(?<={''.join(parts)}{middle})" for parts in product(*map(self._by_width, items))]
        return behind[0] if len(behind) == 1 else f"(?:{'|'.join(behind)})"

    def _by_width(self, item: str) -> list[str]:
        """The alternatives of an item, those of one width together."""
        if item.startswith("!") or item.endswith("*"):
            return [self._item(item)]
        names = self._symbols(item)
        return [self._any([n for n in names if len(n) == width]) for width in sorted(set(map(len, names)))]

    def _item(self, item: str) -> str:
        if item.startswith("!"):
            singles = "".join(re.escape(s) for s in self._symbols(item[1:]))
            return f"[^{singles}]"
        return self._any(self._symbols(item.removesuffix("*"))) + ("*" if item.endswith("*") else "")

    @staticmethod
    def _any(symbols: list[str]) -> str:
        escaped = [re.escape(s) for s in symbols]
        if len(symbols) == 1:
            return escaped[0] if len(symbols[0]) == 1 else f"(?:{escaped[0]})"
        return f"[{''.join(escaped)}]" if all(len(s) == 1 for s in symbols) else f"(?:{'|'.join(escaped)})"

    def _symbols(self, name: str) -> list[str]:
        if name == "#":
            return [BOUNDARY]
        return self._classes[name] if name in self._classes else list(self._encode(name))


def _together(compiled: Sequence[_Compiled], path: str) -> _Rules:
    """The rules of one symbol, in order. Raises DataError."""
    pattern = _any_of([(line, pattern) for line, pattern, _, _ in compiled], path)
    *others, (_, _, last, free) = compiled
    known = [near for _, _, _, near in others if near and any(near)]
    told = len(known) == len(others) and free is not None and not any(free)
    before, after = ([near[side] for near in known] for side in (0, 1))
    return _Rules(
        pattern,
        [output for _, _, output, _ in compiled],
        (frozenset().union(*before), frozenset().union(*after)),
        last if told else None,
    )


def _any_of(patterns: Sequence[tuple[int | None, str]], path: str) -> re.Pattern[str]:
    """The patterns as one expression. Raises DataError naming the line of one that is none."""
    try:
        return re.compile("|".join(pattern for _, pattern in patterns))
    except re.error:
        for line, pattern in patterns:
            try:
                re.compile(pattern)
            except re.error as error:
                raise _not_understood(path, line, error) from error
        raise


def _not_understood(path: str, line: int | None, error: Exception) -> DataError:
    return DataError(path, line, f"cannot understand the rule ({error})")
