"""Language phones to a voice's phones, in samples: every duration exact, every diphone one that exists."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate
from typing import NamedTuple

from fapstream.records import SILENCE, Phone
from fapstream.tts.voices import Voice, phone_codes

MAX_VOICED_S, MAX_SILENCE_S = 9.0, 14.0
"""MBROLA dies of longer phones."""

BRIDGE_MS = 8.0
"""Silence put between two phones that cannot be joined otherwise, taken from the second."""

_STAND_IN_COST, _BRIDGE_COST, _NEVER = 1.0, 6.0, 1e9


Group = tuple[tuple[str, ...], int, int]
"""Voice phones, the first of the language phones that they say, and one past the last."""


class VoicePhone(NamedTuple):
    """One phone as the voice gets it.

    `pitch`: (percent of the duration, Hz), at least one. `parts`: (index of the language phone, how many of
    the samples are its own), in order; they add up to `n_samples`, so boundaries inside merged phones stay
    known.
    """

    name: str
    n_samples: int
    pitch: tuple[tuple[float, float], ...]
    parts: tuple[tuple[int, int], ...]


class Join(NamedTuple):
    """What was written before, and whether more is to come.

    `previous`: the voice phone written last, silence at the start of a stream. `before`: the language phone
    before the first. `behind`: by how much of a sample the phones written end before their wished time.
    `more`: the last phone's successor is not known yet, so it is not realised, nor what is merged with it.
    """

    previous: str = SILENCE
    before: Phone | None = None
    behind: float = 0.0
    more: bool = False


_ALONE = Join()


def realise(phones: Sequence[Phone], voice: Voice, join: Join = _ALONE) -> list[VoicePhone]:
    """The phones of one utterance for `voice`, so that every join within and before it exists.

    Sample counts: boundary k of the input is at round(sum of the first k durations * rate + behind), kept by
    `parts`; see `lengths`.
    """
    ends = _ends(phones, voice.sample_rate, join.behind)
    groups = list(rewrite(phones, voice, join.before))
    slots = _slots(groups, phones, voice, ends)
    kept = len(slots) - len(_slots(groups[-1:], phones, voice, ends)) if join.more else len(slots)
    previous = join.previous
    names = _choose([slot.name for slot in slots], voice, previous)
    joined: list[VoicePhone] = []
    for slot, name in zip(slots[:kept], names, strict=False):
        if not voice.joins(previous, name):
            bridge, slot = _bridge(slot, voice)
            joined.append(bridge)
        joined.append(slot if slot.name == name else slot._replace(name=name))
        previous = name
    return _with_pitch(joined, phones, ends, voice)


def lengths(voice_phones: Sequence[VoicePhone], n_phones: int) -> list[int]:
    """Samples of each of the `n_phones` language phones."""
    total = [0] * n_phones
    for phone in voice_phones:
        for index, samples in phone.parts:
            total[index] += samples
    return total


def _ends(phones: Sequence[Phone], rate: int, behind: float) -> list[int]:
    """The sample at which each phone ends."""
    return [round(behind + ms * rate / 1000.0) for ms in accumulate(p.duration_ms for p in phones)]


def rewrite(phones: Sequence[Phone], voice: Voice, before: Phone | None = None) -> Iterator[Group]:
    """The voice phones by the voice's rules and table, in order; `before`: the phone before the first."""
    codes = phone_codes(voice.lang)
    edge = codes[(SILENCE, 0)]
    left = codes[(before.name, before.stress)] if before else edge
    text = left + "".join([codes[(p.name, p.stress)] for p in phones]) + edge
    at = 0
    for match in voice.rules.apply(text, 1):
        begin, end = match.start - 1, match.end - 1
        yield from _by_table(phones, voice, at, begin)
        yield match.output, begin, end
        at = end
    yield from _by_table(phones, voice, at, len(phones))


def _by_table(phones: Sequence[Phone], voice: Voice, begin: int, end: int) -> Iterator[Group]:
    for i in range(begin, end):
        name = phones[i].name
        yield voice.phones.get(name, (name,)), i, i + 1


def _slots(
    groups: Sequence[Group], phones: Sequence[Phone], voice: Voice, ends: Sequence[int]
) -> list[VoicePhone]:
    """Voice phones without pitch; those without samples are left out, those too long divided. A phone that
    draws out the one before it is one with it."""
    slots: list[VoicePhone] = []
    for names, i, j in groups:
        found = _spread(names, ends, i, j)
        if slots and i and phones[i].hold and phones[i].name == phones[i - 1].name:
            last, drawn = slots[-1], sum(slot.n_samples for slot in found)
            slots[-1] = last._replace(n_samples=last.n_samples + drawn, parts=(*last.parts, (i, drawn)))
        else:
            slots += found
    return [piece for slot in slots if slot.n_samples for piece in _bounded(slot, voice.sample_rate)]


