"""Components that were planted are found, in order, and what each explains."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.learn.guided_pca import Guide, GuidedPca

JAW, LIPS, ALL = np.arange(2), np.arange(2, 8), np.arange(12)
GUIDES = [Guide(JAW), Guide(LIPS, 3), Guide(JAW), Guide(ALL)]


def planted(n: int = 4000, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows (n, 12), their six factors (n, 6) and what these add (6, 12): one of the jaw that moves all,
    three of the lips that do not move the jaw, a second one of the jaw alone, one of the rest alone."""
    rng = np.random.default_rng(seed)
    factors = rng.normal(size=(n, 6))
    factors = factors - factors.mean(axis=0)
    factors = np.linalg.qr(factors)[0] * np.sqrt(n)
    loads = np.zeros((6, 12))
    loads[0] = [3, 1, *rng.normal(size=10)]
    lips = np.linalg.qr(rng.normal(size=(6, 3)))[0].T
    for k, size in enumerate((4.0, 2.0, 1.0)):
        loads[1 + k, 2:8] = size * lips[k]
        loads[1 + k, 8:] = rng.normal(size=4)
    loads[4, :2] = 0.5 * np.array([1, -3]) / np.sqrt(10)
    loads[5, 8:] = [0.4, 0.2, -0.3, 0.1]
    return factors @ loads + rng.normal(size=12), factors, loads


def test_planted_components_are_found_in_their_order() -> None:
    x, factors, loads = planted()
    pca = GuidedPca(GUIDES).fit(x)
    found = pca.transform(x)
    for k in range(6):
        assert abs(np.corrcoef(found[:, k], factors[:, k])[0, 1]) == pytest.approx(1, abs=1e-6)
        assert np.abs(pca.basis_[k]) == pytest.approx(np.abs(loads[k]), abs=1e-6)


def test_what_they_explain_is_what_was_planted() -> None:
    x, _, loads = planted()
    pca = GuidedPca(GUIDES).fit(x)
    variance = (loads**2).sum(axis=1)
    assert pca.explained_ == pytest.approx(variance / variance.sum(), abs=1e-9)
    assert pca.explained_.sum() == pytest.approx(1)


def test_rows_come_back_from_their_parameters() -> None:
    x, *_ = planted()
    pca = GuidedPca(GUIDES).fit(x)
    assert pca.inverse_transform(pca.transform(x)) == pytest.approx(x, abs=1e-9)
    assert pca.transform(pca.inverse_transform(np.eye(6))) == pytest.approx(np.eye(6), abs=1e-9)


def test_parameters_have_unit_variance_and_nothing_in_common() -> None:
    rng = np.random.default_rng(5)
    x = rng.normal(size=(2000, 12)) @ rng.normal(size=(12, 12))
    found = GuidedPca(GUIDES).fit(x).transform(x)
    assert np.cov(found.T, bias=True) == pytest.approx(np.eye(6), abs=1e-9)


def test_without_guides_it_is_plain_principal_components() -> None:
    rng = np.random.default_rng(6)
    x = rng.normal(size=(2000, 12)) * np.arange(1, 13)
    pca = GuidedPca([Guide(ALL, 12)]).fit(x)
    variances = np.linalg.eigvalsh(np.cov(x.T))[::-1]
    assert pca.explained_ == pytest.approx(variances / variances.sum(), abs=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_greatest_part_has_the_sign_that_was_asked_for_and_of_twins_the_first(sign: int) -> None:
    rng = np.random.default_rng(7)
    score = rng.normal(size=500)
    x = np.outer(score, [0.2, -1.0, 1.0]) + 1e-12 * rng.normal(size=(500, 3))
    pca = GuidedPca([Guide(np.arange(3), sign=sign)]).fit(x)
    assert np.sign(pca.basis_[0, 1]) == sign
