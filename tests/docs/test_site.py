"""The parts of the site's build: mathematics, docstrings, and the follower of links."""

import sys

import pytest

from tests.guides import ROOT

sys.path.insert(0, str(ROOT / "docs" / "site"))
import docstrings
import links
import mathematics


def test_a_formula_becomes_a_picture_that_names_its_source():
    drawn = mathematics.svg(r"\theta = \arcsin \frac{h}{t}")
    assert drawn.startswith("<svg") and r'aria-label="\theta = \arcsin \frac{h}{t}"' in drawn
    assert "currentColor" in drawn and "<script" not in drawn


def test_a_fraction_reaches_further_below_the_line_than_a_letter():
    def below(latex):
        return float(mathematics.svg(latex).split("vertical-align: ")[1].split("px")[0])

    assert below(r"\frac{h}{t}") < below("h") - 4


def test_descriptions_on_the_line_of_their_name_get_a_line_of_their_own():
    lines = ["Sum.", "", "Parameters", "----------", "k : float      1 / sin(angle);", "               larger is harder",
             "", "Notes", "-----", "Two  words stay."]  # fmt: skip
    docstrings._split(None, "function", "f", None, None, lines)
    assert lines == ["Sum.", "", "Parameters", "----------", "k : float", "    1 / sin(angle);", "    larger is harder",
                     "", "Notes", "-----", "Two  words stay."]  # fmt: skip


@pytest.mark.parametrize(
    "written, said",
    [
        ('<a href="b.html#there">', None),
        ('<a href="#here"><p id="here">', None),
        ('<a href="https://example.org/gone">', None),
        ('<a href="c.html">', "links to c.html, which is not there"),
        ('<a href="b.html#nowhere">', "the page has no such place"),
        ('<img src="picture.png" alt="a">', "links to picture.png, which is not there"),
        ('<script src="https://example.org/a.js"></script>', "loads https://example.org/a.js from the network"),
        ('<link rel="stylesheet" href="https://example.org/a.css">', "from the network"),
    ],
)
def test_links_and_pictures_are_followed(written, said, tmp_path):
    (tmp_path / "a.html").write_text(written)
    (tmp_path / "b.html").write_text('<h1 id="there">')
    found = links.problems(tmp_path)
    assert (found == []) if said is None else (len(found) == 1 and said in found[0])
