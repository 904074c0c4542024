"""A matplotlib figure without pyplot: laid out in inches, nothing global, shown by notebooks at once."""

import io
import sys
import textwrap
from typing import Any

import matplotlib
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

# Inches: around everything, for the title, for a line of the caption.
_MARGIN, _TITLE, _LINE = 0.1, 0.26, 0.17

_INK, _QUIET = "#22252e", "#5c6170"
_STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.size": 9.0,
    "text.color": _INK,
    "axes.labelcolor": _QUIET,
    "axes.labelsize": 8.0,
    "axes.edgecolor": "#b5b9c4",
    "axes.titlesize": 9.5,
    "axes.titlepad": 4.0,
    "axes.linewidth": 0.6,
    "xtick.color": _QUIET,
    "ytick.color": _QUIET,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "image.interpolation": "nearest",
}


class Picture(Figure):
    """A sheet with a title, room for pictures of `width` by `height` inches, and a caption.

    In a notebook, a cell shows it once: when `present` is called, or where a later cell ends with it. Its ground
    is white, so that it reads the same on light and on dark pages.
    """

    def __init__(self, width, height, title=None, caption=None):
        lines = textwrap.wrap(caption or "", int(width * 14.5))
        self._top = _MARGIN + (_TITLE if title else 0.0)
        self._size = (
            width + 2 * _MARGIN,
            self._top + height + _MARGIN + _LINE * len(lines) + 0.05 * bool(lines),
        )
        super().__init__(figsize=self._size, facecolor="white")
        left = _MARGIN / self._size[0]
        if title:
            self.text(left, 1 - _MARGIN / self._size[1], title, va="top", fontsize=11, fontweight="bold")
        if lines:
            low = 0.8 * _MARGIN / self._size[1]
            self.text(left, low, "\n".join(lines), va="bottom", fontsize=8.5, color=_QUIET)

    def axes_at(self, left, top, width, height):
        """Axes at so many inches from the upper left corner of the room for pictures."""
        with matplotlib.rc_context(_STYLE):
            across, down = self._size
            bottom = down - self._top - top - height
            return self.add_axes(((_MARGIN + left) / across, bottom / down, width / across, height / down))

    def image_at(self, left, top, width, height, rgb, title=None):
        """Pixels without ticks, the title above to the left."""
        with matplotlib.rc_context(_STYLE):
            axes = self.axes_at(left, top, width, height)
            axes.imshow(rgb, aspect="auto")
            axes.set_xticks([])
            axes.set_yticks([])
            axes.set_title(title or "", loc="left")

    def bar_at(self, left, top, width, table, low, high, label, ticks=None):
        """A colour bar below a picture that ends `top` inches down, 0.52 inches high with its label."""
        with matplotlib.rc_context(_STYLE):
            axes = self.axes_at(left + 0.16, top + 0.09, width - 0.32, 0.09)
            colors = ScalarMappable(Normalize(low, high), ListedColormap(table / 255.0))
            if ticks is None:
                many = max(2, min(5, int(2 * width)))
                ticks = MaxNLocator(many, steps=[1, 2, 5, 10]).tick_values(low, high)
            ticks = [tick for tick in ticks if low <= tick <= high]
            bar = self.colorbar(colors, cax=axes, orientation="horizontal", ticks=ticks)
            bar.set_ticklabels([f"{0.0 if tick == 0 else tick:g}".replace("-", "−") for tick in ticks])
            bar.outline.set_visible(False)
            bar.set_label(label, labelpad=2)

    def png(self):
        """The picture as PNG bytes, 144 pixels an inch: sharp on today's screens."""
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=144)
        return buffer.getvalue()

    def present(self):
        """Show it where there is a notebook, and return it."""
        if _cell() is not None:
            self._ipython_display_()
        return self

    def is_shown(self):
        """Whether `present` has shown it in a notebook."""
        return hasattr(self, "_shown_in")

    def _ipython_display_(self):
        cell = _cell()
        if cell != getattr(self, "_shown_in", None):
            from IPython.display import Image, display

            self._shown_in = cell
            display(Image(self.png(), retina=True))


def _cell():
    """The number of the notebook cell that runs; None outside notebooks."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return getattr(shell, "execution_count", None) if hasattr(shell, "kernel") else None
