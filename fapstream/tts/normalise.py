"""Tokens to the words that are spoken: plain words at once, everything else by patterns.

A spoken word is a string of lower-case letters of one script; a single capital letter stands for that
letter's name; phones that are given stand for themselves. What has no letters or digits of a known script is
passed over in silence.
"""

from __future__ import annotations

import re
import unicodedata
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fapstream.records import Spoken
from fapstream.tts.markup import PLAIN, Style
from fapstream.tts.patterns import Patterns, Reading, Vocabulary
from fapstream.tts.segment import INITIALS, Token, core
from fapstream.tts.spelling import Speller

_IGNORED = "\u0300-\u036f\u00ad\u200b-\u200d\u2060"
_GREEK = f"[\u0370-\u0373\u0376\u0377\u037b-\u037d\u0386\u0388-\u03ff\u1f00-\u1fff][{_IGNORED}]*"
_LATIN = f"[a-zA-Z\u00aa\u00ba\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u024f\u1e00-\u1eff\uff21-\uff5a][{_IGNORED}]*"
_WORDS = re.compile(rf"(?P<greek>(?:{_GREEK})+)|(?P<latin>(?:{_LATIN})+(?:['’](?:{_LATIN})+)*)")
_NUMERIC = re.compile(r"[#+\-−.]{0,2}\d")
_STARTER = re.compile(r"(?:[^\W\d_]|\.(?=[^\W\d_]))+\.?")
MAX_GROUP = 8
"""Tokens that may be read together."""
BETWEEN = "./-"
"""Signs that are read between words of two letters or more only, as in example.com."""


Lexicon = Mapping[str, tuple[Spoken, ...]]
_NO_LEXICON: Lexicon = {}


@dataclass(slots=True)
class Item:
    """Characters [start, end) of the turn and the words they are read as.

    `stop`: the phrase end that is written on it, "" if none (see `Token.stop`).
    """

    text: str
    start: int
    end: int
    spoken: list[Spoken]
    style: Style = PLAIN
    stop: str = ""


@dataclass(slots=True)
class Taken:
    """Items in order, and how many of the tokens they come from."""

    items: list[Item] = field(default_factory=list)
    used: int = 0


