"""Guided components of planted factors, and what has to hold of any rows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.learn.guided_pca import Guide, GuidedPca

Floats = NDArray[np.float64]
JAW, LIPS, REST = np.arange(3), np.arange(3, 7), np.arange(7, 10)
EVERYTHING = np.arange(10)
GUIDES = [Guide(JAW, sign=-1), Guide(LIPS, 2), Guide(EVERYTHING)]


def planted() -> Floats:
    """Loadings (4, 10): the jaw takes everything along, two factors move lips and what is near them, one
    moves what is left. In the lips' columns the two are orthogonal, and the second is smaller."""
    found = np.zeros((4, 10))
    found[0] = [-3, 1, 0.5, 0.7, -0.4, 0.3, 0.2, 0.1, -0.6, 0.4]
    found[1, LIPS], found[1, REST] = [2, 1, 0, -1], [0.5, 0, 0.3]
    found[2, LIPS], found[2, REST] = [0.5, -1, 0.3, 0], [0, -0.4, 0.2]
    found[3, REST] = [0.2, 0.1, -0.05]
    return found


def factors(rng: np.random.Generator, n: int, k: int) -> Floats:
    """Of n rows, exactly uncorrelated, of mean 0 and variance 1."""
    raw = rng.normal(size=(n, k))
    q, _ = np.linalg.qr(raw - raw.mean(axis=0))
    return np.asarray(q * np.sqrt(n))


def test_planted_factors_are_found_with_what_they_explain() -> None:
    """In the guides' order and to their side, not in the order of their variance over everything."""
    scores, loadings, mean = factors(np.random.default_rng(0), 500, 4), planted(), np.arange(10.0)
    pca = GuidedPca(GUIDES).fit(mean + scores @ loadings)
    np.testing.assert_allclose(pca.mean_, mean, atol=1e-9)
    # the guide wants the jaw's greatest part to be negative, as it is; the others' is positive
    np.testing.assert_allclose(pca.basis_, loadings * np.array([1, 1, -1, 1])[:, None], atol=1e-9)
    power = (loadings**2).sum(axis=1)
    np.testing.assert_allclose(pca.explained_, power / power.sum(), atol=1e-9)
    np.testing.assert_allclose(
        pca.transform(mean + scores @ loadings), scores * np.array([1, 1, -1, 1]), atol=1e-7
    )


def test_planted_factors_are_found_under_noise() -> None:
    rng, loadings = np.random.default_rng(1), planted()
    x = rng.normal(size=(20_000, 4)) @ loadings + 0.02 * rng.normal(size=(20_000, 10))
    pca = GuidedPca(GUIDES).fit(x)
    expected = loadings * np.array([1, 1, -1, 1])[:, None]
    np.testing.assert_allclose(pca.basis_[:3], expected[:3], atol=0.06)
    power = (loadings**2).sum(axis=1)
    np.testing.assert_allclose(pca.explained_[:3], (power / power.sum())[:3], atol=0.02)


def drawn(seed: int) -> tuple[Floats, GuidedPca]:
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(80, 10)) @ rng.normal(size=(10, 10)) + 5 * rng.normal(size=10)
    return x, GuidedPca(GUIDES).fit(x)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_parameters_are_uncorrelated_and_of_unit_variance(seed: int) -> None:
    x, pca = drawn(seed)
    found = pca.transform(x)
    np.testing.assert_allclose(found.mean(axis=0), 0, atol=1e-7)
    np.testing.assert_allclose(np.cov(found, rowvar=False, bias=True), np.eye(4), atol=1e-7)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_parameters_survive_the_rows_made_of_them(seed: int) -> None:
    """The encoder is the basis' own: what one unit of a parameter adds is read as one unit of it alone."""
    _, pca = drawn(seed)
    wanted = np.random.default_rng(seed).normal(size=(3, 5, 4))
    rows = pca.inverse_transform(wanted)
    assert rows.shape == (3, 5, 10)
    np.testing.assert_allclose(pca.transform(rows), wanted, atol=1e-7)
    np.testing.assert_allclose(pca.basis_ @ pca.encoder_, np.eye(4), atol=1e-7)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_what_is_not_explained_is_what_is_left(seed: int) -> None:
    x, pca = drawn(seed)
    left = x - pca.inverse_transform(pca.transform(x))
    assert (pca.explained_ > 0).all()
    assert pca.explained_.sum() == pytest.approx(1 - left.var(axis=0).sum() / x.var(axis=0).sum())
    np.testing.assert_allclose(pca.transform(x).T @ left, 0, atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_a_component_explains_all_that_it_can_of_the_columns_that_guide_it(seed: int) -> None:
    """Of what those before it left there; found by the singular values."""
    x, pca = drawn(seed)
    jaw = x[:, JAW] - x[:, JAW].mean(axis=0)
    first = pca.transform(x)[:, 0]
    explained = 1 - (jaw - np.outer(first, pca.basis_[0, JAW])).var(axis=0).sum() / jaw.var(axis=0).sum()
    values = np.linalg.svd(jaw, compute_uv=False) ** 2
    assert explained == pytest.approx(values[0] / values.sum())


def test_guided_by_everything_it_is_plain_principal_components() -> None:
    rng = np.random.default_rng(2)
    x = rng.normal(size=(60, 5)) @ np.diag([5, 4, 3, 2, 1.0]) + 7
    pca = GuidedPca([Guide(np.arange(5), 5)]).fit(x)
    _, s, vt = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
    np.testing.assert_allclose(pca.explained_, s**2 / (s**2).sum())
    directions = vt * np.sign(vt[np.arange(5), np.abs(vt).argmax(axis=1)])[:, None]
    np.testing.assert_allclose(pca.basis_, directions * (s / np.sqrt(60))[:, None], atol=1e-9)
    np.testing.assert_allclose(pca.inverse_transform(pca.transform(x)), x, atol=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_guide_says_to_which_side(sign: int) -> None:
    x = np.outer(np.linspace(-1, 1, 20), [1.0, -4.0])
    pca = GuidedPca([Guide(np.arange(2), sign=sign)]).fit(x)
    assert np.sign(pca.basis_[0]).tolist() == [-sign, sign]


@pytest.mark.parametrize("still", [JAW, LIPS, EVERYTHING])
def test_what_does_not_move_guides_nobody(still: NDArray[np.int64]) -> None:
    x = np.random.default_rng(3).normal(size=(50, 10))
    x[:, still] = 4.2
    with pytest.raises(ClipError, match="nothing moves"):
        GuidedPca(GUIDES).fit(x)


def test_there_are_no_more_components_than_motions() -> None:
    """What rounding leaves is no component."""
    scores = factors(np.random.default_rng(4), 50, 2)
    x = scores @ np.array([[1.0, 2, 3, 4], [0, 1, 0, -1]])
    assert GuidedPca([Guide(np.arange(4), 2)]).fit(x).explained_.sum() == pytest.approx(1)
    with pytest.raises(ClipError, match="nothing moves"):
        GuidedPca([Guide(np.arange(4), 3)]).fit(x)
