"""Code samples of the guides: what they are, and running them as a reader would."""

import os
import re
import subprocess
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGES = ("README.md", "autograder/templates/bundle/README.md", "notebooks/README.md", "benchmarks/README.md",
         *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md")))  # fmt: skip
FENCE = re.compile(r"^( *)```(\w+)(?: (\w+))?\n(.*?)^\1```", re.M | re.S)


@dataclass(frozen=True)
class Sample:
    """A fenced block: its language, the word behind it that says who runs it, its text."""

    language: str
    kind: str
    text: str


def samples(page):
    """The fenced blocks of a page, in order."""
    found = FENCE.findall((ROOT / page).read_text(encoding="utf-8"))
    return [Sample(language, kind, textwrap.dedent(text)) for _, language, kind, text in found]


def shell(page, kind=""):
    """The commands of a page that are of this kind, block by block."""
    return [sample.text for sample in samples(page) if (sample.language, sample.kind) == ("sh", kind)]


def environment(**more):
    """That of a reader whose `course` is the one under test."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return os.environ | {"COURSE": str(ROOT), "PATH": path} | more


def follow(blocks, folder, environment, seconds=300):
    """Run blocks of commands one after the other in one shell, stopping at the first that fails; what they print."""
    script = "\n".join(f"echo '>>>> block {number}'\n{block}" for number, block in enumerate(blocks, 1))
    done = subprocess.run(["bash", "-eu", "-c", script], cwd=folder, env=environment, capture_output=True, text=True,
                          timeout=seconds)  # fmt: skip
    assert done.returncode == 0, f"{script}\n{done.stdout[-3000:]}\n{done.stderr[-2000:]}"
    return done.stdout
