"""A growing text to tokens, pauses and notes: scanner, segmenter and mark-up put together.

Mark-up is taken tag by tag as it comes. `sub`, `say-as` and `phoneme` say how their content is read, so it is
kept until they close. What is malformed is read as text, and a note warns of it: a tag that is not
understood, an end tag without its start, content that never closes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from fapstream.records import Note, Spoken
from fapstream.tts.markup import PLAIN, Style, Tag, break_ms, parse, styled
from fapstream.tts.segment import NewLine, Piece, Run, Scanner, Segmenter, TagText, Token, plain_runs

MAX_DEPTH: Final = 32
"""Elements inside each other; deeper ones are text."""
MAX_CONTENT: Final = 400
"""Characters that `sub`, `say-as` or `phoneme` may hold."""

_CAPTURING = frozenset(("sub", "say-as", "phoneme"))


class Pause(NamedTuple):
    """The phrase ends as `kind` says (see `stops` in prosody.toml); `ms`: how long the pause is, if it
    says."""

    kind: str
    ms: float | None = None


Event = Token | NewLine | Pause | Note
Say = Callable[[Tag, str], tuple[Spoken, ...] | None]
"""How the content of a capturing element is read, or None if it cannot be read like that."""


@dataclass(slots=True)
class _Capture:
    """An element whose content is being collected: runs with their places."""

    tag: Tag
    start: int
    runs: list[Run] = field(default_factory=list)
    length: int = 0


class Reader:
    """Tokens of a turn, in order, as soon as they are complete."""

    def __init__(self, segmenter: Callable[[str], Segmenter], lang: str, say: Say) -> None:
        """`segmenter`: that of a language; `lang`: the turn's."""
        self._segmenter_of = segmenter
        self._lang = lang
        self._segmenter = segmenter(lang)
        self._say = say
        self._scanner = Scanner()
        self._open: list[tuple[str, Style]] = []
        self._style = PLAIN
        self._capture: _Capture | None = None

    def feed(self, text: str) -> list[Event]:
        """What more text completes."""
        out: list[Event] = []
        for found in self._scanner.feed(text):
            if isinstance(found, Run) and self._capture is None:
                out += self._segmenter.tokens(found.text, found.start, self._style)
            else:
                out += self._take(found)
        return out

    def end(self) -> Iterator[Event]:
        """The text is over."""
        for found in self._scanner.end():
            yield from self._take(found)
        if self._capture:
            yield from self._give_up()

    def _take(self, found: Piece) -> Iterator[Event]:
        if isinstance(found, TagText):
            yield from self._tag(found)
        elif self._capture is None:
            if isinstance(found, Run):
                yield from self._segmenter.tokens(found.text, found.start, self._style)
            else:
                yield found
        elif isinstance(found, Run):
            self._capture.runs.append(found)
            self._capture.length += len(found.text) + 1
            if self._capture.length > MAX_CONTENT:
                yield from self._give_up()

    def _tag(self, found: TagText) -> Iterator[Event]:
        tag = parse(found.text)
        if self._capture:
            if tag and tag.kind == "close" and tag.name == self._capture.tag.name:
                yield from self._captured(found)
                return
            yield from self._give_up()
        if tag is None or not self._fits(tag):
            yield from self._as_text(found.text, found.start)
            return
        yield from self._effect(tag, found)

    def _fits(self, tag: Tag) -> bool:
        if tag.kind == "close":
            return bool(self._open) and self._open[-1][0] == tag.name
        if tag.name in _CAPTURING:
            return tag.kind == "open"
        return len(self._open) < MAX_DEPTH

    def _effect(self, tag: Tag, found: TagText) -> Iterator[Event]:
        if tag.name == "break":
            if (ms := break_ms(tag)) > 0.0:
                yield Pause("break", ms)
        elif tag.name == "mark":
            yield Note("mark", tag.attributes["name"], found.start, found.start + len(found.text))
        elif tag.name in ("p", "s"):
            yield Pause("line" if tag.name == "p" else "sentence")
        if tag.name in _CAPTURING:
            self._capture = _Capture(tag, found.start)
        elif tag.kind == "open":
            self._open.append((tag.name, self._style))
            self._restyle(styled(self._style, tag))
        elif tag.kind == "close":
            self._restyle(self._open.pop()[1])

    def _restyle(self, style: Style) -> None:
        self._style = style
        self._segmenter = self._segmenter_of(style.lang or self._lang)

    def _captured(self, closing: TagText) -> Iterator[Event]:
        capture, self._capture = self._capture, None
        assert capture
        content = " ".join([run.text for run in capture.runs])
        said = self._say(capture.tag, content) if content else ()
        if said is None:
            self._capture = capture
            yield from self._give_up()
        elif content:
            first, last = capture.runs[0], capture.runs[-1]
            together = last.start + len(last.text) - first.start == len(content)
            yield Token(content if together else first.text, first.start, "", "", self._style, said=said)

    def _give_up(self) -> Iterator[Event]:
        """The content of an element that cannot be read as it asks, as text."""
        capture, self._capture = self._capture, None
        assert capture
        reason = f"<{capture.tag.name}> is not closed or cannot be read as it asks"
        yield Note("warning", reason, capture.start, capture.start + 1)
        for run in capture.runs:
            yield from self._segmenter.tokens(run.text, run.start, self._style)

    def _as_text(self, text: str, start: int) -> Iterator[Event]:
        yield Note("warning", f"mark-up that is not understood: {text[:60]}", start, start + len(text))
        for run in plain_runs(text, start):
            yield from self._segmenter.tokens(run.text, run.start, self._style)
