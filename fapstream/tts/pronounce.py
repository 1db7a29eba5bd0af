"""Spoken words to the phones of the language being spoken, each word read by the language of its script."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from fapstream.tts.english import english
from fapstream.tts.greek import greek
from fapstream.tts.tables import phone_set, read_pairs, require_language

Tokens = tuple[str, ...]


def script(word: str) -> str:
    """The language whose letters a spoken word is written in."""
    return "en" if word[:1].isascii() else "el"


class Pronouncer:
    """Phones of the words of a phrase in one language; foreign phones are mapped to its nearest ones."""

    def __init__(self, lang: str) -> None:
        """Raises UnknownLanguage, DataError."""
        self._lang = require_language(lang)
        foreign = {"en": "el", "el": "en"}[lang]
        pairs = read_pairs(f"{lang}/from_{foreign}.tsv")
        self._vowels = frozenset(p.name for p in phone_set(lang).values() if p.kind == "vowel")
        self._nearest = {phone: tuple(near.split()) for phone, near in pairs.items()}

    def __call__(self, words: Sequence[str]) -> list[Tokens]:
        """One tuple of phones per word; vowels carry stress digits."""
        found: list[Tokens] = []
        for lang, run in groupby(words, script):
            reader = english() if lang == "en" else greek()
            phones = reader.phones(list(run))
            found += phones if lang == self._lang else [self._mapped(tokens) for tokens in phones]
        return found

    def _mapped(self, tokens: Tokens) -> Tokens:
        out: list[str] = []
        for token in tokens:
            stress = token[-1] if token[-1].isdigit() else ""
            name = token[:-1] if stress else token
            for phone in self._nearest.get(name, (name,)):
                if phone in self._vowels:
                    out.append(phone + (stress or "0"))
                    stress = "0"
                else:
                    out.append(phone)
        return tuple(out)
