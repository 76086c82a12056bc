"""Curves and points over axes as an SVG file, by nothing but text."""
import math
from xml.sax.saxutils import escape

COLOURS = ("#1f4e8c", "#c1440e", "#2e7d4f", "#7a3b8f", "#8a6d1a", "#444444")


def ticks(low, high, about=6):
    """Round numbers between low and high, so many or a few less."""
    raw = (high - low) / about
    size = 10.0 ** math.floor(math.log10(raw))
    size *= next(m for m in (1, 2, 5, 10) if m * size >= raw * (1 - 1e-9))
    first = math.ceil(low / size - 1e-9)
    return [k * size for k in range(first, math.floor(high / size + 1e-9) + 1)]


class Drawing:
    """One pair of axes. Data are added as `line` and `points`, each with its name for the legend; `write` draws them."""

    def __init__(self, title, x_name, y_name, x_range=None, y_range=None, size=(720, 460)):
        self._title, self._names, self._ranges, self._size = title, (x_name, y_name), [x_range, y_range], size
        self._data = []

    def line(self, x, y, name, colour, dashed=False):
        self._data.append(("dashed" if dashed else "line", list(x), list(y), name, colour))

    def points(self, x, y, name, colour):
        self._data.append(("points", list(x), list(y), name, colour))

    def _range(self, axis):
        if self._ranges[axis]:
            return self._ranges[axis]
        values = [v for data in self._data for v in data[1 + axis] if math.isfinite(v)]
        low, high = min(values), max(values)
        margin = 0.05 * (high - low or 1)
        return low - margin, high + margin

    def write(self, path):
        width, height = self._size
        left, right, top, bottom = 66, width - 16, 40, height - 50
        (x0, x1), (y0, y1) = self._range(0), self._range(1)
        sx = lambda x: left + (x - x0) / (x1 - x0) * (right - left)
        sy = lambda y: bottom - (y - y0) / (y1 - y0) * (bottom - top)
        out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
               'font-family="sans-serif" font-size="13">', f'<rect width="{width}" height="{height}" fill="white"/>',
               f'<clipPath id="inside"><rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}"/></clipPath>']
        text = lambda x, y, words, how="": out.append(f'<text x="{x:.1f}" y="{y:.1f}" {how}>{escape(words)}</text>')
        for v in ticks(x0, x1):
            out.append(f'<path d="M{sx(v):.1f},{top}V{bottom}" stroke="#dddddd"/>')
            text(sx(v), bottom + 18, f"{v:.6g}", 'text-anchor="middle"')
        for v in ticks(y0, y1):
            out.append(f'<path d="M{left},{sy(v):.1f}H{right}" stroke="#dddddd"/>')
            text(left - 6, sy(v) + 4, f"{v:.6g}", 'text-anchor="end"')
        out.append(f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" fill="none" stroke="#444444"/>')
        text(0.5 * (left + right), 24, self._title, 'text-anchor="middle" font-size="15"')
        text(0.5 * (left + right), height - 12, self._names[0], 'text-anchor="middle"')
        middle = 0.5 * (top + bottom)
        text(18, middle, self._names[1], f'text-anchor="middle" transform="rotate(-90 18 {middle:.1f})"')
        for k, (kind, xs, ys, name, colour) in enumerate(self._data):
            places = [(sx(x), sy(y)) for x, y in zip(xs, ys) if math.isfinite(x) and math.isfinite(y)]
            if kind == "points":
                out.append(f'<g clip-path="url(#inside)" fill="{colour}">'
                           + "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3"/>' for x, y in places) + "</g>")
            else:
                dashes = ' stroke-dasharray="6 4"' if kind == "dashed" else ""
                out.append(f'<polyline clip-path="url(#inside)" fill="none" stroke="{colour}" stroke-width="1.6"{dashes} points="'
                           + " ".join(f"{x:.1f},{y:.1f}" for x, y in places) + '"/>')
            row = top + 20 + 18 * k
            if kind == "points":
                out.append(f'<circle cx="{left + 24}" cy="{row - 4}" r="3" fill="{colour}"/>')
            else:
                out.append(f'<path d="M{left + 12},{row - 4}h24" stroke="{colour}" stroke-width="1.6"{dashes}/>')
            text(left + 44, row, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(out + ["</svg>"]) + "\n", encoding="utf-8")
