"""Say a text without a server: into files, faster than real time, or aloud while it still arrives."""

from __future__ import annotations

import argparse
import asyncio
import codecs
import json
import sys
import wave
from contextlib import AsyncExitStack, aclosing
from pathlib import Path
from typing import Any

from fapstream.adapters.audio import AudioUnavailable, Output
from fapstream.adapters.pool import VoicePool
from fapstream.adapters.record import PhoRecorder
from fapstream.adapters.recorded import RecordedVoice, Recording, read_recording
from fapstream.adapters.stdin import READ_BYTES, chunks
from fapstream.adapters.timed import TimedVoice
from fapstream.cli.arguments import unicode_text
from fapstream.cli.describe import described, lines
from fapstream.cli.manner import add_manner, manner
from fapstream.cli.motion import add_motion, motion
from fapstream.errors import InputError
from fapstream.fap import FapSequence, format_fap
from fapstream.motion import Motion
from fapstream.pipeline import Pipeline
from fapstream.ports import Synthesizer
from fapstream.records import FapFrame, Mark, Packet, TurnFormat, Utterance
from fapstream.talk import Talk
from fapstream.tts import LANGUAGES, FrontEnd, Manner
from fapstream.viewer.sound import Sound

HELP = "say a text into files or aloud"
PLAY_LEAD_S = 0.3
TURN = 1
"""The only one."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """TEXT, --lang, --voice, --fps, --wav, --fap, --pho, --marks, --explain, --play, and how it is read."""
    parser.add_argument(
        "text", type=unicode_text, nargs="?", help="the text; `-` reads it from stdin as it arrives"
    )
    parser.add_argument("--lang", choices=LANGUAGES, help="language (default: the voice's, or en)")
    parser.add_argument("--voice", help="voice, see `fapstream voices`")
    parser.add_argument("--fps", type=int, choices=(25, 50), default=25, help="FAP frames a second")
    parser.add_argument("--wav", type=Path, metavar="F", help="write the sound")
    parser.add_argument("--fap", type=Path, metavar="F", help="write the face as an MPEG-4 FAP file")
    parser.add_argument("--pho", type=Path, metavar="F", help="write phones, durations and pitch for MBROLA")
    parser.add_argument("--marks", type=Path, metavar="F", help="write phone, word and caption times as JSON")
    parser.add_argument(
        "--explain", action="store_true",
        help="print for each word how it was read and where its phones come from: your lexicon (user), "
        "the language's (lexicon), its stem and ending (stem), two words in one (compound), letter-to-sound "
        "trees (tree), rules (rule), or the name of a letter (letter)",
    )  # fmt: skip
    parser.add_argument(
        "--timed", type=Path, metavar="F.jsonl",
        help="take the voice from a file: JSON lines with sample_rate, then phones with start and duration "
        "in seconds, and pcm; TEXT is what it says",
    )  # fmt: skip
    parser.add_argument(
        "--voice-program", metavar="COMMAND",
        help="speak with a program of your own: it is given the planned phones as JSON lines, and answers "
        "with lines as in --timed",
    )  # fmt: skip
    parser.add_argument(
        "--speech", type=Path, metavar="F.wav",
        help="the voice is a recording of English speech (WAV, FLAC or OGG), whose words are found in it; "
        "there is no TEXT then",
    )  # fmt: skip
    parser.add_argument(
        "--transcript", type=unicode_text, metavar="TEXT",
        help="what is said in --speech, as written; without it the words are recognised, and many of them "
        "wrongly unless the speech is clear",
    )  # fmt: skip
    parser.add_argument("--play", action="store_true", help="play it (the default if no file is asked for)")
    parser.add_argument("--seed", type=int, default=0, help="seed of blinks and head motion")
    add_manner(parser)
    add_motion(parser)


def run(args: argparse.Namespace) -> int:
    """Write what was asked for."""
    if args.text is None and args.speech is None:
        print("fapstream say: TEXT, or --speech with a recording, is missing; see --help", file=sys.stderr)
        return 2
    asyncio.run(_say(args))
    return 0


async def _say(args: argparse.Namespace) -> None:
    pool = VoicePool()
    files = any((args.wav, args.fap, args.pho, args.marks, args.explain))
    try:
        text = _text(args)
        if args.speech:
            recording = await asyncio.to_thread(read_recording, args.speech, args.transcript)
            text = recording.heard.text
            turn, wished, synthesizer = _recording(args, recording)
        else:
            turn, wished, synthesizer = await _voice(args, pool)
        async with AsyncExitStack() as stack:
            stack.push_async_callback(synthesizer.aclose)
            sound = _sound(turn, stack) if args.play or not files else None
            sink = Sink(args, turn, stack)
            make = Explained if args.explain else Pipeline
            pipeline = make(turn, FrontEnd(turn.lang, wished), args.seed, motion(args))
            talk = Talk(pipeline, synthesizer, (lambda: _heard(sound) / turn.sample_rate) if sound else None)
            await _run(talk, text, sink, sound)
            sink.finish(synthesizer.lines if isinstance(synthesizer, PhoRecorder) else [])
    finally:
        await pool.aclose()


async def _voice(args: argparse.Namespace, pool: VoicePool) -> tuple[TurnFormat, Manner, Synthesizer]:
    """The turn's format, how it is to be read, and who reads it."""
    complete = args.text != "-"
    if not (args.timed or args.voice_program):
        chosen = pool.find(args.voice, args.lang)
        if args.lang and args.lang != chosen.lang:
            raise InputError(f"the voice {chosen.name} speaks {chosen.lang}, not {args.lang}")
        turn = TurnFormat(TURN, chosen.name, chosen.lang, chosen.sample_rate, args.fps)
        wished = manner(args, chosen.lang, complete).of(chosen)
        return turn, wished, PhoRecorder(await pool.acquire(chosen), chosen)
    if args.voice or args.pho or (args.timed and args.voice_program):
        raise InputError(
            "--timed, --voice-program and --voice are three voices, and only the last writes --pho"
        )
    lang = args.lang or LANGUAGES[0]
    opened = TimedVoice.read(args.timed, lang) if args.timed else TimedVoice.run(args.voice_program, lang)
    voice = await opened
    return TurnFormat(TURN, "timed", lang, voice.sample_rate, args.fps), manner(args, lang, complete), voice


