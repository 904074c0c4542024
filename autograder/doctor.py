"""What this machine has, what is missing and what is lost without it, and how to get it."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
import sys

STUDENT = ("numpy", "numba", "matplotlib", "pillow", "OpenEXR", "trimesh", "nbformat", "jinja2", "tqdm",
           "platformdirs")  # fmt: skip
OPTIONAL = {
    "flip-evaluator": "perceptual error maps (no mark depends on them)",
    "jupyterlab": "opening notebooks: pip install jupyterlab",
    "nbgrader": "releasing assignments and nbgrader's own commands: pip install .[instructor]",
    "jupytext": "releasing assignments: pip install .[instructor]",
    "pyseccomp": "the system call filter of the sandbox (Linux): pip install .[instructor]",
    "distributed": "grading on a cluster: pip install .[cluster]",
    "playwright": "the tests of pages in a browser: pip install .[dev]",
}
WORTH = {
    "namespaces+seccomp": "strangers' notebooks run apart from this machine, with a system call filter",
    "namespaces": "strangers' notebooks run apart from this machine; without pyseccomp no system call filter",
    "process": "NOT ISOLATED: a notebook can do what you can. On Linux, install bubblewrap "
    "(Debian, Ubuntu: apt-get install bubblewrap); elsewhere grade in a Linux machine, or in WSL 2 on Windows",
}


def report() -> int:
    """Print the findings; 0 where a student's path works, 1 where something that it needs is missing."""
    missing = 0
    _line(sys.version_info >= (3, 11), "Python", platform.python_version(), "3.11 or newer is needed")
    _line(True, "system", f"{platform.system()} {platform.machine()}, {cores()} cores", "")
    for name in STUDENT:
        version = _version(name)
        missing += version is None
        _line(version is not None, name, version or "missing", "pip install .")
    for name, worth in OPTIONAL.items():
        version = _version(name)
        _line(None if version is None else True, name, version or "not installed", worth)
    if os.name == "posix":
        from autograder import cgroup
        from autograder.sandbox import PROCESS, strongest_level

        level = strongest_level()
        _line(None if level == PROCESS else True, "isolation", level, "", always=WORTH[level])
        group = cgroup.delegated()
        _line(True if group else None, "control groups", f"below {group}" if group else "none to be had",
              "memory is bounded for each process, not for all of a sandbox; try `systemd-run --user --scope course ...`")
    else:
        _line(None, "isolation", "none", "grading strangers' notebooks needs Linux, for instance WSL 2")
    from framework import compiled

    done = compiled.is_complete()
    _line(True if done else None, "compiled code", f"in {compiled.folder()}" if done else "none yet",
          "the first picture compiles it, in half a minute")  # fmt: skip
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    _line(True if browser else None, "browser", browser or "not found",
          "the tests that look at pages; Debian, Ubuntu: apt-get install chromium")  # fmt: skip
    print("all that a student needs is here" if not missing else "something that students need is missing, see above")
    return 1 if missing else 0


def _version(name):
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _line(good, name, found, otherwise, always=""):
    mark = {True: "ok     ", False: "MISSING", None: "absent "}[good]
    note = always or ("" if good else otherwise)
    print(f"{mark}  {name:15} {found}" + (f" — {note}" if note else ""))
