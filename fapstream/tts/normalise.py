"""Tokens to the words that are spoken: numbers, times, money, abbreviations, signs, capitals.

A spoken word is a string of lower-case letters of one script; a single capital letter stands for that
letter's name. What has no letters or digits of a known script is passed over in silence.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from fapstream.tts.numerals import Numerals
from fapstream.tts.segment import INITIALS, Token, core

_IGNORED = "\u0300-\u036f\u00ad\u200b-\u200d\u2060"
_GREEK = f"[\u0370-\u0373\u0376\u0377\u037b-\u037d\u0386\u0388-\u03ff\u1f00-\u1fff][{_IGNORED}]*"
_LATIN = f"[a-zA-Z\u00aa\u00ba\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u024f\u1e00-\u1eff\uff21-\uff5a][{_IGNORED}]*"
_ACCENTS = {"\u0300": "\u0301", "\u0301": "\u0301", "\u0342": "\u0301", "\u0308": "\u0308"}
_EXTRA = {"ß": "ss", "æ": "ae", "œ": "oe", "ø": "o", "ł": "l", "đ": "d", "ð": "th", "þ": "th", "ŋ": "ng"}
_EXTRA_LATIN = str.maketrans(
    _EXTRA | {k.upper(): v.upper() for k, v in _EXTRA.items() if k != "ß"} | {"ı": "i"}
)
_GREEK_VOWELS = "αεηιουωάέήίόύώϊϋΐΰ"
_GREEK_LETTERS = "βγδζθκλμνξπρστφχψς" + _GREEK_VOWELS
MAX_WORD = 60
"""Longer words are read in pieces of this many letters."""


@dataclass(slots=True)
class Item:
    """Characters [start, end) of the turn and the words they are read as."""

    text: str
    start: int
    end: int
    spoken: list[str] = field(default_factory=list)


class Normaliser:
    """Reads the tokens of a phrase in one language; words of the other script stay what they are."""

    def __init__(
        self,
        lang: str,
        abbreviations: Mapping[str, tuple[str, str]],
        symbols: Mapping[str, str],
        is_word: Callable[[str], bool],
    ) -> None:
        """`is_word`: whether an all-capitals Latin string is a word to be spoken rather than spelled."""
        self._lang = lang
        self._abbreviations = abbreviations
        self._symbols = symbols
        self._is_word = is_word
        self._numerals = Numerals(lang)
        self._pattern = _item_pattern(self._numerals, symbols)

    def __call__(self, tokens: Sequence[Token]) -> list[Item]:
        """The items of a phrase, in order, each with at least one spoken word."""
        items: list[Item] = []
        owed = ""
        for i, token in enumerate(tokens):
            following = core(tokens[i + 1].text).lower() if i + 1 < len(tokens) else ""
            found, owes = self._token(token, following)
            if owed and found:
                found[-1].spoken.append(owed)
            owed = owes
            items += found
        return items

    def _token(self, token: Token, following: str) -> tuple[list[Item], str]:
        """The items of one token, and the word (a currency) that the token after it has to add."""
        text = token.text
        bare = core(text)
        for written in (bare, bare[:-1]) if bare.endswith(".") else (bare,):
            spoken = self._whole(written, following)
            if spoken:
                at = token.start + text.index(written)
                return [Item(written, at, at + len(written), spoken)], ""
        return self._items(token, following)

    def _whole(self, written: str, following: str) -> list[str]:
        """The reading of an abbreviation, initials or a plain word of one script; [] for anything else."""
        entry = self._abbreviations.get(written)
        if entry and (entry[1] != "number" or following[:1].isdigit()):
            return entry[0].split()
        if INITIALS.fullmatch(written) and len(written) > 2:
            return [c.upper() for c in written if c != "."]
        if not written.isalpha():
            return []
        if written.isascii():
            return self._word(written)
        return [] if written.lower().strip(_GREEK_LETTERS) else self._greek(written)

    def _items(self, token: Token, following: str) -> tuple[list[Item], str]:
        items, owed = [], ""
        text = _ascii_digits(token.text)
        for found in self._pattern.finditer(text):
            kind = found.lastgroup or ""
            rest = following if found.end() >= len(text.rstrip(".,;:!?)")) else ""
            if kind in ("prefixed", "suffixed") and rest in self._numerals.scale_words:
                spoken = self._numerals.number(*self._parts(found))
                owed = self._numerals.coins(self._sign(found))
            else:
                spoken = getattr(self, f"_read_{kind}")(found, rest)
            if spoken:
                begin, end = found.span()
                items.append(Item(token.text[begin:end], token.start + begin, token.start + end, spoken))
        return items, owed

    # One reader per named group of the pattern.

    def _read_time(self, found: re.Match[str], following: str) -> list[str]:
        hour, minute, *second = (int(part) for part in found.group().split(":"))
        return self._numerals.clock(hour, minute, *second)

    def _read_prefixed(self, found: re.Match[str], following: str) -> list[str]:
        return self._numerals.money(self._sign(found), *self._parts(found))

    _read_suffixed = _read_prefixed

    def _read_percent(self, found: re.Match[str], following: str) -> list[str]:
        return [*self._read_number(found, ""), *self._numerals.percent.split()]

    def _read_decade(self, found: re.Match[str], following: str) -> list[str]:
        return self._numerals.decade(int(found.group()[:-1]))

    def _read_ordinal(self, found: re.Match[str], following: str) -> list[str]:
        digits = re.match(r"\d+", found.group())
        number = digits.group() if digits else "0"
        if len(number) > 9:
            return self._numerals.digits(number)
        return self._numerals.ordinal(int(number), found.group()[len(number) :])

    def _read_number(self, found: re.Match[str], following: str) -> list[str]:
        text = found.group()
        sign = [self._numerals.minus()] if text[0] in "-−" else []
        whole, fraction = self._parts(found)
        if len(whole) == 4 and whole[0] != "0" and text == whole and following != "%":
            return self._numerals.year(int(whole))
        return sign + self._numerals.number(whole, fraction, self._numerals.gender_before(following, whole))

    def _read_symbol(self, found: re.Match[str], following: str) -> list[str]:
        return self._symbols[found.group()].split()

    def _read_greek(self, found: re.Match[str], following: str) -> list[str]:
        return self._greek(found.group())

    def _greek(self, text: str) -> list[str]:
        """A Greek word: whole, or spelled where it has no vowel."""
        word = fold_greek(text)
        spelled = text.isupper() and len(word) > 1 and not any(c in _GREEK_VOWELS for c in word)
        if spelled or (len(word) == 1 and word in "βγδζθκλμνξπρστφχψ"):
            return [c.upper() for c in word]
        return _pieces(word)

    def _read_latin(self, found: re.Match[str], following: str) -> list[str]:
        return self._word(fold_latin(found.group()))

    def _word(self, text: str) -> list[str]:
        """An ASCII word: whole, or spelled where it cannot be one."""
        word = text.lower()
        if len(word) == 1:
            return [word] if word in "ai" else [word.upper()]
        letters = word.replace("'", "")
        if not letters.isalpha():
            return []
        unsayable = not any(c in "aeiouy" for c in letters)
        if (unsayable or (text.isupper() and len(letters) <= 5)) and not self._is_word(word):
            return [c.upper() for c in letters]
        return _pieces(word)

    def _sign(self, found: re.Match[str]) -> str:
        return next(c for c in found.group() if c in self._numerals.signs)

    def _parts(self, found: re.Match[str]) -> tuple[str, str]:
        """The digits before and after the decimal mark of a matched number."""
        whole, _, fraction = found.group().partition(self._numerals.decimal_mark)
        return re.sub(r"\D", "", whole), re.sub(r"\D", "", fraction)


def _item_pattern(numerals: Numerals, symbols: Mapping[str, str]) -> re.Pattern[str]:
    group, mark = re.escape(numerals.group_mark), re.escape(numerals.decimal_mark)
    number = rf"(?:\d{{1,3}}(?:{group}\d{{3}})+(?!\d)|\d+)(?:{mark}\d+)?"
    signs = "".join(map(re.escape, numerals.signs))
    suffixes = "|".join(sorted(numerals.ordinal_suffixes, key=len, reverse=True))
    plain = "".join(re.escape(s) for s in symbols if s not in "./")
    return re.compile(
        r"(?P<time>(?<!\d)(?:[01]?\d|2[0-4]):[0-5]\d(?::[0-5]\d)?(?![\d:]))"
        rf"|(?P<prefixed>[{signs}]{number})"
        rf"|(?P<suffixed>{number}[{signs}])"
        rf"|(?P<percent>(?:(?<!\w)[-−])?{number}%)"
        r"|(?P<decade>(?<!\d)(?:1[1-9]|20)\d0s(?!\w))"
        rf"|(?P<ordinal>\d+(?:{suffixes})(?!\w))"
        rf"|(?P<number>(?:(?<![\w.,])[-−])?{number})"
        rf"|(?P<greek>(?:{_GREEK})+)"
        rf"|(?P<latin>(?:{_LATIN})+(?:['’](?:{_LATIN})+)*)"
        rf"|(?P<symbol>[{plain}]|(?<=[^\W\d_]{{2}})\.(?=[^\W\d_]{{2}}))"
    )


def _pieces(word: str) -> list[str]:
    return [word[at : at + MAX_WORD] for at in range(0, len(word), MAX_WORD)]


def _ascii_digits(text: str) -> str:
    """Decimal digits of any script as ASCII ones; the length does not change."""
    if text.isascii():
        return text
    return "".join(str(unicodedata.decimal(c)) if c.isdecimal() else c for c in text)


def fold_latin(text: str) -> str:
    """Latin letters without their diacritics, apostrophes made ASCII; case is kept."""
    if text.isascii():
        return text
    folded = unicodedata.normalize("NFKD", text.replace("’", "'").translate(_EXTRA_LATIN))
    return "".join(c for c in folded if c.isascii() and (c.isalpha() or c == "'"))


def fold_greek(text: str) -> str:
    """Modern lower-case Greek: one accent, diaeresis, sigma written one way, breathings dropped."""
    simple = text.lower()
    if not simple.strip(_GREEK_LETTERS):
        return simple.replace("ς", "σ")
    decomposed = unicodedata.normalize("NFD", simple)
    kept = "".join(_ACCENTS.get(c, "") if unicodedata.combining(c) else c for c in decomposed)
    return "".join(c for c in unicodedata.normalize("NFC", kept) if c in _GREEK_LETTERS).replace("ς", "σ")
