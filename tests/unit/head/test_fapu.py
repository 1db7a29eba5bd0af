"""FAPU: ISO/IEC 14496-2, Annex C."""

import pytest

from fapstream.errors import DataError
from fapstream.head.fapu import measure

POINTS = {
    "3.1": (0.03, 0.055, 0.1), "3.3": (0.03, 0.045, 0.1), "3.5": (0.03, 0.05, 0.1), "3.6": (-0.03, 0.05, 0.1),
    "9.15": (0.0, 0.01, 0.11), "2.2": (0.0, -0.01, 0.1), 
    "8.3": (0.025, -0.01, 0.1), "8.4": (-0.025, -0.01, 0.1),
}  # fmt: skip


def test_distances_are_those_of_the_standard() -> None:
    fapu = measure(POINTS)
    expected = {"IRISD0": 0.01, "ES0": 0.06, "ENS0": 0.04, "MNS0": 0.02, "MW0": 0.05}
    assert fapu.as_dict() == pytest.approx(expected)


def test_a_unit_is_a_1024th() -> None:
    fapu = measure(POINTS)
    assert fapu.per_unit("MNS") * 1024 == pytest.approx(0.02)
    assert fapu.per_unit("AU") == 1e-5


def test_a_missing_point_is_named() -> None:
    with pytest.raises(DataError, match=r"MNS0 .*2\.2"):
        measure({name: point for name, point in POINTS.items() if name != "2.2"}, "photo.json")


def test_a_distance_that_is_not_positive_is_refused() -> None:
    with pytest.raises(DataError, match=r"photo\.json: MW0"):
        measure(POINTS | {"8.3": (-0.03, 0.0, 0.0)}, "photo.json")
