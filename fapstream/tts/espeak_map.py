"""Language phones in eSpeak NG's ASCII phoneme notation, to be sent as text between `[[` and `]]`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from fapstream.records import SILENCE, Phone
from fapstream.tts.realise import rewrite
from fapstream.tts.voices import Voice

_MARKS = {1: "'", 2: ","}
SEPARATOR = "|"
"""Keeps neighbouring mnemonics, as in t|S, from being read as one."""


def mnemonics(phones: Sequence[Phone], voice: Voice) -> list[str]:
    """One mnemonic per phone, its stress mark before it; pauses are empty strings.

    eSpeak NG's PHONEME events name the same mnemonics (sometimes an allophone, as `t#` for t), in order.
    """
    found = []
    for output, begin, end in rewrite(phones, voice):
        assert len(output) == end - begin == 1, "tables of eSpeak voices map one to one"
        phone = phones[begin]
        silent = phone.name == SILENCE
        found.append("" if silent else _MARKS.get(phone.stress, "") + output[0])
    return found


def bracketed(phones: Sequence[Phone], voice: Voice) -> str:
    """The phones as `[[h|@|l|'oU w|'3:|l|d]]`, words apart; "" when there is nothing but silence."""
    marks = zip(phones, mnemonics(phones, voice), strict=True)
    words = [
        SEPARATOR.join(mark for _, mark in run if mark)
        for _, run in groupby(marks, key=lambda pair: pair[0].word)
    ]
    spoken = " ".join(word for word in words if word)
    return f"[[{spoken}]]" if spoken else ""
