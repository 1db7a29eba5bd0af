"""The other corridor: sound in, ordered packets out, with a face that says what is heard. Pure."""

from __future__ import annotations

from collections.abc import Iterator

from fapstream.motion import FaceTrack, Motion, hearing_mouth
from fapstream.records import Packet, Pcm, TurnFormat
from fapstream.stream import Packetizer


class Hearing:
    """One turn that somebody speaks himself. The sound goes out as it came, as much later as the face needs
    to be in step with it."""

    def __init__(self, turn: TurnFormat, seed: int = 0, motion: Motion | None = None) -> None:
        self.turn = turn
        self._mouth = hearing_mouth(turn.sample_rate, (motion or Motion()).gain)
        self._track = FaceTrack(turn.lang, turn.sample_rate, turn.fps, seed, mouth=self._mouth)
        self._packetizer = Packetizer(turn)
        self._last = False

    @property
    def delay(self) -> int:
        """How many samples a packet leaves at least after the last of its sound came."""
        return round(self._mouth.delay_s * self.turn.sample_rate)

    @property
    def kept(self) -> int:
        """Samples that came and are not in packets yet."""
        return self._packetizer.pcm_end - self._packetizer.cut_end

    def add(self, pcm: Pcm) -> None:
        """More sound."""
        self._packetizer.add(self._packetizer.pcm_end, pcm)
        self._mouth.hear(pcm)

    def end(self) -> None:
        """No more will come."""
        self._last = True
        self._mouth.end()

    def packets(self) -> Iterator[Packet]:
        """Packets that are complete. More may come at any time or never: all but the last hold."""
        while (end := self._packetizer.next_end(self._last)) is not None:
            if not self._last and self._track.ready_until() < end:
                return
            yield self._packetizer.cut(end, self._track.frames(end), hold=not self._last)
