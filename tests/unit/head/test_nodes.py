"""The hierarchy of a scene: transforms multiply, and what is no tree is refused."""

import numpy as np
import pytest

from fapstream.errors import DataError
from fapstream.head.document import Document
from fapstream.head.nodes import read_nodes, subtree


def nodes(*rows: object) -> list:
    return read_nodes(Document({"asset": {"version": "2.0"}, "nodes": list(rows)}, b"", "x.glb"))


def test_a_child_stands_where_its_parent_puts_it() -> None:
    turned = {"rotation": [0, 0, 0.5**0.5, 0.5**0.5], "scale": [2, 2, 2], "translation": [1, 0, 0]}
    parent, child = nodes({"children": [1], **turned}, {"name": "tip", "translation": [3, 0, 0]})
    np.testing.assert_allclose(child.world[:3, 3], [1, 6, 0], atol=1e-12)
    assert (child.name, child.parent, parent.parent) == ("tip", 0, None)


def test_a_matrix_is_column_major() -> None:
    (node,) = nodes({"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]})
    np.testing.assert_array_equal(node.world[:3, 3], [5, 6, 7])


def test_a_subtree_is_a_node_and_all_that_hang_on_it() -> None:
    tree = nodes({"children": [1, 3]}, {"children": [2]}, {}, {}, {"children": [5]}, {})
    assert subtree(tree, 1) == {1, 2}
    assert subtree(tree, 0) == {0, 1, 2, 3}


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([{"children": [1]}, {"children": [0]}], "its own ancestor"),
        ([{"children": [0]}], "its own ancestor"),
        ([{"children": [2]}, {"children": [2]}, {}], "a child of"),
        ([{"children": [7]}], "not an integer from 0"),
        ([{"children": 1}], "not a list"),
        ([{"rotation": [0, 0, 0, 0]}], "no quaternion"),
        ([{"matrix": [1] * 15}], "not 16 numbers"),
        ([{"translation": [1e300, 0, 0]}], "not a number"),
        ([{"scale": [1e5] * 3, "children": [1]}, {"scale": [1e5] * 3}], "without bounds"),
        ([17], "not an object"),
        ([{}] * 5000, "a list of at most"),
    ],
)
def test_what_is_no_tree_is_refused(rows: list, reason: str) -> None:
    with pytest.raises(DataError, match=rf"x\.glb: .*{reason}"):
        nodes(*rows)