def _text(args: argparse.Namespace) -> str:
    """What is to be said. Raises InputError for options that do not go together."""
    if args.transcript and not args.speech:
        raise InputError("--transcript says what is said in --speech, which is missing")
    if args.speech and (args.text or args.voice or args.pho or args.timed or args.voice_program):
        raise InputError("--speech is a voice and its text: it takes no TEXT, no other voice and no --pho")
    if args.speech and args.lang not in (None, "en"):
        raise InputError("--speech understands English only")
    return args.text or ""


def _recording(args: argparse.Namespace, recording: Recording) -> tuple[TurnFormat, Manner, Synthesizer]:
    """A turn that is a recording."""
    if not args.transcript:
        print(f"recognised: {recording.heard.text}", file=sys.stderr)
    voice = RecordedVoice(recording)
    turn = TurnFormat(TURN, "recorded", "en", recording.sample_rate, args.fps)
    return turn, manner(args, "en"), voice


def _sound(turn: TurnFormat, stack: AsyncExitStack) -> Sound:
    """The sound card, waiting for the turn. Raises AudioUnavailable."""
    try:
        sound = Sound(turn.sample_rate, Output)
    except AudioUnavailable as e:
        raise AudioUnavailable(f"{e}; or write a file with --wav") from e
    stack.callback(sound.close)
    sound.begin(TURN)
    return sound


def _heard(sound: Sound) -> float:
    """The sample that is heard now."""
    heard = sound.heard()
    return heard.sample if heard else 0.0


async def _run(talk: Talk, text: str, sink: Sink, sound: Sound | None) -> None:
    feeder = asyncio.create_task(_feed(talk, text))
    try:
        async with aclosing(talk.packets()) as packets:
            async for packet in packets:
                sink.take(packet)
                if sound:
                    await _play(sound, packet)
        await feeder
        if sound:
            await _play_out(sound)
    finally:
        feeder.cancel()
        await asyncio.gather(feeder, return_exceptions=True)
        await talk.aclose()


