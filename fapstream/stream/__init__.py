"""Time: packets on the audio clock, when they leave, and which sample of them is being heard."""

from __future__ import annotations

from fapstream.stream.buffer import TurnBuffer
from fapstream.stream.heard import Heard
from fapstream.stream.history import KeptText, SaidWord, SaidWords
from fapstream.stream.loudness import Loudness
from fapstream.stream.pacer import Pacer
from fapstream.stream.packetizer import PACKET_MS, Packetizer
from fapstream.stream.playback import Playback
from fapstream.stream.player import PlayerStats

__all__ = [
    "PACKET_MS",
    "Heard",
    "KeptText",
    "Loudness",
    "Pacer",
    "Packetizer",
    "Playback",
    "PlayerStats",
    "SaidWord",
    "SaidWords",
    "TurnBuffer",
]
