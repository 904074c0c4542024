"""Draws the goal pictures that open the notebooks: `python -m autograder.goal_pictures NAME...`.

A goal is what the notebook's own `render(width, height)` makes with the reference's functions: what is promised
at the top is what the reader gets at the end.
"""

import contextlib
import sys

import numpy as np

import framework as fw
from autograder.release import ROOT, build_source

WIDTH, HEIGHT, OVERSAMPLING = 720, 480, 3


def draw(name):
    """Render the goal picture of an assignment to `solutions/pictures/NAME.png`.

    Parameters
    ----------
    name : str      a module of `solutions` whose notebook defines `render(width, height)`

    Returns
    -------
    Path            the picture, 720 x 480, averaged over 3 x 3 rays a pixel
    """
    image = run_cells(name)["render"](OVERSAMPLING * WIDTH, OVERSAMPLING * HEIGHT)
    smooth = np.clip(image, 0, 1).reshape(HEIGHT, OVERSAMPLING, WIDTH, OVERSAMPLING, 3).mean(axis=(1, 3))
    path = ROOT / "solutions" / "pictures" / f"{name}.png"
    path.parent.mkdir(exist_ok=True)
    fw.write_image(path, fw.tone_map(smooth))
    return path


def run_cells(name):
    """Run the code cells of an assignment's source, all but the checks, in this process and off screen.

    Returns
    -------
    dict            the names that the cells define
    """
    import matplotlib.pyplot as plt

    plt.switch_backend("Agg")
    namespace = {"__name__": name}
    beside = ROOT / "solutions" / "data" / name
    with contextlib.chdir(beside if beside.is_dir() else ROOT):  # where the notebook finds its files
        for cell in build_source(name).cells:
            if cell.cell_type == "code" and not cell.source.startswith(("from autograder", "check(")):
                exec(compile(cell.source, f"{name}: {cell.id}", "exec"), namespace)
                plt.close("all")
    return namespace


if __name__ == "__main__":
    for name in sys.argv[1:]:
        print(draw(name))
