"""eSpeak NG in a process of its own: JSON lines in, frames of sound and phoneme events out.

Run as `python -m fapstream.adapters.espeak_worker`. The library is GPL-3; it is loaded here and nowhere else.
Request: {"voice", "text", "rate", "pitch"}. Reply frames: 5 bytes `<BI` (kind, length) and the body:
`S` sound, int16; `P` phonemes, JSON
[[name, sample], ...] that begin in the sound sent next; `E` end; `X` error text.
"""

from __future__ import annotations

import ctypes
import json
import struct
import sys
from typing import Any, BinaryIO

SYNCHRONOUS = 2
PHONEME_EVENTS = 0x0001
UTF8, PHONEMES = 0x1, 0x100
EVENT_END, EVENT_PHONEME = 0, 7
RATE, PITCH = 1, 3
BUFFER_MS = 40
FRAME = struct.Struct("<BI")


class _Id(ctypes.Union):
    _fields_ = [("number", ctypes.c_int), ("name", ctypes.c_char_p), ("string", ctypes.c_char * 8)]


class _Event(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_int),
        ("unique_identifier", ctypes.c_uint),
        ("text_position", ctypes.c_int),
        ("length", ctypes.c_int),
        ("audio_position", ctypes.c_int),
        ("sample", ctypes.c_int),
        ("user_data", ctypes.c_void_p),
        ("id", _Id),
    ]


_Callback = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event)
)


class Worker:
    """The library, speaking to a pipe."""

    def __init__(self, out: BinaryIO) -> None:
        import espeakng_loader

        self._out = out
        self._library: Any = ctypes.CDLL(espeakng_loader.get_library_path())
        data = espeakng_loader.get_data_path().encode()
        self._library.espeak_Initialize.argtypes = [
            ctypes.c_int, ctypes.c_int, ctypes.c_char_p, ctypes.c_int,
        ]  # fmt: skip
        self.sample_rate = self._library.espeak_Initialize(SYNCHRONOUS, BUFFER_MS, data, PHONEME_EVENTS)
        if self.sample_rate <= 0:
            raise OSError("eSpeak NG cannot read its data")
        self._callback = _Callback(self._sound)
        self._library.espeak_SetSynthCallback(self._callback)

    def speak(self, request: dict[str, Any]) -> None:
        """Say one text; the callback sends what comes of it."""
        text = str(request["text"]).encode("utf-8")
        if self._library.espeak_SetVoiceByName(str(request["voice"]).encode()) != 0:
            raise ValueError(f"no eSpeak NG voice {request['voice']!r}")
        self._library.espeak_SetParameter(RATE, int(request["rate"]), 0)
        self._library.espeak_SetParameter(PITCH, int(request["pitch"]), 0)
        buffer = ctypes.create_string_buffer(text)
        self._library.espeak_Synth(buffer, len(text) + 1, 0, 1, 0, UTF8 | PHONEMES, None, None)
        self._send(b"E", b"")

    def _sound(self, wav: Any, n: int, events: Any) -> int:
        phonemes = []
        i = 0
        while events[i].type != EVENT_END:
            if events[i].type == EVENT_PHONEME:
                name = ctypes.string_at(ctypes.addressof(events[i].id), 8).split(b"\0")[0]
                phonemes.append([name.decode("utf-8", "replace"), events[i].sample])
            i += 1
        if phonemes:
            self._send(b"P", json.dumps(phonemes).encode())
        if wav and n > 0:
            self._send(b"S", ctypes.string_at(wav, 2 * n))
        return 0

    def _send(self, kind: bytes, body: bytes) -> None:
        self._out.write(FRAME.pack(kind[0], len(body)) + body)
        if kind != b"P":
            self._out.flush()

    def fail(self, error: Exception) -> None:
        """Report what went wrong and stay alive."""
        self._send(b"X", str(error).encode())


def main() -> None:
    """Serve requests until the input ends."""
    worker = Worker(sys.stdout.buffer)
    for line in sys.stdin.buffer:
        try:
            worker.speak(json.loads(line))
        except (ValueError, KeyError, TypeError) as e:
            worker.fail(e)


if __name__ == "__main__":
    main()
