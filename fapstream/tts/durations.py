"""How long each phone lasts: a table of means modified by rules.

After D. Klatt, "Synthesis by rule of segmental durations in English sentences" (1979):
duration = minimum + (mean - minimum) * product of the factors of all rules that apply. The rules: stress,
place in syllable, word and phrase (lengthening before a pause), number of syllables of the word, consonant
clusters, what follows a vowel, emphasis. The paper on the FPD-based talking head (section 4.1) asks the same
of Greek: the vowel under the accent mark longer, phones shorter as the word has more syllables. The factors
are data, one set a language (`data/prosody.toml`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from fapstream.tts.sounds import Sound, onsets

MAX_COUNTED_SYLLABLES: Final = 12


class DurationModel:
    """Durations of the phones of one word. Its neighbours do not matter, so a word can be timed as soon as it
    is known whether a pause follows."""

    def __init__(self, lang: str, factors: Mapping[str, Any]) -> None:
        """`factors`: the language's table of prosody.toml."""
        f = factors
        self._onsets = onsets(lang)
        vowel = f["vowel"]
        by_stress: list[float] = [vowel["unstressed"], vowel["stressed"], vowel["secondary"]]
        function: float = f["function_word"]
        self._vowel = by_stress
        self._vowel_in_function_word = [v * function for v in by_stress]
        less, floor = f["polysyllabic"], f["polysyllabic_floor"]
        self._syllables: list[float] = [
            max(1.0 - less * (n - 1), floor) for n in range(MAX_COUNTED_SYLLABLES + 1)
        ]
        self._consonant: float = f["consonant"]
        self._unstressed: float = f["consonant_unstressed"]
        self._coda: float = f["coda"]
        self._cluster: float = f["cluster"]
        self._initial: float = f["word_initial"]
        self._word_final: float = f["word_final"]
        self._final_vowel: float = f["final_vowel"]
        self._final_consonant: float = f["final_consonant"]
        self._prefinal: float = f["prefinal"]
        self._before_voiceless: float = f["before_voiceless"]
        self._before_fricative: float = f["before_voiced_fricative"]

    def word(self, sounds: list[Sound], n_vowels: int, function: bool, final: bool) -> list[float]:
        """Milliseconds at rate 1, one per phone. `final`: a pause follows the word."""
        vowel = self._vowel_in_function_word if function else self._vowel
        shortened = self._syllables[min(n_vowels, MAX_COUNTED_SYLLABLES)]
        cluster = self._cluster
        stress, vowels, onset = 0, 0, False
        following: Sound | None = None
        ms: list[float] = []
        for i in range(len(sounds) - 1, -1, -1):
            sound = sounds[i]
            if sound.vowel:
                stress, onset = sound.stress, True
                factor = vowel[stress] * shortened
                if following is not None and not following.vowel:
                    factor *= self._before(following)
                if not vowels and (final or n_vowels > 1):
                    factor *= self._final_vowel if final else self._word_final
                vowels += 1
            else:
                factor = self._consonant
                if stress != 1:
                    factor *= self._unstressed
                if following is not None and not following.vowel:
                    factor *= cluster
                    onset = onset and (sound.name, following.name) in self._onsets
                if not onset:
                    factor *= self._coda
                if final and not vowels:
                    factor *= self._final_consonant
                elif final and vowels == 1 and onset:
                    factor *= self._prefinal
                if not i:
                    factor *= self._initial
                elif not sounds[i - 1].vowel:
                    factor *= cluster
            length = sound.min_ms + sound.span_ms * factor
            ms.append(length if length > sound.least_ms else sound.least_ms)
            following = sound
        ms.reverse()
        return ms

    def _before(self, consonant: Sound) -> float:
        """What a consonant does to the vowel before it (Klatt's rule 9)."""
        if not consonant.voiced:
            return self._before_voiceless
        return self._before_fricative if consonant.kind == "fricative" else 1.0
