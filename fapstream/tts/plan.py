"""The plan of a phrase: words with their phones become timed phones with melody, as far as they are certain.

After the incremental units of Schlangen and Skantze, "A general, abstract model of incremental dialogue
processing" (2009): words are added as they come, what is planned of the last ones is open to revision, and a
word is committed, for ever, once so many words have been added after it as the look-ahead asks for, or its
phrase has ended. What a word is planned with is exactly that look-ahead, however much more is there already,
so the plan depends on the text and the look-ahead alone and never on when the text came.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Final

from fapstream.records import SILENCE, Note, Phone, Utterance, Word, make
from fapstream.tts.manner import PHRASE, Manner
from fapstream.tts.markup import PLAIN
from fapstream.tts.melody import MelodyState, Pitch
from fapstream.tts.normalise import Item
from fapstream.tts.prosody import Prosody
from fapstream.tts.sounds import Sound

LEAD_MS: Final = 15.0
"""Silence before the first phone of a turn."""
MIN_PAUSE_MS: Final = 100.0
MAX_PENDING: Final = 20
MIN_PIECE: Final = 12
"""With unlimited look-ahead a phrase longer than so many words is spoken without waiting for its end, cut
after at least MIN_PIECE words."""

HOLD_MS: Final = 140.0
HOLD_PAUSE_MS: Final = 160.0
"""When the text has run dry: how long the last sound is drawn out, and the pause after it."""
_DRAWN: Final = frozenset(("vowel", "fricative", "nasal", "liquid"))


class PlannedWord:
    """A spoken word whose phones are certain.

    `item`: where it was read from, `whole`: it is the item's last word. `ends`: the phrase end written on
    it, "" if none. `cut`: a long phrase may be cut before it. `stressed`: index of the vowel with the
    primary stress, -1 if there is none; `accent`: the same if the word bears a pitch accent.
    """

    __slots__ = ("accent", "cut", "ends", "function", "item", "n_vowels", "sounds", "stressed", "whole")

    def __init__(self, item: Item, sounds: list[Sound], function: bool, cut: bool, whole: bool) -> None:
        self.item = item
        self.whole = whole
        self.sounds = sounds
        self.function = function
        self.cut = cut
        self.ends = item.stop if whole else ""
        self.n_vowels = 0
        self.stressed = -1
        for i, sound in enumerate(sounds):
            if sound.vowel:
                self.n_vowels += 1
                if sound.stress == 1:
                    self.stressed = i
        emphasis = item.style.emphasis
        weak = emphasis < 0.0 or (function and emphasis == 0.0)
        self.accent = -1 if weak else self.stressed


class Planner:
    """Plans the phrases of a turn, one after the other, and hands out utterances."""

    def __init__(self, lang: str, prosody: Prosody, manner: Manner) -> None:
        self._lang = lang
        self._prosody = prosody
        self._manner = manner
        self._register = manner.f0_hz * manner.pitch, manner.range_hz
        self._state = MelodyState()
        self._words: list[PlannedWord] = []
        self._asks = False
        self._phones: list[Phone] = []
        self._said: list[Word] = []
        self._item: Item | None = None
        """The one that the last of `_said` stands for."""
        self._notes: deque[Note] = deque()
        self._silent_so_far = True
        self._begun = False
        """Something of the phrase has been committed."""
        self._last: tuple[Sound, Phone] | None = None
        """The last phone committed, if the phrase has not ended nor been held since."""

    @property
    def pending(self) -> int:
        """Words that wait for words after them."""
        return len(self._words)

    @property
    def speaking(self) -> bool:
        """The phrase has begun to be spoken and has not ended, nor been held."""
        return self._last is not None

    # what comes in

    def note(self, note: Note) -> None:
        """A mark or warning; it goes with the first phone after it."""
        self._notes.append(note)

    def add(self, words: Sequence[PlannedWord], asks: bool) -> None:
        """The next words of the phrase. `asks`: it began with a question word."""
        self._words += words
        self._asks = asks

    def advance(self) -> None:
        """Commits the words that have their look-ahead."""
        words, ahead = self._words, self._manner.look_ahead
        if ahead >= PHRASE:
            self._shorten()
            return
        count = len(words) - ahead
        while count > 0 and not words[count - 1].whole:
            count -= 1
        self._commit(count)

    def close(self, kind: str, pause_ms: float | None = None) -> None:
        """The phrase ends as `kind` says, if there is one; `pause_ms`: a pause that is asked for in any
        case."""
        words, ahead = self._words, self._manner.look_ahead
        if not (words or self._begun) and pause_ms is None:
            return
        if ahead >= PHRASE:
            self._shorten()
        if kind == "question" and self._asks:
            kind = "word_question"
        stop = self._prosody.stops[kind]
        written = bool(words) and bool(words[-1].ends)
        later = sum([w.accent >= 0 for w in words])
        for left, word in zip(range(len(words) - 1, -1, -1), words, strict=True):
            later -= word.accent >= 0
            in_sight = left < ahead or (left == ahead and written)
            if in_sight and not left and not self._state.accents and word.accent < 0:
                word.accent = word.stressed  # no phrase is without an accent
            self._word(word, stop.tune if in_sight else None, not left, not later)
        words.clear()
        if pause_ms is None:
            pause_ms = max(stop.pause_ms / self._manner.rate, MIN_PAUSE_MS)
        self._silence(Phone(SILENCE, pause_ms))
        self._state.restart(stop.reset)
        self._begun = False
        self._last = None

    def express(self, phone: Phone) -> None:
        """A silent phone of its own, between phrases."""
        self._silence(phone)
        self._silent_so_far = False

    def hold(self) -> None:
        """The text has run dry inside a phrase: the last sound is drawn out, as a speaker does who searches
        for a word, and a pause follows. What is planned later is what it would have been."""
        if self._last is None:
            return
        sound, phone = self._last
        if sound.kind in _DRAWN:
            level = ((0.0, phone.pitch[-1][1]),)
            self._phones.append(Phone(sound.name, HOLD_MS, level, sound.stress, gain=phone.gain, hold=True))
        self._phones.append(Phone(SILENCE, HOLD_PAUSE_MS, hold=True))
        self._last = None

    def finish(self) -> None:
        """The turn is over: notes that nothing came after."""
        if self._notes:
            self._silence(Phone(SILENCE, LEAD_MS))

    def discard(self) -> None:
        """Forgets the words that are not committed."""
        self._words.clear()

    def take(self) -> list[Utterance]:
        """What has been committed since the last time, as one utterance; [] if nothing has."""
        if not self._phones:
            return []
        closed = self._phones[-1].name == SILENCE
        found = Utterance(self._lang, tuple(self._phones), tuple(self._said), closed)
        self._phones, self._said, self._item = [], [], None
        return [found]

    # what is certain

    def _shorten(self) -> None:
        """Commits the beginning of a phrase that is too long to wait for."""
        while len(self._words) > MAX_PENDING and (count := self._cut()):
            self._commit(count)

    def _cut(self) -> int:
        """Where to cut a long phrase: before a late function word if there is one, never inside an item."""
        words = self._words
        late = range(MAX_PENDING - 2, MIN_PIECE - 1, -1)
        for i in late:
            if words[i].cut and words[i - 1].whole:
                return i
        ends = [i for i, word in enumerate(words, 1) if word.whole]
        return max((i for i in ends if i <= MAX_PENDING), default=0) or min(ends, default=0)

    def _commit(self, count: int) -> None:
        """Plans the first `count` words for good; the phrase goes on after them."""
        for word in self._words[: max(count, 0)]:
            self._word(word, None, False, False)
        del self._words[: max(count, 0)]

    def _word(self, word: PlannedWord, tune_name: str | None, last: bool, last_accent: bool) -> None:
        """Plans one word. `tune_name`: that of the phrase's end if it is in sight, and then `last` and
        `last_accent` say whether the word is its last and bears its last accent."""
        item, sounds, prosody, state = word.item, word.sounds, self._prosody, self._state
        if not sounds:
            return
        melody, style, register = prosody.melody, item.style, self._register
        rate, gain = self._manner.rate, self._manner.volume
        tune = melody.tunes[tune_name] if tune_name else None
        final = last and tune is not None
        ms = prosody.durations.word(sounds, word.n_vowels, word.function, final)
        if style is not PLAIN:
            register = register[0] * style.pitch, register[1] * style.range
            rate *= style.rate / (1.0 + prosody.emphasis_length * max(style.emphasis, 0.0))
            gain *= style.volume * (1.0 + prosody.emphasis_gain * style.emphasis)
        if rate != 1.0:
            ms = [d / rate for d in ms]
        accent, height = word.accent, 0.0
        if accent >= 0:
            height = melody.height(state, tune, last_accent, style.emphasis)
        pitch = melody.word(ms, accent, height, state, register)
        if final and tune is not None:
            melody.ending(sounds, ms, pitch, tune, register)
        self._emit(item, sounds, ms, pitch, gain)

    def _emit(
        self, item: Item, sounds: list[Sound], ms: list[float], pitch: list[Pitch], gain: float
    ) -> None:
        if self._silent_so_far:
            self._phones.append(Phone(SILENCE, LEAD_MS))
            self._silent_so_far = False
        if item is not self._item:
            self._item = item
            self._said.append(make(Word, (item.text, item.start, item.end, tuple(item.spoken))))
        index = len(self._said) - 1
        new_tuple, kind = make, Phone  # looked up once
        new = [
            new_tuple(kind, (sound.name, ms[i], pitch[i], sound.stress, index, None, gain, (), False))
            for i, sound in enumerate(sounds)
        ]
        notes = self._notes
        if notes and notes[0].start <= item.start:
            new[0] = new[0]._replace(notes=self._notes_until(item.start))
        self._phones += new
        self._last = sounds[-1], new[-1]
        self._begun = True

    def _silence(self, phone: Phone) -> None:
        """A pause; every note that came before it goes with it."""
        self._phones.append(phone._replace(notes=tuple(self._notes)) if self._notes else phone)
        self._notes.clear()

    def _notes_until(self, start: int) -> tuple[Note, ...]:
        found = []
        while self._notes and self._notes[0].start <= start:
            found.append(self._notes.popleft())
        return tuple(found)
