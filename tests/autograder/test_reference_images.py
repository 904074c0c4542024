"""The reference images: what the repository holds keeps its word, and what does not is found."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from autograder import cli, references
from framework.exr import read_exr, write_exr

CHEAP = "traced_normal"


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """The path of a copy of one image, in a folder that `references` uses instead of its own."""
    path = tmp_path / f"{CHEAP}.exr"
    shutil.copyfile(references.FOLDER / path.name, path)
    monkeypatch.setattr(references, "FOLDER", tmp_path)
    return path


def test_every_reference_is_there_and_they_are_small():
    files = {path.stem: path for path in references.FOLDER.glob("*.exr")}
    assert set(files) == set(references.names())
    assert sum(path.stat().st_size for path in files.values()) < 4 * 2**20
    for path in files.values():
        image, attributes = read_exr(path)
        assert image.dtype == np.float32 and image.size > 1000
        assert {"shows", "scene", "truth", "measure", "error", "standardError", "pixels"} <= set(attributes)
        assert json.loads(attributes["scene"])["method"]


@pytest.mark.parametrize("name", ["traced_distance", CHEAP])
def test_a_stored_image_is_as_near_to_its_truth_as_it_says(name):
    found = references.verify(name)
    assert not found.problem
    assert 0 < found.error <= references.spec(name)["limit"]


def test_a_rebuilt_image_is_the_stored_one(copy):
    stored, _ = read_exr(copy)
    copy.unlink()
    assert not references.build(CHEAP).problem
    np.testing.assert_allclose(read_exr(copy)[0], stored, rtol=0, atol=1e-5)


# Each breaks a copy of the image: what verify then says about it.
def missing(path):
    path.unlink()
    return "is missing; `course references build traced_normal` makes it"


def cut_short(path):
    path.write_bytes(path.read_bytes()[:-500])
    return "damaged"


def no_image(path):
    path.write_bytes(b"P6 2 2 255")
    return "not an OpenEXR file"


def one_pixel_changed(path):
    image, attributes = read_exr(path)
    image[40, 40] += 1e-3
    write_exr(path, image, attributes=_own(attributes))
    return "its pixels are not those that were built"


def not_built_as_a_reference(path):
    write_exr(path, read_exr(path)[0])
    return "the header has no attribute 'error'"


def of_another_scene(path):
    image, attributes = read_exr(path)
    write_exr(path, image, attributes=_own(attributes) | {"scene": attributes["scene"].replace("0.7, 0.7", "0.7, 0.8")})
    return "built from another scene"


def wrong(path):
    """As a build with a wrong function would leave it: all of the header fits the pixels, and says too little."""
    image, attributes = read_exr(path)
    image *= np.float32(0.999)
    write_exr(path, image, attributes=_own(attributes) | {"pixels": references._hash(image)})
    return "the error is 0.001; the header says 1.38e-05"


def wrong_and_frank(path):
    image, attributes = read_exr(path)
    image *= np.float32(0.999)
    own = _own(attributes) | {"pixels": references._hash(image), "error": 2e-3}
    write_exr(path, image, attributes=own)
    return "the header says an error of 0.002; the limit is 3e-05"


def _own(attributes):
    names = ("shows", "scene", "truth", "measure", "error", "standardError", "pixels")
    return {name: attributes[name] for name in names}


@pytest.mark.parametrize(
    "damage",
    [missing, cut_short, no_image, one_pixel_changed, not_built_as_a_reference, of_another_scene, wrong, wrong_and_frank],
    ids=lambda f: f.__name__,
)
def test_verify_says_in_one_sentence_what_is_off_and_exits_1(damage, copy, capsys):
    expected = damage(copy)
    assert cli.main(["references", "verify", CHEAP]) == 1
    *table, problem = capsys.readouterr().out.splitlines()
    assert problem.startswith(f"{CHEAP}: ") and expected in problem
    assert table[1].endswith("NO") and len(table) == 2


def test_verify_prints_a_table_and_exits_0(capsys):
    assert cli.main(["references", "verify", CHEAP]) == 0
    head, row = capsys.readouterr().out.splitlines()
    assert head.split()[:5] == ["image", "truth", "measure", "error", "stated"]
    assert row.split()[:3] == [CHEAP, "analytic", "max"] and row.endswith("yes")


def test_a_build_beyond_its_limit_leaves_the_old_file(copy, monkeypatch):
    from autograder.references import traced

    before = copy.read_bytes()
    right = traced.normal
    monkeypatch.setattr(traced, "normal", lambda spec: right(spec | {"t_max": 10}))
    assert "is beyond its limit 3e-05" in references.build(CHEAP).problem
    assert copy.read_bytes() == before


def test_an_unknown_name_is_refused_with_those_there_are(capsys):
    assert cli.main(["references", "build", "teapot"]) == 2
    assert "no reference 'teapot'; there are traced_distance, " in capsys.readouterr().err


@pytest.mark.drill
def test_all_references_are_proven():
    findings = [references.verify(name) for name in references.names()]
    print(references.table(findings))
    assert not any(found.problem for found in findings)


@pytest.mark.drill
def test_a_machine_of_one_core_without_wide_vectors_builds_the_same_images(tmp_path):
    code = (
        "import pathlib, sys; from autograder import references\n"
        "references.FOLDER = pathlib.Path(sys.argv[1])\n"
        "assert not any(references.build(name).problem for name in references.names())"
    )
    # Another BLAS kernel, no fused products and no vectors beyond SSE in NumPy: other roundings everywhere.
    narrow = {"OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1", "OPENBLAS_CORETYPE": "Nehalem",
              "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4"}  # fmt: skip
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], env={**os.environ, **narrow}, check=True)
    for name in references.names():
        rebuilt, stored = (read_exr(folder / f"{name}.exr")[0] for folder in (tmp_path, references.FOLDER))
        np.testing.assert_allclose(rebuilt, stored, rtol=1e-5, atol=1e-5, err_msg=name)
