"""How long each phone lasts: a table of means modified by rules.

After D. Klatt, "Synthesis by rule of segmental durations in English sentences" (1979):
duration = minimum + (mean - minimum) * product of the factors of all rules that apply. The rules: stress,
place in word and phrase (lengthening before a pause), number of syllables of the word, consonant clusters,
what follows a vowel. The factors are data, one set a language (`data/prosody.toml`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fapstream.tts.tables import PhoneInfo, phone_set


@dataclass(slots=True)
class Segment:
    """A phone of a phrase while its rhythm and melody are being worked out.

    `word`: index of the spoken word within the phrase; `n_syllables`: of that word.
    """

    info: PhoneInfo
    stress: int
    word: int
    n_syllables: int
    is_function: bool
    initial: bool
    is_vowel: bool
    ms: float = 0.0


class DurationModel:
    """Fills in `Segment.ms` for a phrase of one language."""

    def __init__(self, lang: str, factors: Mapping[str, Any]) -> None:
        """`factors`: the language's table of prosody.toml."""
        self._tokens = {
            name + digit: (info, int(digit or "0"), info.kind == "vowel")
            for name, info in phone_set(lang).items()
            for digit in (("0", "1", "2") if info.kind == "vowel" else ("",))
        }
        self._f = factors
        self._vowel = factors["vowel"]

    def segments(self, words: Sequence[tuple[str, ...]], functions: Sequence[bool]) -> list[Segment]:
        """Phones of spoken words (vowels with stress digits) as segments without durations yet."""
        out: list[Segment] = []
        for word, tokens in enumerate(words):
            known = [self._tokens[token] for token in tokens]
            n = sum([vowel for _, _, vowel in known])
            function, initial = functions[word], True
            for info, stress, vowel in known:
                out.append(Segment(info, stress, word, n, function, initial, vowel))
                initial = False
        return out

    def assign(self, segments: Sequence[Segment], rate: float, final: bool) -> None:
        """Sets every `ms`. `final`: a pause follows, so the last syllable is lengthened."""
        last_vowel = max((i for i, s in enumerate(segments) if s.is_vowel), default=-1)
        stress = 0
        for i in range(len(segments) - 1, -1, -1):
            segment = segments[i]
            following = segments[i + 1] if i + 1 < len(segments) else None
            if segment.is_vowel:
                stress = segment.stress
                factor = self._vowel_factor(segment, following)
            else:
                before = segments[i - 1] if i else None
                factor = self._consonant_factor(segment, before, following, stress)
            if final and i >= last_vowel - 1:
                factor *= self._final_factor(segment, i - last_vowel)
            least = segment.info.min_ms
            segment.ms = max(least + (segment.info.mean_ms - least) * factor, 0.8 * least) / rate

    def _vowel_factor(self, segment: Segment, following: Segment | None) -> float:
        f = self._f
        kind = ("unstressed", "stressed", "secondary")[segment.stress]
        factor: float = self._vowel[kind]
        factor *= max(1.0 - f["polysyllabic"] * (segment.n_syllables - 1), f["polysyllabic_floor"])
        if segment.is_function:
            factor *= f["function_word"]
        if following and following.word == segment.word and not following.is_vowel:
            if not following.info.voiced:
                factor *= f["before_voiceless"]
            elif following.info.kind == "fricative":
                factor *= f["before_voiced_fricative"]
        return factor

    def _consonant_factor(
        self, segment: Segment, before: Segment | None, following: Segment | None, stress: int
    ) -> float:
        """`stress` is that of the vowel after this consonant."""
        f = self._f
        factor: float = f["consonant"] if stress == 1 else f["consonant"] * f["consonant_unstressed"]
        if segment.initial:
            factor *= f["word_initial"]
        if before is not None and not before.is_vowel:
            factor *= f["cluster"]
        if following is not None and not following.is_vowel:
            factor *= f["cluster"]
        return factor

    def _final_factor(self, segment: Segment, place: int) -> float:
        """`place`: -1 just before the last vowel, 0 the vowel itself, more after it."""
        rule = "prefinal" if place < 0 else "final_vowel" if place == 0 else "final_consonant"
        factor: float = self._f[rule]
        return factor
