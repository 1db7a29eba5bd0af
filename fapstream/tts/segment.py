"""Characters to tokens and phrase ends, in one pass, whatever the pieces in which the characters arrive.

A token is complete when white space follows it; only then is it looked at, so fragmentation cannot matter.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from fapstream.records import ExpressionName

MAX_TOKEN = 200
"""A longer run without white space is cut every so many characters, which bounds all work per token."""

MIN_SMILEY_MS, DEFAULT_SMILEY_MS, MAX_SMILEY_MS = 40, 1000, 10_000

SMILEYS: Mapping[str, ExpressionName] = {
    ")": "joy",
    "|": "sadness",
    "O": "surprise",
    "(": "anger",
    ";": "disgust",
    "o": "fear",
}

_CHUNK = re.compile(r"\n|[^\S\n]+|\S+")
_CUT = re.compile(
    r"(?P<smiley>\\:[)|O(;o]\d{0,9})"
    r"|(?P<dash>—|(?<!\d)–|–(?!\d)|-{2,})"
    r"|(?P<dots>…|\.{2,})(?=\w)"
    r"|(?P<mark>(?<=[^\W\d_])[,;!?](?=[^\W\d_]))"
)
_TAIL = re.compile(r"([.!?;:,·…\u037e\u0387]+)[\"')\]}>»”’*_]*$")
_OPENERS = "\"'([{<«“‘„*_¿¡"
_CLOSERS = "\"')]}>»”’*_"
INITIALS = re.compile(r"([^\W\d_]\.)+")


@dataclass(frozen=True, slots=True)
class Token:
    """Text without white space, at code point `start` of the turn, and what it does to the phrase.

    `stop`: "" for nothing, the kind of phrase end after it (see `stops` in prosody.toml), or `capital` or
    `number`: a sentence ends here if the next token begins with a capital, or does not begin with a digit.
    """

    text: str
    start: int
    stop: str = ""
    expression: ExpressionName | None = None
    silence_ms: float = 0.0


@dataclass(frozen=True, slots=True)
class NewLine:
    """A line ended."""


class Scanner:
    """Cuts a growing text at white space. `feed` any fragments, then `end`."""

    def __init__(self) -> None:
        self._parts: list[str] = []
        self._length = 0
        self._at = 0

    def feed(self, text: str) -> Iterator[tuple[str, int] | NewLine]:
        """(run without white space, its start) for every run now complete, and line ends."""
        for found in _CHUNK.finditer(text):
            chunk = found.group()
            if not chunk.isspace():
                yield from self._grow(chunk)
                continue
            yield from self.end()
            self._at += len(chunk)
            if chunk == "\n":
                yield NewLine()

    def _grow(self, chunk: str) -> Iterator[tuple[str, int]]:
        at = 0
        while at < len(chunk):
            piece = chunk[at : at + MAX_TOKEN - self._length]
            self._parts.append(piece)
            self._length += len(piece)
            at += len(piece)
            if self._length == MAX_TOKEN:
                yield from self.end()

    def end(self) -> Iterator[tuple[str, int]]:
        """The run that was still growing."""
        if self._parts:
            run, start = "".join(self._parts), self._at
            self._parts.clear()
            self._at += self._length
            self._length = 0
            yield run, start


class Segmenter:
    """Turns runs into tokens that know whether a phrase ends after them."""

    def __init__(self, lang: str, abbreviations: Mapping[str, tuple[str, str]]) -> None:
        """`abbreviations`: as written -> (read as, "" or "end" or "number")."""
        self._abbreviations = abbreviations
        self._question = "?;\u037e" if lang == "el" else "?\u037e"

    def tokens(self, run: str, start: int) -> Iterator[Token]:
        """The tokens of one run of characters without white space."""
        if run.isalnum():
            yield Token(run, start)
            return
        at = 0
        for cut in _CUT.finditer(run):
            yield from self._piece(run[at : cut.start()], start + at)
            yield self._cut_token(cut, start + cut.start())
            at = cut.end()
        yield from self._piece(run[at:], start + at)

    def _cut_token(self, cut: re.Match[str], start: int) -> Token:
        text = cut.group()
        if cut.lastgroup == "smiley":
            wished = int(text[3:]) if text[3:] else DEFAULT_SMILEY_MS
            length = min(max(wished, MIN_SMILEY_MS), MAX_SMILEY_MS)
            return Token(text, start, "smiley", SMILEYS[text[2]], float(length))
        kinds = {"dash": "dash", "dots": "ellipsis"}
        return Token(text, start, kinds.get(cut.lastgroup or "") or self._kind(text))

    def _piece(self, text: str, start: int) -> Iterator[Token]:
        if not text:
            return
        if text[0] in "([" and len(text) > 1:
            yield Token(text[0], start, "comma")
            text, start = text[1:], start + 1
        yield Token(text, start, self._stop(text))

    def _stop(self, text: str) -> str:
        tail = _TAIL.search(text)
        if not tail:
            closing = text[-1] in ")]" and "(" not in text and "[" not in text
            return "comma" if closing else "dash" if text in ("-", "–") else ""
        if tail.group(1) != ".":
            return self._kind(tail.group(1))
        core = text[: tail.end(1)].lstrip(_OPENERS)
        entry = self._abbreviations.get(core)
        if entry:
            return {"end": "capital", "number": "number"}.get(entry[1], "")
        initials = INITIALS.fullmatch(core)
        if initials and core[0].isupper():
            return "capital" if len(core) > 2 else ""
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


def core(text: str) -> str:
    """A token without brackets, quotes and marks around it; a full stop at its end stays."""
    return text.lstrip(_OPENERS).rstrip(_CLOSERS + "!?;:,·…\u037e\u0387")


def ends_before(stop: str, following: str) -> bool:
    """Whether a `capital` or `number` stop turns out to end the sentence, given the next token's text."""
    first = following.lstrip(_OPENERS)[:1]
    return first.isupper() if stop == "capital" else stop == "number" and not first.isdigit()
