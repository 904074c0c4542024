"""Files that a stranger may hand in: name -> a function that lays one into a folder, and what becomes of it.

The outcome is a status, or None for what is reported and left alone.
"""

import io
import json
import os
import socket
import zipfile

import nbformat

from autograder.samples import filled_notebook

NAME = "sphere_tracing.ipynb"
FEW = dict.fromkeys(("sdf_box", "sdf_torus", "smooth_union", "estimate_normal", "sphere_trace"))


def honest():
    return filled_notebook("sphere_tracing", FEW)


def text_of(notebook):
    return nbformat.writes(notebook)


def _written(content):
    def lay(folder):
        data = content() if callable(content) else content
        (folder / NAME).write_bytes(data if isinstance(data, bytes) else data.encode("utf-8", "surrogatepass"))

    return lay


def _changed(change):
    def content():
        notebook = json.loads(text_of(honest()))
        change(notebook)
        return json.dumps(notebook)

    return _written(content)


def _marked(notebook):
    return [cell for cell in notebook["cells"] if "nbgrader" in cell["metadata"]]


def _zip(entries, damage=False):
    def lay(folder):
        block = io.BytesIO()
        with zipfile.ZipFile(block, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content, mode in entries():
                entry = zipfile.ZipInfo(name)
                entry.external_attr, entry.compress_type = mode << 16, zipfile.ZIP_DEFLATED
                archive.writestr(entry, content)
        data = block.getvalue()
        (folder.parent / f"{folder.name}.zip").write_bytes(data[: len(data) // 2] if damage else data)
        folder.rmdir()

    return lay


def _special(make):
    return lambda folder: make(folder / NAME)


def _socket(path):
    here = os.getcwd()
    os.chdir(path.parent)  # the path of a socket is short
    try:
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(path.name)
    finally:
        os.chdir(here)


def _remove_all(notebook):
    notebook["cells"] = [cell for cell in notebook["cells"] if "nbgrader" not in cell["metadata"]]


def _rename_all(notebook):
    for cell in _marked(notebook):
        cell["metadata"]["nbgrader"]["grade_id"] += "x"


def _raise_points(notebook):
    for cell in _marked(notebook):
        cell["metadata"]["nbgrader"]["points"] = 1e308


def _magics(notebook):
    for cell in _marked(notebook):
        if cell["metadata"]["nbgrader"]["solution"] and cell["cell_type"] == "code":
            cell["source"] = "%matplotlib inline\n!touch /tmp/owned\n" + "".join(cell["source"])


SCRIPT = "<script>document.title='owned'</script>"
GRADED, REJECTED = "graded", "rejected"
FILES = {
    "empty": (_written(b""), REJECTED),
    "not JSON": (_written("hello"), REJECTED),
    "truncated": (_written(lambda: text_of(honest())[:4000]), REJECTED),
    "binary": (_written(os.urandom(5000)), REJECTED),
    "NUL": (_written(bytes(5000)), REJECTED),
    "UTF-16": (_written(lambda: text_of(honest()).encode("utf-16")), REJECTED),
    "with a byte order mark": (_written(lambda: b"\xef\xbb\xbf" + text_of(honest()).encode()), GRADED),
    "huge": (_written(lambda: text_of(honest())[:-1] + " " * (31 << 20) + "}"), REJECTED),
    "deep": (_written("[" * 200_000 + "]" * 200_000), REJECTED),
    "deep in a cell": (_changed(lambda n: n["cells"][0].update(metadata={"a": json.loads("[" * 500 + "]" * 500)})), GRADED),
    "a list": (_written("[]"), REJECTED),
    "format 3": (_written('{"nbformat": 3, "worksheets": [{"cells": []}], "metadata": {}}'), REJECTED),
    "format 99": (_changed(lambda n: n.update(nbformat=99, nbformat_minor=-1)), GRADED),
    "cells of nothing": (_written('{"nbformat": 4, "metadata": {}, "cells": [null, 3, "x", [], {}]}'), REJECTED),
    "numbers beyond floats": (_changed(lambda n: n["metadata"].update(x=10**400)), GRADED),
    "all cells twice": (_changed(lambda n: n["cells"].extend(list(n["cells"]))), GRADED),
    "no solution cells": (_changed(_remove_all), REJECTED),
    "all cells renamed": (_changed(_rename_all), REJECTED),
    "points raised": (_changed(_raise_points), GRADED),
    "magics": (_changed(_magics), GRADED),
    "another assignment's name": (_changed(lambda n: n["metadata"]["course"].update(assignment="../../etc")), GRADED),
    "script in markdown": (_changed(lambda n: n["cells"][0].update(source=SCRIPT)), GRADED),
    "script for a version": (_changed(lambda n: n["metadata"]["course"].update(version=SCRIPT)), GRADED),
    "half a character": (_changed(lambda n: n["cells"][0].update(source="\ud800")), GRADED),
    "a link": (_special(lambda path: path.symlink_to("/etc/passwd")), None),
    "a link to nothing": (_special(lambda path: path.symlink_to("/nowhere")), None),
    "a pipe": (_special(os.mkfifo), None),
    "a socket": (_special(_socket), None),
    "a folder": (_special(lambda path: path.mkdir()), None),
    "a device": (_special(lambda path: path.symlink_to("/dev/zero")), None),
    "zip traversal": (_zip(lambda: [(f"../../../{NAME}", text_of(honest()), 0o644)]), GRADED),
    "zip with a root": (_zip(lambda: [(f"/{NAME}", text_of(honest()), 0o644)]), GRADED),
    "zip bomb": (_zip(lambda: [(NAME, b" " * (300 << 20), 0o644)]), REJECTED),
    "zip of a link": (_zip(lambda: [(NAME, "/etc/passwd", 0o120777)]), REJECTED),
    "zip without notebooks": (_zip(lambda: [("a.txt", "x", 0o644)]), REJECTED),
    "damaged zip": (_zip(lambda: [(NAME, text_of(honest()), 0o644)], damage=True), REJECTED),
}
ODD_NAMES = ["=cmd|' C calc'!A0", "-rf", "a\nb", "'\"<b>&", "..hidden", "日本語", "x" * 200, "con", "a;touch owned;", "%s%n",
             "\u202egnp", b"\xff\xfe".decode("utf-8", "surrogateescape")]  # fmt: skip
