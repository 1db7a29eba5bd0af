"""Text, as it arrives, to utterances: the incremental front-end of one turn."""

from __future__ import annotations

from itertools import groupby
from typing import Final

from fapstream.records import SILENCE, Note, Phone, Spoken, Utterance, Word
from fapstream.tts import prosody as prosodies
from fapstream.tts.language import language
from fapstream.tts.manner import Manner
from fapstream.tts.markup import PLAIN
from fapstream.tts.normalise import Item
from fapstream.tts.plan import PlannedWord, Planner
from fapstream.tts.pronounce import LEFT
from fapstream.tts.reader import Event, Pause, Reader
from fapstream.tts.segment import UNDECIDED, WRAPPED, NewLine, Token, ends_before

MAX_TOKENS: Final = 24
"""Tokens are read on at the latest when so many wait."""
LONGEST_PHRASE: Final = 80
"""After so many tokens without a mark that ends a phrase it ends like at a comma: whoever speaks takes
breath, and what is kept of a phrase is bounded."""
PARAGRAPH_MS: Final = 250.0
"""A blank line adds so much to the pause."""


class FrontEnd:
    """Reads one turn. Fragments of any size give the same phones as the whole text at once.

    Pure and synchronous: every method returns the utterances that can no longer change. Only `hold` depends
    on when it is called, and all it does is to insert phones marked as `hold`.
    """

    def __init__(self, lang: str, manner: Manner | None = None) -> None:
        """Raises UnknownLanguage, DataError."""
        self._lang = lang
        self._manner = manner = manner or Manner()
        self._language = language(lang)
        plain = not (manner.prosody or manner.means)
        prosody = prosodies.standard(lang) if plain else _prosody(lang, manner)
        self._sounds = prosody.sounds
        self._planner = Planner(lang, prosody, manner)
        self._reader = Reader(lambda name: language(name).segmenter, lang, self._language.say_as)
        self._tokens: list[Token] = []
        self._length = 0
        """Tokens of the phrase."""
        self._undecided = ""
        """A phrase end that the next token decides."""
        self._spoken: list[Spoken] = []
        """Words whose phones wait for the word after them."""
        self._items: list[Item] = []
        """Where each of those was read from."""
        self._context: list[Spoken] = []
        """The last LEFT words before those."""
        self._opening: list[Spoken] = []
        """The first words of the phrase."""
        self._before = ""
        self._blank_lines = 0
        self._said = False
        """Something has been said since the last blank line."""
        self._out: list[Utterance] = []

    def fresh(self) -> FrontEnd:
        """Another one for the same language and manner, that has read nothing."""
        return FrontEnd(self._lang, self._manner)

    @property
    def pending_words(self) -> int:
        """How many words wait for what follows them: complete tokens, and words not yet committed."""
        return sum(map(_is_word, self._tokens)) + len(self._spoken) + self._planner.pending

    @property
    def speaking(self) -> bool:
        """A phrase has begun to be spoken and waits for more text; `hold` would fill the gap."""
        return self._planner.speaking

    def feed(self, text: str) -> list[Utterance]:
        """Takes the next characters of the turn; returns what they complete."""
        for event in self._reader.feed(text):
            if isinstance(event, Token):
                self._token(event)
            else:
                self._take(event)
        if self._tokens:
            self._advance(False)
        return self._utterances()

    def hold(self) -> list[Utterance]:
        """The text has stalled: the last sound drawn out and a pause, if a phrase is being spoken."""
        self._planner.hold()
        return self._planner.take()

    def end(self) -> list[Utterance]:
        """The text is over: everything left. The last utterance of a turn that spoke is closed."""
        for event in self._reader.end():
            self._take(event)
        self._close("sentence")
        self._planner.finish()
        return self._utterances()

    def discard(self) -> None:
        """Forgets the words that are not committed; what is fed next goes on after those that are."""
        self._tokens.clear()
        self._spoken.clear()
        self._items.clear()
        self._planner.discard()
        self._undecided = ""

    def path(self, word: Word) -> str:
        """How each of a word's spoken words got its phones: user, letter, lexicon, stem, compound, tree,
        rule."""
        own = word.text.lower() in self._manner.lexicon
        paths = dict.fromkeys("user" if own else self._language.pronounce.path(s) for s in word.spoken)
        return "+".join(paths)

    def _utterances(self) -> list[Utterance]:
        out, self._out = self._out, []
        return out + self._planner.take()

    # what the reader finds

    def _take(self, event: Event) -> None:
        if isinstance(event, Token):
            self._token(event)
        elif isinstance(event, NewLine):
            self._line(event)
        elif isinstance(event, Note):
            self._planner.note(event)
        else:
            self._pause(event)

    def _token(self, token: Token) -> None:
        self._blank_lines = 0
        self._said = True
        self._length += 1
        if self._undecided:
            undecided, self._undecided = self._undecided, ""
            if ends_before(undecided, token.text, self._language.openings, self._language.inside):
                self._close(UNDECIDED[undecided])
        stop = token.stop
        if not stop:
            self._tokens.append(token)
            if self._length >= LONGEST_PHRASE:
                self._close("comma")
            elif len(self._tokens) >= MAX_TOKENS:
                self._advance(False)
        elif stop in UNDECIDED:
            token.stop = ""
            self._tokens.append(token)
            self._undecided = stop
        elif token.expression:
            self._close("smiley")
            self._planner.express(Phone(SILENCE, token.silence_ms, expression=token.expression))
            self._out += self._planner.take()
        else:
            self._tokens.append(token)
            self._close(stop)

    def _line(self, line: NewLine) -> None:
        if line.length == 1:
            self._blank_lines += 1
            self._close("paragraph")
            if self._blank_lines == 1 and self._said:
                self._pause(Pause("paragraph", PARAGRAPH_MS))
        elif line.length >= WRAPPED and not self._undecided:
            self._undecided = "wrapped"
        else:
            self._close("line")

    def _pause(self, pause: Pause) -> None:
        self._undecided = ""
        self._advance(True)
        self._planner.close(pause.kind, pause.ms)
        self._end_phrase()

    # from tokens to the planner

    def _close(self, kind: str) -> None:
        """The phrase ends, if there is one."""
        self._undecided = ""
        self._advance(True)
        self._planner.close(kind)
        self._end_phrase()

    def _end_phrase(self) -> None:
        self._out += self._planner.take()
        self._length = 0
        self._context.clear()
        self._opening.clear()
        self._before = ""

    def _advance(self, closed: bool) -> None:
        """Reads and pronounces what is certain, and hands it to the planner."""
        for lang, tokens in self._runs():
            last = len(tokens) == len(self._tokens)
            normalise = (language(lang) if lang else self._language).normalise
            taken = normalise.take(tokens, closed or not last, self._before, self._manner.lexicon)
            del self._tokens[: taken.used]
            if taken.items:
                for item in taken.items:
                    for word in item.spoken:
                        self._spoken.append(word)
                        self._items.append(item)
                self._before = taken.items[-1].text
            if taken.used < len(tokens):
                break
        if self._spoken:
            self._pronounce(closed)
        if not closed:
            self._planner.advance()

    def _runs(self) -> list[tuple[str, list[Token]]]:
        """The tokens that wait, those of one language together."""
        tokens = self._tokens[:]
        if not [token for token in tokens if token.style is not PLAIN]:
            return [("", tokens)] if tokens else []
        return [(lang, list(run)) for lang, run in groupby(tokens, lambda token: token.style.lang)]

    def _pronounce(self, closed: bool) -> None:
        words, items, context, lang = self._spoken, self._items, self._context, self._language
        count = len(words)
        if not closed and lang.pronounce.needs_next(words[-1]):
            count -= 1
        if not count:
            return
        phones = lang.pronounce([*context, *words], len(context))
        if len(self._opening) < 2:
            self._opening += words[: 2 - len(self._opening)]
        planned = []
        for i in range(count):
            word, item = words[i], items[i]
            sounds = [self._sounds[token] for token in phones[i]]
            function = lang.is_weak(word, item.text)
            whole = i + 1 == len(items) or items[i + 1] is not item
            planned.append(PlannedWord(item, sounds, function, word in lang.cut_before, whole))
        self._planner.add(planned, lang.asks_with_word(self._opening))
        self._context = [*context, *words[:count]][-LEFT:]
        del words[:count], items[:count]


def _prosody(lang: str, manner: Manner) -> prosodies.Prosody:
    return prosodies.prosody(lang, manner.prosody, manner.means.get(lang, {}))


def _is_word(token: Token) -> bool:
    return bool(token.word) or any(c.isalnum() for c in token.text)