async def _play(sound: Sound, packet: Packet) -> None:
    """Hand it over, and wait until little of it is left to be heard."""
    sound.push(TURN, packet.start, packet.pcm, packet.hold)
    end = packet.start + len(packet.pcm)
    while end - _heard(sound) > PLAY_LEAD_S * sound.sample_rate:
        await asyncio.sleep(0.01)


async def _play_out(sound: Sound) -> None:
    """Until the last sample has been heard."""
    sound.end(TURN)
    while (heard := sound.heard()) is None or heard.state != "over":
        await asyncio.sleep(0.02)


async def _feed(talk: Talk, text: str) -> None:
    """The text, or standard input as it comes; never more than there is room for."""
    if text != "-":
        for at in range(0, len(text), READ_BYTES):
            await _feed_when_room(talk, text[at : at + READ_BYTES])
    else:
        decoder = codecs.getincrementaldecoder("utf-8")("replace")
        async for data in chunks(sys.stdin.fileno()):
            await _feed_when_room(talk, decoder.decode(data))
        await _feed_when_room(talk, decoder.decode(b"", True))
    talk.end()


async def _feed_when_room(talk: Talk, text: str) -> None:
    while talk.room < len(text):
        await asyncio.sleep(0.01)
    talk.feed(text)


class Explained(Pipeline):
    """A pipeline that prints what its front-end makes of each word."""

    def __init__(self, turn: TurnFormat, frontend: FrontEnd, seed: int, motion: Motion) -> None:
        super().__init__(turn, frontend, seed, motion)
        self._explaining = frontend

    def feed(self, text: str) -> list[Utterance]:
        """See Pipeline."""
        return self._explained(super().feed(text))

    def end(self) -> list[Utterance]:
        """See Pipeline."""
        return self._explained(super().end())

    def _explained(self, utterances: list[Utterance]) -> list[Utterance]:
        for line in lines(described(self._explaining, utterances)):
            print(line, flush=True)
        return utterances


class Sink:
    """The files asked for. Sound is written as it comes, the rest at the end."""

    def __init__(self, args: argparse.Namespace, turn: TurnFormat, stack: AsyncExitStack) -> None:
        self._args = args
        self._turn = turn
        self._frames: list[FapFrame] = []
        self._marks: list[Mark] = []
        self._wav: wave.Wave_write | None = None
        if args.wav:
            file = stack.enter_context(args.wav.open("wb"))
            self._wav = stack.enter_context(wave.open(file, "wb"))  # noqa: SIM115
            self._wav.setnchannels(1)
            self._wav.setsampwidth(2)
            self._wav.setframerate(turn.sample_rate)

    def take(self, packet: Packet) -> None:
        """The next packet."""
        if self._wav:
            self._wav.writeframes(packet.pcm.astype("<i2").tobytes())
        if self._args.fap:
            self._frames += packet.frames
        if self._args.marks:
            self._marks += packet.marks

    def finish(self, pho: list[str]) -> None:
        """Write what needs the whole turn."""
        args = self._args
        if args.fap:
            sequence = FapSequence.of(self._frames, args.fap.stem, self._turn.fps)
            args.fap.write_text(format_fap(sequence), encoding="ascii", errors="replace")
        if args.marks:
            args.marks.write_text(
                json.dumps(self._described(), ensure_ascii=False, indent=1), encoding="utf-8"
            )
        if args.pho:
            args.pho.write_text("".join(pho), encoding="ascii")

    def _described(self) -> dict[str, Any]:
        turn = self._turn
        marks = [
            {
                "kind": m.kind, "text": m.text, "sample": m.sample, "duration": m.duration,
                "time_ms": round(1000 * m.sample / turn.sample_rate, 3),
                "duration_ms": round(1000 * m.duration / turn.sample_rate, 3),
                **({"char_start": m.char_start, "char_end": m.char_end} if m.char_start >= 0 else {}),
            }
            for m in self._marks
        ]  # fmt: skip
        return {"voice": turn.voice, "lang": turn.lang, "sample_rate": turn.sample_rate, "marks": marks}
