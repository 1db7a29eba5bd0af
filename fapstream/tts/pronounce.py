"""Spoken words to the phones of the language being spoken, each word read by the language of its script.

Words come one after the other; a word is pronounced as soon as what follows can no longer change it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from fapstream.records import Spoken
from fapstream.tts.english import English, english
from fapstream.tts.tables import phone_set, read_pairs, require_language

if TYPE_CHECKING:
    from fapstream.tts.greek import Greek

Tokens = tuple[str, ...]

LEFT: Final = 2
"""Words before a word that may act on it; to the right it is one."""


def script(word: Spoken) -> str:
    """The language whose letters a spoken word is written in; "" for phones that are given."""
    if isinstance(word, tuple):
        return ""
    return "en" if word[:1].isascii() else "el"


def phonetiser(lang: str) -> English | Greek:
    """What reads the words of a language; it is loaded when the first of them comes."""
    if lang == "en":
        return english()
    from fapstream.tts.greek import greek

    return greek()


class Pronouncer:
    """Phones of words in one language; foreign phones are mapped to its nearest ones."""

    def __init__(self, lang: str) -> None:
        """Raises UnknownLanguage, DataError."""
        self._lang = require_language(lang)
        foreign = {"en": "el", "el": "en"}[lang]
        pairs = read_pairs(f"{lang}/from_{foreign}.tsv")
        self._vowels = frozenset(p.name for p in phone_set(lang).values() if p.kind == "vowel")
        self._nearest = {phone: tuple(near.split()) for phone, near in pairs.items()}

    def __call__(self, words: list[Spoken], first: int = 0) -> list[Tokens]:
        """One tuple of phones for each word of a phrase from the one at `first` on; vowels carry stress
        digits.

        LEFT words before `first` are enough to get the same as from the whole phrase.
        """
        found: list[Tokens] = []
        run: list[str] = []
        lang = ""
        for word in words:
            if isinstance(word, tuple):
                found += self._run(run, lang)
                found.append(word)
                run = []
                continue
            written = script(word)
            if written != lang:
                found += self._run(run, lang)
                lang, run = written, []
            run.append(word)
        found += self._run(run, lang)
        return found[first:] if first else found

    def _run(self, words: list[str], lang: str) -> list[Tokens]:
        """Words of one language that stand together."""
        if not words:
            return []
        phones = phonetiser(lang).phones(words)
        return phones if lang == self._lang else [self._mapped(tokens) for tokens in phones]

    def needs_next(self, word: Spoken) -> bool:
        """Whether the word after it, or that there is none, could change its phones."""
        if isinstance(word, tuple):
            return False
        return phonetiser(script(word)).needs_next(word)

    def path(self, word: Spoken) -> str:
        """Where its phones come from: user, lexicon, rule, tree and so on."""
        if isinstance(word, tuple):
            return "user"
        return phonetiser(script(word)).path(word)

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
