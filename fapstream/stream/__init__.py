"""Time: packets on the audio clock, and when they leave."""

from __future__ import annotations

from fapstream.stream.pacer import Pacer
from fapstream.stream.packetizer import PACKET_MS, Packetizer

__all__ = ["PACKET_MS", "Pacer", "Packetizer"]
