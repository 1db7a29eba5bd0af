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
from typing import Final

from fapstream.records import Spoken
from fapstream.tts.markup import PLAIN, Style
from fapstream.tts.patterns import Patterns, Reading, Vocabulary
from fapstream.tts.segment import INITIALS, UNDECIDED, Token, core
from fapstream.tts.spelling import Speller, ended

_IGNORED = "\u0300-\u036f\u00ad\u200b-\u200d\u2060\ufeff"
_GREEK = f"[\u00b5\u0370-\u0373\u0376\u0377\u037b-\u037d\u0386\u0388-\u03ff\u1f00-\u1fff][{_IGNORED}]*"
_ROMAN = "a-zA-Z\u00aa\u00ba\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u024f\u1e00-\u1eff\ufb00-\ufb06\uff21-\uff5a"
_LATIN = f"[{_ROMAN}][{_IGNORED}]*"
_WORDS = re.compile(rf"[\u0384\u00b4]?(?:{_GREEK}|{_LATIN})+(?:['’](?:{_LATIN})+)*")
_SIGNS = "#+-−."
_NUMERIC = re.compile(r"[#+\-−.]{0,2}\d")
_STARTER = re.compile(r"(?:[^\W\d_]|\.(?=[^\W\d_]))+[.$']?")
_PRIMES = dict.fromkeys("’΄´ʹ᾽′", "'")
"""Signs that stand for the one after a Greek numeral, or for what an elided word has lost."""
_POSSESSIVE = re.compile(r"['’]s(?!\w)")
_AFTER_WORD = re.compile(r"\W+$")
_SUBSCRIPTS = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
MAX_GROUP: Final = 8
"""Tokens that may be read together."""
BETWEEN = "./-"
"""Signs that are read between words of two letters or more only, as in example.com."""


Lexicon = Mapping[str, tuple[Spoken, ...]]
_NO_LEXICON: Final[Lexicon] = {}


class Item:
    """Characters [start, end) of the turn and the words they are read as.

    `stop`: the phrase end that is written on it, "" if none (see `Token.stop`).
    """

    __slots__ = ("end", "spoken", "start", "stop", "style", "text")

    def __init__(
        self, text: str, start: int, end: int, spoken: Sequence[Spoken], style: Style = PLAIN, stop: str = ""
    ) -> None:
        self.text = text
        self.start = start
        self.end = end
        self.spoken = spoken
        self.style = style
        self.stop = stop


@dataclass(slots=True)
class Taken:
    """Items in order, and how many of the tokens they come from."""

    items: list[Item] = field(default_factory=list)
    used: int = 0