class Normaliser:
    """Reads the tokens of a phrase in one language; words of the other script stay what they are."""

    def __init__(self, vocabulary: Vocabulary, patterns: Patterns, speller: Speller) -> None:
        self._patterns = patterns
        self._words = speller.words
        classes = vocabulary.classes
        self._abbreviations = classes["abbreviation"]
        self._symbols = classes["symbol"]
        self._signs = frozenset(classes["sign"])
        self._starters = {form: name for name in patterns.places for form in classes.get(name, ())}
        self._going_on = frozenset(form.lower() for name in patterns.going_on for form in classes[name])

    def take(
        self, tokens: Sequence[Token], closed: bool, before: str = "", lexicon: Lexicon = _NO_LEXICON
    ) -> Taken:
        """The items of the tokens that nothing after them can change.

        `closed`: the phrase ends after the tokens; `before`: the word before them, lower-case; `lexicon`: the
        user's own readings. Every item has at least one spoken word.
        """
        taken = Taken()
        while taken.used < len(tokens):
            token = tokens[taken.used]
            if lexicon and (own := self._own(token, lexicon)):
                taken.items.append(own)
                taken.used += 1
            elif token.word or token.said:
                if self._starts(token):
                    if not self._group(taken, tokens, closed, before):
                        break
                else:
                    self._single(taken, token)
            elif not self._group(taken, tokens, closed, before):
                break
            if taken.items:
                before = taken.items[-1].text.lower()
        return taken

    def _own(self, token: Token, lexicon: Lexicon) -> Item | None:
        """The token as the user wants it read."""
        bare = core(token.text)
        forms = (bare, bare.removesuffix("."), token.word)
        bare, spoken = next(
            ((form, lexicon[form.lower()]) for form in forms if form.lower() in lexicon), ("", ())
        )
        if not spoken or token.said:
            return None
        start = token.text.index(bare)
        text = (token.raw or token.text)[start : start + len(bare)]
        return Item(
            text, token.start + start, token.start + start + len(bare), list(spoken), token.style, token.stop
        )

    def _starts(self, token: Token) -> bool:
        """Whether a pattern may begin with this word."""
        word = token.word
        return word in self._starters or (len(word) < len(token.text) and word + "." in self._starters)

    def _single(self, taken: Taken, token: Token) -> None:
        """A token that is read by itself: its word is plain, or mark-up says how."""
        text, word = token.text, token.word
        spoken: list[Spoken]
        if token.said:
            spoken = list(token.said)
            word = text
        else:
            dotted = len(word) < len(text) and "." in text
            entry = self._abbreviations.get(word) or (self._abbreviations.get(word + ".") if dotted else None)
            spoken = [*(entry.one.split() if entry else self._words(word))]
        taken.used += 1
        if not spoken:
            return
        start = token.start + text.index(word) if len(word) < len(text) else token.start
        if token.raw:
            word = token.raw[start - token.start : start - token.start + len(word)]
        taken.items.append(Item(word, start, start + len(word), spoken, token.style, token.stop))

    # what is more than letters

    def _group(self, taken: Taken, tokens: Sequence[Token], closed: bool, before: str) -> bool:
        """Reads the next token, and with it those that belong to it; False if that needs more tokens."""
        first = taken.used
        end = first + 1
        limit = min(len(tokens), first + MAX_GROUP)
        while end < limit and not tokens[end - 1].stop and self._goes_on(tokens[end]):
            end += 1
        complete = closed or tokens[end - 1].stop or end == first + MAX_GROUP
        if end == len(tokens) and not complete:
            return False
        window = tokens[first:end] if tokens[end - 1].stop else tokens[first : end + 1]
        text = _Joined(window)
        at = 0
        while at < text.ends[0] or at not in text.starts:
            readings, at = self._at(text, at, before)
            taken.items += [text.item(reading) for reading in text.by_token(readings)]
            if readings:
                before = readings[-1].words[-1] if readings[-1].words else before
            if at >= text.ends[-1]:
                break
        taken.used += text.tokens_before(at)
        return True

    def _goes_on(self, token: Token) -> bool:
        """Whether a token may belong to the number or name before it."""
        bare = core(token.text)
        return bool(_NUMERIC.match(bare)) or bare[:1] in self._signs or bare.lower() in self._going_on

    def _at(self, joined: _Joined, at: int, before: str) -> tuple[list[Reading], int]:
        """What is read at a place, and where to go on."""
        text = joined.text
        place = self._place(text, at)
        if place and (readings := self._patterns.read(place, text, at, before)) is not None:
            return readings, max(readings[-1].end if readings else 0, at + 1)
        if at in joined.starts and (whole := self._whole(joined, at)):
            return [whole], whole.end
        if word := _WORDS.match(text, at):
            return [Reading(self._words(word.group()), at, word.end())], word.end()
        entry = self._symbols.get(text[at])
        if entry and (
            text[at] not in BETWEEN or (text[at - 1 : at].isalpha() and text[at + 1 : at + 3].isalpha())
        ):
            return [Reading([*entry.one.split()], at, at + 1)], at + 1
        return [], at + 1

    def _place(self, text: str, at: int) -> str:
        """Which patterns may begin here, "" if none."""
        if text[at] in self._signs and _NUMERIC.match(text, at + 1):
            return "sign"
        if _NUMERIC.match(text, at):
            return "digit"
        if text[at].isalpha() and not text[at - 1 : at].isalnum() and (word := _STARTER.match(text, at)):
            return self._starters.get(word.group()) or self._starters.get(word.group().rstrip(".")) or ""
        return ""

    def _whole(self, joined: _Joined, at: int) -> Reading | None:
        """The reading of a whole token: an abbreviation with points in it, or initials."""
        token = joined.starts[at]
        bare = core(token.text)
        begin = at + token.text.index(bare) if bare else at
        for written in (bare, bare.removesuffix(".")):
            if entry := self._abbreviations.get(written):
                return Reading([*entry.one.split()], begin, begin + len(written))
            if INITIALS.fullmatch(written) and len(written) > 2:
                return Reading([c.upper() for c in written if c != "."], begin, begin + len(written))
        return None


class _Joined:
    """Tokens as one text, a blank between them."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.text = ascii_digits(" ".join([t.text for t in tokens]))
        self.starts: dict[int, Token] = {}
        self.ends: list[int] = []
        at = 0
        for token in tokens:
            self.starts[at] = token
            self.ends.append(at + len(token.text))
            at += len(token.text) + 1
        self._offsets = list(self.starts)

    def tokens_before(self, at: int) -> int:
        """How many tokens end at or before a place."""
        return bisect_right(self.ends, at)

    def by_token(self, readings: Sequence[Reading]) -> list[Reading]:
        """What one pattern read, a reading for each token: nobody wants to see hours and minutes apart."""
        out: list[Reading] = []
        for reading in readings:
            if out and bisect_right(self._offsets, out[-1].start) == bisect_right(
                self._offsets, reading.start
            ):
                out[-1] = Reading([*out[-1].words, *reading.words], out[-1].start, reading.end)
            else:
                out.append(reading)
        return [reading for reading in out if reading.words]

    def item(self, reading: Reading) -> Item:
        """A reading as an item of the turn."""
        first = bisect_right(self._offsets, reading.start) - 1
        last = bisect_right(self._offsets, reading.end - 1) - 1
        begin, finish = self.starts[self._offsets[first]], self.starts[self._offsets[last]]
        start = begin.start + reading.start - self._offsets[first]
        end = finish.start + reading.end - self._offsets[last]
        text = self.text[reading.start : reading.end]
        if first == last:
            text = (begin.raw or begin.text)[start - begin.start : end - begin.start]
        return Item(text, start, end, list(reading.words), begin.style, finish.stop)


def ascii_digits(text: str) -> str:
    """Decimal digits of any script as ASCII ones; the length does not change."""
    if text.isascii():
        return text
    return "".join(str(unicodedata.decimal(c)) if c.isdecimal() else c for c in text)
