"""The corridor: text in, utterances out to a voice; speech back in, ordered packets out.

Pure: who runs the voice and waits for it is `talk`.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from fapstream.motion import FaceTrack
from fapstream.records import Mark, Packet, Speech, TimedPhone, TurnFormat, Utterance, Word
from fapstream.stream import Loudness, Packetizer
from fapstream.tts import FrontEnd

DRY_PACKETS = 2
"""With less than so many packets' worth of planned sound left, a turn counts as run dry."""


@dataclass(frozen=True, slots=True)
class _Caption:
    """What is said of a phrase up to the character `end`, to be shown from `word` on; `first`: its first
    word."""

    word: Word
    first: Word
    text: str
    end: int


class Pipeline:
    """One turn from text to packets."""

    def __init__(self, turn: TurnFormat, frontend: FrontEnd, seed: int = 0) -> None:
        self.turn = turn
        self._frontend = frontend
        self._track = FaceTrack(turn.lang, turn.sample_rate, turn.fps, seed)
        self._packetizer = Packetizer(turn)
        self._loudness = Loudness(turn.sample_rate)
        self._text = _Text()
        self._captions: deque[_Caption] = deque()
        self._caption_text = ""
        self._caption_start: Word | None = None
        self._lengths: deque[tuple[Word, list[float]]] = deque()
        """Of every word to come: how long its phones wish to be, ms."""
        self._word: Word | None = None
        self._word_ends: list[int] = []
        self._word_samples: list[int] = []
        self._planned_end = 0

    # text side

    def feed(self, text: str) -> list[Utterance]:
        """Phrases that can be spoken now that `text` has come."""
        self._text.add(text)
        return self._note(self._frontend.feed(text))

    def hold(self) -> list[Utterance]:
        """The text has stalled: what fills the gap until it goes on."""
        return self._note(self._frontend.hold())

    def end(self) -> list[Utterance]:
        """The text is over: what is left."""
        return self._note(self._frontend.end())

    @property
    def pending_words(self) -> int:
        """Words that wait for the words after them."""
        return self._frontend.pending_words

    @property
    def speaking(self) -> bool:
        """A phrase is being spoken and waits for more text: a hold would fill the gap."""
        return self._frontend.speaking

    def _note(self, utterances: list[Utterance]) -> list[Utterance]:
        for u in utterances:
            if u.words:
                self._caption_text = (
                    f"{self._caption_text} {self._text.take(u.words[0].start, u.words[-1].end)}"
                )
                self._caption_start = self._caption_start or u.words[0]
                self._captions.append(
                    _Caption(u.words[0], self._caption_start, self._caption_text.strip(), u.words[-1].end)
                )
                self._lengths += _lengths_ms(u)
            if u.closed and not all(p.hold for p in u.phones):
                self._caption_text, self._caption_start = "", None
        return utterances

    # speech side

    def add(self, speech: Speech) -> None:
        """Sound from the voice, and the true times of its phones."""
        self._track.add(speech.phones)
        marks = [mark for i in range(len(speech.phones)) for mark in self._marks(speech.phones, i)]
        self._loudness.add(speech.phones)
        self._packetizer.add(speech.start, self._loudness.apply(speech.start, speech.pcm), marks)
        if speech.phones:
            self._planned_end = speech.phones[-1].end

    def packets(self, dry: bool = False, last: bool = False) -> Iterator[Packet]:
        """Packets that are complete. `dry`: no text waits. `last`: nothing will follow."""
        while (end := self._packetizer.next_end(last)) is not None:
            if not last and self._track.ready_until() < end:
                return
            frames = self._track.frames(end)
            left = self._planned_end - end
            hold = dry and not last and left < DRY_PACKETS * self._packetizer.packet_samples
            yield self._packetizer.cut(end, frames, hold)

    @property
    def produced(self) -> int:
        """Samples given out in packets."""
        return self._packetizer.cut_end

    @property
    def planned(self) -> int:
        """Sample at which the last phone handed to the voice ends, as far as is known."""
        return max(self._planned_end, self._packetizer.pcm_end)

    def heard_char(self, sample: int) -> int:
        """Code points of the text heard by `sample`: to the end of the last word begun."""
        i = bisect_right(self._word_samples, sample)
        return self._word_ends[i - 1] if i else 0

    def _marks(self, phones: tuple[TimedPhone, ...], i: int) -> Iterator[Mark]:
        """Marks that begin with phone i."""
        timed = phones[i]
        word = timed.text
        if word is not None and word is not self._word and word != self._word:
            if caption := self._caption_at(word):
                yield self._caption(phones, i, caption)
            end = self._word_end(phones, word)
            self._word_samples.append(timed.start)
            self._word_ends.append(word.end)
            yield Mark("word", timed.start, end - timed.start, word.text, word.start, word.end)
        self._word = word if word is not None else self._word
        length = timed.end - timed.start
        for note in timed.phone.notes:
            yield Mark(note.kind, timed.start, 0, note.text, note.start, note.end)
        yield Mark("phone", timed.start, length, timed.phone.name)
        if timed.phone.expression:
            yield Mark("expression", timed.start, length, timed.phone.expression)

    def _word_end(self, phones: tuple[TimedPhone, ...], word: Word) -> int:
        """Where a word ends; for those of its phones whose time is not known yet, their wish counts."""
        ends = [p.end for p in phones if p.text == word and not p.phone.hold]
        while self._lengths and self._lengths[0][0].start < word.start:
            self._lengths.popleft()
        wished = self._lengths[0][1] if self._lengths and self._lengths[0][0] == word else []
        return ends[-1] + round(sum(wished[len(ends) :]) * self.turn.sample_rate / 1000)

    def _caption_at(self, word: Word) -> _Caption | None:
        """The caption that begins with this word, or with one before it that is not said."""
        found = None
        while self._captions and self._captions[0].word.start <= word.start:
            found = self._captions.popleft()
        return found

    def _caption(self, phones: tuple[TimedPhone, ...], i: int, caption: _Caption) -> Mark:
        ends = [p.end for p in phones[i:] if p.text is not None and p.text.end <= caption.end]
        start = phones[i].start
        return Mark("caption", start, max(ends) - start, caption.text, caption.first.start, caption.end)


def _lengths_ms(utterance: Utterance) -> list[tuple[Word, list[float]]]:
    lengths: list[tuple[Word, list[float]]] = [(word, []) for word in utterance.words]
    for phone in utterance.phones:
        if phone.word >= 0:
            lengths[phone.word][1].append(phone.duration_ms)
    return lengths


class _Text:
    """The turn's text from the last phrase handed out on, addressed by offsets into the whole."""

    def __init__(self) -> None:
        self._start = 0
        self._parts: list[str] = []

    def add(self, text: str) -> None:
        self._parts.append(text)

    def take(self, start: int, end: int) -> str:
        """Characters [start, end) and the punctuation that closes them; what lies before is forgotten."""
        text = "".join(self._parts)
        after = end - self._start
        while after < len(text) and text[after] in ".,;:!?…»)”’\"'":
            after += 1
        self._parts = [text[after:]]
        taken = text[max(0, start - self._start) : after]
        self._start += after
        return " ".join(taken.split())
