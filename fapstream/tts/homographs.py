"""English words that sound differently by what they are, told apart by the words around them.

The table has four columns: left context, word, right context, phones. The first line of a word whose
contexts fit is taken; its last has none. A context is up to two items on the left, one on the right: a word,
a class of a line `class NAME item item ...`, `*ed` for an ending, `#` for the phrase's edge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from fapstream.errors import DataError
from fapstream.tts.tables import phone_set, read_rows

Tokens = tuple[str, ...]
LEFT: Final = 2
"""Words before a homograph that may tell what it is; after it, it is one."""
EDGE: Final = "#"
CLASS = "class "


class Item(NamedTuple):
    """What a word next to a homograph may be: one of some words, or one with one of some endings."""

    words: frozenset[str]
    endings: tuple[str, ...]

    def fits(self, word: str) -> bool:
        return word in self.words or word.endswith(self.endings)


class Rule(NamedTuple):
    """One line. `left`: nearest first."""

    left: tuple[Item, ...]
    right: Item | None
    phones: Tokens

    def fits(self, near: str, far: str, following: str) -> bool:
        if self.right is not None and not self.right.fits(following):
            return False
        left = self.left
        return not left or (left[0].fits(near) and (len(left) < LEFT or left[1].fits(far)))


class Homographs:
    """Chooses pronunciations."""

    def __init__(self, path: str) -> None:
        """Reads a table of `tts/data`; the lines of a word are made ready when it is first met. Raises
        DataError with the line for one that is wrong, as far as it has been made ready."""
        self._path = path
        self._table = table = _Table(path)
        self._lines: dict[str, list[tuple[int, list[str]]]] = {}
        for line, fields in read_rows(path, 4):
            if not fields[0].startswith(CLASS):
                self._lines.setdefault(fields[1], []).append((line, fields))
            elif self._lines:
                raise DataError(path, line, "classes come before all rules")
            else:
                table.add_class(line, fields[0].split()[1:])
        self._rules: dict[str, tuple[Rule, ...]] = {}

    def warm(self) -> None:
        """Every word. Raises DataError."""
        for word in self._lines:
            self._of(word)

    def __contains__(self, word: object) -> bool:
        return word in self._lines

    @property
    def words(self) -> Mapping[str, tuple[Tokens, ...]]:
        """Every homograph and its pronunciations, the usual one last."""
        return {word: self.ways(word) for word in self._lines}

    def ways(self, word: str) -> tuple[Tokens, ...]:
        """The pronunciations of a homograph, the usual one last."""
        return tuple(dict.fromkeys(rule.phones for rule in self._of(word)))

    def needs_next(self, word: str) -> bool:
        """Whether the word after it, or that there is none, could matter."""
        return word in self._lines and any(rule.right for rule in self._of(word))

    def choose(self, before: Sequence[str], word: str, after: str | None) -> Tokens:
        """How a homograph sounds after the words before it, nearest last, and before the next, None at the
        phrase's end."""
        near = before[-1] if before else EDGE
        far = before[-2] if len(before) > 1 else EDGE
        following = EDGE if after is None else after
        return next(rule.phones for rule in self._of(word) if rule.fits(near, far, following))

    def _of(self, word: str) -> tuple[Rule, ...]:
        if word not in self._rules:
            self._rules[word] = self._table.rules(word, self._lines[word])
        return self._rules[word]


class _Table:
    """How the fields of a table are understood."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._items: dict[str, Item] = {}
        self._classes: dict[str, set[str]] = {}
        self._phones = phone_set("en")

    def add_class(self, line: int, names: list[str]) -> None:
        """A class, or more of it; the classes named in it are those read before."""
        if len(names) < 2 or not names[0].isupper():
            raise DataError(self._path, line, "a class has a name in capitals and words")
        members = self._classes.setdefault(names[0], set())
        for text in names[1:]:
            members |= self._members(line, text)

    def rules(self, word: str, lines: Sequence[tuple[int, list[str]]]) -> tuple[Rule, ...]:
        """The rules of a word, in order; the last has no contexts, and no other."""
        if not word or word != word.lower() or len(word.split()) != 1:
            raise DataError(self._path, lines[0][0], f"not a lower-case word: {word!r}")
        rules = [self._rule(line, fields) for line, fields in lines]
        for (line, _), above in zip(lines[1:], rules, strict=False):
            if not (above.left or above.right):
                raise DataError(
                    self._path, line, f"never reached: a line of {word} without contexts is above"
                )
        if rules[-1].left or rules[-1].right:
            raise DataError(self._path, lines[-1][0], f"the last line of {word} has a context")
        return tuple(rules)

    def _rule(self, line: int, fields: Sequence[str]) -> Rule:
        left, _, right, phones = fields
        if len(left.split()) > LEFT or len(right.split()) > 1:
            raise DataError(self._path, line, f"more than {LEFT} items on the left or one on the right")
        items = tuple(self._item(line, text) for text in reversed(left.split()))
        after = self._item(line, right.strip()) if right.strip() else None
        return Rule(items, after, self._pronunciation(line, phones))

    def _members(self, line: int, text: str) -> set[str]:
        if text in self._classes:
            return self._classes[text]
        if text != text.lower() or text == "*" or EDGE in text[1:] or "*" in text[1:]:
            raise DataError(self._path, line, f"neither a word, an ending nor a class: {text}")
        return {text}

    def _item(self, line: int, text: str) -> Item:
        if text not in self._items:
            members = self._members(line, text)
            endings = tuple(sorted(member[1:] for member in members if member[0] == "*"))
            self._items[text] = Item(frozenset(m for m in members if m[0] != "*"), endings)
        return self._items[text]

    def _pronunciation(self, line: int, text: str) -> Tokens:
        tokens = tuple(text.split())
        if not tokens or not all(map(self._is_phone, tokens)):
            raise DataError(self._path, line, f"not phones with vowels stressed 0, 1 or 2: {text!r}")
        return tokens

    def _is_phone(self, token: str) -> bool:
        stressed = token[-1] in "012"
        phone = self._phones.get(token[:-1] if stressed else token)
        return phone is not None and phone.kind != "silence" and (phone.kind == "vowel") == stressed
