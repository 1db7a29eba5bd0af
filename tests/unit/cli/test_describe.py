"""Words as they are shown."""

from __future__ import annotations

from fapstream.cli.describe import described, lines
from fapstream.tts import FrontEnd, phone_set


def words(text: str, lang: str = "en") -> list[dict[str, object]]:
    front = FrontEnd(lang)
    return described(front, front.feed(text) + front.end())


def test_the_shape() -> None:
    for word in described(front := FrontEnd("en"), front.feed("Hello world, it is 21:45 zorblax. ")):
        assert word.keys() == {"word", "spoken", "path", "syllables", "phones"}
        vowels = [phone_set("en")[p["phone"]].kind == "vowel" for p in word["phones"]]
        assert len(word["syllables"]) == max(1, sum(vowels))
        assert word["syllables"][0] == 0
        assert word["syllables"] == sorted(word["syllables"])
        for phone in word["phones"]:
            assert phone.keys() == {"phone", "duration_ms", "f0_hz", "stress", "pitch"}
            assert phone["pitch"][0][0] == 0.0


def test_readings_and_paths() -> None:
    hello, clock, odd = words("Hello 21:45 zorblax.")
    assert (hello["spoken"], hello["path"]) == (["hello"], "lexicon")
    assert (clock["word"], clock["spoken"]) == ("21:45", ["twenty", "one", "forty", "five"])
    assert odd["path"] == "tree"
    given = words("<phoneme alphabet='sampa' ph='t E1 s t'>x</phoneme>.")
    assert (given[0]["spoken"], given[0]["path"]) == (["t E1 s t"], "user")


def test_lines_show_syllables_with_stress_durations_and_pitch() -> None:
    shown = list(lines(words("Hello 21:45.")))
    assert shown[0].startswith("Hello ")
    assert shown[0].endswith("lexicon")
    assert " ms  " in shown[0]
    assert shown[1].strip().startswith("h:")
    assert shown[2].strip().startswith("' l:")
    assert shown[2].endswith(" Hz")
    assert "«twenty one forty five»" in shown[3]


def test_words_without_a_vowel_are_one_syllable() -> None:
    (word,) = words("<phoneme alphabet='sampa' ph='s t'>x</phoneme>.")
    assert word["syllables"] == [0]
    assert len(list(lines([word]))) == 2
