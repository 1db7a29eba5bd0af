"""Written words as spoken words: lower-case letters of one script, or the names of letters.

A spoken word is a string of lower-case letters of one script; a single capital letter stands for that
letter's name.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Mapping
from typing import Final

from fapstream.tts.lookalikes import is_greek, one_script

_ACCENTS = {"\u0300": "\u0301", "\u0301": "\u0301", "\u0342": "\u0301", "\u0308": "\u0308"}
_EXTRA = {"ß": "ss", "æ": "ae", "œ": "oe", "ø": "o", "ł": "l", "đ": "d", "ð": "th", "þ": "th", "ŋ": "ng"}
_EXTRA_LATIN = str.maketrans(
    _EXTRA | {k.upper(): v.upper() for k, v in _EXTRA.items() if k != "ß"} | {"ı": "i"}
)
_GREEK_VOWELS: Final = "αεηιουωάέήίόύώϊϋΐΰ"
_GREEK_LETTERS: Final = "βγδζθκλμνξπρστφχψς" + _GREEK_VOWELS
_ACCENTS_BEFORE = "\u0384\u00b4\u1fce\u1fde\u1fcd\u1fdd"
"""Signs that old texts write before a capital instead of on it."""
_ENDING = re.compile(r"([A-Z]{2,60})(['’]?s)")
MAX_WORD: Final = 60
"""Longer words are read in pieces of this many letters."""


class Speller:
    """Decides what is read as a word and what is spelled."""

    def __init__(self, is_word: Callable[[str], bool], known: Mapping[str, list[str]] | None = None) -> None:
        """`is_word`: whether an all-capitals Latin string is a word to be spoken rather than spelled.

        `known`: how acronyms and abbreviations are read.
        """
        self._is_word = is_word
        self._known = known or {}

    def words(self, text: str) -> list[str]:
        """A word of letters in any script as it is spoken."""
        if text[1:2].isupper() and (found := self.acronym(text)):
            return found
        if text.isascii():
            return self._word(text)
        word = text.lower()
        if not word.strip(_GREEK_LETTERS):
            return self._greek(text, word.replace("ς", "σ"))
        out: list[str] = []
        for part in one_script(text):
            out += self._greek(part, fold_greek(part)) if is_greek(part) else self._word(fold_latin(part))
        return out

    def acronym(self, text: str) -> list[str]:
        """What is known of a written form, or of capitals with a small s; empty if nothing."""
        if known := self._known.get(text):
            return list(known)
        ending = _ENDING.fullmatch(text)
        if ending is None:
            return []
        words = list(self._known.get(ending[1]) or self._word(ending[1]))
        return ended(words, "s" if ending[2] == "s" else "'s")

    def is_word(self, text: str) -> bool:
        """Whether capitals can be a word."""
        return self._is_word(text.lower())

    def _greek(self, text: str, word: str) -> list[str]:
        """A Greek word: whole, or spelled where it has no vowel. `word`: in the letters that are spoken."""
        spelled = text.isupper() and len(word) > 1 and not any(c in _GREEK_VOWELS for c in word)
        if spelled or (len(word) == 1 and word in "βγδζθκλμνξπρστφχψ"):
            return [c.upper() for c in word]
        return _pieces(word)

    def _word(self, text: str) -> list[str]:
        """An ASCII word: whole, or spelled where it cannot be one."""
        word = text.lower()
        if len(word) == 1:
            return [word] if word in "ai" else [word.upper()]
        if _has_vowel(word) and not text.isupper():
            return _pieces(word)
        letters = word.replace("'", "").replace("’", "")
        if not letters.isalpha():
            return []
        if (not _has_vowel(letters) or (text.isupper() and len(letters) <= 5)) and not self._is_word(word):
            return [c.upper() for c in letters]
        return _pieces(word)


def ended(words: list[str], ending: str) -> list[str]:
    """Words with `s` or `'s` at the end of the last; the name of a letter always takes `'s`."""
    *first, last = words or [""]
    return [*first, last.lower() + "'s" if len(last) == 1 else last + ending] if last else []


def _has_vowel(word: str) -> bool:
    return "e" in word or "a" in word or "o" in word or "i" in word or "u" in word or "y" in word


def _pieces(word: str) -> list[str]:
    if 0 < len(word) <= MAX_WORD:
        return [word]
    return [word[at : at + MAX_WORD] for at in range(0, len(word), MAX_WORD)]


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
    if simple[0] in _ACCENTS_BEFORE:
        simple = simple[1:2] + "\u0301" + simple[2:]
    decomposed = unicodedata.normalize("NFD", simple)
    kept = "".join(_ACCENTS.get(c, "") if unicodedata.combining(c) else c for c in decomposed)
    return "".join(c for c in unicodedata.normalize("NFC", kept) if c in _GREEK_LETTERS).replace("ς", "σ")
