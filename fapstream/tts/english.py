"""English words to phones: lexicon, stems and compounds, then letter-to-sound trees."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from fapstream.tts.homographs import Homographs
from fapstream.tts.lexicon import Lexicon
from fapstream.tts.stems import Stems
from fapstream.tts.tables import read_bytes, read_rows

if TYPE_CHECKING:
    from fapstream.tts.lts import LetterToSound

Tokens = tuple[str, ...]
"""Phones; a vowel carries its stress digit, as in `i1`."""


class English:
    """Pronounces lower-case words of a-z and apostrophes, and capital letters by name."""

    def __init__(self) -> None:
        """Reads the lexicon; the trees are read when a word is in no other way known. Raises DataError."""
        self._lexicon = Lexicon(read_bytes("en/lexicon.bin"))
        self._recent = {row[0]: tuple(row[1].split()) for _, row in read_rows("en/recent.tsv", 2)}
        self._stems = Stems(self._known)
        self._homographs = Homographs("en/homographs.tsv")
        self._trees: LetterToSound | None = None
        self._letters = {row[0].upper(): tuple(row[1].split()) for _, row in read_rows("en/letters.tsv", 2)}
        rows = [row for _, row in read_rows("en/function_words.tsv", 4)]
        self._weak = {row[0]: tuple(row[1].split()) for row in rows if row[1]}
        self._before_vowel = {row[0]: tuple(row[3].split()) for row in rows if row[3]}

    def warm(self) -> None:
        """Makes everything ready that else is when it is first met: rare letters, the trees."""
        self._lexicon.warm()
        self._homographs.warm()
        self.guess("a")

    def is_word(self, word: str) -> bool:
        """Whether the lexicon has it."""
        return word in self._lexicon or word in self._recent

    def lexicon_words(self) -> list[str]:
        """Every word of the lexicon, for tools and tests."""
        return self._lexicon.words()

    def phones(self, words: list[str]) -> list[Tokens]:
        """The phones of each word of a phrase: all but the last may be weak forms."""
        found: list[Tokens] = []
        last = len(words) - 1
        for i, word in enumerate(words):
            if word in self._homographs:
                after = words[i + 1] if i < last else None
                found.append(self._homographs.choose(words[max(0, i - 2) : i], word, after))
            else:
                found.append(self._weak.get(word) or self.word(word))
        for i in range(last):
            word = words[i]
            if word in self._before_vowel and _begins_with_vowel(found[i + 1]):
                found[i] = self._before_vowel[word]
        if last > 0 and words[last] in self._weak and words[last] not in self._homographs:
            found[last] = self.word(words[last])
        return found

    def needs_next(self, word: str) -> bool:
        """Whether the word after it, or that there is none, could change its phones."""
        return word in self._weak or word in self._before_vowel or self._homographs.needs_next(word)

    def path(self, word: str) -> str:
        """Where a word's phones come from: letter, lexicon, stem, compound or tree."""
        return self._found(word)[1]

    def word(self, word: str) -> Tokens:
        """One word by itself. Characters other than a-z and the apostrophe are ignored."""
        return self._letters.get(word) or self._lexicon.get(word) or self._found(word)[0]

    def readings(self, word: str) -> tuple[Tokens, ...]:
        """Every way to say a word by itself; a homograph has several."""
        return self._homographs.ways(word) if word in self._homographs else (self.word(word),)

    def _found(self, word: str) -> tuple[Tokens, str]:
        if tokens := self._letters.get(word):
            return tokens, "letter"
        if tokens := self._known(word):
            return tokens, "lexicon"
        if tokens := self._stems.inflected(word):
            return tokens, "stem"
        if tokens := self._stems.compound(word):
            return tokens, "compound"
        letters = "".join(c for c in word.lower() if "a" <= c <= "z")
        return self.guess(letters) if letters else (), "tree"

    def _known(self, word: str) -> Tokens | None:
        return self._lexicon.get(word) or self._recent.get(word)

    def guess(self, word: str) -> Tokens:
        """What the trees alone make of a word of letters a-z, as if no lexicon had it."""
        if self._trees is None:
            from fapstream.tts.lts import LetterToSound  # and numpy with it, which most texts do without

            self._trees = LetterToSound(read_bytes("en/lts.bin"))
        return self._trees(word)


def _begins_with_vowel(tokens: Tokens) -> bool:
    return bool(tokens) and tokens[0][-1].isdigit()


@cache
def english() -> English:
    """The one instance: the lexicon is read the first time it is asked for."""
    return English()
