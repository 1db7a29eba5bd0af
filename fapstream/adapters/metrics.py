"""The Meter port on Prometheus: figures of one process, or of several workers that share a folder.

Workers write their figures into files of the folder, named by the number of the worker; any of them can give
out the sum. The parent calls `fresh` once, and `worker_gone` whenever a worker has ended, before it starts
another with the same number, which then counts on where the dead one stopped.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from prometheus_client import (
    CONTENT_TYPE_LATEST,
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    ProcessCollector,
    disable_created_metrics,
    generate_latest,
    multiprocess,
    values,
)

from fapstream.ports import Counted, Gauged, Timed

PREFIX = "fapstream"
FOLDER_VARIABLE = "PROMETHEUS_MULTIPROC_DIR"


@dataclass(frozen=True, slots=True)
class Kinds:
    """A counter's help, its label if it has one, and the label's values known beforehand."""

    help: str
    label: str = ""
    values: tuple[str, ...] = ()


COUNTERS: dict[Counted, Kinds] = {
    "turns": Kinds("Turns that are over", "reason", ("end", "interrupted", "failed")),
    "resumes": Kinds("Sessions that were asked for again", "result", ("resumed", "gone")),
    "errors": Kinds("Errors told to clients", "code"),
    "late_packets": Kinds("Packets that left more than 20 ms after they were due"),
    "dropped": Kinds("What slow listeners did not get", "level", ("thin", "skipped", "closed")),
    "underruns": Kinds("Times the sound ran dry, as clients report"),
    "voice_restarts": Kinds("MBROLA programs that died in a turn and were replaced"),
    "voice_hangs": Kinds("MBROLA programs that stopped answering and were ended"),
    "sent_bytes": Kinds("Bytes sent to clients"),
}
GAUGES: dict[Gauged, str] = {
    "sessions": "Clients that may speak",
    "listeners": "Clients that only listen",
    "adapting": "Pages on which a head is being made",
    "voice_processes": "MBROLA programs that run",
    "outbox_packets": "Packets waiting to be sent, of all clients",
    "text_waiting": "Characters waiting to be spoken, of all clients",
}
HISTOGRAMS: dict[Timed, tuple[str, tuple[float, ...]]] = {
    "first_audio": (
        "From a turn's first text to its first packet",
        (0.005, 0.01, 0.02, 0.03, 0.05, 0.075, 0.1, 0.15, 0.25, 0.5, 1.0, 2.5),
    ),
    "packet_lateness": (
        "How long after it was due a packet left",
        (0.001, 0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.5, 1.0),
    ),
    "skew": (
        "Picture minus sound, as clients report",
        (-0.2, -0.1, -0.04, -0.02, -0.01, 0.0, 0.01, 0.02, 0.04, 0.1, 0.2),
    ),
    "loop_lag": (
        "How late the event loop was",
        (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0),
    ),
}


class Metrics:
    """One process's meter. With a folder, that of worker number `worker` among others."""

    def __init__(self, folder: Path | None = None, worker: int = 0) -> None:
        """With a folder, the whole process becomes that worker for Prometheus."""
        disable_created_metrics()
        self._folder = folder
        self._registry = registry = CollectorRegistry()
        if folder:
            os.environ[FOLDER_VARIABLE] = str(folder)
            values.ValueClass = values.MultiProcessValue(lambda: worker)
        else:
            ProcessCollector(registry=registry)
        self._families = {
            name: Counter(
                f"{PREFIX}_{name}", kinds.help, (kinds.label,) if kinds.label else (), registry=registry
            )
            for name, kinds in COUNTERS.items()
        }
        self._counters = {
            (name, value): self._family(name, value)
            for name, kinds in COUNTERS.items()
            for value in (kinds.values if kinds.label else ("",))
        }
        self._gauges = {
            name: Gauge(f"{PREFIX}_{name}", text, registry=registry, multiprocess_mode="livesum")
            for name, text in GAUGES.items()
        }
        self._histograms = {
            name: Histogram(f"{PREFIX}_{name}_seconds", text, buckets=buckets, registry=registry)
            for name, (text, buckets) in HISTOGRAMS.items()
        }

    def count(self, name: Counted, amount: float = 1, label: str = "") -> None:
        """See the port."""
        counter = self._counters.get((name, label))
        if counter is None:
            counter = self._counters[name, label] = self._family(name, label)
        counter.inc(amount)

    def level(self, name: Gauged, value: float) -> None:
        """See the port."""
        self._gauges[name].set(value)

    def time(self, name: Timed, seconds: float) -> None:
        """See the port."""
        self._histograms[name].observe(seconds)

    def exposition(self) -> tuple[bytes, str]:
        """What Prometheus wants to read, and its content type; of all workers if there are others."""
        registry = self._registry
        if self._folder:
            registry = CollectorRegistry()
            multiprocess.MultiProcessCollector(registry, path=str(self._folder))
        return generate_latest(registry), CONTENT_TYPE_LATEST

    def _family(self, name: Counted, label: str) -> Counter:
        return self._families[name].labels(label) if COUNTERS[name].label else self._families[name]


def exported() -> frozenset[str]:
    """The names under which the figures can be queried. Sums of what may be negative mean nothing."""
    names = [f"{name}_total" for name in COUNTERS] + list(GAUGES)
    for name, (_, buckets) in HISTOGRAMS.items():
        parts = ("bucket", "count", "sum") if buckets[0] >= 0 else ("bucket", "count")
        names += [f"{name}_seconds_{part}" for part in parts]
    return frozenset(f"{PREFIX}_{name}" for name in names)


def fresh(folder: Path) -> None:
    """Make the folder ready for workers; figures of an earlier run would count twice."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in folder.glob("*.db"):
        file.unlink()


def worker_gone(folder: Path, worker: int) -> None:
    """What a worker had open is open no more; what it counted stays counted."""
    multiprocess.mark_process_dead(worker, str(folder))
