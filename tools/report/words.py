"""Numbers and colours as a reader sees them."""
import csv
import math

import numpy as np

INK, ORANGE, BLUE, GREY, INDIGO = "#28303c", "#d55e00", "#0072b2", "#9aa3af", "#3d3d8f"
LIGHT_GREY = (203, 208, 214)
# Okabe & Ito; the colours of `render`.
OKABE_ITO = ((213, 94, 0), (0, 114, 178), (0, 158, 115), (230, 159, 0), (204, 121, 167), (86, 180, 233), (240, 228, 66))


def hexadecimal(colour):
    return "#{:02x}{:02x}{:02x}".format(*colour)


def object_colour(number):
    """As tools/render/appearance.cpp: seven hues at three lightnesses."""
    if number == 0:
        return hexadecimal(LIGHT_GREY)
    hue = OKABE_ITO[(number - 1) % 7]
    lightness = (1.0, 0.72, 1.3)[(number - 1) // 7 % 3]
    return hexadecimal([int(v * lightness if lightness <= 1 else 255 - (255 - v) * (2 - lightness)) for v in hue])


def phase_colours(species, matrix):
    """Label -> colour, the matrix in grey, the others in the order of their labels."""
    others = [label for label in sorted(species) if label != matrix]
    return {matrix: hexadecimal(LIGHT_GREY), **{label: hexadecimal(OKABE_ITO[k % 7]) for k, label in enumerate(others)}}


def read_table(path):
    """Column name without its unit -> values, texts where they are no numbers; an empty cell is not a number."""
    with open(path, newline="") as file:
        head, *rows = csv.reader(file)
    columns = list(zip(*rows)) if rows else [()] * len(head)

    def values(cells):
        try:
            return np.array([float(cell) if cell else np.nan for cell in cells])
        except ValueError:
            return list(cells)

    return {name.split(" [")[0]: values(column) for name, column in zip(head, columns)}


def number(value, digits=3):
    text, _, power = f"{value:.{digits}g}".replace("-", "−").partition("e")
    return f"{text}·10{str(int(power.replace('−', '-'))).translate(SUPERSCRIPT)}" if power else text


SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def in_unit(text, unit):
    """As the label of an axis or of a column."""
    return f"{text} [{unit}]".strip() if unit else text


def quantity(value, unit, digits=4):
    """A whole number as it is, another one with so many digits; with its unit, kPa for the small stresses of open structures."""
    if unit == "MPa" and 0 < abs(value) < 0.1:
        value, unit = 1000.0 * value, "kPa"
    text = count(value) if isinstance(value, int) else number(value, digits)
    return f"{text} {unit}".strip()


def fixed(value, digits):
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if float(text) == 0 else text.replace("-", "−")


def percent(value, digits=2):
    return f"{fixed(100 * value, digits)} %"


def count(value):
    return f"{value:,}".replace(",", "\u202f")


def plural(value, word):
    return f"{count(value)} {word}{'s' * (value != 1)}"


def seconds(value):
    if value < 60:
        return f"{value:.1f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def mebibytes(value):
    return f"{count(round(value / 2**20))} MiB"


def length(mm, digits=3):
    if not math.isfinite(mm):
        return "unknown"
    for factor, unit in ((1e-3, "m"), (1, "mm"), (1e3, "µm"), (1e6, "nm")):
        if abs(mm) * factor >= 0.9995:
            break
    return f"{number(mm * factor, digits)} {unit}"
