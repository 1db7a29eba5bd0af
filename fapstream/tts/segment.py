"""Characters to tokens and phrase ends, in one pass, whatever the pieces in which the characters arrive.

A token is complete when white space or a tag follows it; only then is it looked at, so fragmentation cannot
matter.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from typing import Final, NamedTuple

from fapstream.records import ExpressionName, Spoken
from fapstream.tts.markup import PLAIN, Style

MAX_TOKEN: Final = 200
"""A longer run without white space is cut every so many characters, which bounds all work per token."""

MAX_TAG: Final = 400
"""What begins like a tag and is longer is text."""

WRAPPED: Final = 60
"""A line of so many characters may have been wrapped: it ends a phrase unless the next one goes on."""

MIN_SMILEY_MS, DEFAULT_SMILEY_MS, MAX_SMILEY_MS = 40, 1000, 10_000

SMILEYS: Mapping[str, ExpressionName] = {
    ")": "joy",
    "|": "sadness",
    "O": "surprise",
    "(": "anger",
    ";": "disgust",
    "o": "fear",
}

_CHUNK: Final = re.compile(r"(?P<run>[^\s<]+)[^\S\n]*|(?P<blank>[^\S\n]+)|(?P<line>\n)|(?P<tag><)")
_LITERAL = re.compile(r"(?P<run>\S+)|(?P<blank>[^\S\n]+)|(?P<line>\n)")
_RUN = re.compile(rf"\S{{1,{MAX_TOKEN}}}")
_TAG_PIECE = re.compile(r"[^<>]+|[<>]")
_TAG_START = re.compile(r"[A-Za-z/!?]")
_CUT = re.compile(
    r"(?P<smiley>\\:[)|O(;o]\d{0,9})"
    r"|(?P<note>\[\d{1,3}\])"
    r"|(?P<dash>—|(?<!\d)–|–(?!\d)|-{2,})"
    r"|(?P<dots>…|\.{2,})(?=\w)"
    r"|(?P<mark>(?<=[^\W\d_])(?!(?<=\b[όοΌΟ]),(?:τι|ΤΙ))[,;!?](?=[^\W\d_]))"
)
_ENTITY = re.compile(r"&(?:#\d{1,7}|#[xX][0-9a-fA-F]{1,6}|[a-zA-Z][a-zA-Z0-9]{1,15});")
_FILLER = "\u2060"
"""Stands for the characters of an entity that are none of its own: ignored wherever it is met."""
_OPENERS = "\"'([{<«“‘„*_~¿¡" + _FILLER
_CLOSERS = "\"')]}>»”’*_~" + _FILLER
_AREA = re.compile(r"\(\d{1,3}\)[-\d]{0,20}")
"""A part of a telephone number."""
_DAY = re.compile(r"(?:[12]\d|3[01]|[1-9])(?:st|nd|rd|th)?,")
_YEAR = re.compile(r"(?:1\d|20)\d\d(?!\d)")
_ROMAN = re.compile("[IVXLC]{2,8}|[VX]")
"""Numbers, that is; one I is a word."""
_TAIL = re.compile(r"([.!?;:,·…\u037e\u0387]+)[" + re.escape(_CLOSERS) + "]*$")
_MARKS: Final = ",.!?:"
_NO_LETTERS = r"\W\d_²³¹¼-¾\u2070-\u2089\u2150-\u2189"
_WORD = re.compile(f"[{re.escape(_OPENERS)}]*([^{_NO_LETTERS}]+(?:['’][^{_NO_LETTERS}]+)*)([^\\w\\s(\\[]*)$")
INITIALS = re.compile(r"([^\W\d_]\.)+")


UNDECIDED: Final[Mapping[str, str]] = {
    "capital": "sentence",
    "number": "sentence",
    "date": "comma",
    "wrapped": "line",
}
"""Phrase ends that the next token decides -> what kind they are if they are one."""


class Token:
    """Text without white space, at code point `start` of the turn, and what it does to the phrase.

    `word` is the text when brackets, quotes and marks around it are left out and only letters and apostrophes
    remain, else "". `stop`: "" for nothing, the kind of phrase end after it (see `stops` in prosody.toml), or
    one of UNDECIDED: a phrase ends here if the next token says so. `raw` is what was written where `text` is
    not it (entities); `said`: the reading that mark-up gives, and then `text` may hold white space.

    Not a dataclass, like Run and Item: many are made, and of a dataclass the constructor is not compiled.
    """

    __slots__ = ("expression", "raw", "said", "silence_ms", "start", "stop", "style", "text", "word")

    def __init__(
        self,
        text: str,
        start: int,
        word: str = "",
        stop: str = "",
        style: Style = PLAIN,
        expression: ExpressionName | None = None,
        silence_ms: float = 0.0,
        raw: str = "",
        said: tuple[Spoken, ...] | None = None,
    ) -> None:
        self.text = text
        self.start = start
        self.word = word
        self.stop = stop
        self.style = style
        self.expression = expression
        self.silence_ms = silence_ms
        self.raw = raw
        self.said = said


class Run:
    """Characters without white space, at code point `start`."""

    __slots__ = ("start", "text")

    def __init__(self, text: str, start: int) -> None:
        self.text = text
        self.start = start


class NewLine(NamedTuple):
    """A line ended; `length` is that of the line in characters."""

    length: int


class TagText(NamedTuple):
    """From `<` to `>`, at code point `start`."""

    text: str
    start: int


Piece = Run | NewLine | TagText


class Scanner:
    """Cuts a growing text at white space and tags. `feed` any fragments, then `end`."""

    def __init__(self) -> None:
        self._fed = 0
        """Characters that have come before the present fragment."""
        self._parts: list[str] = []
        self._start = self._length = 0
        """Of the run that is growing."""
        self._line_start = 0
        self._tag = ""
        self._tag_start = 0

    def feed(self, text: str) -> list[Piece]:
        """Every run now complete, line ends, and tags, in order."""
        out: list[Piece] = []
        at = self._tags(text, 0, out) if self._tag else 0
        while at < len(text):
            at = self._plain(text, at, out)
        self._fed += len(text)
        return out

    def end(self) -> list[Piece]:
        """The text is over: the run that was still growing, and what might have become a tag."""
        out: list[Piece] = []
        if self._tag:
            self._as_text(out)
        self._finish(out)
        return out

    def _plain(self, text: str, at: int, out: list[Piece]) -> int:
        """Reads on up to where a tag may begin, and over it; returns where it came to."""
        n, fed = len(text), self._fed
        for found in _CHUNK.finditer(text, at):
            kind = found.lastgroup
            if kind == "run":
                run: str = found["run"]
                start = fed + found.start()
                complete = found.end() - found.start() > len(run)
                if complete and not self._parts and len(run) <= MAX_TOKEN:
                    out.append(Run(run, start))
                    continue
                self._grow(run, start, out)
                if complete:
                    self._finish(out)
            elif kind == "tag":
                return self._tags(text, found.start(), out)
            else:
                self._finish(out)
                if kind == "line":
                    self._line(fed + found.end(), out)
        return n

    def _line(self, end: int, out: list[Piece]) -> None:
        out.append(NewLine(end - self._line_start))
        self._line_start = end

    def _grow(self, chunk: str, start: int, out: list[Piece]) -> None:
        at = 0
        while at < len(chunk):
            if not self._parts:
                self._start = start + at
            piece = chunk[at : at + MAX_TOKEN - self._length]
            self._parts.append(piece)
            self._length += len(piece)
            at += len(piece)
            if self._length == MAX_TOKEN:
                self._finish(out)

    def _finish(self, out: list[Piece]) -> None:
        if self._parts:
            out.append(Run("".join(self._parts), self._start))
            self._parts.clear()
            self._length = 0

    def _tags(self, text: str, at: int, out: list[Piece]) -> int:
        """Reads on where a tag has begun or begins; returns where ordinary text goes on."""
        for found in _TAG_PIECE.finditer(text, at):
            piece = found.group()
            if piece == "<" or (self._tag == "<" and not _TAG_START.match(piece)):
                self._as_text(out)
                if piece != "<":
                    return found.start()
                self._tag, self._tag_start = "<", self._fed + found.start()
                continue
            self._tag += piece
            if piece == ">":
                self._finish(out)
                out.append(TagText(self._tag, self._tag_start))
                self._tag = ""
                return found.end()
            if len(self._tag) > MAX_TAG:
                self._as_text(out)
                return found.end()
        return len(text)

    def _as_text(self, out: list[Piece]) -> None:
        """What began like a tag was none."""
        text, self._tag = self._tag, ""
        for found in _LITERAL.finditer(text):
            start = self._tag_start + found.start()
            if found.lastgroup == "run":
                self._grow(found.group(), start, out)
            else:
                self._finish(out)
                if found.lastgroup == "line":
                    self._line(start + 1, out)


def plain_runs(text: str, start: int) -> list[Run]:
    """The runs of a short text in which `<` begins nothing."""
    return [Run(m.group(), start + m.start()) for m in _RUN.finditer(text)]


class Segmenter:
    """Turns runs into tokens that know whether a phrase ends after them."""

    def __init__(self, lang: str, abbreviations: Mapping[str, str]) -> None:
        """`abbreviations`: as written -> "", or "end" or "number" (see `Token.stop`)."""
        self._abbreviations = abbreviations
        self._question = "?;\u037e" if lang == "el" else "?\u037e"

    def tokens(self, run: str, start: int, style: Style = PLAIN) -> list[Token]:
        """The tokens of one run of characters without white space."""
        if run.isalpha():
            return [Token(run, start, run, "", style)]
        if run[-1] in _MARKS and (word := run[:-1]).isalpha():
            stop = self.stop(run) if run[-1] == "." else self._kind(run[-1])
            return [Token(run, start, word, stop, style)]
        return list(self._tokens(run, start, style))

    def _tokens(self, run: str, start: int, style: Style) -> Iterator[Token]:
        """Those of a run that is more than a word and one mark after it."""
        raw = run
        if "&" in run and ";" in run:
            run = _ENTITY.sub(_decoded, run)
        at = 0
        for cut in _CUT.finditer(run) if "://" not in run else ():
            yield from self._piece(run, at, cut.start(), (raw, start, style))
            if cut.lastgroup != "note":
                yield self._cut_token(cut, start + cut.start(), style)
            at = cut.end()
        yield from self._piece(run, at, len(run), (raw, start, style))

    def _cut_token(self, cut: re.Match[str], start: int, style: Style) -> Token:
        text = cut.group()
        if cut.lastgroup == "smiley":
            wished = int(text[3:]) if text[3:] else DEFAULT_SMILEY_MS
            length = float(min(max(wished, MIN_SMILEY_MS), MAX_SMILEY_MS))
            return Token(text, start, "", "smiley", style, SMILEYS[text[2]], length)
        kinds = {"dash": "dash", "dots": "ellipsis"}
        return Token(text, start, "", kinds.get(cut.lastgroup or "") or self._kind(text), style)

    def _piece(self, run: str, begin: int, end: int, place: tuple[str, int, Style]) -> Iterator[Token]:
        if begin == end:
            return
        raw, start, style = place
        if run[begin] in "([" and end - begin > 1 and not _AREA.fullmatch(run, begin, end):
            yield Token(run[begin], start + begin, "", "comma", style)
            begin += 1
        text = run[begin:end]
        written = "" if raw is run else raw[begin:end]
        word = _WORD.match(text)
        if word is None:
            yield Token(text, start + begin, "", self.stop(text), style, raw=written)
        else:
            stop = self.stop(text) if word.end(1) < len(text) else ""
            yield Token(text, start + begin, word.group(1), stop, style, raw=written)

    def stop(self, text: str) -> str:
        """What a token of that text does to the phrase; see `Token.stop`."""
        tail = _TAIL.search(text)
        if not tail:
            closing = text[-1] in ")]" and "(" not in text and "[" not in text
            return "comma" if closing else "dash" if text in ("-", "–") else ""
        marks = tail.group(1)
        if marks != ".":
            after_point = marks[0] == "." and marks[1] not in ".…"
            return "date" if _DAY.fullmatch(text) else self._kind(marks[1:] if after_point else marks)
        bare = text[: tail.end(1)].lstrip(_OPENERS)
        entry = self._abbreviations.get(bare)
        if entry is not None:
            return {"end": "capital", "number": "number"}.get(entry, "")
        initials = INITIALS.fullmatch(bare)
        if initials and bare[0].isupper():
            return "capital" if len(bare) > 2 else ""
        return "sentence"

    def _kind(self, marks: str) -> str:
        if any(c in self._question for c in marks):
            return "question"
        if "!" in marks:
            return "exclamation"
        if "…" in marks or ".." in marks:
            return "ellipsis"
        if "." in marks:
            return "sentence"
        if any(c in ";·\u0387" for c in marks):
            return "semicolon"
        return "colon" if ":" in marks else "comma"


def _decoded(entity: re.Match[str]) -> str:
    """The character that an entity stands for, filled up to the entity's length."""
    text = entity.group()
    from html import unescape  # few texts have entities, and its table takes two milliseconds to load

    character = unescape(text)
    if len(character) != 1 or character.isspace() or not character.isprintable():
        character = _FILLER
    return _FILLER * (len(text) - 1) + character


def core(text: str) -> str:
    """A token without brackets, quotes and marks around it; a full stop at its end stays."""
    return text.lstrip(_OPENERS).rstrip(_CLOSERS + "!?;:,·…\u037e\u0387")


def ends_before(
    stop: str, following: str, openings: Collection[str] = (), inside: Collection[str] = ()
) -> bool:
    """Whether a stop of UNDECIDED turns out to end the phrase, given the next token's text: `capital` if it
    begins with one and is one of `openings`, if there are any (a sentence may end before `The` but not before
    `President`), and none of `inside` (directions after a distance); `number` unless it begins with a digit
    or is a Roman number; `date` unless it is a year; `wrapped` unless it begins with a small letter."""
    text = following.lstrip(_OPENERS)
    first = text[:1]
    if stop == "capital":
        word = text.rstrip(_CLOSERS + ",")
        return first.isupper() and word not in inside and (not openings or word in openings)
    if stop == "date":
        return not _YEAR.match(text)
    if stop == "wrapped":
        return not first.islower()
    return not (first.isdigit() or _ROMAN.fullmatch(text.rstrip(_CLOSERS + ".,;:!?")))
