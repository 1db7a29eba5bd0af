"""The records that travel between the rooms. They import nothing of ours and do nothing.

Time is an integer: a sample index on the audio clock of one turn, at that turn's sample rate.
Sample 0 is the first PCM sample of the turn.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:  # text is read without numpy: loading it takes longer than loading the lexicon
    import numpy as np
    from numpy.typing import NDArray

    Pcm = NDArray[np.int16]
else:
    Pcm = Any
    """Mono signed 16-bit samples, shape (n,)."""

N_FAPS = 68

ExpressionName = Literal["joy", "sadness", "anger", "fear", "disgust", "surprise"]


class Word(NamedTuple):
    """One spoken word and the characters it came from.

    `start` and `end` are code-point offsets [start, end) into the whole text of the turn. `spoken`: the words
    it is read as, in the spelling that the phonetiser gets; a tuple of phones where the reader gave them.
    """

    text: str
    start: int
    end: int
    spoken: tuple[Spoken, ...] = ()


Spoken = str | tuple[str, ...]
"""A word as the phonetiser gets it, or the phones themselves, vowels with stress digits."""


class Note(NamedTuple):
    """Something in the text that is not spoken and happens where the next phone begins.

    `mark`: the name of an SSML mark. `warning`: mark-up that could not be understood and was read as text.
    """

    kind: Literal["mark", "warning"]
    text: str
    start: int
    end: int


class Phone(NamedTuple):
    """One phone as planned: language-level SAMPA name, wished duration and melody.

    `pitch` holds (position in percent of the duration, f0 in Hz), empty for the voice's default.
    `stress`: 0 none, 1 primary, 2 secondary. `word` indexes `Utterance.words`, or is -1 in a pause. A silent
    phone (`_`) may carry a facial expression, which begins with the pause and lasts, weaker, under the phrase
    that follows. `gain` multiplies the sound. `hold`: the phone is there only because the text had run dry.

    A named tuple and not a dataclass, like Word: thousands are made a second, and it is made four times as
    fast.
    """

    name: str
    duration_ms: float
    pitch: tuple[tuple[float, float], ...] = ()
    stress: int = 0
    word: int = -1
    expression: ExpressionName | None = None
    gain: float = 1.0
    notes: tuple[Note, ...] = ()
    hold: bool = False


SILENCE = "_"

make = tuple.__new__
"""make(Phone, (every field, in order)): a named tuple in two thirds of the time of Phone(...)."""


@dataclass(frozen=True, slots=True)
class Utterance:
    """A run of phones that may be handed to a voice.

    `closed` means that it ends in a pause, where a voice may be flushed without being heard;
    an open one is the beginning of a phrase whose rest has not been written yet.
    """

    lang: str
    phones: tuple[Phone, ...]
    words: tuple[Word, ...] = ()
    closed: bool = True


@dataclass(frozen=True, slots=True)
class TimedPhone:
    """A phone and the samples [start, end) of the turn in which it is really heard."""

    phone: Phone
    start: int
    end: int
    text: Word | None = None
    """The word it belongs to, resolved."""


@dataclass(frozen=True, slots=True)
class Speech:
    """What a Synthesizer gives back: sound, and the phones whose true times are known by now.

    `pcm[0]` is sample `start` of the turn. Phones come in order and never later than the sound
    in which they are heard.
    """

    start: int
    pcm: Pcm
    phones: tuple[TimedPhone, ...] = ()


@dataclass(frozen=True, slots=True)
class HeardPhone:
    """A phone of recorded speech and the seconds [start_s, end_s) in which it is heard.

    `name`: as in the CMU Pronouncing Dictionary, vowels with their stress digit (`IY1`), `SIL` in a pause.
    """

    name: str
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class HeardWord:
    """A spoken word of recorded speech, or a pause, whose `text` is "".

    [char_start, char_end) are code points of `Heard.text`: those of the written word that it is a part of, so
    that "5 pm" is `five`, `p` and `m`, the last two at the same characters; -1 in a pause. `fit`: how likely
    the sound is if these are the phones, against the likeliest phones there; the mean over the phones of
    the log likelihood ratio per 10 ms, in nats, 0 at best.
    """

    text: str
    start_s: float
    end_s: float
    phones: tuple[HeardPhone, ...]
    char_start: int = -1
    char_end: int = -1
    fit: float = 0.0


@dataclass(frozen=True, slots=True)
class Heard:
    """Recorded speech: its words and pauses in order, without gaps, from 0 to its end.

    `fit`: of the middle word, see HeardWord. `covered`: which part of the loud sound the words take up.
    """

    text: str
    words: tuple[HeardWord, ...]
    fit: float
    covered: float


@dataclass(frozen=True, slots=True)
class FapFrame:
    """The facial animation parameters that hold at one sample.

    `values` is int32 of shape (68,): FAP n is at n-1, in units of 1/1024 FAPU of the face that shows it, or
    of 1e-5 rad. Only the low-level FAPs 3-68 travel between the rooms; 1 and 2 are composite (below) and 0
    here.
    """

    sample: int
    values: NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class VisemeFap:
    """FAP 1: viseme 1 with weight blend/63, viseme 2 with the rest (ISO/IEC 14496-2, visemes).

    Selects are 0 (none) to 14, `blend` is 0-63. `define`: the mouth's FAPs sent along define viseme 1.
    """

    select1: int = 0
    select2: int = 0
    blend: int = 0
    define: bool = False


@dataclass(frozen=True, slots=True)
class ExpressionFap:
    """FAP 2: the sum of two expressions, each with an intensity of 0-63 (ISO/IEC 14496-2, expressions).

    Selects are 0 (none) to 6, joy is 1. `init_face`: the neutral face is modified. `define`: the FAPs
    sent along define expression 1.
    """

    select1: int = 0
    intensity1: int = 0
    select2: int = 0
    intensity2: int = 0
    init_face: bool = False
    define: bool = False


@dataclass(frozen=True, slots=True)
class Mark:
    """Something that happens at a sample of the turn and lasts `duration` samples.

    kind `phone`: `text` is its SAMPA name. `word`: as written. `caption`: the text of a phrase.
    `expression`: its name. `mark` and `warning`: see Note. Character offsets [start, end) are code points of
    the turn's text.
    """

    kind: Literal["phone", "word", "caption", "expression", "mark", "warning"]
    sample: int
    duration: int
    text: str
    char_start: int = -1
    char_end: int = -1


@dataclass(frozen=True, slots=True)
class Packet:
    """A slice of a turn: sound, and the FAP frames and marks of exactly those samples.

    `hold` says that the text has run dry: what follows may come late without being a fault.
    """

    turn: int
    start: int
    pcm: Pcm
    frames: tuple[FapFrame, ...] = ()
    marks: tuple[Mark, ...] = ()
    hold: bool = False


@dataclass(frozen=True, slots=True)
class TurnFormat:
    """What a turn is made of; fixed when the turn begins."""

    turn: int
    voice: str
    lang: str
    sample_rate: int
    fps: Literal[25, 50]
