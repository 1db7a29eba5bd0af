"""How long each phone lasts: a table of means modified by rules.

After D. Klatt, "Synthesis by rule of segmental durations in English sentences" (1979):
duration = minimum + (mean - minimum) * product of the factors of all rules that apply. The rules: stress,
place in syllable, word and phrase (lengthening before a pause), number of syllables of the word, consonant
clusters, what follows a vowel, emphasis. The paper on the FPD-based talking head (section 4.1) asks the same
of Greek: the vowel under the accent mark longer, phones shorter as the word has more syllables. The factors
are data, one set a language (`data/prosody.toml`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fapstream.tts.sounds import Sound, onsets

MAX_COUNTED_SYLLABLES = 12


class DurationModel:
    """Durations of the phones of one word. Its neighbours do not matter, so a word can be timed as soon as it
    is known whether a pause follows."""

    def __init__(self, lang: str, factors: Mapping[str, Any]) -> None:
        """`factors`: the language's table of prosody.toml."""
        f = factors
        self._onsets = onsets(lang)
        vowel = f["vowel"]
        by_stress = (vowel["unstressed"], vowel["stressed"], vowel["secondary"])
        self._stress = (by_stress, tuple(v * f["function_word"] for v in by_stress))
        self._syllables = [
            max(1.0 - f["polysyllabic"] * (n - 1), f["polysyllabic_floor"])
            for n in range(MAX_COUNTED_SYLLABLES + 1)
        ]
        self._consonant = (f["consonant"] * f["consonant_unstressed"], f["consonant"])
        self._coda, self._cluster, self._initial = f["coda"], f["cluster"], f["word_initial"]
        self._last_vowel = (f["word_final"], f["final_vowel"])
        self._final = (f["final_consonant"], f["prefinal"])
        self._before_voiceless, self._before_fricative = f["before_voiceless"], f["before_voiced_fricative"]

    def word(self, sounds: Sequence[Sound], n_vowels: int, function: bool, final: bool) -> list[float]:
        """Milliseconds at rate 1, one per phone. `final`: a pause follows the word."""
        by_stress, by_next, cluster = self._stress[function], self._consonant, self._cluster
        shortened = self._syllables[min(n_vowels, MAX_COUNTED_SYLLABLES)]
        stress, vowels, onset = 0, 0, False
        following: Sound | None = None
        ms: list[float] = []
        for i in range(len(sounds) - 1, -1, -1):
            sound = sounds[i]
            clustered = following is not None and not following.vowel
            if sound.vowel:
                stress, onset = sound.stress, True
                factor = by_stress[stress] * shortened
                if clustered and following:
                    factor *= self._before(following)
                if not vowels and (final or n_vowels > 1):
                    factor *= self._last_vowel[final]
                vowels += 1
            else:
                factor = by_next[stress == 1]
                if clustered and following:
                    factor *= cluster
                    onset = onset and (sound.name, following.name) in self._onsets
                if not onset:
                    factor *= self._coda
                if final and vowels < 2 and (onset or not vowels):
                    factor *= self._final[vowels]
                factor *= cluster if i and not sounds[i - 1].vowel else 1.0 if i else self._initial
            length = sound.min_ms + sound.span_ms * factor
            ms.append(length if length > sound.least_ms else sound.least_ms)
            following = sound
        ms.reverse()
        return ms

    def _before(self, consonant: Sound) -> float:
        """What a consonant does to the vowel before it (Klatt's rule 9)."""
        if not consonant.voiced:
            return float(self._before_voiceless)
        return float(self._before_fricative) if consonant.kind == "fricative" else 1.0
