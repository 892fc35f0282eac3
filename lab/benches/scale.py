#!/usr/bin/env python3
"""A table of a million runs: time, memory and size, and whether a killed study resumes to the same table.

    python lab/benches/scale.py FOLDER [--blocks 1000] [--records 100] [--scales 10] [--threads N] [--lanes N]

Writes artificial ground motions (noise of the spectrum of Kanai and Tajimi with the high pass of Clough and Penzien, 20 s at
0.01 s) and a study into FOLDER, and starts `rocking sweep` in the background. The sweep is killed (SIGKILL) after four tenths
of the rows and resumed. The same number of rows is then computed again from the beginning and compared. Needs NumPy,
`cargo build --release`, and Linux, since memory is read from /proc.
"""

import argparse
import json
import os
import subprocess
import time
from itertools import islice
from pathlib import Path

import numpy as np

ROCKING = Path(os.environ.get("ROCKING", Path(__file__).resolve().parents[2] / "target/release/rocking"))
STUDY = """\
[study]
design = "latin-hypercube"
samples = {blocks}
seed = 1
scales = {scales}

[parameters]
alpha = {{ from = 0.1, to = 0.35 }}
p = {{ from = 0.8, to = 4, spacing = "log" }}
eta = {{ from = 20, to = 100, spacing = "log" }}
xi_v = {{ from = 0.05, to = 0.3 }}
foundation = "viscoelastic"

[[records]]
horizontal = "records/*.txt"
unit = "m/s2"
dt = 0.01
"""


def ground_motion(seed: int, count: int = 2000, dt: float = 0.01) -> np.ndarray:
    """Returns accelerations [m/s2] with a peak of 1 m/s2; the ground's angular frequency is 8 to 20 rad/s."""
    random = np.random.default_rng(seed)
    ground, damping, high_pass = random.uniform(8, 20), 0.6, 1.5
    omega = 2 * np.pi * np.fft.rfftfreq(count, dt)
    kanai = (ground**2 + 2j * damping * ground * omega) / (ground**2 - omega**2 + 2j * damping * ground * omega)
    clough = -(omega**2) / (high_pass**2 - omega**2 + 1.2j * high_pass * omega)
    time = dt * np.arange(count)
    envelope = np.minimum(time / 2, 1) ** 2 * np.exp(-0.4 * np.maximum(time - 8, 0))
    motion = envelope * np.fft.irfft(np.fft.rfft(random.standard_normal(count)) * kanai * clough, count)
    return motion / np.abs(motion).max()


def rows(table: Path) -> int:
    """Returns the number of rows in a table, without its head."""
    if not table.exists():
        return 0
    with table.open("rb") as file:
        return max(sum(1 for line in file if not line.startswith(b"#")) - 1, 0)


def memory(pid: int) -> int:
    """Returns the resident memory of a process [bytes]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def watched(command: list, expected: int, size_of_row: float, table: Path, until: float | None) -> tuple[list, float]:
    """Runs a command and samples it every second; returns pairs of the finished fraction of the table and the memory.

    Kills the command at the fraction `until`.
    """
    begun, seen = time.monotonic(), []
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None:
        time.sleep(1)
        if process.poll() is not None or not table.exists():
            continue
        seen.append((table.stat().st_size / size_of_row / expected, memory(process.pid)))
        if until is not None and seen[-1][0] >= until:
            process.kill()
    printed = process.communicate()[1]
    if process.returncode not in (0, -9):
        raise SystemExit(f"{command}: {printed}")
    return seen, time.monotonic() - begun


def study(folder: Path, blocks: int, scales: int) -> Path:
    path = folder / f"study-{blocks}.toml"
    # From a strength at which no block rocks to one at which nearly all overturn.
    path.write_text(STUDY.format(blocks=blocks, scales=[round(float(s), 3) for s in np.geomspace(1, 10, scales)]))
    return path


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--blocks", type=int, default=1000)
    parser.add_argument("--records", type=int, default=100)
    parser.add_argument("--scales", type=int, default=10)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--lanes", type=int)
    options = parser.parse_args()
    (options.folder / "records").mkdir(parents=True, exist_ok=True)
    for seed in range(options.records):
        np.savetxt(options.folder / f"records/{seed:03}.txt", ground_motion(seed), fmt="%.6e")
    expected = options.blocks * options.records * options.scales
    table = options.folder / "table.csv"
    table.unlink(missing_ok=True)
    command = [ROCKING, "sweep", study(options.folder, options.blocks, options.scales), "--csv", table,
               f"--threads={options.threads}"]
    if options.lanes:
        command.append(f"--lanes={options.lanes}")

    # Size of a row on disk, from a small table.
    small = options.folder / "small.csv"
    small.unlink(missing_ok=True)
    subprocess.run([*command[:2], study(options.folder, 2, options.scales), "--csv", small], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    size_of_row = small.stat().st_size / rows(small)

    first, until_killed = watched(command, expected, size_of_row, table, 0.4)
    kept = rows(table)
    second, after = watched([*command, "--resume"], expected, size_of_row, table, None)
    seconds = until_killed + after
    print(f"{rows(table)} rows of {expected}: {seconds:.0f} s on {options.threads} threads, killed after {kept} rows "
          f"({until_killed:.0f} s) and resumed; {expected / seconds / options.threads:.0f} runs per second and thread")
    print(f"{table.stat().st_size / 1e6:.0f} MB, {table.stat().st_size / expected:.0f} bytes a row")
    for name, seen in (("until killed", first), ("after that", second)):
        at = [0.1, 0.2, 0.3, 0.4] if seen is first else [0.5, 0.7, 0.9, 1.0]
        used = [min(seen, key=lambda pair: abs(pair[0] - part))[1] / 1e6 for part in at]
        print(f"memory {name}: " + ", ".join(f"{mb:.1f} MB at {part:.0%}" for part, mb in zip(at, used)))

    # The same study from its beginning, to compare its first rows and those around the kill.
    again = options.folder / "again.csv"
    again.unlink(missing_ok=True)
    process = subprocess.Popen([*command[:4], again, *command[5:]], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and (not again.exists() or again.stat().st_size < 0.41 * expected * size_of_row):
        time.sleep(1)
    process.kill()
    process.wait()
    count = rows(again)
    with table.open() as one, again.open() as other:
        pairs = zip(one, islice(other, count))
        different = sum(a != b for a, b in pairs)
    print(json.dumps({"compared": count, "rows_across_the_kill": max(count - kept, 0), "different": different}))


if __name__ == "__main__":
    main()
