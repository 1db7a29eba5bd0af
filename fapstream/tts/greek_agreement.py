"""What a Greek number agrees with: gender, case and number, told by the words around it.

`agreement.tsv` has five columns: kind, word or ending, gender (n, m, f), case (g, a, or empty for the
nominative), number (s, p; x: it is not what is counted); what is empty is left open. Kinds: `before` a word
before the number, `after` a word after it that says more than its ending, `one` and `many` the endings of the
nouns that one and several of something are; the longest ending wins.
`declension.tsv`: nominative, genitive, accusative and, if it differs from the first, vocative.
`names.tsv`: the beginning of a name and its gender.
"""

from __future__ import annotations

from typing import NamedTuple

from fapstream.tts.tables import read_pairs, read_rows

_PLAIN = str.maketrans("άέήίόύώϊϋΐΰς", "αεηιουωιυιυσ")
_ORDINAL = {
    "ns": {"g": "ου", "": "ο"},
    "ms": {"g": "ου", "a": "ο", "": "ος"},
    "fs": {"g": "ης", "": "η"},
    "np": {"g": "ων", "": "α"},
    "mp": {"g": "ων", "a": "ους", "": "οι"},
    "fp": {"g": "ων", "": "ες"},
}


class Form(NamedTuple):
    """Gender, case and number, each "" if it is not known."""

    gender: str = ""
    case: str = ""
    number: str = ""

    @property
    def key(self) -> str:
        """The suffix of the tables in numbers.toml whose words have this form."""
        if self.case == "g":
            return "fg" if self.gender == "f" else "g"
        if self.gender == "m":
            return "ma" if self.case == "a" else "m"
        return "f" if self.gender == "f" else ""

    @property
    def ordinal(self) -> str:
        """The ending of an adjective."""
        endings = _ORDINAL[(self.gender or "n") + ("p" if self.number == "p" else "s")]
        return endings.get(self.case, endings[""])


OPEN = Form()
_MALE = {
    **dict.fromkeys(("", "ος", "ης", "ας", "ς"), Form("m", "", "s")),
    "ου": Form("m", "g", "s"),
    "οι": Form("m", "", "p"),
    "ων": Form("m", "g", "p"),
    "ους": Form("m", "a", "p"),
}
"""What the ending of a man's name says of its form; any other is the accusative."""


class Agreement:
    """Tells forms by words."""

    def __init__(self) -> None:
        """Raises DataError."""
        self._before: dict[str, Form] = {}
        self._tables: dict[str, dict[str, Form]] = {"after": {}, "one": {}, "many": {}}
        for _, (kind, word, *form) in read_rows("el/agreement.tsv", 5):
            if kind == "before":
                self._before[word] = Form(*form)
                self._before.setdefault(plain(word), Form(*form))
            else:
                self._tables[kind][plain(word)] = Form(*form)
        self._names = {plain(stem): gender for stem, gender in read_pairs("el/names.tsv").items()}
        self._cases = {row[0]: row[1:] for _, row in read_rows("el/declension.tsv", 4)}

    def before(self, word: str) -> Form | None:
        """What an article, a preposition or the like before the number says."""
        return self._before.get(word)

    def after(self, word: str, single: bool) -> Form:
        """What the word after the number says."""
        word = plain(word)
        if (form := self._tables["after"].get(word)) is not None:
            return form
        endings = self._tables["one" if single else "many"]
        return next((endings[word[at:]] for at in range(len(word)) if word[at:] in endings), OPEN)

    def form(self, before: str, after: str, single: bool, gender: str = "") -> Form:
        """The form of a cardinal; `gender`: that of its unit if it has one, and then `after` says nothing.

        After a verb in the singular, several of something are its object.
        """
        governor = self.before(before)
        if governor and governor.number == "s" and not single and not gender:
            return Form("n")
        noun = Form(gender) if gender else self.after(after, single)
        if governor is None:
            open_case = noun.gender == "m" and noun.case != "g" and not single
            return noun._replace(case="a") if open_case and plain(before).endswith(("ε", "ει")) else noun
        case = governor.case
        if not case or (noun.case == "g" and not governor.number):
            case = noun.case or case
        usual = "m" if governor.number == "p" and not case else ""
        return Form(gender or governor.gender or noun.gender or usual, case, governor.number)

    def name(self, word: str) -> Form | None:
        """The form of the name of a person, None if it is not a known one."""
        word = plain(word)
        for end in range(len(word), 2, -1):
            if gender := self._names.get(word[:end]):
                ending = word[end:].replace("σ", "ς").removeprefix("ι")
                if gender == "f":
                    return Form("f", "g" if ending.endswith("ς") else "", "s")
                return _MALE.get(ending, Form("m", "a", "s"))
        return None

    def declined(self, words: list[str], case: str) -> list[str]:
        """Words in another case, up to the first that is not in the table."""
        column = {"g": 0, "a": 1, "v": 2}.get(case)
        if column is None:
            return words
        out: list[str] = []
        for at, word in enumerate(words):
            forms = self._cases.get(word)
            if forms is None:
                return out + words[at:]
            out.append(forms[column] or word)
        return out


def plain(word: str) -> str:
    """Lower case without accents, every sigma written one way."""
    return word.lower().translate(_PLAIN)
