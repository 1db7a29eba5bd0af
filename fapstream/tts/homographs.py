"""English words that sound differently by what they are, told apart by the words around them.

`homographs.tsv` has the words, each with its kind and its pronunciations; `homograph_kinds.tsv` the rules of
the kinds, in order, as the Greek rules are: left context, right context, and which pronunciation is taken.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from fapstream.errors import DataError
from fapstream.tts.stems import plural
from fapstream.tts.tables import read_rows

Tokens = tuple[str, ...]
LEFT = 2
"""Words before a homograph that may tell what it is; after it, it is one."""
EDGE = "#"
THIRD_PERSON = {"nv": "nvs", "vn": "vns"}
"""Kinds whose words have a form in -s, and the kind of that."""


class _Item(NamedTuple):
    """What a word next to a homograph must be: one of some words, or ends with something; any if both are
    empty."""

    words: frozenset[str] = frozenset()
    ending: str = ""

    def fits(self, word: str) -> bool:
        if self.ending:
            return word.endswith(self.ending)
        return not self.words or word in self.words


@dataclass(slots=True)
class _Kind:
    """Rules: items before, nearest first, the item after or None, index of the pronunciation."""

    rules: list[tuple[tuple[_Item, ...], _Item | None, int]] = field(default_factory=list)

    @property
    def looks_right(self) -> bool:
        return any(right for _, right, _ in self.rules)


class Homographs:
    """Chooses pronunciations."""

    def __init__(self) -> None:
        """Reads the tables. Raises DataError."""
        self._kinds = _kinds("en/homograph_kinds.tsv")
        self._words: dict[str, tuple[_Kind, tuple[Tokens, ...]]] = {}
        path = "en/homographs.tsv"
        for line, (word, kind, pronunciations) in read_rows(path, 3):
            ways = tuple(tuple(way.split()) for way in pronunciations.split(" / "))
            self._add(path, line, word, kind, ways)
            if kind in THIRD_PERSON:
                self._words.setdefault(
                    word + "s", (self._kinds[THIRD_PERSON[kind]], tuple(map(plural, ways)))
                )

    def _add(self, path: str, line: int, word: str, kind: str, ways: tuple[Tokens, ...]) -> None:
        rules = self._kinds.get(kind)
        if rules is None or not all(ways) or any(index >= len(ways) for _, _, index in rules.rules):
            raise DataError(path, line, f"no such kind, or too few pronunciations: {word} {kind}")
        self._words[word] = rules, ways

    def __contains__(self, word: str) -> bool:
        return word in self._words

    @property
    def words(self) -> Mapping[str, tuple[Tokens, ...]]:
        """Every homograph and its pronunciations."""
        return {word: ways for word, (_, ways) in self._words.items()}

    def needs_next(self, word: str) -> bool:
        """Whether the word after it, or that there is none, could matter."""
        found = self._words.get(word)
        return found is not None and found[0].looks_right

    def choose(self, before: Sequence[str], word: str, after: str | None) -> Tokens | None:
        """How a word sounds after the words before it, nearest last, and before the next, None at the
        phrase's end; None if it is no homograph."""
        found = self._words.get(word)
        if found is None:
            return None
        kind, ways = found
        left = [*reversed(before[-LEFT:]), EDGE, EDGE]
        following = after or EDGE
        for items, right, index in kind.rules:
            if (right is None or right.fits(following)) and all(
                item.fits(w) for item, w in zip(items, left, strict=False)
            ):
                return ways[index]
        return None


def _kinds(path: str) -> dict[str, _Kind]:
    classes: dict[str, set[str]] = {}
    kinds: dict[str, _Kind] = {}
    for line, (name, left, right, number) in read_rows(path, 4):
        if name.startswith("class "):
            _, called, *words = name.split()
            classes.setdefault(called, set()).update(words)
            continue
        items = tuple(_item(text, classes) for text in reversed(left.split()))
        if number not in ("1", "2") or len(items) > LEFT or len(right.split()) > 1:
            raise DataError(path, line, f"expected {LEFT} items, an item, and 1 or 2")
        after = _item(right, classes) if right else None
        kinds.setdefault(name, _Kind()).rules.append((items, after, int(number) - 1))
    for name, kind in kinds.items():
        if kind.rules[-1][0] or kind.rules[-1][1]:
            raise DataError(path, None, f"the last rule of {name} has a context")
    return kinds


def _item(text: str, classes: Mapping[str, set[str]]) -> _Item:
    if text.startswith("*") and len(text) > 1:
        return _Item(ending=text[1:])
    return _Item() if text == "." else _Item(frozenset(classes.get(text, (text,))))
