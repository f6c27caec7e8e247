"""What is to be read off a drawn sheet."""

import itertools
from typing import Any

import matplotlib as mpl

from slidepipe.figures import style
from slidepipe.figures.sheet import Sheet


def line(axes: Any, look: Any) -> Any:
    """The one line of these axes that is drawn in a look."""
    (found,) = [one for one in axes.lines if one.get_color() == look["color"] and one.get_zorder() == look["zorder"]]
    return found


def assert_readable(sheet: Sheet) -> None:
    """No two words overlap, all are within the picture, and the legend is beside every panel."""
    with mpl.rc_context(dict(style.SETTINGS)):
        sheet.figure.draw_without_rendering()
        boxes = {f"{text.get_text()} {index}": text.get_window_extent() for index, text in enumerate(_words(sheet))}
    assert len(boxes) > 20
    whole, legend = sheet.figure.bbox.padded(1), sheet.figure.legends[0].get_window_extent()
    assert [name for name, box in boxes.items() if not _inside(box, whole)] == []
    assert [pair for pair in itertools.combinations(boxes, 2) if boxes[pair[0]].overlaps(boxes[pair[1]])] == []
    assert not any(axes.bbox.overlaps(legend) for axes in sheet.figure.axes)


def _words(sheet: Sheet) -> list[Any]:
    """Every text of a picture that has something to say."""
    texts = [sheet.figure._suptitle, *sheet.figure.legends[0].get_texts()]
    for axes in sheet.figure.axes:
        texts += [axes.title, axes._right_title, axes.xaxis.label, axes.yaxis.label]
        texts += [text for text in (*axes.get_xticklabels(), *axes.get_yticklabels()) if _ticked(axes, text)]
    return [text for text in texts if text.get_text()]


def _inside(box: Any, whole: Any) -> bool:
    return bool(whole.contains(box.x0, box.y0) and whole.contains(box.x1, box.y1))


def _ticked(axes: Any, text: Any) -> bool:
    """Whether a tick label is shown: within the scale, and not one that a shared axis hides."""
    x, y = text.get_position()
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    along_x = text in axes.get_xticklabels()
    return bool(text.get_visible()) and (left <= x <= right if along_x else low <= y <= high)
