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
LEAST = 0.8
"""No phone becomes shorter than this share of its minimum at rate 1."""


class DurationModel:
    """Durations of the phones of one word. Its neighbours do not matter, so a word can be timed as soon as it
    is known whether a pause follows."""

    def __init__(self, lang: str, factors: Mapping[str, Any]) -> None:
        """`factors`: the language's table of prosody.toml."""
        self._f = factors
        self._onsets = onsets(lang)
        vowel = factors["vowel"]
        by_stress = (vowel["unstressed"], vowel["stressed"], vowel["secondary"])
        self._stress = (by_stress, tuple(v * factors["function_word"] for v in by_stress))
        self._syllables = [
            max(1.0 - factors["polysyllabic"] * (n - 1), factors["polysyllabic_floor"])
            for n in range(MAX_COUNTED_SYLLABLES + 1)
        ]

    def word(self, sounds: Sequence[Sound], n_vowels: int, function: bool, final: bool) -> list[float]:
        """Milliseconds at rate 1, one per phone. `final`: a pause follows the word."""
        f = self._f
        by_stress = self._stress[function]
        shortened = self._syllables[min(n_vowels, MAX_COUNTED_SYLLABLES)]
        ms: list[float] = []
        stress, vowels, onset = 0, 0, False
        following: Sound | None = None
        for i in range(len(sounds) - 1, -1, -1):
            sound = sounds[i]
            if sound.vowel:
                stress, onset = sound.stress, True
                factor = by_stress[stress] * shortened
                if following is not None and not following.vowel:
                    factor *= self._before(following)
                if not vowels:
                    factor *= f["final_vowel"] if final else f["word_final"] if n_vowels > 1 else 1.0
                vowels += 1
            else:
                onset = onset and self._opens(sound, following)
                factor = self._place(onset, stress, vowels if final else 2)
                if following is not None and not following.vowel:
                    factor *= f["cluster"]
                if not i:
                    factor *= f["word_initial"]
                elif not sounds[i - 1].vowel:
                    factor *= f["cluster"]
            length = sound.min_ms + sound.span_ms * factor
            ms.append(max(length, LEAST * sound.min_ms))
            following = sound
        ms.reverse()
        return ms

    def _opens(self, sound: Sound, following: Sound | None) -> bool:
        """Whether a consonant belongs to the syllable of the onset or vowel after it."""
        return following is None or following.vowel or (sound.name, following.name) in self._onsets

    def _place(self, onset: bool, stress: int, vowels: int) -> float:
        """A consonant's factor by its place in the syllable and before a pause; `vowels`: how many follow
        it."""
        f = self._f
        factor: float = f["consonant"] if stress == 1 else f["consonant"] * f["consonant_unstressed"]
        if not onset:
            factor *= f["coda"]
        if vowels < 2:
            factor *= f["final_consonant"] if not vowels else f["prefinal"] if onset else 1.0
        return factor

    def _before(self, consonant: Sound) -> float:
        """What a consonant does to the vowel before it (Klatt's rule 9)."""
        if not consonant.voiced:
            return float(self._f["before_voiceless"])
        return float(self._f["before_voiced_fricative"]) if consonant.kind == "fricative" else 1.0