def _spread(names: Sequence[str], ends: Sequence[int], begin: int, end: int) -> list[VoicePhone]:
    """Language phones [begin, end) as the voice phones `names`, each an equal share of the time."""
    first = ends[begin - 1] if begin else 0
    total = ends[end - 1] - first
    if len(names) == 1 and end == begin + 1:
        return [VoicePhone(names[0], total, (), ((begin, total),))]
    out = []
    for k, name in enumerate(names):
        low, high = first + total * k // len(names), first + total * (k + 1) // len(names)
        parts = []
        for i in range(begin, end):
            own = min(high, ends[i]) - max(low, ends[i - 1] if i else 0)
            if own > 0:
                parts.append((i, own))
        out.append(VoicePhone(name, high - low, (), tuple(parts)))
    return out


def _bounded(slot: VoicePhone, rate: int) -> list[VoicePhone]:
    """A slot too long for MBROLA as the phone and silence after it, or as several silences."""
    limit = int((MAX_SILENCE_S if slot.name == SILENCE else MAX_VOICED_S) * rate)
    if slot.n_samples <= limit:
        return [slot]
    head, tail = _cut(slot, limit)
    return [head, *_bounded(tail._replace(name=SILENCE), rate)]


def _cut(slot: VoicePhone, at: int) -> tuple[VoicePhone, VoicePhone]:
    """The slot's first `at` samples, and the rest."""
    head: list[tuple[int, int]] = []
    tail: list[tuple[int, int]] = []
    left = at
    for index, samples in slot.parts:
        taken = min(samples, left)
        left -= taken
        if taken:
            head.append((index, taken))
        if samples > taken:
            tail.append((index, samples - taken))
    first = slot._replace(n_samples=at, parts=tuple(head))
    return first, slot._replace(n_samples=slot.n_samples - at, parts=tuple(tail))


def _bridge(slot: VoicePhone, voice: Voice) -> tuple[VoicePhone, VoicePhone]:
    """A short silence, and what is left of the slot."""
    wished = max(voice.period, int(BRIDGE_MS * voice.sample_rate / 1000.0))
    head, tail = _cut(slot, max(1, min(wished, slot.n_samples // 2))) if slot.n_samples > 1 else (slot, slot)
    return head._replace(name=SILENCE), tail


def _choose(names: Sequence[str], voice: Voice, previous: str) -> list[str]:
    """For each phone itself or a stand-in, so that as few joins as possible are missing (Viterbi search).

    Whatever comes after must be reachable through silence, so a phone that cannot be followed by silence
    never ends the result.
    """
    if all(voice.joins(a, b) for a, b in zip([previous, *names], [*names, SILENCE], strict=True)):
        return list(names)
    paths: dict[str, tuple[float, list[str]]] = {previous: (0.0, [])}
    for name in names:
        step: dict[str, tuple[float, list[str]]] = {}
        for rank, candidate in enumerate((name, *voice.stand_ins.get(name, ()))):
            cost, before = min(
                ((c + _join_cost(voice, last, candidate), path) for last, (c, path) in paths.items()),
                key=lambda found: found[0],
            )
            step[candidate] = (cost + rank * _STAND_IN_COST, [*before, candidate])
        paths = step
    final = ((c + (0.0 if voice.joins(last, SILENCE) else _NEVER), path) for last, (c, path) in paths.items())
    return min(final, key=lambda found: found[0])[1]


def _join_cost(voice: Voice, left: str, right: str) -> float:
    if voice.joins(left, right):
        return 0.0
    return _BRIDGE_COST if voice.joins(left, SILENCE) and voice.joins(SILENCE, right) else _NEVER


def _with_pitch(
    slots: Sequence[VoicePhone], phones: Sequence[Phone], ends: Sequence[int], voice: Voice
) -> list[VoicePhone]:
    """The planned melody cut at the voice phones' borders; each gets at least a point at its start."""
    points = _points(phones, ends) or [(0, voice.f0_hz)]
    out, at, k = [], 0, 0
    for slot in slots:
        end = at + slot.n_samples
        while k + 1 < len(points) and points[k + 1][0] <= at:
            k += 1
        pitch = [(0.0, _between(points, k, at))]
        j = k + 1
        while j < len(points) and points[j][0] < end:
            pitch.append((100.0 * (points[j][0] - at) / slot.n_samples, points[j][1]))
            j += 1
        out.append(VoicePhone(slot.name, slot.n_samples, tuple(pitch), slot.parts))
        at = end
    return out


def _points(phones: Sequence[Phone], ends: Sequence[int]) -> list[tuple[int, float]]:
    """Every pitch target as (sample, Hz), ascending."""
    out: list[tuple[int, float]] = []
    begin = 0
    for phone, end in zip(phones, ends, strict=True):
        out += [(begin + round(percent * (end - begin) / 100.0), hz) for percent, hz in phone.pitch]
        begin = end
    return out


def _between(points: Sequence[tuple[int, float]], k: int, at: int) -> float:
    """Linear interpolation between points k and k + 1, flat outside."""
    (t0, f0), (t1, f1) = points[k], points[min(k + 1, len(points) - 1)]
    if at <= t0 or t1 <= t0:
        return f0
    return f0 + (f1 - f0) * (at - t0) / (t1 - t0)
