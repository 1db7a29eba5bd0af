"""What is kept for a resumption, against a list of everything ever sent."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from fapstream.protocol.sent import Sent


def test_what_the_other_side_does_not_have_is_sent_again() -> None:
    sent = Sent()
    for data in (b"1", b"2", b"3"):
        sent.append(data, 10)
    assert sent.after(1) == [b"2", b"3"]
    assert sent.after(3) == []
    assert sent.after(4) is None
    sent.forget(2)
    assert (sent.weight, sent.after(1), sent.after(2)) == (10, None, [b"3"])


@given(st.lists(st.tuples(st.sampled_from(["append", "forget", "shrink"]), st.integers(0, 40)), max_size=60))
def test_against_a_plain_list(steps: list[tuple[str, int]]) -> None:
    sent, all_, kept = Sent(), [], 0  # type: ignore[var-annotated]
    for step, n in steps:
        if step == "append":
            all_.append((bytes([n]), n))
            sent.append(bytes([n]), n)
        elif step == "forget":
            kept = max(kept, min(n, len(all_)))
            sent.forget(n)
        else:
            while sum(w for _, w in all_[kept:]) > n:
                kept += 1
            sent.shrink(n)
        assert sent.count == len(all_)
        assert sent.weight == sum(w for _, w in all_[kept:])
        for received in range(len(all_) + 2):
            wanted = [d for d, _ in all_[received:]] if kept <= received <= len(all_) else None
            assert sent.after(received) == wanted
