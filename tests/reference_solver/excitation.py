"""Ground motions of the cases, cut at their kinks."""

import re
from math import cos, pi, sin
from pathlib import Path

RECORDS = Path(__file__).resolve().parents[3] / "shared/records"
# File and interval (s) of each record; None: the file's header has it. All in g, taken as 9.81 m/s2.
FILES = {
    "rinaldi": ("paper/NGA_no_1063_RRS228.AT2", None),
    "erzincan": ("paper_derived/ERZ-NS_unrotated.AT2", None),
    "sylmar052": ("paper/SCS052.AT2", 0.005),
    "sylmar_up": ("paper/SCSUP.AT2", 0.005),
}


class Missing(Exception):
    """A record that may not be redistributed is not at hand."""


def read(given):
    """Returns interval (s) and samples (m/s2) of a record."""
    file, interval = FILES[given["record"]] if "record" in given else (given["file"], None)
    path = RECORDS / file
    if not path.exists():
        raise Missing(path.name)
    lines = path.read_text().splitlines()
    if interval is None:
        # The fourth line has "1991    0.0100    NPTS, DT" or "NPTS=   4156, DT=   0.0050 SEC".
        interval, lines = float(re.findall(r"[\d.]+", lines[3])[1]), lines[4:]
    return interval, [9.81 * given["scale"] * float(word) for line in lines for word in line.split()]


def motion(given, end):
    """Returns the kinks of a motion until `end`, and a function that gives its smooth piece around a time."""
    if not given:
        return [], lambda middle: lambda t: 0.0
    start = given.get("start", 0.0)
    if given["kind"] == "record":
        # From the record's time `start` on.
        interval, samples = read(given)

        def line(middle):
            i = int((middle + start) / interval)
            if i + 1 >= len(samples):
                return lambda t: 0.0
            slope = (samples[i + 1] - samples[i]) / interval
            return lambda t: samples[i] + slope * (t + start - i * interval)

        kinks = [i * interval - start for i in range(1, len(samples))]
        return [kink for kink in kinks if 0 < kink < end], line
    # One period, from `start` on.
    amplitude, omega = given.get("a_p", given.get("a")), given.get("omega_p", given.get("omega"))
    wave = {"sine": sin, "cosine": cos}[given["kind"]]
    stop = start + 2 * pi / omega

    def pulse(middle):
        if start < middle < stop:
            return lambda t: amplitude * wave(omega * (t - start))
        return lambda t: 0.0

    return [kink for kink in (start, stop) if 0 < kink < end], pulse


def pieces(motions, end):
    """Cuts motions into smooth pieces (begin, end, function of t that gives each motion's acceleration)."""
    motions = [motion(given, end) for given in motions]
    cuts = [0.0, *sorted({kink for kinks, _ in motions for kink in kinks}), end]
    found = []
    for begin, stop in zip(cuts, cuts[1:]):
        smooth = [around((begin + stop) / 2) for _, around in motions]
        found.append((begin, stop, lambda t, smooth=smooth: [piece(t) for piece in smooth]))
    return found
