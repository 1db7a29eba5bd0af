"""Text, as it arrives, to utterances: the incremental front-end of one turn."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fapstream.records import SILENCE, Phone, Utterance, Word
from fapstream.tts.durations import Segment
from fapstream.tts.language import Stop, language
from fapstream.tts.melody import MelodyState, share
from fapstream.tts.normalise import Item
from fapstream.tts.segment import NewLine, Scanner, Token, core, ends_before

LEAD_MS = 15.0
"""Silence before the first phone of a turn."""

MAX_PENDING, MIN_PIECE = 20, 12
"""A phrase this many words long is spoken without waiting for its end, cut after at least MIN_PIECE words."""

MAX_PENDING_CHARACTERS = 400
"""So is one with this many characters, whatever they are."""

MIN_PAUSE_MS = 100.0


class FrontEnd:
    """Reads one turn. Fragments of any size give the same phones as the whole text at once.

    Pure and synchronous: every method returns the utterances that can no longer change. Only `hold` depends
    on when it is called.
    """

    def __init__(self, lang: str, rate: float = 1.0, f0_hz: float = 120.0) -> None:
        """`rate`: 2.0 is twice as fast; `f0_hz`: the voice's middle pitch. Raises UnknownLanguage."""
        self._language = language(lang)
        self._rate = min(max(rate, 0.2), 5.0)
        self._f0_hz = f0_hz
        self._scanner = Scanner()
        self._tokens: list[Token] = []
        self._words = self._size = 0
        self._undecided = ""
        self._melody = MelodyState()
        self._open = False
        self._silent_so_far = True
        self._asks_with_word = False

    @property
    def pending_words(self) -> int:
        """How many complete words wait for their phrase to end."""
        return self._words

    def feed(self, text: str) -> list[Utterance]:
        """Takes the next characters of the turn; returns the phrases that they complete."""
        out: list[Utterance] = []
        for event in self._scanner.feed(text):
            if isinstance(event, NewLine):
                self._close("line", out)
            else:
                self._run(*event, out)
        return out

    def hold(self) -> list[Utterance]:
        """The text has stalled: the complete words now, as an open utterance; [] if there are none."""
        if not self._words:
            return []
        return self._commit(self._take(len(self._tokens)), "open")

    def end(self) -> list[Utterance]:
        """The text is over: everything left. The last utterance of a turn that spoke is closed."""
        out: list[Utterance] = []
        for event in self._scanner.end():
            self._run(*event, out)
        self._close("sentence", out)
        return out

    def _run(self, run: str, start: int, out: list[Utterance]) -> None:
        for token in self._language.segmenter.tokens(run, start):
            if ends_before(self._undecided, token.text):
                self._close("sentence", out)
            self._undecided = token.stop
            if token.expression:
                self._close("smiley", out)
                out.append(self._smiley(token))
                continue
            self._tokens.append(token)
            self._words += _is_word(token)
            self._size += len(token.text)
            if token.stop in self._language.stops:
                self._close(token.stop, out)
            elif self._words >= MAX_PENDING or self._size >= MAX_PENDING_CHARACTERS:
                out += self._commit(self._take(self._cut()), "open")

    def _close(self, kind: str, out: list[Utterance]) -> None:
        if self._tokens or self._open:
            out += self._commit(self._take(len(self._tokens)), kind)

    def _take(self, count: int) -> list[Token]:
        taken, self._tokens = self._tokens[:count], self._tokens[count:]
        self._words = sum(_is_word(t) for t in self._tokens)
        self._size = sum(len(t.text) for t in self._tokens)
        return taken

    def _cut(self) -> int:
        """Where to cut a long phrase: before a late function word if there is one."""
        for i in range(len(self._tokens) - 2, MIN_PIECE - 1, -1):
            if core(self._tokens[i].text).lower() in self._language.cut_before:
                return i
        return len(self._tokens)

    def _smiley(self, token: Token) -> Utterance:
        self._silent_so_far = False
        phone = Phone(SILENCE, token.silence_ms, expression=token.expression)
        return Utterance(self._language.name, (phone,))

    def _commit(self, tokens: Sequence[Token], kind: str) -> list[Utterance]:
        """Speaks the tokens and ends the phrase as `kind` says."""
        items = self._language.normalise(tokens)
        phones = self._speak(items, self._stop(items, kind))
        closing = kind != "open"
        if not phones and not (closing and self._open):
            return []
        self._open = not closing
        if closing:
            stop = self._language.stops[kind]
            phones.append(Phone(SILENCE, max(stop.pause_ms / self._rate, MIN_PAUSE_MS)))
            self._restart(stop)
        if self._silent_so_far:
            phones.insert(0, Phone(SILENCE, LEAD_MS))
            self._silent_so_far = False
        words = tuple(Word(item.text, item.start, item.end) for item in items)
        return [Utterance(self._language.name, tuple(phones), words, closed=closing)]

    def _stop(self, items: Iterable[Item], kind: str) -> Stop:
        """The phrase end; a question is told by its first words, which may have been spoken already."""
        if not self._open:
            spoken = [word for item in items for word in item.spoken]
            self._asks_with_word = self._language.asks_with_word(spoken)
        if kind == "question" and self._asks_with_word:
            kind = "word_question"
        return self._language.stops[kind]

    def _restart(self, stop: Stop) -> None:
        self._melody.elapsed_ms *= 1.0 - stop.reset
        self._melody.f0 = None
        self._melody.accents = 0

    def _speak(self, items: Sequence[Item], stop: Stop) -> list[Phone]:
        spoken = [word for item in items for word in item.spoken]
        owner = [i for i, item in enumerate(items) for _ in item.spoken]
        language = self._language
        functions = [word in language.function_words for word in spoken]
        segments = language.durations.segments(language.pronounce(spoken), functions)
        if not segments:
            return []
        language.durations.assign(segments, self._rate, final=stop.tune != "open")
        points = language.melody.contour(segments, stop.tune, self._melody)
        pitch = share(points, segments, self._f0_hz)
        return [_phone(s, p, owner[s.word]) for s, p in zip(segments, pitch, strict=True)]


def _is_word(token: Token) -> bool:
    return any(c.isalnum() for c in token.text)


def _phone(segment: Segment, pitch: tuple[tuple[float, float], ...], word: int) -> Phone:
    return Phone(segment.info.name, segment.ms, pitch, segment.stress, word)
