"""What is kept of a judged notebook: the result, whole or not at all, its pictures, and the page that shows them."""

from __future__ import annotations

import io
import json
import os
from pathlib import Path

from autograder import report

PICTURES = ("yours", "reference", "difference")


def draw(result, judgements) -> dict[str, tuple[bytes, ...]]:
    """The pictures of the judged tasks as PNG, by task id; their captions and scales go into the result."""
    records = {record["id"]: record for record in result["checks"]}
    return {j.task.id: _drawn(j.picture, records[j.task.id]) for j in judgements if j.picture is not None}


def write(result, pictures, out, folder):
    """Write a result with its pictures and page below `out`; the result comes last, whole or not at all."""
    path = Path(out) / "results" / folder / f"{result['assignment']}.json"
    pages = Path(out) / "pages" / folder
    path.parent.mkdir(parents=True, exist_ok=True)
    for record in result["checks"]:
        for name, data in zip(PICTURES, pictures.get(record["id"], ()), strict=False):
            file = pages / result["assignment"] / f"{record['id']}-{name}.png"
            file.parent.mkdir(parents=True, exist_ok=True)
            _replace(file, data)
            record["images"][name] = os.path.relpath(file, path.parent).replace(os.sep, "/")
    report.write_page(result, path, Path(out))
    text = json.dumps(result, indent=1, ensure_ascii=True, allow_nan=False) + "\n"
    _replace(path, text.encode("ascii"))


def _drawn(picture, record):
    """The three pictures as PNG; their caption and scale go into the task's record."""
    from PIL import Image

    from framework.comparison import comparison_images

    shown = comparison_images(picture.yours, picture.expected, picture.kind)
    record.update(kind=shown.kind, scale=shown.scale, caption=f"{picture.caption}. {shown.caption}")
    drawn = []
    for pixels in (shown.yours, shown.expected, shown.difference):
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, format="png", optimize=True)
        drawn.append(file.getvalue())
    return tuple(drawn)


def _replace(path, data):
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_bytes(data)
    os.replace(unfinished, path)
