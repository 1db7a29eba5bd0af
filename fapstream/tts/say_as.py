"""How the content of `sub`, `say-as` and `phoneme` is read."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from fapstream.records import Spoken
from fapstream.tts.markup import Tag
from fapstream.tts.tables import phone_set, read_pairs

_READ = {"characters": "spell", "spell-out": "spell", "verbatim": "spell", "digits": "digits",
         "telephone": "digits", "cardinal": "cardinal", "ordinal": "ordinal"}  # fmt: skip
"""interpret-as -> the reader; everything else is read as text is."""
_NOT_HEARD = str.maketrans("", "", ". ːˑ͡")
"""Syllable marks, lengths and ties of IPA."""


def phones_of(text: str, lang: str) -> tuple[str, ...] | None:
    """Phones written one blank apart, vowels with stress digits (0 where there is none); None if they are
    not.

    The stress may also stand as a quotation mark before the vowel, as in SAMPA.
    """
    known = phone_set(lang)
    out: list[str] = []
    for symbol in text.split():
        stress = "1" if symbol[:1] in "\"'" else "2" if symbol[:1] == "%" else ""
        name = symbol.lstrip("\"'%")
        if name not in known and name[-1:] in ("0", "1", "2"):
            name, stress = name[:-1], name[-1]
        info = known.get(name)
        if info is None or info.kind == "silence" or (stress and info.kind != "vowel"):
            return None
        out.append(name + (stress or "0") if info.kind == "vowel" else name)
    return tuple(out) or None


def ipa_phones(text: str, lang: str) -> tuple[str, ...] | None:
    """Phones written in IPA without blanks, by `data/<lang>/ipa.tsv`; None where a symbol is not in it."""
    table = read_pairs(f"{lang}/ipa.tsv")
    out: list[str] = []
    stress, at = "0", 0
    text = text.translate(_NOT_HEARD)
    while at < len(text):
        if text[at] in "ˈˌ":
            stress = {"ˈ": "1", "ˌ": "2"}[text[at]]
            at += 1
            continue
        size = next((n for n in (3, 2, 1) if text[at : at + n] in table), 0)
        if not size:
            return None
        for name in table[text[at : at + size]].split():
            vowel = phone_set(lang)[name].kind == "vowel"
            out.append(name + stress if vowel else name)
            stress = "0" if vowel else stress
        at += size
    return tuple(out) or None


class SayAs:
    """Reads the content of capturing elements in one language."""

    def __init__(self, lang: str, read: Callable[[str, str], list[Spoken]]) -> None:
        """`read`: (name of a reader, or "" for plain text; the content) -> spoken words."""
        self._lang = lang
        self._read = read

    def __call__(self, tag: Tag, content: str) -> tuple[Spoken, ...] | None:
        """The words to be spoken, or None if it cannot be read like that."""
        given: Mapping[str, str] = tag.attributes
        if tag.name == "sub":
            return tuple(self._read("", given["alias"])) or None
        if tag.name == "phoneme":
            reader = ipa_phones if given.get("alphabet", "ipa") == "ipa" else phones_of
            phones = reader(given["ph"], self._lang)
            return (phones,) if phones else None
        return tuple(self._read(_READ.get(given["interpret-as"], ""), content)) or None
