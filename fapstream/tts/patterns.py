"""Patterns that read what is not a plain word: dates, times, money, units, numbers. Data, and a small engine.

A table `patterns.tsv` has three columns. The first says where a pattern may begin: `digit` (at a digit or
one of `+-−.#` before it), the name of a vocabulary class (at one of its forms: a whole word, or the sign it
begins with), `start` (at the beginning of any word or number, before all others), `word` (the same, after
the others) or `mark` (at any other sign); words of letters alone are met only if a class has them. ` after
REGEX` behind it asks that the word before in the phrase, as written, is all matched by REGEX; none is
written "". The second column is a regular expression over the text of one or several tokens, which stand
one blank apart; `{NAME}` in it is a macro (a line `macro`, name, expression) or any written form of a
vocabulary class. It must end where no letter or digit goes on, unless it ends with `~`. The third is the
reading: words as they are (one that begins with an apostrophe is joined to the word before it),
`$group:reader` or `$group:reader:other` for the text of a named group read by a reader (a method of
Readers, or a vocabulary class), and `[ ... ]` around what is left out when none of the groups in it took
part; nothing at all is silence. The first pattern that matches wins.

A line `going_on` names the vocabulary classes whose words may belong to a number before them: only over
those do patterns reach from one token to the next.

A table `vocabulary.tsv` has five columns: class, written form (or several with `|` between them), reading
for one, for many if it differs, gender. Of acronyms those of class `spelled` are read letter by letter,
those of class `spoken` as words, those of class `wordlike` letter by letter unless all around them is in
capitals.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from typing import NamedTuple

from fapstream.errors import DataError
from fapstream.tts.tables import read_rows

Words = list[str]
_AFTER = re.compile(r" [^\w\s]*([^\W\d_]+)")
GOING_ON = "going_on"
Reader = Callable[["Found", str, str], Words]
"""(what was found, the group's name, the other group's name or "") -> words."""


class Entry(NamedTuple):
    """A word of the vocabulary as it is read: one of it, several of it, and the gender of what is counted."""

    one: str
    many: str
    gender: str


class Found(NamedTuple):
    """A match in its surroundings; `before`: the word before it in the phrase, lower-case, "" if none."""

    match: re.Match[str]
    before: str

    @property
    def after(self) -> str:
        """The word after it, lower-case, "" if none or unless only a blank is between them."""
        following = _AFTER.match(self.match.string, self.match.end())
        return following.group(1).lower() if following else ""

    def text(self, group: str) -> str:
        """What a group matched, "" if it took no part or there is none of that name."""
        return (self.match.groupdict().get(group) or "") if group else ""


class Reading(NamedTuple):
    """Words and the characters [start, end) that they are read from."""

    words: Words
    start: int
    end: int


class _Part(NamedTuple):
    """A piece of a reading: a literal (`group` empty), a group with its reader, or an optional sequence."""

    literal: str = ""
    group: str = ""
    reader: str = ""
    other: str = ""
    optional: tuple[_Part, ...] = ()


class _Rule:
    """One line of the table; `after`: what the word before must be, None if that does not matter.

    The expression is compiled when it is first tried: all of them together take longer than everything else
    that a language needs to begin.
    """

    __slots__ = ("_match", "after", "expression", "parts")

    def __init__(self, after: re.Pattern[str] | None, expression: str, parts: tuple[_Part, ...]) -> None:
        self.after = after
        self.parts = parts
        self.expression = expression
        self._match: Callable[[str, int], re.Match[str] | None] | None = None

    def match(self, text: str, at: int) -> re.Match[str] | None:
        """What it finds at a place."""
        match = self._match or self._compiled().match
        return match(text, at)

    def _compiled(self) -> re.Pattern[str]:
        regex = re.compile(self.expression)
        self._match = regex.match
        return regex

    def check(self, readers: Container[str]) -> None:
        """Raises re.error or KeyError if the table's line makes no sense."""
        groups = set(self._compiled().groupindex)
        for part in _flat(self.parts):
            if part.group and not {part.group, part.other} - {""} <= groups:
                raise KeyError(part.group)
            if part.reader and part.reader not in readers:
                raise KeyError(part.reader)


