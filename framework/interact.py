"""Pictures that answer to sliders, in a notebook with a kernel; beside them a strip for those who only read."""

import io
import statistics
import time

import numpy as np

from framework import show

_LEAST_FRAMES = 9  # a strip's time is the median of so many pictures, or of all in it


def interact(draw, strip=3, title=None, **controls):
    """Show what a function draws: as a strip over its first control, and live under a slider for each control.

    Parameters
    ----------
    draw : callable         takes the controls by name, returns a picture: (H, W, 3) display values, uint8, or float
                            in [0, 1] as `fw.tone_map` returns them
    strip : int             pictures of the strip, from the first control's first value to its last
    title : str, optional
    **controls : sequences  the values of each, in order: numbers make a slider that starts in the middle, strings
                            make buttons. An underscore shows as a space: `radius_in_degrees`

    Returns
    -------
    matplotlib.figure.Figure    the strip

    Raises
    ------
    ValueError              without controls, or where one has no values

    Notes
    -----
    Sliders need ipywidgets and a kernel; without them there is the strip alone.
    """
    if not controls or any(len(values) == 0 for values in controls.values()):
        raise ValueError("interact: at least one control is wanted, each with its values")
    at_first = {name: _start(values) for name, values in controls.items()}
    name, values = next(iter(controls.items()))
    chosen = [values[i] for i in np.unique(np.rint(np.linspace(0, len(values) - 1, strip)).astype(int))]
    pictures = [draw(**at_first | {name: value}) for value in chosen]
    seconds = []
    for i in range(max(_LEAST_FRAMES, len(chosen))):
        seconds.append(_timed(draw, at_first | {name: chosen[i % len(chosen)]})[1])
    height, width = np.shape(pictures[0])[:2]
    took = statistics.median(seconds)
    caption = f"{width} × {height} pixels. {_pace(took)}"
    others = [f"{_spoken(other)} = {_shown(value)}" for other, value in at_first.items() if other != name]
    caption += f" Here {', '.join(others)}." if others else ""
    figure = show.strip(pictures, [f"{_spoken(name)} = {_shown(value)}" for value in chosen], title, caption)
    if figure.is_shown():
        _show_live(draw, controls, at_first)
    return figure


def _start(values):
    return values[0] if isinstance(values[0], str) else values[len(values) // 2]


def _timed(draw, settings):
    """The picture as PNG bytes, and the seconds that drawing and packing took."""
    from PIL import Image

    begun = time.perf_counter()
    pixels = show.display_pixels(draw(**settings))
    packed = io.BytesIO()
    Image.fromarray(pixels).save(packed, format="png", compress_level=1)
    return packed.getvalue(), time.perf_counter() - begun


def _show_live(draw, controls, at_first):
    """A picture that is drawn anew whenever a control moves, where ipywidgets is installed."""
    try:
        import ipywidgets
        from IPython.display import display
    except ImportError:
        return
    knobs = {name: _knob(ipywidgets, name, values, at_first[name]) for name, values in controls.items()}
    picture, pace = ipywidgets.Image(format="png"), ipywidgets.Label()

    def redraw(_=None):
        picture.value, seconds = _timed(draw, {name: knob.value for name, knob in knobs.items()})
        pace.value = _pace(seconds)

    for knob in knobs.values():
        knob.observe(redraw, "value")
    redraw()
    display(ipywidgets.VBox([*knobs.values(), picture, pace]))


def _knob(ipywidgets, name, values, start):
    options = [(_shown(value), value) for value in values]
    kind = ipywidgets.ToggleButtons if isinstance(start, str) else ipywidgets.SelectionSlider
    return kind(options=options, value=start, description=_spoken(name), style={"description_width": "initial"})


def _spoken(name):
    return name.replace("_", " ")


def _shown(value):
    return value if isinstance(value, str) else f"{value:.3g}"


def _pace(seconds):
    return f"A picture took {1e3 * seconds:.0f} ms: {1 / seconds:.0f} a second."