class Normaliser:
    """Reads the tokens of a phrase in one language; words of the other script stay what they are."""

    def __init__(self, vocabulary: Vocabulary, patterns: Patterns, speller: Speller) -> None:
        self._patterns = patterns
        self.warm = patterns.check
        self._speller = speller
        classes = vocabulary.classes
        self._abbreviations = vocabulary.known
        self._wordlike = frozenset(classes.get("wordlike", ()))
        self._symbols = classes["symbol"]
        self._signs = frozenset(classes["sign"])
        self._starters: dict[str, tuple[str, ...]] = {}
        for name in patterns.places:
            for form in classes.get(name, ()):
                for key in (form, form + "'s", form + "’s") if form[0].isalpha() else form[:1]:
                    self._starters[key] = tuple(dict.fromkeys((*self._starters.get(key, ()), name)))
        keys = (*self._starters, *self._abbreviations)
        self._special = frozenset(keys) | {_AFTER_WORD.sub("", key) for key in keys if not key.isalpha()}
        """Words that by themselves or with a sign after them are more than their letters."""
        going_on = [form.lower() for name in patterns.going_on for form in classes[name]]
        self._going_on = frozenset(part for form in going_on for part in form.split())

    def take(
        self, tokens: Sequence[Token], closed: bool, before: str = "", lexicon: Lexicon = _NO_LEXICON
    ) -> Taken:
        """The items of the tokens that nothing after them can change.

        `closed`: the phrase ends after the tokens; `before`: the word before them, as written; `lexicon`: the
        user's own readings. Every item has at least one spoken word.
        """
        taken = Taken()
        while taken.used < len(tokens):
            token = tokens[taken.used]
            if lexicon and (own := self._own(token, lexicon)):
                taken.items.append(own)
                taken.used += 1
            elif token.word and token.word not in self._special:
                self._single(taken, token, before, self._speller.words(token.word))
            elif token.word or token.said:
                if self._starts(token, before):
                    if not self._group(taken, tokens, closed, before):
                        break
                else:
                    self._single(taken, token, before, self._spoken(token))
            elif not self._group(taken, tokens, closed, before):
                break
            if taken.items:
                before = taken.items[-1].text
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

    def _starts(self, token: Token, before: str) -> bool:
        """Whether a pattern may begin with this word."""
        word = token.word
        places = self._starters.get(word, ())
        if len(word) < len(token.text):
            places += self._starters.get(_signed(token), ())
        return any(self._patterns.may_begin(place, before) for place in places)

    def _spoken(self, token: Token) -> Sequence[Spoken]:
        """What a token is read as: mark-up or the vocabulary may say it."""
        if token.said:
            return token.said
        word = token.word
        entry = self._abbreviations.get(word)
        if entry is None and len(word) < len(token.text):
            entry = self._abbreviations.get(_signed(token))
        return entry.one.split() if entry else self._speller.words(word)

    def _single(self, taken: Taken, token: Token, before: str, spoken: Sequence[Spoken]) -> None:
        """A token that is read by itself."""
        text = token.text
        word = text if token.said else token.word
        if len(spoken) > 1 and not token.said and word.isupper() and self._in_capitals(word, before):
            spoken = self._speller.words(word.lower())
        taken.used += 1
        if not spoken:
            return
        start = token.start + text.index(word) if len(word) < len(text) else token.start
        if token.raw:
            word = token.raw[start - token.start : start - token.start + len(word)]
        taken.items.append(Item(word, start, start + len(word), spoken, token.style, token.stop))

    def _in_capitals(self, word: str, before: str) -> bool:
        """Whether capitals are a word of a line in capitals, not an acronym."""
        if not (len(before) > 2 and before.isupper() and before.isalpha()) or before in self._abbreviations:
            return False
        line = len(before) > 3 or self._speller.is_word(before)
        return line and (word not in self._abbreviations or word in self._wordlike)

    # what is more than letters

    def _group(self, taken: Taken, tokens: Sequence[Token], closed: bool, before: str) -> bool:
        """Reads the next token, and with it those that belong to it; False if that needs more tokens."""
        first = taken.used
        end = first + 1
        limit = min(len(tokens), first + MAX_GROUP)
        alone = self._is_alone(tokens[first])
        while end < limit and not (alone or _ends(tokens[end - 1])) and self._goes_on(tokens[end]):
            end += 1
        over = _ends(tokens[end - 1]) or end == first + MAX_GROUP or alone
        if end == len(tokens) and not (closed or over):
            return False
        text = _Joined(tokens[first : end if over or (end < len(tokens) and tokens[end].said) else end + 1])
        at = 0
        while at < text.ends[0] or at not in text.starts:
            readings, at = self._at(text, at, before)
            taken.items += [text.item(reading) for reading in text.by_token(readings)]
            if readings:
                before = text.text[readings[-1].start : readings[-1].end]
            if at >= text.ends[-1]:
                break
        taken.used += text.tokens_before(at)
        return True

    def _is_alone(self, token: Token) -> bool:
        """Whether no pattern can begin at a token: initials, or an abbreviation that is read the same
        always."""
        bare = core(token.text)
        forms = (bare, bare.removesuffix("."))
        fixed = INITIALS.fullmatch(bare) or any(form in self._abbreviations for form in forms)
        return bool(fixed) and not any(form in self._starters for form in forms)

    def _goes_on(self, token: Token) -> bool:
        """Whether a token may belong to the number or name before it."""
        if token.said:
            return False
        bare = core(token.text)
        if _NUMERIC.match(bare) or bare[:1] in self._signs:
            return True
        return bare.lower() in self._going_on or bare.lower().partition("-")[0] in self._going_on

    def _at(self, joined: _Joined, at: int, before: str) -> tuple[list[Reading], int]:
        """What is read at a place, and where to go on."""
        text = joined.text
        for place in self._places(text, at):
            if found := self._patterns.read(place, text, at, before):
                return found[0], max(found[1], at + 1)
        begins = text[at].isalpha() and not text[at - 1 : at].isalnum()
        if begins and (known := self._written(joined, at) or self._dotted(text, at)):
            return [known], known.end
        if word := _WORDS.match(text, at):
            return [Reading(self._inner(word.group(), text[word.end() :]), at, word.end())], word.end()
        entry = self._symbols.get(text[at])
        if entry and (text[at] not in BETWEEN or _between(text, at)):
            return [Reading([*entry.one.split()], at, at + 1)], at + 1
        return [], at + 1

    def _inner(self, word: str, following: str) -> list[str]:
        """A word inside of what is more than a plain word."""
        if entry := self._abbreviations.get(word):
            return entry.one.split()
        code = len(word) == 1 and (word.isascii() or word.isupper()) and following[:1].isdecimal()
        return [word.upper()] if code else self._speller.words(word)

    def _places(self, text: str, at: int) -> Sequence[str]:
        """Which patterns may begin here."""
        sign = text[at]
        begins = sign.isalnum() and not text[at - 1 : at].isalnum()
        if sign.isalpha():
            if not begins:
                return ()
            written = word.group() if (word := _STARTER.match(text, at)) else sign
            end = at + len(written)
            forms = dict.fromkeys((text[at : end + 1], written, written.rstrip(".$'")))
            return ("start", *[place for form in forms for place in self._starters.get(form, ())], "word")
        if _NUMERIC.match(text, at):
            return (
                ("start", "digit", "word") if begins else ("digit", "mark") if sign in _SIGNS else ("digit",)
            )
        first = () if text[at - 1 : at].isalnum() else ("start",)
        return (*first, *self._starters.get(sign, ()), "mark")

    def _written(self, joined: _Joined, at: int) -> Reading | None:
        """A token that the vocabulary has with digits and all."""
        token = joined.starts.get(at)
        bare = core(token.text) if token else ""
        if not bare or not token or not token.text.startswith(bare):
            return None
        for form in (bare, bare.removesuffix(".")):
            if entry := self._abbreviations.get(form):
                return Reading([*entry.one.split()], at, at + len(form))
        return None

    def _dotted(self, text: str, at: int) -> Reading | None:
        """An abbreviation with points in it, or initials, and the ending of a possessive."""
        word = _STARTER.match(text, at)
        written = word.group().rstrip("$'") if word else ""
        for form in (written, written.removesuffix(".")):
            if entry := self._abbreviations.get(form):
                words = entry.one.split()
            elif "." in form and INITIALS.fullmatch(written) and len(written) > 2:
                plain = self._abbreviations.get(form.replace(".", ""))
                words = plain.one.split() if plain else [c.upper() for c in form if c != "."]
            else:
                continue
            end = at + len(form)
            if ending := _POSSESSIVE.match(text, end):
                return Reading(ended(words, "'s"), at, ending.end())
            return Reading(words, at, end)
        return None


