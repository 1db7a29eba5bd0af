"""What of a turn's text is heard at a sample, and the text itself, kept for a while to be said again."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import deque
from dataclasses import dataclass

KEPT_TEXT = 65_536
"""Characters that were taken to be spoken are kept so long."""

KEPT_WORDS = 512
"""Spoken words are remembered: some minutes, much more than anybody hears behind what is made."""

PIECE = 4096
"""Text that comes in small pieces is kept in larger ones."""

SENTENCE_END = r"""(?:^|[.!?…MARKS]|\n[ \t\r]*\n)(?:["'”’»)\]\s]|<[^<>]*>|\\\S+)*$"""
"""A closing mark or a blank line, and then quotes, brackets, blanks, mark-up and smileys only."""

LOOK_BACK = 200
"""A sentence's beginning is told by so many characters before it."""


@dataclass(frozen=True, slots=True)
class SaidWord:
    """A word of the text, characters [char_start, char_end), heard in the samples [start, end)."""

    start: int
    end: int
    char_start: int
    char_end: int


class KeptText:
    """The last of a text, addressed by code-point offsets into the whole."""

    def __init__(self) -> None:
        self._parts: deque[str] = deque()
        self._start = 0
        self._end = 0

    @property
    def start(self) -> int:
        """The offset of the oldest character that is kept."""
        return self._start

    def add(self, text: str, waiting: int) -> None:
        """More text; with it, `waiting` characters at the end are still to be spoken. Old text is
        forgotten."""
        if self._parts and len(self._parts[-1]) + len(text) <= PIECE:
            self._parts[-1] += text
        elif text:
            self._parts.append(text)
        self._end += len(text)
        while self._parts and self._start + len(self._parts[0]) < self._end - waiting - KEPT_TEXT:
            self._start += len(self._parts.popleft())

    def since(self, char: int) -> str:
        """From a character on; from the oldest there is, if that was forgotten."""
        out, at = deque[str](), self._end
        for part in reversed(self._parts):
            if at <= char:
                break
            at -= len(part)
            out.appendleft(part[max(0, char - at) :])
        return "".join(out)

    def before(self, char: int, n: int) -> str:
        """At most n characters before it."""
        start = max(self._start, char - n)
        return self.since(start)[: max(0, char - start)]

    def cut(self, char: int) -> None:
        """Forget what is from a character on; the next that comes is there."""
        while self._parts and self._end > char:
            last = self._parts.pop()
            self._end -= len(last)
            if self._end < char:
                self._parts.append(last[: char - self._end])
                self._end += len(self._parts[-1])
        if self._end != char:
            self._parts.clear()
            self._start = self._end = char


class SaidWords:
    """Words by the samples at which they are heard, and where phrases begin in the text."""

    def __init__(self, marks: str = "") -> None:
        """`marks`: what ends a sentence of the language besides `.!?…`."""
        self._sentence_end = re.compile(SENTENCE_END.replace("MARKS", re.escape(marks)))
        self._words: list[SaidWord] = []
        self._phrases: list[int] = []

    def add(self, word: SaidWord) -> None:
        """The next word; its end may only be estimated."""
        self._words.append(word)
        if len(self._words) >= 2 * KEPT_WORDS:
            del self._words[:KEPT_WORDS]

    def begin_phrase(self, char: int) -> None:
        """A phrase begins at a character."""
        if not self._phrases or char > self._phrases[-1]:
            self._phrases.append(char)
            if len(self._phrases) >= 2 * KEPT_WORDS:
                del self._phrases[:KEPT_WORDS]

    def at(self, sample: int) -> SaidWord | None:
        """The last word begun by a sample."""
        i = bisect_right(self._words, sample, key=lambda word: word.start)
        return self._words[i - 1] if i else None

    def until(self, sample: int, char: int) -> SaidWord | None:
        """The last word whose text ends by a character; no earlier one than that heard at a sample."""
        for word in reversed(self._words):
            if word.char_end <= char or word.start <= sample:
                return word
        return None

    def cut(self, sample: int, char: int) -> None:
        """What was to be heard from a sample on is void, and so is the text from a character on."""
        i = bisect_right(self._words, sample - 1, key=lambda word: word.start)
        del self._words[i:]
        del self._phrases[bisect_right(self._phrases, char) :]

    def sentence(self, text: KeptText, char: int, back: int) -> int:
        """Where the sentence that holds a character begins, or one so many sentences before it; the oldest
        beginning that is known, if there are not so many."""
        found = text.start
        for start in reversed(self._phrases[: bisect_right(self._phrases, char)]):
            if start < text.start or back < 0:
                break
            if self._sentence_end.search(text.before(start, LOOK_BACK)):
                found, back = start, back - 1
        return found