class Vocabulary:
    """Classes of written forms and their readings."""

    def __init__(self, path: str) -> None:
        """Raises DataError."""
        self.classes: dict[str, dict[str, Entry]] = {}
        self.ends: dict[str, str] = {}
        """Abbreviation -> "", or what its point may mean (see Segmenter)."""
        for line, (name, written, one, many, gender) in read_rows(path, 5):
            if not (name and written):
                raise DataError(path, line, "a class and a written form are needed")
            for form in written.split("|") if len(written) > 1 else [written]:
                self.classes.setdefault(name, {})[form] = Entry(one, many or one, gender)
                if name == "abbreviation":
                    self.ends[form] = many

    @property
    def known(self) -> dict[str, Entry]:
        """Forms that are always read as the table says: abbreviations and acronyms."""
        lettered = [*self.classes.get("spelled", ()), *self.classes.get("wordlike", ())]
        known = {form: Entry(" ".join(form.upper()), "", "") for form in lettered}
        known |= {form: Entry(form.lower(), "", "") for form in self.classes.get("spoken", ())}
        return known | self.classes["abbreviation"]

    def entry(self, name: str, written: str) -> Entry | None:
        """By the written form, or that in lower case."""
        entries = self.classes[name]
        return entries.get(written) or entries.get(written.lower())

    def gender(self, written: str) -> str:
        """The gender of a written form in whatever class, "" if none has it."""
        return next(
            (e[written].gender for e in self.classes.values() if written in e and e[written].gender), ""
        )

    def alternatives(self, name: str) -> str:
        """A regular expression for every written form, the longest first of those that begin alike."""
        beginnings: dict[str, list[str]] = {}
        for form in sorted(self.classes[name], key=len, reverse=True):
            beginnings.setdefault(form[0], []).append(re.escape(form[1:]))
        return "(?:" + "|".join(re.escape(c) + _any_of(rest) for c, rest in beginnings.items()) + ")"


def _any_of(expressions: list[str]) -> str:
    return expressions[0] if len(expressions) == 1 else "(?:" + "|".join(expressions) + ")"


