"""Errors, spreads and costs of the settings in the table that collect.py makes."""
import csv
import math
import statistics
import tomllib

QUANTITIES = {  # of plan's table: those measured that it is made of
    "flow_stress": ["flow_stress"],
    "composite_stress": ["composite_stress"],
    "shape_factor": ["shape_factor"],
    "pore_volume": ["pore_start", "pore_pressed"],
    "foam_stress": ["foam_stress"],
}
BASE_FILTER = "level-set"


class Results:
    """Rows of results.csv, and what errors are counted from."""

    def __init__(self, table, reference):
        with open(table) as file:
            self.rows = list(csv.DictReader(file))
        for row in self.rows:
            for key in ("size", "rate", "value", "particles", "steps", "cpu_solve", "cpu_prepare", "peak_bytes"):
                row[key] = float(row[key]) if row[key] else math.nan
            row["step_number"] = float(row["step"])
        with open(reference, "rb") as file:
            self.reference = tomllib.load(file)

    def of(self, **wanted):
        return [row for row in self.rows if all(row[key] == value for key, value in wanted.items())]

    def values(self, key, of, **wanted):
        return sorted({row[key] for row in self.of(**wanted) if row["quantity"] in of})

    def base(self, quantity, law):
        """The step that was taken most often: that of the sweep over sizes."""
        steps = [row["step"] for row in self.of(law=law, rate=1.0, filter=BASE_FILTER)
                 if row["quantity"] in QUANTITIES.get(quantity, [quantity])]
        return max(sorted(set(steps), key=float), key=steps.count, default=None)

    def truth(self, quantity, rate=1.0):
        """The value that is right; of what has none the mean of the finest step of the finest size of norton."""
        known = self.reference.get(quantity, {}).get(f"{rate:g}")
        if known is not None:
            return known
        law = "norton" if self.of(quantity=quantity, law="norton") else self.rows[0]["law"]
        rows = self.of(quantity=quantity, law=law, filter=BASE_FILTER, rate=rate)
        finest = max((row["size"], -row["step_number"]) for row in rows)
        return statistics.mean(row["value"] for row in rows if (row["size"], -row["step_number"]) == finest)

    def errors(self, quantity, **setting):
        """Error of each packing, signed share."""
        truth = self.truth(quantity, setting.get("rate", 1.0))
        return [row["value"] / truth - 1 for row in self.of(quantity=quantity, **setting)]


def spread(values):
    return statistics.stdev(values) if len(values) > 1 else 0.0
