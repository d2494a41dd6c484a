"""What differs between a distributed and the serial run of a case."""

import numpy as np

TOL = 1e-9


def differences(serial, other):
    """Sentences; none: both agree to 1e-9."""
    for found, whose in ((serial, "the serial run "), (other, "")):
        if "failure" in found:
            return [whose + found["failure"]]
    if serial["error"]:
        return [f"the serial run raises {serial['error']}"]
    if other["error"] or any(other["errors"]):
        return [f"raises, rank by rank: {other['errors']}"]
    faults = [f"ranks {other['other']} have other results"] if other["other"] else []
    if other["talkers"]:
        faults.append(f"ranks {other['talkers']} print, too")
    return faults + different(serial["values"], other["values"])


def different(serial, other):
    if serial.keys() != other.keys():
        return [f"other results: {sorted(serial.keys() ^ other.keys())}"]
    pairs = {name: (serial[name], other[name]) for name in serial}
    found = {name: distance(*one, two[0]) for name, (one, two) in pairs.items()}
    return [f"{name}: {found[name]}" for name in found if found[name]]


def distance(expected, size, value):
    """In words, or an empty text; texts and whole numbers have to be equal."""
    one, two = np.asarray(expected), np.asarray(value)
    if one.shape != two.shape:
        return f"shape {two.shape} for {one.shape}"
    if one.dtype.kind not in "f":
        same = np.array_equal(one, two)
        return "" if same else f"{shown(two, one)} for {shown(one, two)}"
    if not np.array_equal(np.isnan(one), np.isnan(two)):
        return "NaN in other places"
    one, two = np.nan_to_num(one), np.nan_to_num(two)  # gaps without a partner
    size = float(np.abs(one).max(initial=0.0)) if size is None else size
    off = float(np.abs(one - two).max(initial=0.0))
    return "" if off <= TOL * size else f"differs by {off / size if size else off:.1e}"


def shown(one, two):
    """The entries that are others, the first of them."""
    entries = one[one != two] if one.ndim else one
    return str(entries.tolist() if np.ndim(entries) == 0 else entries[:8].tolist())


def largest(serial, other):
    """The largest relative difference of all numbers of a case."""
    worst = 0.0
    for name, (expected, size) in serial["values"].items():
        one, two = np.asarray(expected), np.asarray(other["values"][name][0])
        if one.dtype.kind == "f" and one.size:
            one, two = np.nan_to_num(one), np.nan_to_num(two)
            size = float(np.abs(one).max()) if size is None else size
            off = float(np.abs(one - two).max())
            worst = max(worst, off / size if size else off)
    return worst