class Patterns:
    """The patterns of a language."""

    def __init__(self, path: str, vocabulary: Vocabulary, readers: Mapping[str, Reader]) -> None:
        """Raises DataError naming the line that cannot be understood."""
        self._path = path
        self._vocabulary = vocabulary
        self._readers = readers
        self._macros = {name: vocabulary.alternatives(name) for name in vocabulary.classes}
        self._rules: dict[str, list[_Rule]] = {}
        self.going_on: set[str] = set()
        """Vocabulary classes whose words may belong to a number or name before them."""
        for line, (where, pattern, reading) in read_rows(path, 3):
            try:
                self._line(where, pattern, reading)
            except (KeyError, ValueError, re.error) as error:
                raise DataError(path, line, f"cannot understand the pattern ({error})") from error

    def check(self) -> None:
        """Compiles every expression, so that none has to be when it is met. Raises DataError for one that
        cannot be, or whose reading makes no sense."""
        readers = {*self._readers, *self._vocabulary.classes}
        for place, rules in self._rules.items():
            for rule in rules:
                try:
                    rule.check(readers)
                except (KeyError, re.error) as error:
                    raise DataError(self._path, None, f"{place}: {rule.expression[:60]} ({error})") from error

    @property
    def places(self) -> list[str]:
        """Where patterns may begin."""
        return list(self._rules)

    def may_begin(self, where: str, before: str) -> bool:
        """Whether any pattern may begin there after that word."""
        return any(rule.after is None or rule.after.fullmatch(before) for rule in self._rules[where])

    def read(self, where: str, text: str, at: int, before: str) -> tuple[list[Reading], int] | None:
        """The readings, in order, and the end of what the first matching pattern finds at `at`; None if none
        matches. `before`: the word before, as written."""
        for rule in self._rules.get(where, ()):
            if rule.after and not rule.after.fullmatch(before):
                continue
            if match := rule.match(text, at):
                return self._spans(Found(match, before.lower()), rule.parts), match.end()
        return None

    def _line(self, where: str, pattern: str, reading: str) -> None:
        if where == "macro":
            self._macros[pattern] = "(?:" + self._expanded(reading) + ")"
            return
        if where == GOING_ON:
            self.going_on |= set(pattern.split())
            return
        expanded = self._expanded(pattern.removesuffix("~"))
        expanded += "" if pattern.endswith("~") else r"(?!\w)"
        parts, rest = self._parsed(reading.split())
        if rest:
            raise ValueError("an unexpected ]")
        place, _, after = where.partition(" after ")
        condition = re.compile(self._expanded(after)) if " after " in where else None
        self._rules.setdefault(place, []).append(_Rule(condition, expanded, parts))

    def _expanded(self, pattern: str) -> str:
        return re.sub(r"\{([a-z_]+)\}", lambda m: self._macros[m.group(1)], pattern)

    def _parsed(self, words: Sequence[str]) -> tuple[tuple[_Part, ...], list[str]]:
        """The parts up to an unmatched `]`, and the words from it on."""
        parts: list[_Part] = []
        left = list(words)
        while left and left[0] != "]":
            word = left.pop(0)
            if word == "[":
                inside, left = self._parsed(left)
                if not left:
                    raise ValueError("a ] is missing")
                left.pop(0)
                parts.append(_Part(optional=inside))
            elif word.startswith("$"):
                group, reader, other = (word[1:].split(":") + ["", ""])[:3]
                parts.append(_Part(group=group, reader=reader or "text", other=other))
            else:
                parts.append(_Part(literal=word))
        return tuple(parts), left

    def _spans(self, found: Found, parts: Sequence[_Part]) -> list[Reading]:
        """Readings in the order of the text: a literal goes with the group after it, what comes out of
        order with what was before it."""
        out: list[Reading] = []
        waiting: Words = []
        for words, span in self._said(found, parts):
            if span is None and out and not waiting and words[0][0] == "'":
                out[-1] = out[-1]._replace(words=[*out[-1].words[:-1], out[-1].words[-1] + words[0]])
            elif span is None:
                waiting += words
            elif out and span[0] < out[-1].end:
                last = out[-1]
                start = max(min(last.start, span[0]), out[-2].end if len(out) > 1 else 0)
                end = max(last.end, span[1])
                out[-1] = Reading([*last.words, *waiting, *words], start, end)
                waiting = []
            else:
                out.append(Reading([*waiting, *words], *span))
                waiting = []
        if waiting and out:
            out[-1] = out[-1]._replace(words=[*out[-1].words, *waiting])
        elif waiting:
            out = [Reading(waiting, *found.match.span())]
        return _covering(out, *found.match.span())

    def _said(self, found: Found, parts: Sequence[_Part]) -> Iterator[tuple[Words, tuple[int, int] | None]]:
        for part in parts:
            if part.optional:
                if any(found.text(p.group) for p in _flat(part.optional) if p.group):
                    yield from self._said(found, part.optional)
            elif not part.group:
                yield [part.literal], None
            elif found.text(part.group):
                yield self._group(found, part), found.match.span(part.group)

    def _group(self, found: Found, part: _Part) -> Words:
        if reader := self._readers.get(part.reader):
            return reader(found, part.group, part.other)
        entry = self._vocabulary.entry(part.reader, found.text(part.group))
        if entry is None:
            return []
        single = part.other and found.text(part.other) in ("1", "+1", "-1", "−1")
        return (entry.one if single or not part.other else entry.many).split()


def _flat(parts: Sequence[_Part]) -> Iterator[_Part]:
    for part in parts:
        yield from _flat(part.optional) if part.optional else (part,)


def _covering(readings: list[Reading], start: int, end: int) -> list[Reading]:
    """The readings, the first stretched to where the match begins and the last to where it ends."""
    if readings:
        readings[0] = readings[0]._replace(start=min(start, readings[0].start))
        readings[-1] = readings[-1]._replace(end=max(end, readings[-1].end))
    return readings
