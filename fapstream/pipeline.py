"""The corridor: text in, utterances out to a voice; speech back in, ordered packets out.

Pure: who runs the voice and waits for it is `talk`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from fapstream.motion import FaceTrack, Motion
from fapstream.records import Mark, Packet, Speech, TimedPhone, TurnFormat, Utterance, Word
from fapstream.stream import KeptText, Loudness, Packetizer, SaidWord, SaidWords
from fapstream.tts import FrontEnd

DRY_PACKETS = 2
"""With less than so many packets' worth of planned sound left, a turn counts as run dry."""

UNSAID = 4096
"""Text in which nothing that can be said is kept no longer than so many characters."""

ASKING = {"el": ";\u037e"}
"""What ends sentences of a language besides `.!?…`."""


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

    def __init__(
        self, turn: TurnFormat, frontend: FrontEnd, seed: int = 0, motion: Motion | None = None
    ) -> None:
        self.turn = turn
        self._track = FaceTrack(turn.lang, turn.sample_rate, turn.fps, seed, motion)
        self._packetizer = Packetizer(turn)
        self._kept = KeptText()
        self._said = SaidWords(ASKING.get(turn.lang, ""))
        self._begin(frontend, 0, 0)

    def _begin(self, frontend: FrontEnd, sample: int, char: int) -> None:
        """Text that begins at a character is spoken from a sample on, as if nothing had been before."""
        self._frontend = frontend
        self._sample, self._char = sample, char
        self._loudness = Loudness(self.turn.sample_rate)
        self._text = _Text()
        self._captions: deque[_Caption] = deque()
        self._caption_text = ""
        self._caption_start: Word | None = None
        self._lengths: deque[tuple[Word, list[float]]] = deque()
        """Of every word to come: how long its phones wish to be, ms."""
        self._word: Word | None = None
        self._planned_end = sample

    def cut(self, sample: int, char: int) -> int:
        """Ends what is planned and goes on with other text, whose first character is `char`.

        Returns t, from which on all sound, marks and frames are void, also those in packets already: the end
        of the word that is heard at `sample`, or `sample` itself in a pause; never beyond the sound that is
        there. The next packets end at t, if they do not reach it yet, and then one begins at t exactly.
        Whoever calls drops the voice that spoke, and lets another begin at its own sample 0.
        """
        word = self._said.at(sample)
        end = word.end if word else 0
        t = min(max(sample, end), self._packetizer.pcm_end)
        self._track.cut(t)
        self._packetizer.cut_back(t)
        self._said.cut(t, char)
        self._kept.cut(char)
        self._begin(self._frontend.fresh(), t, char)
        return t

    # text side

    def keep(self, text: str, waiting: int) -> None:
        """Text that has come, for `text_from`; with it, `waiting` characters wait to be fed."""
        self._kept.add(text, waiting)

    def text_from(self, char: int) -> str:
        """The text kept from a character on, or from the oldest that is kept."""
        return self._kept.since(char)

    def feed(self, text: str) -> list[Utterance]:
        """Phrases that can be spoken now that `text` has come."""
        self._text.add(text)
        utterances = self._note(self._frontend.feed(text))
        if not self.pending_words:
            self._text.keep(UNSAID)
        return utterances

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
                if self._caption_start is None:
                    self._caption_start = u.words[0]
                    self._said.begin_phrase(self._char + u.words[0].start)
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
        start, phones = self._sample + speech.start, speech.phones
        if self._sample:
            at = self._sample
            phones = tuple([TimedPhone(t.phone, t.start + at, t.end + at, t.text) for t in phones])
        self._track.add(phones)
        marks = [mark for i in range(len(phones)) for mark in self._marks(phones, i)]
        self._loudness.add(phones)
        self._packetizer.add(start, self._loudness.apply(start, speech.pcm), marks)
        if phones:
            self._planned_end = phones[-1].end

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
        return self.heard_word(sample)[1]

    def heard_word(self, sample: int) -> tuple[int, int]:
        """The characters [start, end) of the last word begun by `sample`; (0, 0) before the first."""
        word = self._said.at(sample)
        return (word.char_start, word.char_end) if word else (0, 0)

    def said_until(self, sample: int, char: int) -> SaidWord | None:
        """The last word whose text ends by a character; no earlier one than that heard at a sample."""
        return self._said.until(sample, char)

    def sentence(self, sample: int, back: int) -> int:
        """The character with which the sentence heard at `sample` begins, or one so many before it."""
        return self._said.sentence(self._kept, self.heard_word(sample)[0], back)

    def _marks(self, phones: tuple[TimedPhone, ...], i: int) -> Iterator[Mark]:
        """Marks that begin with phone i."""
        timed = phones[i]
        word = timed.text
        if word is not None and word is not self._word and word != self._word:
            if caption := self._caption_at(word):
                yield self._caption(phones, i, caption)
            end, at = self._word_end(phones, word), self._char
            self._said.add(SaidWord(timed.start, end, at + word.start, at + word.end))
            yield Mark("word", timed.start, end - timed.start, word.text, at + word.start, at + word.end)
        self._word = word if word is not None else self._word
        length = timed.end - timed.start
        for note in timed.phone.notes:
            at = self._char
            yield Mark(note.kind, timed.start, 0, note.text, at + note.start, at + note.end)
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
        start, at = phones[i].start, self._char
        return Mark(
            "caption", start, max(ends) - start, caption.text, at + caption.first.start, at + caption.end
        )


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

    def keep(self, most: int) -> None:
        """Forget the oldest pieces, so that no more than so many characters are left, or one piece."""
        while len(self._parts) > 1 and sum(map(len, self._parts)) > most:
            self._start += len(self._parts.pop(0))

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
