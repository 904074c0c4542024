"""Compiled code: found by name, compiled once, and for exactly the types that it is called with."""

import ast
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from framework import compiled

ROOT = Path(__file__).resolve().parents[2]
MODULES = compiled.kernel_modules()


def run(code, cache, **environment):
    """What a fresh process says on stdout and stderr, with its compiled code kept in `cache`."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(ROOT)} | environment,
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout, done.stderr


def imports(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from names if node.module in ("framework", "solutions", "solutions.fast") else [node.module]
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def test_whatever_compiles_is_in_a_module_that_is_named_as_a_kernel():
    paths = [path for home in ("framework", "solutions") for path in (ROOT / home).rglob("*.py")]
    compiling = {".".join(path.relative_to(ROOT).with_suffix("").parts) for path in paths if "njit" in path.read_text()}
    assert compiling and compiling == set(MODULES)


@pytest.mark.parametrize("name", MODULES)
def test_a_kernel_depends_on_no_source_that_its_cache_is_not_keyed_by(name):
    ours = {module for module in imports(ROOT / (name.replace(".", "/") + ".py"))
            if module.split(".")[0] in ("framework", "solutions", "autograder")}  # fmt: skip
    assert ours <= set(MODULES)


@pytest.mark.parametrize("name", MODULES)
def test_a_kernel_module_compiles_itself(name):
    import_module(name).warm()


FIRST_USE = """
import sys
from framework import compiled
compile_all = compiled._compile_all
compiled._compile_all = lambda names: compile_all(["framework.lookup_kernel"])
assert "numba" not in sys.modules
print(compiled.is_complete())
from framework.lookup_kernel import bilinear, warm
warm()
print(compiled.is_complete(), sum(bilinear.stats.cache_misses.values()))
"""


def test_the_first_use_compiles_with_a_progress_line_and_later_ones_find_it_done(tmp_path):
    said, progress = run(FIRST_USE, tmp_path)
    assert said.split() == ["False", "True", "0"] and "1/1" in progress
    said, progress = run(FIRST_USE, tmp_path)
    assert said.split() == ["True", "True", "0"] and not progress


PREPARE = """
from framework import compiled
compile_all = compiled._compile_all
compiled._compile_all = lambda names: compile_all(["framework.no_kernel"])
compiled.prepare()
print(compiled.is_complete())
"""


def test_a_module_that_cannot_be_compiled_is_told_once_and_stops_nothing(tmp_path):
    said, warning = run(PREPARE, tmp_path)
    assert said == "True\n" and "framework.no_kernel could not be compiled: ModuleNotFoundError" in warning
    assert run(PREPARE, tmp_path) == ("True\n", "")


def test_a_process_that_has_ended_is_replaced():
    crew = compiled._Compiler()
    try:
        crew._process.kill()
        crew._process.wait()
        assert crew.compile("framework.no_kernel").startswith("ModuleNotFoundError")
        assert crew.compile("math").startswith("AttributeError")  # by the same one
    finally:
        crew.close()


def test_a_process_that_ends_while_it_compiles_is_told(monkeypatch):
    monkeypatch.setattr(compiled._Compiler, "_CODE", "input()")
    crew = compiled._Compiler()
    try:
        assert "ended" in crew.compile("framework.lookup_kernel")
    finally:
        crew.close()


def test_where_compiled_code_is_to_be_copied_nothing_is_compiled_ahead(tmp_path):
    assert run(PREPARE, tmp_path, **{compiled.COPIED_FROM: ""}) == ("False\n", "")


def test_a_changed_source_another_version_and_another_place_have_a_cache_of_their_own(monkeypatch, tmp_path):
    def key():
        compiled.folder.cache_clear()
        return compiled.folder().name

    keys = [key(), key()]
    with monkeypatch.context() as patch:
        changed = tmp_path / "changed.py"
        changed.write_text("# changed")
        original = compiled._source
        patch.setattr(compiled, "_source", lambda name: changed if "lookup" in name else original(name))
        keys.append(key())
    for name, other in (("version", "3.0"), ("path", "x")):
        with monkeypatch.context() as patch:
            if name == "version":
                patch.setattr(sys, "version", other)
            else:
                patch.setattr(compiled, "_processor", lambda other=other: other)
            keys.append(key())
    compiled.folder.cache_clear()
    assert keys[0] == keys[1] and len(set(keys)) == 4


def test_a_module_is_keyed_by_the_kernels_that_it_names_and_by_no_others(monkeypatch, tmp_path):
    before = compiled._keys()
    changed = tmp_path / "changed.py"
    changed.write_text("# changed")
    original = compiled._source
    monkeypatch.setattr(compiled, "_source", lambda name: changed if name.endswith("raster_grid_kernels") else original(name))
    differing = {name for name, key in compiled._keys().items() if key != before[name]}
    assert {"framework.raster_grid_kernels", "framework.raster_kernels", "framework.resolve_kernel"} <= differing
    assert "framework.lookup_kernel" not in differing


def test_compiled_code_of_unchanged_modules_is_taken_over(monkeypatch, tmp_path):
    home = tmp_path / "compiled-old" / "framework_x"
    home.mkdir(parents=True)
    for name in ("a_kernel.f-1.py311.nbi", "b_kernel.f-1.py311.nbi"):
        (home / name).touch()
    (tmp_path / "compiled-old" / "complete").write_text('{"framework.a_kernel": "k", "framework.b_kernel": "k"}')
    (tmp_path / "compiled-new").mkdir()
    monkeypatch.setattr(compiled, "folder", lambda: tmp_path / "compiled-new")
    assert compiled._take_over("framework.a_kernel", "k") and not compiled._take_over("framework.b_kernel", "other")
    assert [path.name for path in (tmp_path / "compiled-new").rglob("*.*")] == ["a_kernel.f-1.py311.nbi"]


def test_folders_that_nobody_asked_for_in_a_month_are_removed(monkeypatch, tmp_path):
    for name in ("compiled-old", "compiled-new", "compiled-mine", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "complete").touch()
    for name in ("compiled-old", "other"):
        os.utime(tmp_path / name / "complete", (0, 0))
    monkeypatch.setattr(compiled, "folder", lambda: tmp_path / "compiled-mine")
    compiled._remove_unused()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["compiled-mine", "compiled-new", "other"]


USED = """
import numpy as np
import framework as fw
from framework import compiled, mesh as shapes
import importlib
modules = [importlib.import_module(name) for name in compiled.kernel_modules()]
for module in modules:
    module.warm()
def kernels():
    return {f: len(f.signatures) for m in modules for f in vars(m).values() if hasattr(f, "signatures")}
before = kernels()
camera = fw.Camera((0.3, 0.5, 2.6), (0, 0, 0), (0, 1, 0), 0.9)
mesh = shapes.bumpy_sphere(1000)
for mesh in (mesh, fw.Mesh(mesh.vertices, mesh.faces)):
    for channels in ((), ("depth",), ("position", "normal"), ("barycentric", "uv")):
        fw.rasterize(mesh, camera, 64, 48, channels=channels)
env, directions = fw.skies.gradient(16), np.ones((5000, 3))
env.radiance(directions)
env.radiance(np.broadcast_to(directions[0], (5000, 3)))
print([f.__name__ for f, count in kernels().items() if count != before[f]])
"""


def test_warming_up_compiles_all_that_is_called():
    compiled.prepare()
    said, _ = run(USED, compiled.folder().parent)
    assert said.strip() == "[]"
