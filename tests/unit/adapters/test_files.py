"""Files are read as a whole, and only so much of them."""

from pathlib import Path

import pytest

from fapstream.adapters.files import read_file
from fapstream.errors import InputError


def test_all_of_a_file_or_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(bytes(1 << 20))
    assert len(read_file(path, 1 << 20)) == 1 << 20
    path.write_bytes(bytes((1 << 20) + 1))
    with pytest.raises(InputError, match=r"a\.bin: more than 1 MB"):
        read_file(path, 1 << 20)


def test_a_file_without_an_end_is_refused() -> None:
    with pytest.raises(InputError, match="/dev/zero"):
        read_file(Path("/dev/zero"), 1 << 20)
