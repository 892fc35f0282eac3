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


def read(name, scale):
    """Returns interval (s) and samples (m/s2) of a record."""
    file, interval = FILES[name]
    path = RECORDS / file
    if not path.exists():
        raise Missing(path.name)
    lines = path.read_text().splitlines()
    if interval is None:
        # The fourth line has "1991    0.0100    NPTS, DT" or "NPTS=   4156, DT=   0.0050 SEC".
        interval, lines = float(re.findall(r"[\d.]+", lines[3])[1]), lines[4:]
    return interval, [9.81 * scale * float(word) for line in lines for word in line.split()]


def motion(given, end):
    """Returns the kinks of a motion until `end`, and a function that gives its smooth piece around a time."""
    kind = given.get("kind")
    if kind is None:
        return [], lambda middle: lambda t: 0.0
    if kind == "record":
        interval, samples = read(given["record"], given["scale"])

        def line(middle):
            i = int(middle / interval)
            if i + 1 >= len(samples):
                return lambda t: 0.0
            slope = (samples[i + 1] - samples[i]) / interval
            return lambda t: samples[i] + slope * (t - i * interval)

        return [i * interval for i in range(1, len(samples)) if i * interval < end], line
    amplitude, omega = given["a_p"], given["omega_p"]
    wave = {"sine": sin, "cosine": cos}[kind]
    period = 2 * pi / omega
    pulse = lambda middle: (lambda t: amplitude * wave(omega * t)) if middle < period else (lambda t: 0.0)
    return [period], pulse


def pieces(case):
    """Cuts the ground motion of a case into smooth pieces (begin, end, function of t that gives a_gx and a_gz)."""
    end = case["t_end"]
    kinks_x, around_x = motion(case.get("a_gx", {}), end)
    kinks_z, around_z = motion(case.get("a_gz", {}), end)
    cuts = [0.0, *sorted({kink for kink in kinks_x + kinks_z if kink < end}), end]
    found = []
    for begin, stop in zip(cuts, cuts[1:]):
        x, z = around_x((begin + stop) / 2), around_z((begin + stop) / 2)
        found.append((begin, stop, lambda t, x=x, z=z: (x(t), z(t))))
    return found
