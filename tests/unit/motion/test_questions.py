"""What may be asked about a unit in context."""

from __future__ import annotations

from fapstream.motion.questions import Context, answers, asked, questions
from fapstream.motion.units import features


def test_each_question_is_about_one_feature_of_one_of_the_three() -> None:
    context = Context("B", "AA1", "SIL")
    given = answers(context)
    assert given.shape == (len(questions()),) == (3 * len(asked()),)
    for (place, feature), answer in zip(questions(), given, strict=True):
        assert answer == (feature in features()[context[place + 1]])


def test_units_that_differ_are_told_apart() -> None:
    rows = {unit: answers(Context("SIL", unit, "SIL")).tobytes() for unit in features()}
    assert len(set(rows.values())) == len(features())
