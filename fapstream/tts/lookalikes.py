"""Words that mix Greek and Latin letters: a letter taken for one that looks the same, or two words in one."""

from __future__ import annotations

import re

_LOOKS = dict(zip("ABEZHIKMNOPTYXaikvopuxtwáíóúïµ", "ΑΒΕΖΗΙΚΜΝΟΡΤΥΧαικνορυχτωάίόύϊμ", strict=True))
_GREEK_FOR = str.maketrans(_LOOKS)
_LATIN_FOR = str.maketrans({greek: latin for latin, greek in _LOOKS.items()})
_SCRIPT = re.compile(r"[\u0300-\u03ff\u1f00-\u1fff\W]+|[^\u0370-\u03ff\u1f00-\u1fff]+")
_GREEK = re.compile("[\u0370-\u03ff\u1f00-\u1fff]")


def is_greek(text: str) -> bool:
    """Whether any letter of it is Greek."""
    return _GREEK.search(text) is not None


def one_script(text: str) -> list[str]:
    """A word as words of one script each.

    What a letter of the wrong script looks like decides, if that makes the whole word Greek or else Latin;
    otherwise the word is cut where the script changes.
    """
    greek = text.translate(_GREEK_FOR)
    if is_greek(greek) and len(_parts(greek)) == 1:
        return [greek]
    latin = text.translate(_LATIN_FOR)
    return [latin] if not is_greek(latin) else _parts(text)


def _parts(text: str) -> list[str]:
    return _SCRIPT.findall(text)
