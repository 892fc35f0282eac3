"""Writes 40 ground motions for the studies of this folder: both records, scaled to 4 m/s² and played at twenty speeds.

    python examples/motions.py

They go to the folder `motions` beside this file, as CSV. They stand in for 40 earthquakes, which have to come from a database
(docs/studies/records.md): these have the shapes of two records, and differ in duration and periods alone. Needs Python without packages,
and the program: `target/release/rocking`, or that of the variable ROCKING.
"""

import os
import subprocess
from pathlib import Path

FOLDER = Path(__file__).parent
PROGRAM = os.environ.get("ROCKING", "target/release/rocking")
PEAK = 4.0  # m/s2
STRETCHES = [0.5 + 0.05 * number for number in range(20)]


def main():
    folder = FOLDER / "motions"
    folder.mkdir(exist_ok=True)
    for record in sorted((FOLDER / "records").glob("*.smc")):
        table = subprocess.run([PROGRAM, "record", str(record), "--csv", "-"], check=True, capture_output=True, text=True).stdout
        rows = [line.split(",") for line in table.splitlines() if line[0].isdigit() or line[0] == "-"]
        step = float(rows[1][0]) - float(rows[0][0])
        accelerations = [float(acceleration) for _, acceleration in rows]
        factor = PEAK / max(map(abs, accelerations))
        for stretch in STRETCHES:
            lines = [f"{number * step * stretch:.9g},{factor * value:.9g}" for number, value in enumerate(accelerations)]
            path = folder / f"{record.stem}_{stretch:.2f}.csv"
            path.write_text("\n".join(["t [s],a [m/s2]", *lines, ""]), newline="\n")


if __name__ == "__main__":
    main()
