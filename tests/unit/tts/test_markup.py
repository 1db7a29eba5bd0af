"""Tags of SSML one by one."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.markup import PLAIN, Tag, break_ms, parse, styled


def tag(text: str) -> Tag:
    found = parse(text)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("text", "name", "kind"),
    [
        ("<speak>", "speak", "open"),
        ("</speak>", "close", ""),
        ("< break time = '20ms' />", "break", "empty"),
        ('<prosody rate="slow" pitch="+2st">', "prosody", "open"),
        ("<mark name='here'/>", "mark", "empty"),
        ("<!-- a comment -->", "", "empty"),
        ('<?xml version="1.0"?>', "", "empty"),
    ],
)
def test_tags(text: str, name: str, kind: str) -> None:
    found = tag(text)
    assert (found.name, found.kind) == ((name, kind) if kind else ("speak", "close"))


@pytest.mark.parametrize(
    "text",
    [
        "<b>",
        "<>",
        "< >",
        "<3>",
        "<prosody rate='quick'>",
        "<prosody volume='120'>",
        "<emphasis level='huge'>",
        "<break time='soon'/>",
        "<break time='-1s'/>",
        "<break strength='mighty'/>",
        "<sub>",
        "<sub alias=' '>",
        "<say-as interpret-as='song'>",
        "<say-as>",
        "<phoneme>",
        "<mark/>",
        "<lang xml:lang='fr'>",
        "</b>",
        "</sub alias='x'>",
        "</speak/>",
        "<speak",
        "<mark name=x/>",
        "<mark name='a' 'b'/>",
    ],
)
def test_what_is_no_tag(text: str) -> None:
    assert parse(text) is None


@pytest.mark.parametrize(
    ("text", "ms"),
    [
        ("<break/>", 350),
        ("<break time='250ms'/>", 250),
        ("<break time='1.5s'/>", 1500),
        ("<break strength='none'/>", 0),
        ("<break strength='x-strong'/>", 1200),
        ("<break time='999s'/>", 10_000),
    ],
)
def test_breaks(text: str, ms: float) -> None:
    assert break_ms(tag(text)) == ms


@pytest.mark.parametrize(
    ("attributes", "name", "value"),
    [
        ("rate='fast'", "rate", 1.35),
        ("rate='50%'", "rate", 0.5),
        ("rate='+20%'", "rate", 1.2),
        ("rate='2'", "rate", 2.0),
        ("rate='99'", "rate", 4.0),
        ("rate='-99%'", "rate", 0.25),
        ("pitch='high'", "pitch", 1.2),
        ("pitch='+12st'", "pitch", 2.0),
        ("pitch='-10%'", "pitch", 0.9),
        ("range='x-low'", "range", 0.7),
        ("volume='silent'", "volume", 0.0),
        ("volume='+6dB'", "volume", 1.995),
        ("volume='50'", "volume", 0.5),
        ("volume='+20dB'", "volume", 4.0),
    ],
)
def test_prosody(attributes: str, name: str, value: float) -> None:
    style = styled(PLAIN, tag(f"<prosody {attributes}>"))
    assert getattr(style, name) == pytest.approx(value, abs=1e-3)
    others = {n for n in ("rate", "pitch", "range", "volume", "emphasis") if n != name}
    assert all(getattr(style, n) == getattr(PLAIN, n) for n in others)


def test_styles_are_inside_each_other() -> None:
    slow = styled(PLAIN, tag("<prosody rate='50%' volume='50'>"))
    both = styled(styled(slow, tag("<prosody rate='+50%'>")), tag("<emphasis level='strong'>"))
    assert (both.rate, both.volume, both.emphasis) == (0.75, 0.5, 0.8)
    assert styled(both, tag("<lang xml:lang='el-GR'>")).lang == "el"
    assert styled(both, tag("<emphasis level='none'>")).emphasis == 0.0


@given(st.text(alphabet="<>/='\" abprosdy-rate:1%.", max_size=80).map(lambda t: f"<{t}>"))
def test_any_text_is_a_tag_or_none(text: str) -> None:
    found = parse(text)
    assert found is None or found.kind in ("open", "close", "empty")