class _Joined:
    """Tokens as one text, a blank between them."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.text = plain_signs(" ".join([t.text for t in tokens]))
        self._written = " ".join([t.raw or t.text for t in tokens])
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
        return Item(
            self._written[reading.start : reading.end],
            start,
            end,
            list(reading.words),
            begin.style,
            finish.stop,
        )


def _ends(token: Token) -> bool:
    """Whether the phrase ends after it, as far as it tells itself."""
    return bool(token.stop) and token.stop not in UNDECIDED


def _between(text: str, at: int) -> bool:
    """Whether a sign stands between letters, two at least on either side."""
    return text[max(at - 2, 0) : at].isalpha() and text[at + 1 : at + 3].isalpha()


def plain_signs(text: str) -> str:
    """Decimal digits of any script, and lowered ones, as ASCII digits, primes after a letter as apostrophes;
    the length does not change."""
    if text.isascii():
        return text
    text = text.translate(_SUBSCRIPTS)
    out = [str(unicodedata.decimal(c)) if c.isdecimal() else c for c in text]
    for at, c in enumerate(text):
        if c in _PRIMES and text[at - 1 : at].isalpha():
            out[at] = "'"
    return "".join(out)


def _signed(token: Token) -> str:
    """The word of a token and the sign right after it."""
    end = token.text.index(token.word) + len(token.word)
    sign = token.text[end : end + 1]
    return token.word + _PRIMES.get(sign, sign)
